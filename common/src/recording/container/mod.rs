//! MCAP containers: chunks with CRC and zstd, one channel per service, an index at the end.
//!
//! ```text
//! magic, header, metadata "radar-chain" and "counts", schema + channel per topic,
//! chunk, chunk, …, data end, summary (index, statistics), footer, magic
//! ```
//!
//! A chunk is written in one go, so that a file that is cut anywhere is readable up to its
//! last whole chunk: a reader needs nothing of what follows. The payload of a message is
//! the header, the number of elements (u64) and the elements, each field by field without
//! padding, little-endian, integers at their full width ("bincode" with fixed integers).
//! The schema of a channel is the Rust source that defines both, with its units.
//!
//! What is missing lies in a channel of its own, `radar/<site>/gaps`, as JSON, where the messages would lie.

mod blocks;
mod index;
mod lengths;
mod reader;
mod writer;

pub use blocks::{Block, Blocks, BlocksAhead, End};
pub use index::{FromChunk, Index, Span};
pub use reader::{Entry, Reader, decode};
pub use writer::Writer;

use std::collections::BTreeMap;

use bincode::config::{Configuration, Fixint, LittleEndian};

use super::{RecordedRef, RecordingError};
use crate::messages::{ForMessage, ForTopic, Message};
use crate::printable::printable;
use crate::topic::Topic;

/// The first bytes of every MCAP file.
pub const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

/// Message encoding of the channels of messages.
const ENCODING: &str = "bincode";
/// Name of the metadata record that describes the run.
const DESCRIPTION: &str = "radar-chain";
/// Name of the metadata record of what was counted before the file began, and of its only key.
const COUNTS: &str = "counts";
/// Last part of the name of the channel of gaps.
const GAPS: &str = "gaps";
/// No record of ours is larger; a larger length is damage.
const LONGEST_RECORD: usize = 1 << 28;

/// JSON Schema of a gap.
const GAP_SCHEMA: &str = r#"{"type":"object","description":"Messages that are missing here","properties":{
"topic":{"type":"string"},
"session":{"type":"integer","description":"Session of their publisher"},
"first_seq":{"type":"integer","description":"Position of the first one"},
"last_seq":{"type":"integer","description":"Position of the last one"},
"count":{"type":"integer","description":"How many are missing"},
"reason":{"type":"string","enum":["queue","disk","away","sender"]}}}"#;

/// How numbers are written in recordings and on links: every one at its full width, little-endian.
pub fn encoding() -> Configuration<LittleEndian, Fixint> {
    bincode::config::standard().with_fixed_int_encoding()
}

/// A message as the bytes of its header and elements: equal bytes are equal messages, also where numbers are not equal to
/// themselves (NaN) or equal to others (−0).
///
/// # Errors
/// The message cannot be encoded.
pub fn encode(message: RecordedRef<'_>, out: &mut Vec<u8>) -> Result<(), RecordingError> {
    struct Encode<'a>(&'a mut Vec<u8>);
    impl ForMessage for Encode<'_> {
        type Out = Result<usize, bincode::error::EncodeError>;

        fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> Self::Out {
            bincode::serde::encode_into_std_write((header, elements), self.0, encoding())
        }
    }
    let written = message.apply(Encode(out));
    written.map(|_| ()).map_err(|error| RecordingError::Container { message: error.to_string() })
}

/// What a recording says of itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Description {
    /// Name of the radar.
    pub site: String,
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
    /// By the names of the fields.
    pub fn to_map(&self) -> BTreeMap<String, String> {
        let pairs = [
            ("site", self.site.clone()),
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
        let raw = |key: &str| map.get(key).cloned().unwrap_or_default();
        let text = |key: &str| printable(&raw(key));
        Self {
            site: text("site"),
            config: raw("config"),
            version: text("version"),
            seed: text("seed").parse().unwrap_or_default(),
            session: text("session").parse().unwrap_or_default(),
            run: text("run"),
            part: text("part").parse().unwrap_or_default(),
        }
    }
}

/// Name and defining source of the messages of a topic.
pub fn schema(topic: Topic) -> (&'static str, &'static str) {
    struct Schema;
    impl ForTopic for Schema {
        type Out = (&'static str, &'static str);

        fn call<M: Message>(self) -> Self::Out {
            (M::SCHEMA, M::SOURCE)
        }
    }
    topic.apply(Schema)
}
