//! Tables as Parquet: typed columns, null where a value is not known. The metadata of the file, each key with `radar-chain.`
//! before it, are what the recording says of itself.

use std::fmt::Write;
use std::fs::File;
use std::io;
use std::sync::Arc;

use common::recording::container::Description;
use common::recording::row::{Table, Value};
use common::recording::{RecordedRef, RecordingError};
use common::topic::Topic;
use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::parser::parse_message_type;
use recorder::export::{Form, Places, Sink, files_by_topic, put_columns, put_rows};

/// Rows that are kept in memory until they are written together.
const GROUP_ROWS: usize = 1 << 16;

/// Parquet tables, one per topic.
#[derive(Debug, Clone, Copy)]
pub struct Parquet;

impl Form for Parquet {
    fn files(&self, topics: &[Topic]) -> Vec<(String, Vec<Topic>)> {
        files_by_topic(topics, "parquet")
    }

    fn create(
        &self,
        file: File,
        description: Option<&Description>,
        topics: &[Topic],
    ) -> Result<Box<dyn Sink>, RecordingError> {
        let &[topic] = topics else { return Err(io::Error::other("a Parquet table holds one topic").into()) };
        Ok(Box::new(ParquetTable::create(file, description, topic)?))
    }
}

/// A table of one topic.
struct ParquetTable {
    rows: Rows,
    places: Places,
}

struct Rows {
    out: SerializedFileWriter<File>,
    columns: Vec<Column>,
    /// Column of the next value.
    next: usize,
    /// Rows in the columns.
    waiting: usize,
}

/// The waiting values of a column.
struct Column {
    values: Values,
    /// 1 for a value that is known, 0 for one that is not; empty where all are known.
    known: Vec<i16>,
}

enum Values {
    U32(Vec<i32>),
    U64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    Text(Vec<ByteArray>),
}

impl ParquetTable {
    fn create(file: File, description: Option<&Description>, topic: Topic) -> io::Result<Self> {
        let mut layout = Layout { schema: format!("message {} {{", topic.name()), columns: Vec::new() };
        let places = Places::of(description);
        put_columns(topic, &places, &mut layout)?;
        let schema = Arc::new(parse_message_type(&format!("{} }}", layout.schema)).map_err(failed)?);
        let about = description.map(Description::to_map).into_iter().flatten();
        let about = about.map(|(key, value)| KeyValue::new(format!("radar-chain.{key}"), value)).collect();
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(concat!("radar-chain ", env!("CARGO_PKG_VERSION")).into())
            .set_key_value_metadata(Some(about))
            .build();
        let out = SerializedFileWriter::new(file, schema, Arc::new(properties)).map_err(failed)?;
        Ok(Self { rows: Rows { out, columns: layout.columns, next: 0, waiting: 0 }, places })
    }
}

impl Sink for ParquetTable {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        put_rows(message, &self.places, &mut self.rows)?;
        Ok(message.len() as u64)
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        self.rows.write_group()?;
        self.rows.out.close().map_err(failed)?;
        Ok(())
    }
}

/// The schema in words, and the columns for it.
struct Layout {
    schema: String,
    columns: Vec<Column>,
}

impl Layout {
    fn add(&mut self, repetition: &str, column: &str, value: Value<'_>) {
        let (kind, annotation, values) = match value {
            Value::U32(_) => ("INT32", "(INTEGER(32,false))", Values::U32(Vec::new())),
            // Measurement time: ns since 1970, UTC.
            Value::U64(_) if column == "time_ns" => ("INT64", "(TIMESTAMP(NANOS,true))", Values::U64(Vec::new())),
            Value::U64(_) => ("INT64", "(INTEGER(64,false))", Values::U64(Vec::new())),
            Value::F32(_) => ("FLOAT", "", Values::F32(Vec::new())),
            Value::F64(_) => ("DOUBLE", "", Values::F64(Vec::new())),
            Value::Text(_) => ("BYTE_ARRAY", "(STRING)", Values::Text(Vec::new())),
        };
        let _ = write!(self.schema, " {repetition} {kind} {column} {annotation};");
        self.columns.push(Column { values, known: Vec::new() });
    }
}

impl Table for Layout {
    fn put(&mut self, column: &str, value: Value<'_>) -> io::Result<()> {
        self.add("REQUIRED", column, value);
        Ok(())
    }

    fn put_if(&mut self, _: bool, column: &str, value: Value<'_>) -> io::Result<()> {
        self.add("OPTIONAL", column, value);
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Rows {
    /// Writes the waiting rows.
    fn write_group(&mut self) -> io::Result<()> {
        if self.waiting == 0 {
            return Ok(());
        }
        let mut group = self.out.next_row_group().map_err(failed)?;
        for Column { values, known } in &mut self.columns {
            let Some(mut out) = group.next_column().map_err(failed)? else { break };
            match values {
                Values::U32(values) => write_column::<Int32Type>(&mut out, values, known),
                Values::U64(values) => write_column::<Int64Type>(&mut out, values, known),
                Values::F32(values) => write_column::<FloatType>(&mut out, values, known),
                Values::F64(values) => write_column::<DoubleType>(&mut out, values, known),
                Values::Text(values) => write_column::<ByteArrayType>(&mut out, values, known),
            }
            .and_then(|()| out.close())
            .map_err(failed)?;
        }
        group.close().map_err(failed)?;
        self.waiting = 0;
        Ok(())
    }
}

impl Table for Rows {
    fn put(&mut self, column: &str, value: Value<'_>) -> io::Result<()> {
        // The physical types are signed; the schema says that the numbers are not.
        match (&mut self.columns[self.next].values, value) {
            (Values::U32(values), Value::U32(value)) => values.push(value.cast_signed()),
            (Values::U64(values), Value::U64(value)) => values.push(value.cast_signed()),
            (Values::F32(values), Value::F32(value)) => values.push(value),
            (Values::F64(values), Value::F64(value)) => values.push(value),
            (Values::Text(values), Value::Text(text)) => values.push(text.into()),
            (_, value) => return Err(io::Error::other(format!("column {column} does not take {value:?}"))),
        }
        self.next += 1;
        Ok(())
    }

    fn put_if(&mut self, known: bool, column: &str, value: Value<'_>) -> io::Result<()> {
        self.columns[self.next].known.push(i16::from(known));
        if known {
            return self.put(column, value);
        }
        self.next += 1;
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        (self.next, self.waiting) = (0, self.waiting + 1);
        if self.waiting == GROUP_ROWS { self.write_group() } else { Ok(()) }
    }
}

fn write_column<T: DataType>(
    out: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    known: &mut Vec<i16>,
) -> Result<(), ParquetError> {
    let levels = (!known.is_empty()).then_some(known.as_slice());
    out.typed::<T>().write_batch(values, levels, None)?;
    values.clear();
    known.clear();
    Ok(())
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
