//! Tables as clients get them: columns of numbers in a binary frame, or rows in JSON.
//!
//! ```text
//! u32 H │ header, H bytes of JSON │ 0… to 8 │ column 0 │ 0… to 8 │ column 1 │ 0… to 8 │ …
//! ```
//!
//! All numbers are little endian; a browser lays typed arrays over the columns without copying.

use schemars::JsonSchema;
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
    /// Whole numbers that need not be known, as [`Self::F64`]; whole in JSON.
    Count(fn(&R) -> Option<u32>),
    /// Text, which stands in JSON alone.
    Text(fn(&R) -> Option<&str>),
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

    /// A column of whole numbers that need not be known.
    pub const fn count(name: &'static str, value: fn(&R) -> Option<u32>) -> Self {
        Self { name, value: Value::Count(value) }
    }

    /// A column of text.
    pub const fn text(name: &'static str, value: fn(&R) -> Option<&str>) -> Self {
        Self { name, value: Value::Text(value) }
    }

    /// Its name and type in headers; `None` where it stands in JSON alone.
    fn named(&self) -> Option<Named> {
        let kind = match self.value {
            Value::F64(_) | Value::Whole(_) | Value::Count(_) => Kind::F64,
            Value::F32(_) => Kind::F32,
            Value::U32(_) => Kind::U32,
            Value::U8(_) => Kind::U8,
            Value::Text(_) => return None,
        };
        Some(Named { name: self.name, kind })
    }

    fn write(&self, rows: &[R], out: &mut Vec<u8>) {
        match self.value {
            Value::F64(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::Whole(value) => rows.iter().for_each(|row| out.extend((value(row) as f64).to_le_bytes())),
            Value::F32(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::U32(value) => rows.iter().for_each(|row| out.extend_from_slice(&value(row).to_le_bytes())),
            Value::U8(value) => out.extend(rows.iter().map(value)),
            Value::Count(value) => {
                rows.iter().map(value).for_each(|of| out.extend(of.map_or(f64::NAN, f64::from).to_le_bytes()));
            }
            Value::Text(_) => {}
        }
        pad(out);
    }
}

/// What a binary frame consists of, in its header.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Columns {
    /// The columns in their order.
    columns: Vec<Named>,
    /// Values in each column.
    count: usize,
}

/// Name and type of a column.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Column")]
struct Named {
    name: &'static str,
    /// Little endian.
    #[serde(rename = "as")]
    kind: Kind,
}

/// Type of the values of a column.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "ColumnType")]
enum Kind {
    F64,
    F32,
    U32,
    U8,
}

/// A header with what it says of its columns.
#[derive(Serialize)]
struct WithColumns<'a, H> {
    #[serde(flatten)]
    header: &'a H,
    #[serde(flatten)]
    columns: Columns,
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
                Value::Count(value) => object.serialize_entry(column.name, &value(self.row))?,
                Value::Text(value) => object.serialize_entry(column.name, &value(self.row))?,
            }
        }
        object.end()
    }
}

/// A header and rows as a binary frame.
pub fn binary<H: Serialize, R>(header: &H, columns: &[Column<R>], rows: &[R]) -> Vec<u8> {
    let named = columns.iter().filter_map(Column::named).collect();
    let mut out = begin(&WithColumns { header, columns: Columns { columns: named, count: rows.len() } });
    for column in columns {
        column.write(rows, &mut out);
    }
    out
}

/// A header and one column of bytes, which there are already, as a binary frame.
pub fn block<H: Serialize>(header: &H, name: &'static str, bytes: &[u8]) -> Vec<u8> {
    let columns = Columns { columns: vec![Named { name, kind: Kind::U8 }], count: bytes.len() };
    let mut out = begin(&WithColumns { header, columns });
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
    fn counts_may_be_unknown_and_text_stands_in_json_alone() {
        let columns = [
            Column::text("label", |row: &(u32, f32)| (row.0 > 0).then_some("blue")),
            Column::count("hits", |row| (row.0 > 0).then_some(row.0)),
        ];
        let (head, rows) = (Head { r#type: "tracks" }, [(7, 0.0), (0, 0.0)]);
        let text = json(&head, &columns, &rows);
        assert_eq!(text, r#"{"type":"tracks","items":[{"label":"blue","hits":7},{"label":null,"hits":null}]}"#);
        let frame = binary(&head, &columns, &rows);
        let header = r#"{"type":"tracks","columns":[{"name":"hits","as":"f64"}],"count":2}"#;
        assert_eq!(&frame[4..4 + header.len()], header.as_bytes());
        assert!(frame.ends_with(&[7.0_f64.to_le_bytes(), f64::NAN.to_le_bytes()].concat()));
    }

    #[test]
    fn rows_are_objects_and_what_is_not_known_is_null() {
        let text = json(&Head { r#type: "plots" }, &COLUMNS, &[(7, f32::NAN)]);
        assert_eq!(text, r#"{"type":"plots","items":[{"index":7,"time_s":null,"state":7,"snr_db":null}]}"#);
    }
}
