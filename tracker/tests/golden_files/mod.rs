//! Where golden cases are, and how their numbers are read and compared.

use std::path::{Path, PathBuf};

use serde_json::Value;

/// Every JSON file of `tests/golden/FOLDER`, or of `GOLDEN_DIR` (or its sub-folder of that name).
pub(crate) fn golden_files(folder: &str) -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let parent = std::env::var_os("GOLDEN_DIR").map_or(own, PathBuf::from);
    let folder = if parent.join(folder).is_dir() { parent.join(folder) } else { parent };
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    files
}

/// The list that `value` is.
pub(crate) fn array(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("not a list: {value}"))
}

/// The number that `value` is.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("not a number: {value}"))
}

/// The numbers of a list.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    array(value).iter().map(number).collect()
}
