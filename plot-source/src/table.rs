//! Plots as a table: CSV with a header, or JSON lines with the same names.
//!
//! | name | what | unit |
//! |---|---|---|
//! | `time_s` | when the beam passed the target: UTC since 1970, or since midnight of the configured date | s |
//! | `range_m` | slant range | m |
//! | `azimuth_deg` | clockwise from north | degrees |
//! | `range_rate_mps` | range rate, positive when receding; may be absent | m/s |
//! | `height_m` | height above the sea; may be absent | m |
//! | `amplitude_db` | amplitude relative to any reference; may be absent | dB |

use common::units::NS_PER_S;
use serde::Deserialize;

/// Times below this are of the configured date, s.
const TWO_DAYS_S: f64 = 2.0 * 86_400.0;
/// Largest time that is possible, s since 1970: in 2065. Three times as many nanoseconds can be counted in 64 bits.
const LAST_S: f64 = 3e9;
/// Largest values of a plot that are possible: m, degrees, m/s, m above the sea, dB.
const LARGEST_RANGE_M: f64 = 1e8;
const LARGEST_AZIMUTH_DEG: f64 = 720.0;
const LARGEST_RANGE_RATE_MPS: f64 = 1e5;
const LARGEST_HEIGHT_M: f64 = 1e8;
const LARGEST_AMPLITUDE_DB: f64 = 300.0;

/// A line of the table.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    time_s: f64,
    /// Slant range, m.
    pub range_m: f64,
    /// Azimuth, degrees.
    pub azimuth_deg: f64,
    /// Range rate, m/s.
    #[serde(default)]
    pub range_rate_mps: Option<f64>,
    /// Height, m.
    #[serde(default)]
    pub height_m: Option<f64>,
    /// Amplitude, dB.
    #[serde(default)]
    pub amplitude_db: Option<f64>,
}

impl Row {
    /// The time, ns since 1970, where that may be since a midnight.
    pub fn time_ns(&self, midnight_ns: u64) -> i64 {
        let base_ns = if self.time_s < TWO_DAYS_S { midnight_ns as i64 } else { 0 };
        base_ns + (self.time_s * NS_PER_S).round() as i64
    }

    fn is_possible(&self) -> bool {
        let may_be = |value: Option<f64>, largest: f64| value.is_none_or(|value| value.abs() <= largest);
        (0.0..LAST_S).contains(&self.time_s)
            && self.range_m > 0.0
            && may_be(Some(self.range_m), LARGEST_RANGE_M)
            && may_be(Some(self.azimuth_deg), LARGEST_AZIMUTH_DEG)
            && may_be(self.range_rate_mps, LARGEST_RANGE_RATE_MPS)
            && may_be(self.height_m, LARGEST_HEIGHT_M)
            && may_be(self.amplitude_db, LARGEST_AMPLITUDE_DB)
    }
}

/// A table of plots.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Table {
    /// Lines in the order of the file.
    pub rows: Vec<Row>,
    /// Lines that could not be read, and why the first of them could not.
    pub unread: Option<Unread>,
}

/// Lines that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unread {
    /// How many.
    pub lines: u64,
    /// Number of the first.
    pub first: usize,
    /// Why it could not.
    pub why: String,
}

impl Table {
    /// The table that `bytes` are, if they are one of plots and hold at least one line that can be read.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(bytes).ok()?;
        let first = text.lines().next()?;
        let mut table = Self::default();
        if first.starts_with('{') {
            for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
                table.take(index + 1, serde_json::from_str(line).map_err(|error| error.to_string()));
            }
        } else if first.split(',').any(|name| name.trim() == "range_m") {
            let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes);
            for (index, row) in reader.deserialize().enumerate() {
                table.take(index + 2, row.map_err(|error: csv::Error| reason(&error)));
            }
        }
        (!table.rows.is_empty()).then_some(table)
    }

    fn take(&mut self, number: usize, row: Result<Row, String>) {
        let why = match row {
            Ok(row) if row.is_possible() => return self.rows.push(row),
            Ok(row) => format!("impossible values: {row:?}"),
            Err(why) => why,
        };
        self.unread.get_or_insert(Unread { lines: 0, first: number, why }).lines += 1;
    }
}

/// Without the place, which is said otherwise.
fn reason(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_hold_the_same() {
        let csv = b"time_s, range_m, azimuth_deg, range_rate_mps\n10.5,1000,90,-3.5\n11,1001.5,91.25,\n";
        let json = b"{\"time_s\":10.5,\"range_m\":1000,\"azimuth_deg\":90,\"range_rate_mps\":-3.5}\n\n\
            {\"azimuth_deg\":91.25,\"time_s\":11,\"range_m\":1001.5}\n";
        let table = Table::of(csv).expect("a table");
        assert_eq!((table.rows.len(), &table.unread), (2, &None));
        assert_eq!(Table::of(json), Some(table.clone()));
        assert_eq!((table.rows[0].range_rate_mps, table.rows[1].range_rate_mps), (Some(-3.5), None));
        assert_eq!(table.rows[0].time_ns(1_000_000_000), 11_500_000_000);
    }

    #[test]
    fn lines_that_cannot_be_read_are_counted() {
        let csv = b"time_s,range_m,azimuth_deg\n1,1000,90\n2,abc,90\n3,-5,90\n4,1000\n5,1000,91\n";
        let table = Table::of(csv).expect("a table");
        assert_eq!(table.rows.len(), 2);
        let unread = table.unread.expect("three lines");
        assert_eq!((unread.lines, unread.first), (3, 3));
        assert!(unread.why.contains("invalid float"), "{}", unread.why);
    }

    #[test]
    fn other_tables_are_none() {
        for other in [&b"a,b\n1,2\n"[..], b"{\"topic\":\"plots\"}\n", b"time_s,range_m,azimuth_deg\n", b"", b"\xff\xfe"]
        {
            assert_eq!(Table::of(other), None);
        }
    }
}
