//! A container as its chunks, unpacked and checked, with their places in the file.

use std::io::Read;
use std::sync::mpsc::{Receiver, sync_channel};

use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::{COUNTS, DESCRIPTION, Description, LONGEST_RECORD, lengths};
use crate::printable::printable;

/// Bytes of the opcode and the length before every record.
const RECORD_START: u64 = 9;
/// Unpacked chunks that wait for their reader.
const UNPACKED_AHEAD: usize = 2;

/// A part of a container.
#[derive(Debug)]
pub enum Block {
    /// What the recording says of itself.
    Description(Description),
    /// What had been counted before this file began (JSON).
    Counts(String),
    /// Records whose checksum is right.
    Chunk {
        /// Place of the chunk in the file, bytes.
        offset: u64,
        /// The records, unpacked.
        records: Vec<u8>,
    },
    /// A chunk, or the whole rest of the file, that cannot be read.
    Spoilt {
        /// Its place in the file, bytes.
        offset: u64,
        /// What is wrong.
        message: String,
    },
    /// A chunk in a form that is not read.
    NotSupported {
        /// Its place in the file, bytes.
        offset: u64,
        /// What was found, and what is read.
        message: String,
    },
    /// Nothing follows.
    End(End),
}

/// Where and how a container ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct End {
    /// The recording was closed in order.
    pub whole: bool,
    /// Bytes up to the end of the last whole record.
    pub readable: u64,
}

/// Reads the blocks of a container.
pub struct Blocks<R: Read> {
    input: R,
    records: LinearReader,
    unpacker: Option<zstd::bulk::Decompressor<'static>>,
    offset: u64,
    /// Bytes that the input has given.
    taken: u64,
    /// Reads on to the last byte and compares the checksums and the index of the whole file.
    checking: bool,
    chunks: Vec<u64>,
    indexed: usize,
    data_ended: bool,
    ended: bool,
}

impl<R: Read> Blocks<R> {
    /// The blocks of `input`, up to the end of its data.
    pub fn new(input: R) -> Self {
        Self::with(input, false)
    }

    /// As [`Blocks::new`], and everything is checked up to the last byte.
    pub fn checking(input: R) -> Self {
        Self::with(input, true)
    }

    fn with(input: R, checking: bool) -> Self {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(checking)
            .with_validate_summary_section_crc(checking)
            .with_check_finishes_after_end_magic(checking)
            .with_record_length_limit(LONGEST_RECORD);
        Self {
            input,
            records: LinearReader::new_with_options(options),
            unpacker: None,
            offset: super::MAGIC.len() as u64,
            taken: 0,
            checking,
            chunks: Vec::new(),
            indexed: 0,
            data_ended: false,
            ended: false,
        }
    }

    fn end(&mut self, whole: bool) -> Block {
        self.ended = true;
        if whole && self.checking && self.indexed != self.chunks.len() {
            let message = format!("the index names {} of {} chunks", self.indexed, self.chunks.len());
            return Block::Spoilt { offset: self.offset, message };
        }
        // A file that ends within its first bytes ends before the first record.
        Block::End(End { whole, readable: self.offset.min(self.taken) })
    }

    /// The next record, if it says something.
    fn advance(&mut self) -> Option<Block> {
        let (opcode, content) = match self.records.next_event() {
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                match read(&mut self.input, self.records.insert(wanted)) {
                    Ok(count) => {
                        self.taken += count as u64;
                        self.records.notify_read(count);
                    }
                    Err(error) => {
                        self.ended = true;
                        return Some(Block::Spoilt { offset: self.offset, message: error.to_string() });
                    }
                }
                return None;
            }
            Some(Ok(LinearReadEvent::Record { opcode, data })) => (opcode, data),
            // The end of a file that was cut: what is whole has been given out.
            Some(Err(McapError::UnexpectedEof)) => return Some(self.end(false)),
            None => return Some(self.end(self.data_ended)),
            Some(Err(McapError::BytesAfterEndMagic)) => {
                self.ended = true;
                let offset = self.offset + super::MAGIC.len() as u64;
                return Some(Block::Spoilt { offset, message: "bytes after the end of the recording".into() });
            }
            Some(Err(error)) => {
                self.ended = true;
                return Some(Block::Spoilt { offset: self.offset, message: error.to_string() });
            }
        };
        let offset = self.offset;
        let fits = lengths::fit(opcode, content);
        self.offset += RECORD_START + content.len() as u64;
        match opcode {
            _ if !fits => {
                Some(Block::Spoilt { offset, message: "a length in the record is greater than the record".into() })
            }
            op::CHUNK => {
                if self.checking {
                    self.chunks.push(offset);
                }
                Some(match unpack(content, &mut self.unpacker) {
                    Ok(records) => Block::Chunk { offset, records },
                    Err(Unpack::NotSupported(message)) => Block::NotSupported { offset, message },
                    Err(Unpack::Spoilt(message)) => Block::Spoilt { offset, message: format!("chunk: {message}") },
                })
            }
            // Outside a chunk, as other programs may write them.
            op::SCHEMA | op::CHANNEL | op::MESSAGE if !self.data_ended => {
                let mut records = vec![opcode];
                records.extend((content.len() as u64).to_le_bytes());
                records.extend(content);
                Some(Block::Chunk { offset, records })
            }
            op::METADATA => match mcap::parse_record(opcode, content) {
                Ok(Record::Metadata(found)) if found.name == DESCRIPTION => {
                    Some(Block::Description(Description::from_map(&found.metadata)))
                }
                Ok(Record::Metadata(mut found)) if found.name == COUNTS => {
                    found.metadata.remove(COUNTS).map(Block::Counts)
                }
                Ok(_) => None,
                Err(error) => Some(Block::Spoilt { offset, message: error.to_string() }),
            },
            op::CHUNK_INDEX if self.checking => match mcap::parse_record(opcode, content) {
                Ok(Record::ChunkIndex(index)) if self.chunks.binary_search(&index.chunk_start_offset).is_ok() => {
                    self.indexed += 1;
                    None
                }
                _ => Some(Block::Spoilt { offset, message: "the index names a chunk that is not there".into() }),
            },
            op::DATA_END => {
                self.data_ended = true;
                // The summary repeats what is known.
                (!self.checking).then(|| self.end(true))
            }
            _ => None,
        }
    }
}

impl<R: Read> Iterator for Blocks<R> {
    type Item = Block;

    fn next(&mut self) -> Option<Block> {
        while !self.ended {
            if let Some(block) = self.advance() {
                return Some(block);
            }
        }
        None
    }
}

impl<R: Read> std::fmt::Debug for Blocks<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Blocks").field("offset", &self.offset).finish_non_exhaustive()
    }
}

/// Blocks that another thread reads and unpacks ahead of their use.
#[derive(Debug)]
pub struct BlocksAhead(Receiver<Block>);

impl BlocksAhead {
    /// Lets a thread of its own read `blocks`; it ends with them or when this is dropped.
    pub fn of<R: Read + Send + 'static>(blocks: Blocks<R>) -> Self {
        let (sender, receiver) = sync_channel(UNPACKED_AHEAD);
        std::thread::spawn(move || {
            for block in blocks {
                if sender.send(block).is_err() {
                    break; // nobody wants more
                }
            }
        });
        Self(receiver)
    }
}

impl Iterator for BlocksAhead {
    type Item = Block;

    fn next(&mut self) -> Option<Block> {
        self.0.recv().ok()
    }
}

/// Why a chunk cannot be unpacked.
enum Unpack {
    /// It is in a form that is not read.
    NotSupported(String),
    /// It is damaged.
    Spoilt(String),
}

impl From<String> for Unpack {
    fn from(message: String) -> Self {
        Self::Spoilt(message)
    }
}

/// The records in a chunk, after their checksum has been found right.
fn unpack(content: &[u8], unpacker: &mut Option<zstd::bulk::Decompressor<'static>>) -> Result<Vec<u8>, Unpack> {
    let Record::Chunk { header, data } = mcap::parse_record(op::CHUNK, content).map_err(|error| error.to_string())?
    else {
        return Err("expected a chunk".to_string().into());
    };
    let size = header.uncompressed_size as usize;
    if size > LONGEST_RECORD {
        return Err(format!("{size} bytes unpacked, expected at most {LONGEST_RECORD}").into());
    }
    let records = match header.compression.as_str() {
        "" => data.into_owned(),
        "zstd" => {
            let unpacker = match unpacker {
                Some(unpacker) => unpacker,
                None => unpacker.insert(zstd::bulk::Decompressor::new().map_err(|error| error.to_string())?),
            };
            unpacker.decompress(&data, size).map_err(|error| error.to_string())?
        }
        other => {
            let found = printable(other);
            return Err(Unpack::NotSupported(format!("chunk compressed by `{found}`, expected zstd or none")));
        }
    };
    if records.len() != size {
        return Err(format!("{} bytes unpacked, expected {size}", records.len()).into());
    }
    let checksum = crc32fast::hash(&records);
    if header.uncompressed_crc != 0 && header.uncompressed_crc != checksum {
        return Err(format!("checksum {checksum:08x}, expected {:08x}", header.uncompressed_crc).into());
    }
    Ok(records)
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
