//! Recordings as tables (CSV; Parquet in the program `parquet-export`), as JSON lines, as MCAP with JSON for viewers, and as ways
//! of targets over the earth.
//!
//! ```text
//! messages ──▶ rows ──▶ CSV, Parquet: one file per topic, one row per element
//!     ├──────▶ JSON lines:            one file per topic, one line per message
//!     ├──────▶ MCAP with JSON:        one file, one channel per topic
//!     └──────▶ GeoJSON, KML:          one file per topic, one way per target; COURAGEOUS: one file of tracks
//! ```

mod courageous;
mod csv_table;
mod foxglove;
mod geojson;
mod kml;
mod mcap_json;
mod paths;
mod places;

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use common::messages::{ForMessage, ForTopic, Message};
use common::recording::container::Description;
use common::recording::row::{Row, Table};
use common::recording::{Recorded, RecordedRef, RecordingError, jsonl};
use common::topic::Topic;

use courageous::Courageous;
use csv_table::CsvTable;
use geojson::GeoJson;
use kml::Kml;
use mcap_json::McapJson;
pub use places::Places;

/// A form that recordings can be written in.
pub trait Form {
    /// The files for `topics`, and the topics in each.
    fn files(&self, topics: &[Topic]) -> Vec<(String, Vec<Topic>)>;

    /// Begins a file for `topics` of a recording that says `description` of itself.
    ///
    /// # Errors
    /// Those of the file.
    fn create(
        &self,
        file: File,
        description: Option<&Description>,
        topics: &[Topic],
    ) -> Result<Box<dyn Sink>, RecordingError>;
}

/// One file for each of `topics`, however often it was asked for.
pub fn files_by_topic(topics: &[Topic], extension: &str) -> Vec<(String, Vec<Topic>)> {
    let mut topics = topics.to_vec();
    topics.sort_unstable();
    topics.dedup();
    topics.iter().map(|&topic| (format!("{}.{extension}", topic.name()), vec![topic])).collect()
}

/// The topics that targets move in, of those that are asked for.
fn moving(topics: &[Topic]) -> Vec<Topic> {
    topics.iter().copied().filter(|topic| paths::TOPICS.contains(topic)).collect()
}

/// The forms that the recorder writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// JSON lines, which read back as a recording.
    JsonLines,
    /// MCAP with JSON messages and their JSON Schemas, for viewers.
    McapJson,
    /// Ways of targets as GeoJSON.
    GeoJson,
    /// Ways of targets as KML.
    Kml,
    /// Tracks as the test log of a counter-drone system.
    Courageous,
}

impl Form for Format {
    fn files(&self, topics: &[Topic]) -> Vec<(String, Vec<Topic>)> {
        match self {
            Self::McapJson => vec![("messages.mcap".into(), topics.to_vec())],
            Self::Csv => files_by_topic(topics, "csv"),
            Self::JsonLines => files_by_topic(topics, "jsonl"),
            Self::GeoJson => files_by_topic(&moving(topics), "geojson"),
            Self::Kml => files_by_topic(&moving(topics), "kml"),
            Self::Courageous => vec![("courageous.json".into(), vec![Topic::Tracks])],
        }
    }

    fn create(
        &self,
        file: File,
        description: Option<&Description>,
        topics: &[Topic],
    ) -> Result<Box<dyn Sink>, RecordingError> {
        Ok(match (self, topics) {
            (Self::Csv, &[topic]) => Box::new(CsvTable::create(file, description, topic)?),
            (Self::GeoJson, _) => Box::new(GeoJson::create(BufWriter::new(file), description)?),
            (Self::Kml, topics) => {
                let name = topics.first().map_or("", |topic| topic.name());
                Box::new(Kml::create(BufWriter::new(file), description, name)?)
            }
            (Self::Courageous, _) => Box::new(Courageous::create(BufWriter::new(file), description)?),
            (Self::McapJson, topics) => Box::new(McapJson::create(BufWriter::new(file), description, topics)?),
            (_, _) => Box::new(jsonl::Writer::new(BufWriter::new(file))),
        })
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
    form: &dyn Form,
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
    for (name, topics) in form.files(topics) {
        let path = directory.join(&name);
        let unfinished = Unfinished(directory.join(format!("{name}.unfinished")));
        let begun = File::create(&unfinished.0).map_err(RecordingError::from);
        let sink = begun.and_then(|file| form.create(file, description, &topics));
        let sink = sink.map_err(|error| failed(&path, &error))?;
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
///
/// # Errors
/// Those of `table`.
pub fn put_columns(topic: Topic, places: &Places, table: &mut dyn Table) -> io::Result<()> {
    struct Columns<'a>(&'a Places, &'a mut dyn Table);
    impl ForTopic for Columns<'_> {
        type Out = io::Result<()>;

        fn call<M: Message>(self) -> io::Result<()> {
            let Self(places, table) = self;
            put_element::<M>(&M::Header::default(), &M::Element::default(), places, table)
        }
    }
    topic.apply(Columns(places, table))
}

/// Gives `table` the rows of a message, one per element.
///
/// # Errors
/// Those of `table`.
pub fn put_rows(message: RecordedRef<'_>, places: &Places, table: &mut dyn Table) -> io::Result<()> {
    struct Rows<'a>(&'a Places, &'a mut dyn Table);
    impl ForMessage for Rows<'_> {
        type Out = io::Result<()>;

        fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> io::Result<()> {
            let Self(places, table) = self;
            elements.iter().try_for_each(|element| put_element::<M>(header, element, places, table))
        }
    }
    message.apply(Rows(places, table))
}

/// One row, with its place behind its own columns.
fn put_element<M: Message>(
    header: &M::Header,
    element: &M::Element,
    places: &Places,
    table: &mut dyn Table,
) -> io::Result<()> {
    element.put_row(header, table)?;
    places.put(element.position_m(), table)?;
    table.end_row()
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
pub trait Sink {
    /// Appends a message; returns how many rows, lines or messages that were.
    ///
    /// # Errors
    /// Those of the file.
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError>;

    /// Closes the file.
    ///
    /// # Errors
    /// Those of the file.
    fn finish(self: Box<Self>) -> Result<(), RecordingError>;
}

impl Sink for jsonl::Writer<BufWriter<File>> {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        jsonl::Writer::write(self, message).map(|()| 1)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordingError> {
        jsonl::Writer::finish(*self)
    }
}
