//! MCAP containers: chunks with CRC and zstd, one channel per service, an index at the end.
//!
//! ```text
//! magic, header, metadata "radar-chain", schema + channel per topic,
//! chunk, chunk, …, data end, summary (index, statistics), footer, magic
//! ```
//!
//! A chunk is written in one go, so that a file that is cut anywhere is readable up to its
//! last whole chunk: a reader needs nothing of what follows. The payload of a message is
//! the header, the number of elements (u64) and the elements, each field by field without
//! padding, little-endian, integers at their full width ("bincode" with fixed integers).
//! The schema of a channel is the Rust source that defines both, with its units.

use std::collections::{BTreeMap, HashMap};
use std::io::{Read, Seek, Write};

use bincode::config::{Configuration, Fixint, LittleEndian};
use mcap::records::{MessageHeader, Record};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Recorded, RecordedRef, RecordingError};
use crate::services::{ALL_TOPICS, Dwells, HealthReports, Message, Plots, TOPICS, Topic, Tracks, Truth};

/// The first bytes of every MCAP file.
pub const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

/// Message encoding of all channels.
const ENCODING: &str = "bincode";
/// Name of the metadata record that describes the run.
const DESCRIPTION: &str = "radar-chain";
/// No record of ours is larger; a larger length is damage.
const LONGEST_RECORD: usize = 1 << 28;

fn encoding() -> Configuration<LittleEndian, Fixint> {
    bincode::config::standard().with_fixed_int_encoding()
}

/// What a recording says of itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Description {
    /// The effective configuration, TOML.
    pub config: String,
    /// Version of the program.
    pub version: String,
    /// Seed of every random draw.
    pub seed: u64,
    /// Session of the recorder.
    pub session: u64,
    /// Identity of the run: the same in all files of one run.
    pub run: String,
    /// Number of the file in its run, from 0.
    pub part: u32,
}

impl Description {
    fn to_map(&self) -> BTreeMap<String, String> {
        let pairs = [
            ("config", self.config.clone()),
            ("version", self.version.clone()),
            ("seed", self.seed.to_string()),
            ("session", self.session.to_string()),
            ("run", self.run.clone()),
            ("part", self.part.to_string()),
        ];
        pairs.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
    }

    /// What is missing or unreadable keeps its default.
    fn from_map(map: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| map.get(key).cloned().unwrap_or_default();
        Self {
            config: text("config"),
            version: text("version"),
            seed: text("seed").parse().unwrap_or_default(),
            session: text("session").parse().unwrap_or_default(),
            run: text("run"),
            part: text("part").parse().unwrap_or_default(),
        }
    }
}

/// Name and defining source of the messages of a topic.
fn schema(topic: Topic) -> (&'static str, &'static str) {
    match topic {
        Topic::Dwells => (Dwells::SCHEMA, include_str!("../dwell.rs")),
        Topic::Plots => (Plots::SCHEMA, concat!(include_str!("../message.rs"), include_str!("../plots.rs"))),
        Topic::Tracks => (Tracks::SCHEMA, concat!(include_str!("../message.rs"), include_str!("../tracks.rs"))),
        Topic::Truth => (Truth::SCHEMA, include_str!("../truth.rs")),
        Topic::Health => (HealthReports::SCHEMA, include_str!("../health.rs")),
    }
}

/// Writes a container. What has been written is on its way to the file after [`Writer::flush`].
pub struct Writer<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    channels: [u16; TOPICS],
    payload: Vec<u8>,
    chunk_bytes: u64,
    /// Bytes in the open chunk.
    open_bytes: u64,
    /// Messages in the open chunk, by topic.
    open: [u64; TOPICS],
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a container for the services of `site`; a chunk is closed at `chunk_bytes`.
    ///
    /// # Errors
    /// `out` fails.
    pub fn new(out: W, site: &str, description: &Description, chunk_bytes: u64) -> Result<Self, RecordingError> {
        let mut mcap = mcap::WriteOptions::new()
            .library(concat!("radar-chain ", env!("CARGO_PKG_VERSION")))
            .chunk_size(None) // `write` closes chunks itself, to know what is in the file
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(1) // 3 takes twice the time for 5 % less
            .compression_threads(0)
            .disable_seeking(true) // chunks are written in one go
            .create(out)
            .map_err(write_error)?;
        let metadata = mcap::records::Metadata { name: DESCRIPTION.into(), metadata: description.to_map() };
        mcap.write_metadata(&metadata).map_err(write_error)?;
        let mut channels = [0; TOPICS];
        for topic in ALL_TOPICS {
            let (name, source) = schema(topic);
            let schema = mcap.add_schema(name, "rust", source.as_bytes()).map_err(write_error)?;
            let service = format!("radar/{site}/{}", topic.name());
            channels[topic as usize] =
                mcap.add_channel(schema, &service, ENCODING, &BTreeMap::new()).map_err(write_error)?;
        }
        Ok(Self { mcap, channels, payload: Vec::new(), chunk_bytes, open_bytes: 0, open: [0; TOPICS] })
    }

    /// Appends one message.
    ///
    /// # Errors
    /// `out` fails; nothing can be written afterwards.
    pub fn write(&mut self, message: RecordedRef<'_>) -> Result<(), RecordingError> {
        self.payload.clear();
        match message {
            RecordedRef::Dwells(header, elements) => self.encode(header, elements),
            RecordedRef::Plots(header, elements) => self.encode(header, elements),
            RecordedRef::Tracks(header, elements) => self.encode(header, elements),
            RecordedRef::Truth(header, elements) => self.encode(header, elements),
            RecordedRef::Health(header, elements) => self.encode(header, elements),
        }?;
        let header = MessageHeader {
            channel_id: self.channels[message.topic() as usize],
            sequence: message.seq() as u32,
            log_time: message.time_ns(),
            publish_time: message.time_ns(),
        };
        self.open[message.topic() as usize] += 1;
        self.open_bytes += self.payload.len() as u64;
        self.mcap.write_to_known_channel(&header, &self.payload).map_err(write_error)?;
        if self.open_bytes >= self.chunk_bytes { self.flush() } else { Ok(()) }
    }

    /// Messages that are not in a whole chunk of the file yet, by topic: lost if writing fails now.
    pub fn unsaved(&self) -> [u64; TOPICS] {
        self.open
    }

    fn encode<H: Serialize, E: Serialize>(&mut self, header: &H, elements: &[E]) -> Result<(), RecordingError> {
        bincode::serde::encode_into_std_write((header, elements), &mut self.payload, encoding())
            .map(|_| ())
            .map_err(|error| RecordingError::Container { message: error.to_string() })
    }

    /// Closes the chunk, so that everything so far survives the end of the process.
    ///
    /// # Errors
    /// `out` fails; nothing can be written afterwards.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        self.mcap.flush().map_err(write_error)?;
        (self.open, self.open_bytes) = ([0; TOPICS], 0);
        Ok(())
    }

    /// Writes index and end.
    ///
    /// # Errors
    /// `out` fails: the file ends after its last whole chunk.
    pub fn finish(mut self) -> Result<(), RecordingError> {
        self.mcap.finish().map_err(write_error)?;
        self.mcap.into_inner().flush().map_err(RecordingError::Io)
    }
}

impl<W: Write + Seek> std::fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer").field("channels", &self.channels).finish_non_exhaustive()
    }
}

fn write_error(error: mcap::McapError) -> RecordingError {
    match error {
        mcap::McapError::Io(error) => RecordingError::Io(error),
        other => RecordingError::Container { message: other.to_string() },
    }
}

/// Reads a container from start to end, whole or cut.
pub struct Reader<R: Read> {
    input: R,
    mcap: LinearReader,
    channels: HashMap<u16, (Topic, String)>,
    description: Option<Description>,
    /// A message read while looking for the description.
    waiting: Option<Result<Recorded, RecordingError>>,
    index: u64,
    whole: bool,
    ended: bool,
}

impl<R: Read> Reader<R> {
    /// A reader from the start of `input`.
    pub fn new(input: R) -> Self {
        // A chunk is checked before any of its messages is given out.
        let options =
            LinearReaderOptions::default().with_prevalidate_chunk_crcs(true).with_record_length_limit(LONGEST_RECORD);
        Self {
            input,
            mcap: LinearReader::new_with_options(options),
            channels: HashMap::new(),
            description: None,
            waiting: None,
            index: 0,
            whole: false,
            ended: false,
        }
    }

    /// What the recording says of itself; `None` if it does not.
    pub fn description(&mut self) -> Option<&Description> {
        if self.description.is_none() && self.waiting.is_none() {
            self.waiting = self.advance();
        }
        self.description.as_ref()
    }

    /// Whether the recording was closed in order; known at the end.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// Messages given out so far.
    pub fn messages(&self) -> u64 {
        self.index
    }

    /// Reads on to the next message.
    fn advance(&mut self) -> Option<Result<Recorded, RecordingError>> {
        while !self.ended {
            let found = match self.mcap.next_event() {
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let read = read(&mut self.input, self.mcap.insert(wanted));
                    match read {
                        Ok(count) => self.mcap.notify_read(count),
                        Err(error) => {
                            self.ended = true;
                            return Some(Err(RecordingError::Io(error)));
                        }
                    }
                    continue;
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => mcap::parse_record(opcode, data).map(Some),
                // The end of a file that was cut: what is whole has been given out.
                Some(Err(mcap::McapError::UnexpectedEof)) | None => Ok(None),
                Some(Err(error)) => Err(error),
            };
            match found {
                Ok(Some(Record::Metadata(metadata))) if metadata.name == DESCRIPTION => {
                    self.description = Some(Description::from_map(&metadata.metadata));
                }
                Ok(Some(Record::Channel(channel))) if channel.message_encoding == ENCODING => {
                    let last = channel.topic.rsplit('/').next().unwrap_or_default();
                    if let Some(topic) = ALL_TOPICS.into_iter().find(|topic| topic.name() == last) {
                        self.channels.insert(channel.id, (topic, channel.topic.clone()));
                    }
                }
                Ok(Some(Record::Message { header, data })) => {
                    if let Some((topic, channel)) = self.channels.get(&header.channel_id) {
                        let index = self.index;
                        self.index += 1;
                        return Some(decode(*topic, &data).map_err(|message| RecordingError::Message {
                            index,
                            channel: channel.clone(),
                            message,
                        }));
                    }
                }
                Ok(Some(Record::DataEnd(_))) => {
                    self.whole = true;
                    self.ended = true; // the summary repeats what is known
                }
                Ok(Some(_)) => {}
                Ok(None) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    return Some(Err(RecordingError::Container { message: error.to_string() }));
                }
            }
        }
        None
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Recorded, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.waiting.take().or_else(|| self.advance())
    }
}

impl<R: Read> std::fmt::Debug for Reader<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reader").field("index", &self.index).field("whole", &self.whole).finish_non_exhaustive()
    }
}

/// One read that a signal does not end.
fn read(input: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    loop {
        match input.read(buffer) {
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

fn decode(topic: Topic, data: &[u8]) -> Result<Recorded, String> {
    match topic {
        Topic::Dwells => parts(data).map(|(header, elements)| Recorded::Dwells(header, elements)),
        Topic::Plots => parts(data).map(|(header, elements)| Recorded::Plots(header, elements)),
        Topic::Tracks => parts(data).map(|(header, elements)| Recorded::Tracks(header, elements)),
        Topic::Truth => parts(data).map(|(header, elements)| Recorded::Truth(header, elements)),
        Topic::Health => parts(data).map(|(header, elements)| Recorded::Health(header, elements)),
    }
}

fn parts<H: DeserializeOwned, E: DeserializeOwned>(data: &[u8]) -> Result<(H, Vec<E>), String> {
    let (message, length) = bincode::serde::decode_from_slice(data, encoding()).map_err(|error| error.to_string())?;
    if length == data.len() { Ok(message) } else { Err(format!("{length} of {} bytes used", data.len())) }
}
