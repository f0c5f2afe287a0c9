//! What is missing from a recording, and why.

use serde::{Deserialize, Serialize};

use crate::messages::RecordedRef;
use crate::topic::Topic;

/// Why messages are missing from a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapReason {
    /// The recorder came too late to its full queue.
    Queue,
    /// They were received, but could not be written.
    Disk,
    /// No recorder was there, or it died before they were in a whole chunk.
    Away,
    /// Their sender died: positions that nobody published.
    Sender,
}

impl GapReason {
    /// For a sentence that says how many are missing.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Queue => "queue full",
            Self::Disk => "not written",
            Self::Away => "recorder away",
            Self::Sender => "sender died",
        }
    }
}

/// Messages of one topic that are missing where this lies in the recording.
///
/// `count` may be less than the span of positions: a stage that has itself missed something has published less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Gap {
    /// Topic of the messages.
    pub topic: Topic,
    /// Session of their publisher; of the message after the gap where it began anew.
    pub session: u64,
    /// Position of the first one.
    pub first_seq: u64,
    /// Position of the last one.
    pub last_seq: u64,
    /// How many are missing.
    pub count: u64,
    /// Why.
    pub reason: GapReason,
}

impl Gap {
    /// The gap that is left where `message` is missing.
    pub fn of(message: RecordedRef<'_>, reason: GapReason) -> Self {
        let (topic, session, seq) = (message.topic(), message.session(), message.seq());
        Self { topic, session, first_seq: seq, last_seq: seq, count: 1, reason }
    }

    /// Takes in `other` if it is missing for the same reason from the same session; whether it was.
    pub fn merge(&mut self, other: &Self) -> bool {
        let same = (self.topic, self.session, self.reason) == (other.topic, other.session, other.reason);
        if same {
            self.first_seq = self.first_seq.min(other.first_seq);
            self.last_seq = self.last_seq.max(other.last_seq);
            self.count += other.count;
        }
        same
    }
}

impl std::fmt::Display for Gap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { topic, first_seq, last_seq, count, reason, .. } = self;
        write!(f, "{}: {count} missing at positions {first_seq} to {last_seq} ({})", topic.name(), reason.in_words())
    }
}
