//! The files of a run: `<site>-<run>.000.mcap`, `.001.mcap` and so on.

use std::path::{Path, PathBuf};

/// Name of part `number` of the run whose files begin with `stem`.
pub fn part_name(stem: &str, number: u32) -> String {
    format!("{stem}.{number:03}.mcap")
}

/// What the name of a part says: the stem of its run, `<site>-<run>`, and its number.
pub fn run_and_part(path: &Path) -> Option<(&str, u32)> {
    let (stem, number) = path.file_name()?.to_str()?.strip_suffix(".mcap")?.rsplit_once('.')?;
    Some((stem, number.parse().ok()?))
}

/// The parts in `directory` of the run whose files begin with `stem`, in order.
pub fn parts_of(directory: &Path, stem: &str) -> Vec<(u32, PathBuf)> {
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let mut parts: Vec<(u32, PathBuf)> = entries
        .filter_map(|entry| {
            let path = entry.path();
            run_and_part(&path)
                .filter(|&(other, _)| other == stem)
                .map(|(_, number)| number)
                .map(|number| (number, path))
        })
        .collect();
    parts.sort_unstable();
    parts
}

/// All parts of the run of a recording, those that lie beside it, in order; a file with a name of its own is alone.
pub fn parts_of_run(path: &Path) -> Vec<PathBuf> {
    let Some((stem, _)) = run_and_part(path) else { return vec![path.to_path_buf()] };
    let directory = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    parts_of(directory, stem).into_iter().map(|(_, part)| part).collect()
}

/// A recording and the later parts of its run that lie beside it, in order.
pub fn parts_from(path: &Path) -> Vec<PathBuf> {
    let number = |path: &Path| run_and_part(path).map(|(_, number)| number);
    let later = parts_of_run(path).into_iter().filter(|part| number(part) > number(path));
    std::iter::once(path.to_path_buf()).chain(later).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_found_by_name_in_the_order_of_their_numbers() {
        let folder = tempfile::tempdir().expect("a folder");
        let names = ["a-1.002.mcap", "a-1.1000.mcap", "a-1.000.mcap", "a-12.001.mcap", "a-1.x.mcap", "a-1.001.json"];
        for name in names {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        let numbers = |parts: Vec<(u32, PathBuf)>| parts.into_iter().map(|(number, _)| number).collect::<Vec<_>>();
        assert_eq!(numbers(parts_of(folder.path(), "a-1")), [0, 2, 1000]);
        let from = parts_from(&folder.path().join("a-1.002.mcap"));
        assert_eq!(from, ["a-1.002.mcap", "a-1.1000.mcap"].map(|name| folder.path().join(name)));
        let all = parts_of_run(&folder.path().join("a-1.1000.mcap"));
        assert_eq!(all, ["a-1.000.mcap", "a-1.002.mcap", "a-1.1000.mcap"].map(|name| folder.path().join(name)));
        assert_eq!(parts_from(Path::new("other.mcap")), [PathBuf::from("other.mcap")]);
    }
}
