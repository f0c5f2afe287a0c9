//! Recordings as tables (CSV, Parquet), as JSON lines, and as MCAP with JSON for viewers.
//!
//! ```text
//! messages ──▶ rows ──▶ CSV, Parquet: one file per topic, one row per element
//!     ├──────▶ JSON lines:            one file per topic, one line per message
//!     └──────▶ MCAP with JSON:        one file, one channel per topic
//! ```

mod csv_table;
mod mcap_json;
mod parquet_table;

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use common::messages::{ForMessage, ForTopic, Message};
use common::recording::container::Description;
use common::recording::row::{Row, Table};
use common::recording::{Recorded, RecordedRef, RecordingError, jsonl};
use common::topic::Topic;

use csv_table::CsvTable;
use mcap_json::McapJson;
use parquet_table::ParquetTable;

/// Form of the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// JSON lines, which read back as a recording.
    JsonLines,
    /// MCAP with JSON messages and their JSON Schemas, for viewers.
    McapJson,
    /// Parquet tables, with the columns of the CSV.
    Parquet,
}

impl Format {
    /// The files in this form and the topics in each.
    fn files(self, topics: &[Topic]) -> Vec<(String, Vec<Topic>)> {
        let extension = match self {
            Self::McapJson => return vec![("messages.mcap".into(), topics.to_vec())],
            Self::Csv => "csv",
            Self::JsonLines => "jsonl",
            Self::Parquet => "parquet",
        };
        let mut topics = topics.to_vec();
        topics.sort_unstable(); // one file each, however often it was asked for
        topics.dedup();
        topics.iter().map(|&topic| (format!("{}.{extension}", topic.name()), vec![topic])).collect()
    }
}

/// Why an export stops.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file cannot be written.
    #[error("cannot write {}: {message}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        message: String,
    },
    /// Too much for any of the forms.
    #[error("topic `{0}` has no text form: 10⁸ bytes a second in a recording, 10⁹ as text")]
    Bulk(&'static str),
}

/// Writes the messages of `topics` into `directory`; returns the files with their numbers of rows, lines or messages.
/// Parquet and MCAP hold the `description` of the recording as well, if it has one.
///
/// # Errors
/// [`ExportError`].
pub fn export(
    messages: impl Iterator<Item = Result<Recorded, RecordingError>>,
    description: Option<&Description>,
    topics: &[Topic],
    format: Format,
    directory: &Path,
) -> Result<Vec<(PathBuf, u64)>, ExportError> {
    if let Some(bulk) = topics.iter().find(|topic| topic.is_bulk()) {
        return Err(ExportError::Bulk(bulk.name()));
    }
    let failed = |path: &Path, error: &dyn std::fmt::Display| ExportError::Write {
        path: path.to_path_buf(),
        message: error.to_string(),
    };
    std::fs::create_dir_all(directory).map_err(|error| failed(directory, &error))?;
    let mut outputs = Vec::new();
    for (name, topics) in format.files(topics) {
        let path = directory.join(&name);
        let unfinished = Unfinished(directory.join(format!("{name}.unfinished")));
        let sink = create(&unfinished.0, description, &topics, format).map_err(|error| failed(&path, &error))?;
        outputs.push(Output { path, topics, written: 0, sink, unfinished });
    }
    for message in messages {
        let message = message?;
        let message = message.by_ref();
        if let Some(output) = outputs.iter_mut().find(|output| output.topics.contains(&message.topic())) {
            output.written += output.sink.write(message).map_err(|error| failed(&output.path, &error))?;
        }
    }
    let close = |output: Output| match output.sink.finish().and_then(|()| output.unfinished.becomes(&output.path)) {
        Ok(()) => Ok((output.path, output.written)),
        Err(error) => Err(failed(&output.path, &error)),
    };
    outputs.into_iter().map(close).collect()
}

/// Gives `table` a row with the columns of a topic.
fn put_columns(topic: Topic, table: &mut dyn Table) -> io::Result<()> {
    struct Columns<'a>(&'a mut dyn Table);
    impl ForTopic for Columns<'_> {
        type Out = io::Result<()>;

        fn call<M: Message>(self) -> io::Result<()> {
            M::Element::default().put_row(&M::Header::default(), self.0)?;
            self.0.end_row()
        }
    }
    topic.apply(Columns(table))
}

/// Gives `table` the rows of a message, one per element.
fn put_rows(message: RecordedRef<'_>, table: &mut dyn Table) -> io::Result<()> {
    struct Rows<'a>(&'a mut dyn Table);
    impl ForMessage for Rows<'_> {
        type Out = io::Result<()>;

        fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> io::Result<()> {
            elements.iter().try_for_each(|element| {
                element.put_row(header, self.0)?;
                self.0.end_row()
            })
        }
    }
    message.apply(Rows(table))
}

/// One file.
struct Output {
    path: PathBuf,
    topics: Vec<Topic>,
    written: u64,
    sink: Box<dyn Sink>,
    unfinished: Unfinished,
}

/// A file that is not complete: it has its name only when it is, and goes if it never will be.
struct Unfinished(PathBuf);

impl Unfinished {
    fn becomes(&self, path: &Path) -> Result<(), RecordingError> {
        Ok(std::fs::rename(&self.0, path)?)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0); // renamed, if all went well
    }
}

/// Where messages go.
trait Sink {
    /// Appends a message; returns how many rows, lines or messages that were.
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError>;

    /// Closes the file.
    fn finish(self: Box<Self>) -> Result<(), RecordingError>;
}

fn create(
    path: &Path,
    description: Option<&Description>,
    topics: &[Topic],
    format: Format,
) -> Result<Box<dyn Sink>, RecordingError> {
    let file = File::create(path)?;
    Ok(match (format, topics) {
        (Format::Csv, &[topic]) => Box::new(CsvTable::create(file, topic)?),
        (Format::Parquet, &[topic]) => Box::new(ParquetTable::create(file, description, topic)?),
        (Format::McapJson, topics) => Box::new(McapJson::create(BufWriter::new(file), description, topics)?),
        (_, _) => Box::new(jsonl::Writer::new(BufWriter::new(file))),
    })
}

impl Sink for jsonl::Writer<BufWriter<File>> {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        jsonl::Writer::write(self, message).map(|()| 1)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordingError> {
        jsonl::Writer::finish(*self)
    }
}
