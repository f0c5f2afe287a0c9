//! The configuration explained: what each key means, from the doc comments of the types; its default, from the types; its
//! range, from the checks themselves, which are asked what they expect in place of a value that is none.

use std::fmt::Write;

use super::keys::{About, about, keys};
use super::sites::adjust;
use super::{ChainConfig, ConfigError, OutputConfig, Sites};

/// What a range is asked about: values that few keys allow.
const OUT_OF_RANGE: [&str; 7] = ["-1e300", "1e300", "nan", "-1", "4294967295", "9223372036854775807", "''"];

/// Units by the last word of a key.
const UNITS: [(&str, &str); 12] = [
    ("_mps3", "m/s³"),
    ("_mps2", "m/s²"),
    ("_mps", "m/s"),
    ("_m2", "m²"),
    ("_m", "m"),
    ("_us", "µs"),
    ("_s", "s"),
    ("_deg", "degrees"),
    ("_db", "dB"),
    ("_mib", "MiB"),
    ("_hz", "Hz"),
    ("_scans", "scans"),
];

/// `sites` as TOML, complete, with a line of explanation above each table and key.
pub fn explained(sites: &Sites) -> String {
    explain(sites, |_| true)
}

/// The same of one key with its range, or of one table; none if there is no such key.
pub fn explained_key(sites: &Sites, key: &str) -> Option<String> {
    let in_table = format!("{key}.");
    let is_asked = |path: &str| path == key || path.starts_with(&in_table) || path.strip_suffix("[]") == Some(key);
    let (keys, mut text) = (keys(), explain(sites, is_asked));
    if text.is_empty() {
        // A key without a default is in no configuration that does not set it.
        let about = about(&keys, key)?;
        text = format!("# {}\n# not set\n", about.text);
    }
    if let Some(about) = about(&keys, key).filter(|about| !about.kind.is_empty()) {
        text.insert_str(0, &format!("# `{key}`: {}\n", range_of(key, about)));
    }
    Some(text)
}

/// The lines of tables and keys whose path is `wanted`, and explanations above them.
fn explain(sites: &Sites, wanted: impl Fn(&str) -> bool) -> String {
    let keys = keys();
    let (mut text, mut table) = (String::new(), String::new());
    for line in sites.to_toml().lines() {
        let path = path_of(line, &mut table).unwrap_or_default();
        if !wanted(&path) {
            continue;
        }
        // Of several sites, each has its own tables and the keys of `[site]`.
        let of_site = path.strip_prefix("site[].");
        let own = of_site.map(|key| format!("site.{key}"));
        let empty = format!("{path}[]"); // an array of tables without any
        let about = about(&keys, of_site.unwrap_or(&path)).or_else(|| keys.get(own.as_deref().unwrap_or(&empty)));
        if let Some(about) = about {
            let _ = writeln!(text, "# {}", about.text);
        }
        let _ = writeln!(text, "{line}");
    }
    text
}

/// Every key with its unit, default, range and meaning, as Markdown: `docs/configuration.md`.
pub fn reference() -> String {
    let keys = keys();
    let mut text = String::from(
        "# Configuration\n\nMade by `radar-chain config --docs`; a test holds this file to it. Any key can be overridden on \
         the command line: `--set tracker.snr_db=12`.\nUnknown keys are errors. `radar-chain config` prints what is in \
         effect, `radar-chain config --explain` with the meaning of each key.\n",
    );
    let mut defaults = ChainConfig::default();
    defaults.outputs.insert("NAME".into(), OutputConfig::default());
    let (defaults, mut table) = (defaults.to_toml(), String::new());
    let mut written: Vec<(String, &str)> = Vec::new(); // paths in the order of the types, with their defaults
    for line in defaults.lines() {
        if let Some(path) = path_of(line, &mut table) {
            written.push((path, line.split_once(" = ").map_or("", |(_, value)| value)));
        }
    }
    let is_table = |path: &str| keys.get(path).is_none_or(|about| about.kind.is_empty());
    let parent = |path: &str| path.rsplit_once('.').map_or(String::new(), |(table, _)| table.to_string());
    let mut tables: Vec<String> =
        written.iter().filter(|(path, _)| is_table(path)).map(|(path, _)| path.clone()).collect();
    let unwritten = keys.iter().filter(|(path, about)| about.kind.is_empty() && !tables.contains(path));
    let unwritten: Vec<String> = unwritten.map(|(path, _)| path.clone()).collect();
    for path in unwritten {
        // A table without defaults stands after those of its parent.
        let family = |other: &String| *other == parent(&path) || other.starts_with(&format!("{}.", parent(&path)));
        let place = tables.iter().rposition(family).map_or(tables.len(), |last| last + 1);
        tables.insert(place, path);
    }
    for table in tables {
        let own: Vec<(&String, &str)> = (written.iter().map(|(path, default)| (path, *default)))
            .chain(keys.keys().filter(|path| written.iter().all(|(other, _)| other != *path)).map(|path| (path, "")))
            .filter(|(path, _)| !is_table(path) && parent(path) == table)
            .collect();
        if own.is_empty() {
            continue;
        }
        let shown = table.strip_suffix("[]").map_or(format!("[{table}]"), |array| format!("[[{array}]]"));
        let about = keys.get(&table).map_or(String::new(), |about| about.text.clone());
        let about = about.strip_prefix(&format!("`{shown}`: ")).map_or(about.clone(), capitalised);
        let _ = write!(
            text,
            "\n## `{shown}`\n\n{about}\n\n| key | unit | default | range | meaning |\n|---|---|---|---|---|\n"
        );
        for (path, default) in own {
            let about = &keys[path];
            let key = path.rsplit_once('.').map_or(path.as_str(), |(_, key)| key);
            let unit = UNITS.iter().find(|(end, _)| key.ends_with(end)).map_or("", |(_, unit)| unit);
            let default = if default.is_empty() { "not set".to_string() } else { format!("`{default}`") };
            let range = range_of(path, about);
            let _ = writeln!(text, "| `{key}` | {unit} | {default} | {range} | {} |", about.text.replace('|', "\\|"));
        }
    }
    text
}

/// With a capital letter at the beginning.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Path of the key or table in a line of TOML; `table` is the table that the line stands in, and is kept.
fn path_of(line: &str, table: &mut String) -> Option<String> {
    if let Some(array) = line.strip_prefix("[[").and_then(|line| line.strip_suffix("]]")) {
        *table = format!("{array}[]");
        return Some(table.clone());
    }
    if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
        *table = name.to_string();
        return Some(table.clone());
    }
    let (key, _) = line.split_once(" = ")?;
    Some(if table.is_empty() { key.to_string() } else { format!("{table}.{key}") })
}

/// What the checks expect of a key, or else its kind.
fn range_of(path: &str, about: &About) -> String {
    if !about.values.is_empty() {
        return about.values.join(", ");
    }
    let default = ChainConfig::default();
    let asked = OUT_OF_RANGE.iter().find_map(|value| match adjust(&default, &[format!("{path}={value}")]) {
        Err(ConfigError::Range { key, expected, .. }) if key == path => Some(expected),
        _ => None,
    });
    asked.unwrap_or_else(|| about.kind.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_is_explained_and_reads_back() {
        let config = ChainConfig::default();
        let text = explained(&Sites::one(config.clone()));
        let lines: Vec<&str> = text.lines().collect();
        let is_key = |line: &str| !line.starts_with('#') && line.contains(" = ");
        for pair in lines.windows(2).filter(|pair| is_key(pair[1])) {
            assert!(pair[0].starts_with("# "), "{}", pair[1]);
        }
        let read = super::super::parse(std::path::Path::new("explained"), &text, &[]).expect("a configuration");
        assert_eq!(read, config);
    }

    #[test]
    fn one_key_or_one_table_is_explained() {
        let sites = Sites::one(ChainConfig::default());
        let text = explained_key(&sites, "tracker.snr_db").expect("a key");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines.len(), lines[0]), (3, "# `tracker.snr_db`: a number from 0 to 60"), "{text}");
        assert!(lines[1].starts_with("# ") && lines[2].starts_with("snr_db = "), "{text}");
        let table = explained_key(&sites, "ipc").expect("a table");
        assert!(table.contains("[ipc]\n") && table.contains("\nprefix = ") && !table.contains("[run]"), "{table}");
        let unset = explained_key(&sites, "site.sac").expect("a key without a default");
        assert!(unset.contains("not set"), "{unset}");
        let of_output = explained_key(&sites, "outputs.asterix.to").expect("a key of an output that is not configured");
        assert!(of_output.contains("`outputs.asterix.to`") && of_output.contains("not set"), "{of_output}");
        assert_eq!(explained_key(&sites, "tracker.nonsense"), None);
        assert_eq!(explained_key(&sites, "outputs.asterix.nonsense"), None);
    }

    #[test]
    fn ranges_are_what_the_checks_expect() {
        let range = |path: &str| range_of(path, &keys()[path]);
        assert_eq!(range("tracker.snr_db"), "a number from 0 to 60");
        assert_eq!(range("run.mode"), "`\"lossless\"`, `\"real-time\"`");
        assert_eq!(range("recorder.record"), "`true` or `false`");
    }
}
