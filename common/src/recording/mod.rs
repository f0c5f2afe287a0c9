//! Recorded messages: what the recorder writes and what batch runs read.
//!
//! Two forms of the same messages: JSON lines for people and scripts ([`jsonl`]), and
//! MCAP containers for everything else. [`open`] reads either.

pub mod jsonl;
mod message;
pub(crate) mod not_known;

pub use message::{Recorded, RecordedRef};

use std::path::PathBuf;

/// Why a recording cannot be read or written. Each is one line.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened.
    #[error("cannot open recording {}: {source}", path.display())]
    Open {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Neither a recording nor JSON lines.
    #[error("{} is not a recording: expected an MCAP file or JSON lines", path.display())]
    NotARecording {
        /// Which file.
        path: PathBuf,
    },
    /// A line of a JSON lines file is not a message.
    #[error("line {line}: {message}")]
    Line {
        /// Number of the line from 1.
        line: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A message in a container does not decode.
    #[error("message {index} on {channel}: {message}")]
    Message {
        /// Number of the message in the file from 0.
        index: u64,
        /// Its channel.
        channel: String,
        /// What is wrong with it.
        message: String,
    },
    /// The container is damaged before its end.
    #[error("damaged container: {message}")]
    Container {
        /// What the reader says.
        message: String,
    },
    /// Reading or writing fails.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}
