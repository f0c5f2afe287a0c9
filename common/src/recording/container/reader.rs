//! The messages of a container.

use std::collections::HashMap;
use std::io::Read;

use bincode::config::{Configuration, Fixint, LittleEndian};
use mcap::records::{Record, op};
use serde::de::DeserializeOwned;

use super::blocks::{Block, Blocks, BlocksAhead, End};
use super::{Description, ENCODING, GAPS, encoding, lengths, schema};
use crate::dwell::DwellHeader;
use crate::messages::{ForTopic, Message};
use crate::printable::printable;
use crate::recording::{Gap, Recorded, RecordingError};
use crate::topic::Topic;

/// What lies in a recording.
#[expect(clippy::large_enum_variant, reason = "nearly all entries are messages")]
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// A message.
    Message(Recorded),
    /// Messages that are missing here.
    Gap(Gap),
}

/// Reads a container from start to end, whole or cut.
///
/// As an iterator it gives the messages alone. A chunk that is spoilt is an error; what follows it can still be read.
pub struct Reader<B> {
    blocks: B,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    description: Option<Description>,
    counts: Option<String>,
    chunk: Chunk,
    /// An entry read while looking for the description.
    waiting: Option<Result<Entry, RecordingError>>,
    index: u64,
    end: Option<End>,
}

#[derive(Debug)]
enum Channel {
    Messages(Topic, String),
    /// Messages of another version, and what to say of them; said once.
    Foreign(Option<(String, String)>),
    Gaps(String),
}

/// Records being read.
#[derive(Debug, Default)]
struct Chunk {
    records: Vec<u8>,
    place: usize,
}

impl<R: Read> Reader<Blocks<R>> {
    /// A reader from the start of `input`.
    pub fn new(input: R) -> Self {
        Self::of(Blocks::new(input))
    }
}

impl Reader<BlocksAhead> {
    /// As [`Reader::new`]; another thread reads and unpacks ahead.
    pub fn ahead<R: Read + Send + 'static>(input: R) -> Self {
        Self::of(BlocksAhead::of(Blocks::new(input)))
    }
}

impl<B: Iterator<Item = Block>> Reader<B> {
    /// A reader of the messages in `blocks`.
    pub fn of(blocks: B) -> Self {
        Self {
            blocks,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            description: None,
            counts: None,
            chunk: Chunk::default(),
            waiting: None,
            index: 0,
            end: None,
        }
    }

    /// What the recording says of itself; `None` if it does not.
    pub fn description(&mut self) -> Option<&Description> {
        self.look_ahead();
        self.description.as_ref()
    }

    /// What had been counted before the file began, as it was given to the writer.
    pub fn counts(&mut self) -> Option<&str> {
        self.look_ahead();
        self.counts.as_deref()
    }

    fn look_ahead(&mut self) {
        if self.index == 0 && self.waiting.is_none() && self.end.is_none() {
            self.waiting = self.advance();
        }
    }

    /// Whether the recording was closed in order; known at the end.
    pub fn is_whole(&self) -> bool {
        self.end.is_some_and(|end| end.whole)
    }

    /// Where the container ends; known at the end, unless it is damaged before.
    pub fn end(&self) -> Option<End> {
        self.end
    }

    /// Messages given out so far.
    pub fn messages(&self) -> u64 {
        self.index
    }

    /// The next message or gap.
    pub fn next_entry(&mut self) -> Option<Result<Entry, RecordingError>> {
        self.waiting.take().or_else(|| self.advance())
    }

    fn advance(&mut self) -> Option<Result<Entry, RecordingError>> {
        loop {
            match self.chunk.next(&mut self.schemas, &mut self.channels) {
                Ok(Some(entry)) => {
                    self.index += u64::from(matches!(entry, Entry::Message(_)));
                    return Some(Ok(entry));
                }
                Ok(None) => {}
                Err((channel, message)) => {
                    let index = self.index;
                    self.index += 1;
                    return Some(Err(RecordingError::Message { index, channel, message }));
                }
            }
            match self.blocks.next()? {
                Block::Description(description) => self.description = Some(description),
                Block::Counts(counts) => self.counts = Some(counts),
                Block::Chunk { records, .. } => self.chunk = Chunk { records, place: 0 },
                Block::Spoilt { offset, message } => {
                    return Some(Err(RecordingError::Container { message: format!("byte {offset}: {message}") }));
                }
                Block::NotSupported { offset, message } => {
                    return Some(Err(RecordingError::NotSupported { message: format!("byte {offset}: {message}") }));
                }
                Block::End(end) => self.end = Some(end),
            }
        }
    }
}

impl<B: Iterator<Item = Block>> Iterator for Reader<B> {
    type Item = Result<Recorded, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.next_entry()? {
                Ok(Entry::Message(message)) => return Some(Ok(message)),
                Ok(Entry::Gap(_)) => {}
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

impl<B> std::fmt::Debug for Reader<B> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reader").field("index", &self.index).field("end", &self.end).finish_non_exhaustive()
    }
}

impl Chunk {
    /// The next entry of the chunk; an error names the channel and ends nothing.
    fn next(
        &mut self,
        schemas: &mut HashMap<u16, String>,
        channels: &mut HashMap<u16, Channel>,
    ) -> Result<Option<Entry>, (String, String)> {
        while let Some((opcode, content)) = self.record() {
            let damaged = |error: mcap::McapError| ("container".to_string(), error.to_string());
            match opcode {
                _ if !lengths::fit(opcode, content) => {
                    return Err(("container".into(), "a length in a record is greater than the record".into()));
                }
                op::SCHEMA => {
                    if let Record::Schema { header, .. } = mcap::parse_record(opcode, content).map_err(damaged)? {
                        schemas.insert(header.id, printable(&header.name));
                    }
                }
                op::CHANNEL => {
                    if let Record::Channel(channel) = mcap::parse_record(opcode, content).map_err(damaged)? {
                        let name = printable(&channel.topic);
                        let last = name.rsplit('/').next().unwrap_or_default();
                        let topic = Topic::from_name(last);
                        if let (Some(topic), ENCODING) = (topic, channel.message_encoding.as_str()) {
                            let (ours, found) = (schema(topic).0, schemas.get(&channel.schema_id));
                            let known = match found.filter(|found| *found != ours) {
                                None => Channel::Messages(topic, name),
                                // What the chain says of itself is of its own time: the data can be read without.
                                Some(found) if !topic.is_data() => {
                                    tracing::warn!("{name}: recorded as {found}, this version reads {ours}: left out");
                                    Channel::Foreign(None)
                                }
                                Some(found) => {
                                    let says = format!("recorded as {found}, this version reads {ours}");
                                    Channel::Foreign(Some((name, says)))
                                }
                            };
                            channels.insert(channel.id, known);
                        } else if last == GAPS {
                            channels.insert(channel.id, Channel::Gaps(name));
                        }
                    }
                }
                op::MESSAGE => {
                    let Record::Message { header, data } = mcap::parse_record(opcode, content).map_err(damaged)? else {
                        continue;
                    };
                    return match channels.get_mut(&header.channel_id) {
                        None => continue,
                        Some(Channel::Foreign(says)) => match says.take() {
                            Some(says) => Err(says),
                            None => continue,
                        },
                        Some(Channel::Messages(topic, name)) => {
                            recorded(*topic, &data).map(Entry::Message).map_err(|message| (name.clone(), message))
                        }
                        Some(Channel::Gaps(name)) => serde_json::from_slice(&data)
                            .map(Entry::Gap)
                            .map_err(|error| (name.clone(), error.to_string())),
                    }
                    .map(Some);
                }
                _ => {}
            }
        }
        Ok(None)
    }

    /// The next record; what is left is dropped if it is shorter than it says.
    fn record(&mut self) -> Option<(u8, &[u8])> {
        let rest = self.records.get(self.place..)?;
        let (&opcode, rest) = rest.split_first()?;
        let (length, rest) = rest.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        self.place = self.place.saturating_add(9).saturating_add(length);
        Some((opcode, rest.get(..length)?))
    }
}

fn recorded(topic: Topic, data: &[u8]) -> Result<Recorded, String> {
    struct Decode<'a>(&'a [u8]);
    impl ForTopic for Decode<'_> {
        type Out = Result<Recorded, String>;

        fn call<M: Message>(self) -> Self::Out {
            let (header, elements) = decode::<M>(self.0)?;
            Ok(M::recorded(header, elements))
        }
    }
    // `bincode` looks at each cell of a dwell; here they are taken over as they lie there.
    if topic == Topic::Dwells {
        return dwell(data).map(|(header, cells)| Recorded::Dwells(header, cells));
    }
    topic.apply(Decode(data))
}

/// Header and elements that [`super::encode`] has written.
///
/// # Errors
/// In words: what does not fit.
pub fn decode<M: Message>(data: &[u8]) -> Result<(M::Header, Vec<M::Element>), String> {
    let (message, length) = decode_start(data)?;
    if length == data.len() { Ok(message) } else { Err(format!("{length} of {} bytes used", data.len())) }
}

fn dwell(data: &[u8]) -> Result<(DwellHeader, Vec<f32>), String> {
    let ((header, count), length): ((DwellHeader, u64), usize) = decode_start(data)?;
    let cells = &data[length..];
    if cells.len() as u64 != count.saturating_mul(4) {
        return Err(format!("{count} cells in {} bytes", cells.len()));
    }
    let (cells, _) = cells.as_chunks();
    Ok((header, cells.iter().map(|&cell| f32::from_le_bytes(cell)).collect()))
}

fn decode_start<T: DeserializeOwned>(data: &[u8]) -> Result<(T, usize), String> {
    bincode::serde::decode_from_slice::<T, Configuration<LittleEndian, Fixint>>(data, encoding())
        .map_err(|error| error.to_string())
}
