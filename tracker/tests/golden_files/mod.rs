//! Where golden cases are, and how their numbers are read and compared.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// Every JSON file of `tests/golden/FOLDER`, or of `GOLDEN_DIR` (or its sub-folder of that name).
pub(crate) fn golden_files(folder: &str) -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let parent = std::env::var_os("GOLDEN_DIR").map_or(own, PathBuf::from);
    let folder = if parent.join(folder).is_dir() { parent.join(folder) } else { parent };
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    files
}

/// Every case of the files of a folder that hold lists of them: with a name for messages, and with the file that it stands in.
pub(crate) fn for_each_case(folder: &str, mut take: impl FnMut(&Check, &Value, &Value)) {
    let mut cases = 0;
    for file in golden_files(folder) {
        let content = read(&file);
        for (index, case) in array(&content["cases"]).iter().enumerate() {
            take(&Check { case: format!("{}: {index} {}", file.display(), case["case"]) }, case, &content);
            cases += 1;
        }
    }
    assert!(cases > 0, "no golden case found");
}

/// The JSON of a file.
pub(crate) fn read(file: &Path) -> Value {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// Comparison of a case: |ours − golden| ≤ limit (1 + |golden|).
pub(crate) struct Check {
    /// In messages.
    pub(crate) case: String,
}

impl Check {
    pub(crate) fn close(&self, what: &str, ours: f64, golden: f64, limit: f64) {
        let case = &self.case;
        assert!((ours - golden).abs() <= limit * (1.0 + golden.abs()), "{case}: {what}: {ours:e}, expected {golden:e}");
    }

    pub(crate) fn all_close(&self, what: &str, ours: &[f64], golden: &Value, limit: f64) {
        let golden = numbers(golden);
        assert_eq!(ours.len(), golden.len(), "{}: {what}: length", self.case);
        for (index, (a, b)) in ours.iter().zip(golden).enumerate() {
            self.close(&format!("{what}[{index}]"), *a, b, limit);
        }
    }
}

/// The number after ` NAME ` in the note of a file.
pub(crate) fn said(content: &Value, name: &str) -> f64 {
    let note = format!(" {}", content["note"].as_str().expect("a note"));
    let rest = note.split_once(&format!(" {name} ")).unwrap_or_else(|| panic!("{name} in {note}")).1;
    let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().unwrap_or_else(|_| panic!("a number after {name} in {note}"))
}

/// Three numbers.
pub(crate) fn three(value: &Value) -> [f64; 3] {
    numbers(value).try_into().unwrap_or_else(|_| panic!("not three numbers: {value}"))
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
