//! Where in a container which time lies, found without unpacking anything.

use std::fs::File;
use std::io::{self, BufReader, Chain, Read, Seek, SeekFrom, Take};
use std::path::Path;

use mcap::records::op;

use super::MAGIC;

/// Bytes of the opcode and the length before every record, and of the two times that a chunk begins with.
const CHUNK_START: usize = 25;

/// A chunk of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Its place in the file, bytes.
    pub offset: u64,
    /// Time of its first message, ns UTC.
    pub from_ns: u64,
    /// Time of its last message, ns UTC.
    pub to_ns: u64,
}

/// The chunks of a container, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Index {
    /// Bytes up to the end of the first chunk, which says what lies in all others.
    head: u64,
    /// Chunks with messages.
    pub spans: Vec<Span>,
}

/// A container that begins at one of its chunks.
pub type FromChunk = Chain<Take<BufReader<File>>, BufReader<File>>;

impl Index {
    /// Goes through a container from chunk to chunk; one that is cut ends with its last whole chunk.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn of(file: &mut (impl Read + Seek)) -> io::Result<Self> {
        let length = file.seek(SeekFrom::End(0))?;
        let (mut index, mut offset) = (Self::default(), MAGIC.len() as u64);
        let mut start = [0; CHUNK_START];
        while offset.saturating_add(CHUNK_START as u64) <= length {
            file.seek(SeekFrom::Start(offset))?;
            file.read_exact(&mut start)?;
            let number = |at: usize| start[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
            let end = offset.saturating_add(9).saturating_add(number(1));
            if start[0] == op::DATA_END || end > length {
                break;
            }
            if start[0] == op::CHUNK && index.head == 0 {
                index.head = end;
            } else if start[0] == op::CHUNK {
                index.spans.push(Span { offset, from_ns: number(9), to_ns: number(17) });
            }
            offset = end;
        }
        Ok(index)
    }

    /// The container as if it began at one of its chunks.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open_at(&self, path: &Path, span: &Span) -> io::Result<FromChunk> {
        let mut rest = File::open(path)?;
        rest.seek(SeekFrom::Start(span.offset))?;
        Ok(BufReader::new(File::open(path)?).take(self.head).chain(BufReader::new(rest)))
    }
}
