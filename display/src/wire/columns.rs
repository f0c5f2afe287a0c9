//! Tables as clients get them: columns of numbers in a binary frame, or rows in JSON.
//!
//! ```text
//! u32 H │ header, H bytes of JSON │ 0… to 8 │ column 0 │ 0… to 8 │ column 1 │ 0… to 8 │ …
//! ```
//!
//! All numbers are little endian; a browser lays typed arrays over the columns without copying.

use serde::ser::{SerializeMap, SerializeSeq};
use serde::{Serialize, Serializer};

/// A column of rows `R`: its name, which says its unit, and how a row gives its value.
pub struct Column<R> {
    /// Name in headers and in JSON.
    pub name: &'static str,
    /// Its value in a row.
    pub value: Value<R>,
}

/// Where the values of a column come from, by their type.
pub enum Value<R> {
    /// Eight bytes, floating point; NaN for what is not known.
    F64(fn(&R) -> f64),
    /// Eight bytes, floating point, which is all that a browser has for large whole numbers; whole in JSON.
    Whole(fn(&R) -> u64),
    /// Four bytes, floating point; NaN for what is not known.
    F32(fn(&R) -> f32),
    /// Four bytes, whole numbers.
    U32(fn(&R) -> u32),
    /// One byte.
    U8(fn(&R) -> u8),
}

impl<R> Column<R> {
    /// A column of eight-byte floating-point numbers.
    pub const fn f64(name: &'static str, value: fn(&R) -> f64) -> Self {
        Self { name, value: Value::F64(value) }
    }

    /// A column of whole numbers in eight-byte floating-point numbers.
    pub const fn whole(name: &'static str, value: fn(&R) -> u64) -> Self {
        Self { name, value: Value::Whole(value) }
    }

    /// A column of four-byte floating-point numbers.
    pub const fn f32(name: &'static str, value: fn(&R) -> f32) -> Self {
        Self { name, value: Value::F32(value) }
    }

    /// A column of four-byte whole numbers.
    pub const fn u32(name: &'static str, value: fn(&R) -> u32) -> Self {
        Self { name, value: Value::U32(value) }
    }

    /// A column of bytes.
    pub const fn u8(name: &'static str, value: fn(&R) -> u8) -> Self {
        Self { name, value: Value::U8(value) }
    }

    /// Name of the type in headers.
    pub const fn kind(&self) -> &'static str {
        match self.value {
            Value::F64(_) | Value::Whole(_) => "f64",
            Value::F32(_) => "f32",
            Value::U32(_) => "u32",
            Value::U8(_) => "u8",
        }
    }

    /// Whether its values are whole numbers, from zero up, in JSON.
    pub const fn is_whole(&self) -> bool {
        matches!(self.value, Value::Whole(_) | Value::U32(_) | Value::U8(_))
    }

    fn write(&self, rows: &[R], out: &mut Vec<u8>) {
        match self.value {
            Value::F64(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::Whole(value) => rows.iter().for_each(|row| out.extend((value(row) as f64).to_le_bytes())),
            Value::F32(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::U32(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::U8(value) => out.extend(rows.iter().map(value)),
        }
        pad(out);
    }
}

/// Name and type of a column, in a header.
#[derive(Serialize)]
struct Named {
    name: &'static str,
    #[serde(rename = "as")]
    kind: &'static str,
}

/// A header with what it says of its columns.
#[derive(Serialize)]
struct WithColumns<'a, H> {
    #[serde(flatten)]
    header: &'a H,
    columns: Vec<Named>,
    count: usize,
}

/// A header with its rows.
#[derive(Serialize)]
#[serde(bound = "H: Serialize")]
struct WithRows<'a, H, R> {
    #[serde(flatten)]
    header: &'a H,
    items: Rows<'a, R>,
}

/// Rows that are objects in JSON, with the names of the columns as keys.
pub struct Rows<'a, R> {
    /// The columns.
    pub columns: &'a [Column<R>],
    /// The rows.
    pub rows: &'a [R],
}

impl<R> Serialize for Rows<'_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut rows = serializer.serialize_seq(Some(self.rows.len()))?;
        for row in self.rows {
            rows.serialize_element(&Object { columns: self.columns, row })?;
        }
        rows.end()
    }
}

struct Object<'a, R> {
    columns: &'a [Column<R>],
    row: &'a R,
}

impl<R> Serialize for Object<'_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(Some(self.columns.len()))?;
        for column in self.columns {
            // JSON has no NaN: what is not known is null.
            match column.value {
                Value::F64(value) => object.serialize_entry(column.name, &value(self.row))?,
                Value::Whole(value) => object.serialize_entry(column.name, &value(self.row))?,
                Value::F32(value) => object.serialize_entry(column.name, &value(self.row))?,
                Value::U32(value) => object.serialize_entry(column.name, &value(self.row))?,
                Value::U8(value) => object.serialize_entry(column.name, &value(self.row))?,
            }
        }
        object.end()
    }
}

/// A header and rows as a binary frame.
pub fn binary<H: Serialize, R>(header: &H, columns: &[Column<R>], rows: &[R]) -> Vec<u8> {
    let named = columns.iter().map(|column| Named { name: column.name, kind: column.kind() }).collect();
    let mut out = begin(&WithColumns { header, columns: named, count: rows.len() });
    for column in columns {
        column.write(rows, &mut out);
    }
    out
}

/// A header and one column of bytes, which there are already, as a binary frame.
pub fn block<H: Serialize>(header: &H, name: &'static str, bytes: &[u8]) -> Vec<u8> {
    let columns = vec![Named { name, kind: "u8" }];
    let mut out = begin(&WithColumns { header, columns, count: bytes.len() });
    out.extend_from_slice(bytes);
    pad(&mut out);
    out
}

/// A header and rows as JSON.
pub fn json<H: Serialize, R>(header: &H, columns: &[Column<R>], rows: &[R]) -> String {
    text(&WithRows { header, items: Rows { columns, rows } })
}

/// A message as JSON.
pub fn text(message: &impl Serialize) -> String {
    serde_json::to_string(message).expect("messages have only text keys")
}

fn begin<H: Serialize>(header: &WithColumns<'_, H>) -> Vec<u8> {
    let header = text(header);
    let mut out = Vec::with_capacity(4 + header.len() + 8);
    out.extend_from_slice(&(header.len() as u32).to_le_bytes());
    out.extend_from_slice(header.as_bytes());
    pad(&mut out);
    out
}

fn pad(out: &mut Vec<u8>) {
    out.resize(out.len().next_multiple_of(8), 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Head {
        r#type: &'static str,
    }

    const COLUMNS: [Column<(u32, f32)>; 4] = [
        Column::u32("index", |row| row.0),
        Column::f64("time_s", |row| f64::from(row.1) * 2.0),
        Column::u8("state", |row| row.0 as u8),
        Column::f32("snr_db", |row| row.1),
    ];

    #[test]
    fn every_column_begins_at_a_multiple_of_eight_and_holds_its_values() {
        let frame = binary(&Head { r#type: "plots" }, &COLUMNS, &[(7, 1.5), (8, -2.0), (9, f32::NAN)]);
        let length = u32::from_le_bytes(frame[..4].try_into().expect("four bytes")) as usize;
        let header: serde_json::Value = serde_json::from_slice(&frame[4..4 + length]).expect("JSON");
        assert_eq!((header["type"].as_str(), header["count"].as_u64()), (Some("plots"), Some(3)));
        let kinds = header["columns"].as_array().expect("a list").iter().map(|column| column["as"].as_str());
        assert_eq!(kinds.collect::<Vec<_>>(), [Some("u32"), Some("f64"), Some("u8"), Some("f32")]);
        let start = (4 + length).next_multiple_of(8);
        assert_eq!(frame.len(), start + 16 + 24 + 8 + 16);
        assert_eq!(frame[start + 16..start + 32], [3.0_f64.to_le_bytes(), (-4.0_f64).to_le_bytes()].concat());
        assert_eq!(frame[start + 40..start + 48], [7, 8, 9, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn numbers_of_tracks_are_whole_in_json() {
        let columns = [Column::whole("id", |row: &(u32, f32)| u64::from(row.0) << 20)];
        assert_eq!(
            json(&Head { r#type: "tracks" }, &columns, &[(3, 0.0)]),
            r#"{"type":"tracks","items":[{"id":3145728}]}"#
        );
        let frame = binary(&Head { r#type: "tracks" }, &columns, &[(3, 0.0)]);
        assert!(frame.ends_with(&3_145_728.0_f64.to_le_bytes()));
    }

    #[test]
    fn rows_are_objects_and_what_is_not_known_is_null() {
        let text = json(&Head { r#type: "plots" }, &COLUMNS, &[(7, f32::NAN)]);
        assert_eq!(text, r#"{"type":"plots","items":[{"index":7,"time_s":null,"state":7,"snr_db":null}]}"#);
    }
}
