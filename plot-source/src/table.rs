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
//!
//! Other columns are ignored, and named. A value that is no number (`nan`, `NaN`) is absent.

use std::collections::{BTreeMap, BTreeSet};

use common::units::NS_PER_S;
use serde::Deserialize;
use serde_json::Value;

/// The column that makes a table one of plots.
const RANGE: &str = "range_m";
/// Names of the columns.
const COLUMNS: [&str; 6] = ["time_s", RANGE, "azimuth_deg", "range_rate_mps", "height_m", "amplitude_db"];

/// Times below this are of the configured date, s.
const TWO_DAYS_S: f64 = 2.0 * DAY_S;
const DAY_S: f64 = 86_400.0;
/// Largest time that is possible, s since 1970: in 2065. Three times as many nanoseconds can be counted in 64 bits.
const LAST_S: f64 = 3e9;
/// Largest values of a plot that are possible: m, degrees, m/s, m above the sea, dB.
const LARGEST_RANGE_M: f64 = 1e8;
const LARGEST_AZIMUTH_DEG: f64 = 720.0;
const LARGEST_RANGE_RATE_MPS: f64 = 1e5;
const LARGEST_HEIGHT_M: f64 = 1e8;
const LARGEST_AMPLITUDE_DB: f64 = 300.0;

/// A line of the table.
#[derive(Debug, Default, Clone, Copy, PartialEq, Deserialize)]
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
    /// Columns that say nothing of a plot, in the order of their names.
    pub ignored: BTreeSet<String>,
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
    /// The table that `bytes` are, if their header, or their first object, names a range.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        // A capture of gigabytes is not made a text to find that out.
        let is_blank = |line: &&[u8]| line.iter().all(u8::is_ascii_whitespace) || line.starts_with(b"#");
        let head = bytes.split(|octet| *octet == b'\n').find(|line| !is_blank(line))?;
        if !head.windows(RANGE.len()).any(|window| window == RANGE.as_bytes()) {
            return None;
        }
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let (_, first) = lines.clone().next()?;
        let mut table = Self::default();
        if first.starts_with('{') {
            if !first.contains(&format!("\"{RANGE}\"")) {
                return None;
            }
            for (index, line) in lines {
                // What `json.dumps` makes of a number that is none is no JSON.
                let cells = serde_json::from_str::<BTreeMap<String, Value>>(&line.replace("NaN", "null"));
                let row = cells.map_err(|error| error.to_string()).and_then(|cells| table.row_of_values(cells));
                table.take(index + 1, row);
            }
        } else {
            let delimiter = if first.contains(';') { b';' } else { b',' };
            let mut reader = csv::ReaderBuilder::new();
            reader.trim(csv::Trim::All).flexible(true).comment(Some(b'#')).delimiter(delimiter);
            let mut reader = reader.from_reader(text.as_bytes());
            let names: Vec<String> = reader.headers().ok()?.iter().map(Into::into).collect();
            if !names.iter().any(|name| name == RANGE) {
                return None;
            }
            table.ignored.extend(names.iter().filter(|name| !COLUMNS.contains(&name.as_str())).cloned());
            for cells in reader.records().flatten() {
                let line = cells.position().map_or(0, csv::Position::line);
                table.take(line as usize, row_of_cells(&names, &cells));
            }
        }
        Some(table)
    }

    /// Times of the rows, ns since 1970. Those of a day go on over midnight: one that lies more than half a day before the last is of
    /// the next day, and then one that lies as far after it is of the day before.
    pub fn times_ns(&self, midnight_ns: u64) -> impl Iterator<Item = i64> {
        let (mut days, mut last_s) = (0.0, None);
        self.rows.iter().map(move |row| {
            if row.time_s >= TWO_DAYS_S {
                return (row.time_s * NS_PER_S).round() as i64;
            }
            let passed_s = last_s.map_or(0.0, |last_s: f64| row.time_s + days * DAY_S - last_s);
            if passed_s < -0.5 * DAY_S {
                days += 1.0;
            } else if passed_s > 0.5 * DAY_S && days > 0.0 {
                days -= 1.0;
            }
            let time_s = row.time_s + days * DAY_S;
            last_s = Some(time_s);
            midnight_ns as i64 + (time_s * NS_PER_S).round() as i64
        })
    }

    /// Why it has no row.
    pub fn why_no_row(&self) -> String {
        let of_first = |unread: &Unread| format!("line {}: {}", unread.first, unread.why);
        let found = self.unread.as_ref().map_or("it ends after its header".into(), of_first);
        format!("{found}; expected columns {}, of which the first three must have values", COLUMNS.join(", "))
    }

    fn row_of_values(&mut self, cells: BTreeMap<String, Value>) -> Result<Row, String> {
        let (known, unknown): (BTreeMap<_, _>, BTreeMap<_, _>) =
            cells.into_iter().partition(|(name, _)| COLUMNS.contains(&name.as_str()));
        self.ignored.extend(unknown.into_keys());
        serde_json::from_value(Value::Object(known.into_iter().collect())).map_err(|error| error.to_string())
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

/// A line of a table with a header; an empty cell, or one that is no number (`nan`), is absent.
fn row_of_cells(names: &[String], cells: &csv::StringRecord) -> Result<Row, String> {
    if cells.len() != names.len() {
        return Err(format!("found {} cells, expected {}", cells.len(), names.len()));
    }
    let mut known = serde_json::Map::new();
    for (name, cell) in names.iter().zip(cells).filter(|(name, _)| COLUMNS.contains(&name.as_str())) {
        if cell.is_empty() {
            continue;
        }
        let value: f64 = cell.parse().map_err(|_| format!("`{cell}` in column `{name}` is no number"))?;
        known.extend(serde_json::Number::from_f64(value).map(|value| (name.clone(), Value::Number(value))));
    }
    serde_json::from_value(Value::Object(known)).map_err(|error| error.to_string())
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
        assert_eq!(table.times_ns(1_000_000_000).collect::<Vec<_>>(), [11_500_000_000, 12_000_000_000]);
    }

    #[test]
    fn times_of_a_day_go_on_over_midnight() {
        let times_s = |times: &[f64]| -> Vec<i64> {
            let rows = times.iter().map(|&time_s| Row { time_s, ..Row::default() }).collect();
            Table { rows, ..Table::default() }.times_ns(0).map(|time_ns| time_ns / 1_000_000_000).collect()
        };
        assert_eq!(times_s(&[86_399.0, 1.0, 86_398.0, 2.0]), [86_399, 86_401, 86_398, 86_402]);
        assert_eq!(times_s(&[86_399.0, 0.0, 40_000.0, 80_000.0, 3.0]), [86_399, 86_400, 126_400, 166_400, 172_803]);
        assert_eq!(times_s(&[5.0, 80_000.0, 90_000.0, 89_000.0]), [5, 80_000, 90_000, 89_000], "seconds that go on");
        assert_eq!(times_s(&[1.7e9, 1.7e9 - 90_000.0]), [1_700_000_000, 1_699_910_000], "a clock that is set back");
    }

    #[test]
    fn lines_that_cannot_be_read_are_counted() {
        let csv = b"time_s,range_m,azimuth_deg\n1,1000,90\n2,abc,90\n3,-5,90\n4,1000\n5,1000,91\n";
        let table = Table::of(csv).expect("a table");
        assert_eq!(table.rows.len(), 2);
        let unread = table.unread.expect("three lines");
        assert_eq!((unread.lines, unread.first), (3, 3));
        assert_eq!(unread.why, "`abc` in column `range_m` is no number");
    }

    /// What tools of others make of a table: an index and further columns, numbers that are none, an octet of another encoding.
    #[test]
    fn what_a_table_holds_besides_is_left_out() {
        let csv = b",time_s,range_m,azimuth_deg,height_m,id\n0,1,1000,90,nan,A\n1,2,1001,90,,\xe9\n";
        let json = b"{\"time_s\":1,\"range_m\":1000,\"azimuth_deg\":90,\"height_m\":NaN,\"id\":\"A\"}\n";
        let table = Table::of(csv).expect("a table");
        assert_eq!((table.rows.len(), &table.unread, table.rows[0].height_m), (2, &None, None));
        assert_eq!(table.ignored.iter().collect::<Vec<_>>(), ["", "id"]);
        assert_eq!(Table::of(json).expect("a table").rows, table.rows[..1]);
        let semicolons = Table::of(b"# radar\n\ntime_s;\"range_m\";azimuth_deg\n1;1000;90\n").expect("a table");
        assert_eq!(semicolons.rows, table.rows[..1]);
        let wrong = Table::of(b"time_s,range_m,azimuth\n1,1000,90\n").expect("a table, though not one line fits");
        assert_eq!(wrong.unread.expect("a line").why, "missing field `azimuth_deg`");
    }

    #[test]
    fn other_tables_are_none() {
        for other in [&b"a,b\n1,2\n"[..], b"{\"topic\":\"plots\"}\n", b"", b"\xff\xfe"] {
            assert_eq!(Table::of(other), None);
        }
    }
}
