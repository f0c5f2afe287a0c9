//! Reading tables, overriding keys, checking values.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::{ChainConfig, keys};

/// Why a configuration cannot be used. Each is one line for the user, exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("cannot read configuration file {path}: {cause}")]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// The file is not TOML.
    #[error("{path}: {message}")]
    Syntax {
        /// Which file.
        path: PathBuf,
        /// What the parser says, on one line.
        message: String,
    },
    /// A key is unknown or holds the wrong type.
    #[error("{place}: key `{key}`: {message}")]
    Key {
        /// File or option.
        place: String,
        /// Dotted path of the key.
        key: String,
        /// What was expected.
        message: String,
    },
    /// `--set` without `=`.
    #[error("--set {argument}: expected table.key=value, for example --set extractor.pfa=1e-4")]
    Override {
        /// The argument as given.
        argument: String,
    },
    /// A value outside its range.
    #[error("key `{key}` is {value}, expected {expected}")]
    Range {
        /// Dotted path of the key.
        key: String,
        /// The value as given.
        value: String,
        /// The range in words.
        expected: String,
    },
}

/// No configuration is longer, bytes; a device may be endless.
const LONGEST: u64 = 16 << 20;
/// No key lies in more tables than these.
const DEEPEST: usize = 8;

/// The text of a file; nothing without one.
pub(super) fn read_text(path: Option<&Path>) -> Result<String, ConfigError> {
    let Some(path) = path else { return Ok(String::new()) };
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST + 1).read_to_string(&mut text));
    let read = read.and_then(|bytes| match bytes as u64 {
        0..=LONGEST => Ok(text),
        _ => Err(io::Error::other(format!("it is longer than {} MiB", LONGEST >> 20))),
    });
    read.map_err(|cause| ConfigError::Read { path: path.to_path_buf(), cause })
}

pub(super) fn read(place: &str, table: toml::Table) -> Result<ChainConfig, ConfigError> {
    serde_path_to_error::deserialize(toml::Value::Table(table)).map_err(|error| {
        let key = error.path().to_string();
        let message = in_words(&error.inner().message().lines().collect::<Vec<_>>().join(" "), &key);
        ConfigError::Key { place: place.to_string(), key, message }
    })
}

/// A message about the value of `key` that says what the configuration expects, where it names a type of Rust.
fn in_words(message: &str, key: &str) -> String {
    const RUST_TYPES: [&str; 10] = ["u8", "u16", "u32", "u64", "usize", "i64", "f32", "f64", "a string", "string only"];
    let message = message.replace("invalid type: unit variant", "the value is of another kind");
    let wanted = message.rsplit_once(", expected ").filter(|(_, wanted)| RUST_TYPES.contains(wanted));
    match wanted.and_then(|(found, _)| Some((found, keys::expected(key)?))) {
        Some((found, expected)) => format!("{found}, expected {expected}"),
        None => message,
    }
}

/// Sets `table.key` to `value`, which is TOML, or text when it is not.
pub(super) fn apply(table: &mut toml::Table, argument: &str) -> Result<(), ConfigError> {
    let malformed = || ConfigError::Override { argument: argument.chars().take(80).collect() };
    let (path, value) = argument.split_once('=').ok_or_else(malformed)?;
    let value = toml::from_str::<toml::Table>(&format!("value = {value}"))
        .ok()
        .and_then(|mut parsed| parsed.remove("value"))
        .unwrap_or_else(|| toml::Value::String(value.to_string()));
    let mut keys: Vec<&str> = path.split('.').map(str::trim).collect();
    let last = keys.pop().filter(|key| !key.is_empty()).ok_or_else(malformed)?;
    if keys.len() > DEEPEST {
        return Err(malformed());
    }
    let mut place = table;
    for key in keys {
        place = place
            .entry(key)
            .or_insert_with(|| toml::Value::Table(toml::Table::new()))
            .as_table_mut()
            .ok_or_else(malformed)?;
    }
    place.insert(last.to_string(), value);
    Ok(())
}

/// `Ok` if `valid`, else the error that names key, value and range.
pub(super) fn require(
    key: &str,
    value: impl std::fmt::Display,
    valid: bool,
    expected: &str,
) -> Result<(), ConfigError> {
    if valid {
        return Ok(());
    }
    Err(ConfigError::Range { key: key.to_string(), value: value.to_string(), expected: expected.to_string() })
}

/// A finite number above zero.
pub(super) fn positive(key: &str, value: f64) -> Result<(), ConfigError> {
    require(key, value, value.is_finite() && value > 0.0, "a number above 0")
}

/// A finite number, zero or above.
pub(super) fn not_negative(key: &str, value: f64) -> Result<(), ConfigError> {
    require(key, value, value.is_finite() && value >= 0.0, "a number of at least 0")
}

/// A time above zero that a clock can count, s.
pub(super) fn seconds(key: &str, value: f64) -> Result<(), ConfigError> {
    require(key, value, value > 0.0 && value <= 1e9, "a number above 0, at most 1e9")
}

/// A time that a clock can count, 0 for none, s.
pub(super) fn seconds_or_none(key: &str, value: f64) -> Result<(), ConfigError> {
    require(key, value, (0.0..=1e9).contains(&value), "a number from 0 to 1e9")
}

/// A probability, both ends excluded.
pub(super) fn probability(key: &str, value: f64) -> Result<(), ConfigError> {
    require(key, value, value > 0.0 && value < 1.0, "a probability between 0 and 1, both excluded")
}

/// A whole number in a range.
pub(super) fn within(key: &str, value: u64, range: std::ops::RangeInclusive<u64>) -> Result<(), ConfigError> {
    let expected = format!("a whole number from {} to {}", range.start(), range.end());
    require(key, value, range.contains(&value), &expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endless_files_and_keys_of_endless_depth_are_refused() {
        let text = read_text(Some(Path::new("/dev/zero"))).expect_err("endless").to_string();
        assert!(text.ends_with("/dev/zero: it is longer than 16 MiB"), "{text}");
        let deep = format!("{}a=1", "a.".repeat(30_000));
        let text = apply(&mut toml::Table::new(), &deep).expect_err("too deep").to_string();
        assert!(text.contains("expected table.key=value") && text.len() < 200, "{text}");
    }
}
