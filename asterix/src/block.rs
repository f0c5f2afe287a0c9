//! Data blocks: `category (1 octet), length (2, big-endian, of the whole block), records`.

use crate::error::BlockError;

/// Octets of category and length.
pub const HEADER: usize = 3;

/// A block of records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block<'a> {
    /// Category of its records.
    pub category: u8,
    /// Its records, back to back.
    pub records: &'a [u8],
    /// Where the records begin, bytes from the start of what is read.
    pub offset: usize,
}

/// The blocks of a datagram, one after the other; ends after the first that cannot be read.
#[derive(Debug, Clone)]
pub struct Blocks<'a> {
    bytes: &'a [u8],
    at: usize,
    failed: bool,
}

impl<'a> Blocks<'a> {
    /// The blocks in the payload of a datagram.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, failed: false }
    }

    /// Octets from the next block on, or from the one that cannot be read.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }
}

/// Category and length that a header at the start of `bytes` says.
pub(crate) fn header(bytes: &[u8]) -> Option<(u8, usize)> {
    let &[category, high, low] = bytes.first_chunk()?;
    Some((category, usize::from(u16::from_be_bytes([high, low]))))
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Result<Block<'a>, BlockError>;

    fn next(&mut self) -> Option<Self::Item> {
        let (offset, rest) = (self.at, &self.bytes[self.at..]);
        if rest.is_empty() || self.failed {
            return None;
        }
        let block = block(rest, offset);
        match block {
            Ok(block) => self.at += HEADER + block.records.len(),
            Err(_) => self.failed = true,
        }
        Some(block)
    }
}

/// The block at the start of `bytes`.
fn block(bytes: &[u8], offset: usize) -> Result<Block<'_>, BlockError> {
    let left = bytes.len();
    let (category, length) = header(bytes).ok_or(BlockError::NoHeader { offset, left })?;
    let records = bytes.get(HEADER..length).ok_or(BlockError::Length { category, offset, length, left })?;
    Ok(Block { category, records, offset: offset + HEADER })
}
