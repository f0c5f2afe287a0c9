//! Tables as comma-separated values; what is not known is an empty field.

use std::fmt::Write;
use std::fs::File;
use std::io;

use common::recording::container::Description;
use common::recording::row::{Table, Value};
use common::recording::{RecordedRef, RecordingError};
use common::topic::Topic;

use super::{Places, Sink, put_columns, put_rows};

/// A table of one topic.
pub(super) struct CsvTable {
    rows: Rows,
    places: Places,
}

struct Rows {
    out: csv::Writer<File>,
    field: String,
}

impl CsvTable {
    pub(super) fn create(file: File, description: Option<&Description>, topic: Topic) -> io::Result<Self> {
        let (mut names, places) = (Names(Vec::new()), Places::of(description));
        put_columns(topic, &places, &mut names)?;
        let mut out = csv::Writer::from_writer(file);
        out.write_record(names.0)?;
        Ok(Self { rows: Rows { out, field: String::new() }, places })
    }
}

impl Sink for CsvTable {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        put_rows(message, &self.places, &mut self.rows)?;
        Ok(message.len() as u64)
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        Ok(self.rows.out.flush()?)
    }
}

/// Names of the columns.
struct Names(Vec<String>);

impl Table for Names {
    fn put(&mut self, column: &str, _: Value<'_>) -> io::Result<()> {
        self.0.push(column.to_string());
        Ok(())
    }

    fn put_if(&mut self, _: bool, column: &str, value: Value<'_>) -> io::Result<()> {
        self.put(column, value)
    }

    fn end_row(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Table for Rows {
    fn put(&mut self, _: &str, value: Value<'_>) -> io::Result<()> {
        self.field.clear();
        // Debug has as many digits as it takes to read a number back unchanged, and an exponent where it is shorter.
        let _ = match value {
            Value::U32(value) => write!(self.field, "{value}"),
            Value::U64(value) => write!(self.field, "{value}"),
            Value::F32(value) => write!(self.field, "{value:?}"),
            Value::F64(value) => write!(self.field, "{value:?}"),
            Value::Text(text) => write!(self.field, "{text}"),
        };
        Ok(self.out.write_field(&self.field)?)
    }

    fn put_if(&mut self, known: bool, column: &str, value: Value<'_>) -> io::Result<()> {
        if known { self.put(column, value) } else { Ok(self.out.write_field("")?) }
    }

    fn end_row(&mut self) -> io::Result<()> {
        Ok(self.out.write_record(None::<&[u8]>)?)
    }
}
