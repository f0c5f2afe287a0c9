//! What travels with every message of a link, and with those that answer.
//!
//! The bytes of a message are those of recordings, the same on every architecture. Beside them goes an envelope: which protocol,
//! which message, in which version, and check sums of both.

use common::recording::container::{encoding, schema};
use common::topic::Topic;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::clock::Offset;

/// The first bytes of every envelope.
const MAGIC: [u8; 4] = *b"RCLK";
/// Version of the protocol.
const VERSION: u16 = 1;
/// Bytes before the envelope's own: magic, version, check sum.
const PREFIX: usize = 10;

/// From the side that sends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Envelope {
    /// One start of the sender.
    pub session: u64,
    /// Number of the message in this session, from 0; of a beat, the number of the next message.
    pub number: u64,
    /// Number of the oldest message that the sender still has: what is missing before it is lost.
    pub oldest: u64,
    /// The sender's monotonic clock at sending, ns.
    pub sent_ns: u64,
    /// What must be added to times of the sender's clock to get the receiver's; `None` while it is not known.
    pub offset: Option<Offset>,
    /// The message that goes with it; `None` for a beat, which says that the sender is there and how far it is.
    pub message: Option<Enclosed>,
}

/// A message that goes with an envelope.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Enclosed {
    /// Name of its topic.
    pub topic: String,
    /// Version of header and elements.
    pub version: String,
    /// CRC-32 of its bytes.
    pub checksum: u32,
}

/// From the side that receives.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// The sender's session.
    pub session: u64,
    /// One start of the receiver.
    pub receiver: u64,
    /// Number of the message that is expected next: all before it have been delivered or counted.
    pub next: u64,
    /// Whether later ones have arrived before it.
    pub gap: bool,
    /// `sent_ns` of the envelope that is answered.
    pub sent_ns: u64,
    /// The receiver's monotonic clock when that came, ns.
    pub received_ns: u64,
    /// The receiver's monotonic clock at answering, ns.
    pub answered_ns: u64,
}

/// Why bytes from the network are not used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Not of a link.
    #[error("no envelope of a link: {0}")]
    Garbage(String),
    /// Of a link of another version.
    #[error("link of version {found}, expected {VERSION}")]
    Protocol {
        /// Which.
        found: u16,
    },
    /// Damaged on the way.
    #[error("check sum {found:08x}, expected {expected:08x}")]
    Damaged {
        /// Of the bytes.
        found: u32,
        /// In the envelope.
        expected: u32,
    },
    /// A topic that this version does not have.
    #[error("topic `{0}`, which this version does not know")]
    Topic(String),
    /// A message of another version.
    #[error("{found}, expected {expected}: both hosts need the same version of the program")]
    Version {
        /// Which.
        found: String,
        /// Which one this program has.
        expected: &'static str,
    },
}

impl Enclosed {
    /// The label of a message with these bytes.
    pub fn new(topic: Topic, bytes: &[u8]) -> Self {
        Self { topic: topic.name().to_string(), version: schema(topic).0.to_string(), checksum: crc32fast::hash(bytes) }
    }

    /// The topic of the message, if this program can read it and its bytes are whole.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn check(&self, bytes: &[u8]) -> Result<Topic, Refused> {
        let found = crc32fast::hash(bytes);
        if found != self.checksum {
            return Err(Refused::Damaged { found, expected: self.checksum });
        }
        let topic =
            Topic::from_name(&self.topic).ok_or_else(|| Refused::Topic(self.topic.escape_debug().to_string()))?;
        let expected = schema(topic).0;
        if self.version != expected {
            return Err(Refused::Version { found: self.version.escape_debug().to_string(), expected });
        }
        Ok(topic)
    }
}

/// The bytes of an [`Envelope`] or an [`Answer`].
///
/// # Panics
/// Never: both can be written to memory.
pub fn pack<T: Serialize>(content: &T) -> Vec<u8> {
    let content = bincode::serde::encode_to_vec(content, encoding()).expect("numbers and texts can be encoded");
    let mut bytes = Vec::with_capacity(PREFIX + content.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(crc32fast::hash(&content).to_le_bytes());
    bytes.extend(content);
    bytes
}

/// What [`pack`] has packed.
///
/// # Errors
/// [`Refused`].
pub fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Refused> {
    let garbage = |why: String| Refused::Garbage(why);
    let (prefix, content) =
        bytes.split_first_chunk::<PREFIX>().ok_or_else(|| garbage(format!("{} bytes", bytes.len())))?;
    let [m0, m1, m2, m3, v0, v1, sum @ ..] = *prefix;
    if [m0, m1, m2, m3] != MAGIC {
        return Err(garbage("it begins with other bytes".into()));
    }
    let version = u16::from_le_bytes([v0, v1]);
    if version != VERSION {
        return Err(Refused::Protocol { found: version });
    }
    let (found, expected) = (crc32fast::hash(content), u32::from_le_bytes(sum));
    if found != expected {
        return Err(Refused::Damaged { found, expected });
    }
    let decoded = bincode::serde::decode_from_slice(content, encoding()).map_err(|error| garbage(error.to_string()))?;
    match decoded {
        (value, length) if length == content.len() => Ok(value),
        (_, length) => Err(garbage(format!("{length} of {} bytes used", content.len()))),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn envelope(bytes: &[u8]) -> Envelope {
        Envelope {
            session: 7,
            number: 12,
            oldest: 3,
            sent_ns: 99,
            offset: Some(Offset { offset_ns: -5, uncertainty_ns: 2 }),
            message: Some(Enclosed::new(Topic::Tracks, bytes)),
        }
    }

    #[test]
    fn what_is_packed_comes_out_and_other_versions_are_named() {
        let sent = envelope(b"tracks");
        let received: Envelope = unpack(&pack(&sent)).expect("an envelope");
        assert_eq!(received, sent);
        let enclosed = received.message.expect("a message");
        assert_eq!(enclosed.check(b"tracks"), Ok(Topic::Tracks));
        assert!(matches!(enclosed.check(b"trucks"), Err(Refused::Damaged { .. })));

        let older = Enclosed { version: "tracks/2".into(), ..enclosed.clone() };
        let error = older.check(b"tracks").expect_err("another version").to_string();
        assert_eq!(error, "tracks/2, expected tracks/3: both hosts need the same version of the program");
        let unknown = Enclosed { topic: "weather".into(), ..enclosed };
        assert!(unknown.check(b"tracks").expect_err("no such topic").to_string().contains("`weather`"));

        let mut newer = pack(&sent);
        newer[4] = 2;
        assert_eq!(unpack::<Envelope>(&newer), Err(Refused::Protocol { found: 2 }));
    }

    proptest! {
        #[test]
        fn no_bytes_are_taken_for_an_envelope(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            prop_assert!(unpack::<Envelope>(&bytes).is_err());
            prop_assert!(unpack::<Answer>(&bytes).is_err());
        }

        #[test]
        fn one_wrong_bit_is_noticed(bit in 0_usize..8 * 60) {
            let mut bytes = pack(&envelope(b"tracks"));
            let bit = bit % (8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(unpack::<Envelope>(&bytes).is_err());
        }
    }
}
