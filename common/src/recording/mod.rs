//! Recorded messages: what the recorder writes and what batch runs read.
//!
//! Two forms of the same messages: JSON lines for people and scripts ([`jsonl`]), and
//! MCAP containers for everything else ([`container`]). [`open`] reads either.

mod commands;
pub mod container;
mod gap;
pub mod jsonl;
mod log_time;
pub(crate) mod not_known;
mod parts;
mod plain_plots;
pub mod row;

pub use crate::messages::{Recorded, RecordedRef};
pub use commands::commands_of;
pub use gap::{Gap, GapReason};
pub use log_time::LogTime;
pub use parts::{part_name, parts_from, parts_of, parts_of_run, run_and_part};

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Why a recording cannot be read or written. Each is one line.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened.
    #[error("cannot open recording {}: {cause}", path.display())]
    Open {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// Neither a recording nor JSON lines.
    #[error("{} is not a recording: expected an MCAP file or JSON lines", path.display())]
    NotARecording {
        /// Which file.
        path: PathBuf,
    },
    /// JSON lines where a container is needed.
    #[error("{} holds JSON lines, expected an MCAP recording", path.display())]
    NotAContainer {
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
    /// A part of the container is in a form that is not read.
    #[error("not supported: {message}")]
    NotSupported {
        /// What was found, and what is read.
        message: String,
    },
    /// Reading or writing fails.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl RecordingError {
    /// Whether what was read is to blame.
    pub fn is_of_input(&self) -> bool {
        !matches!(self, Self::Open { .. } | Self::Io(_))
    }
}

/// All messages of a recording, in file order, from a reader of either form.
pub type Messages = Box<dyn Iterator<Item = Result<Recorded, RecordingError>>>;

/// Opens a recording of either form; the form is found from the first bytes.
///
/// # Errors
/// The file does not exist, is a directory, or is neither form.
pub fn open(path: &Path) -> Result<Messages, RecordingError> {
    let (file, is_container) = open_either(path)?;
    let input = BufReader::with_capacity(1 << 20, file);
    Ok(if is_container { Box::new(container::Reader::ahead(input)) } else { Box::new(jsonl::Reader::new(input)) })
}

/// Opens a recording that has to be a container.
///
/// # Errors
/// As [`open`], or the file holds JSON lines.
pub fn open_container(path: &Path) -> Result<File, RecordingError> {
    match open_either(path)? {
        (file, true) => Ok(file),
        (_, false) => Err(RecordingError::NotAContainer { path: path.to_path_buf() }),
    }
}

/// A file at its beginning, and whether it is a container. One that was cut within the first bytes is a container in which
/// there is nothing.
fn open_either(path: &Path) -> Result<(File, bool), RecordingError> {
    let opening = |cause| RecordingError::Open { path: path.to_path_buf(), cause };
    let mut file = File::open(path).map_err(opening)?;
    let mut start = [0_u8; container::MAGIC.len()];
    let length = read_up_to(&mut file, &mut start).map_err(opening)?;
    file.seek(SeekFrom::Start(0)).map_err(opening)?;
    let start = &start[..length];
    let is_container = container::MAGIC.starts_with(start);
    let first = start.iter().find(|byte| !byte.is_ascii_whitespace());
    if is_container || first.is_none_or(|&byte| byte == b'{') {
        Ok((file, is_container))
    } else {
        Err(RecordingError::NotARecording { path: path.to_path_buf() })
    }
}

/// Reads until `buffer` is full or the file ends; returns how much that was.
fn read_up_to(file: &mut File, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut length = 0;
    while length < buffer.len() {
        match file.read(&mut buffer[length..])? {
            0 => break,
            read => length += read,
        }
    }
    Ok(length)
}
