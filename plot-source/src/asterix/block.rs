//! Data blocks: `category (1 byte), length (2, big-endian, of the whole block), records`.

use common::health::Reject;

/// Bytes of category and length.
const HEADER: usize = 3;

/// One data block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block<'a> {
    /// Category of its records.
    pub category: u8,
    /// Its records, back to back. The last block of a cut recording holds what is left of them.
    pub records: &'a [u8],
    /// Whether the recording ends inside the block.
    pub cut: bool,
}

/// The blocks of a recording, one after the other.
///
/// Ends after a block that the end of the recording cuts, and after a length below 3:
/// there is no mark in the format by which to find the next block.
#[derive(Debug, Clone)]
pub struct Blocks<'a> {
    rest: &'a [u8],
}

impl<'a> Blocks<'a> {
    /// The blocks of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Result<Block<'a>, Reject>;

    fn next(&mut self) -> Option<Self::Item> {
        let bytes = std::mem::take(&mut self.rest);
        if bytes.is_empty() {
            return None;
        }
        let &[category, high, low, ..] = bytes else {
            return Some(Err(Reject::TruncatedRecord));
        };
        let length = usize::from(u16::from_be_bytes([high, low]));
        if length < HEADER {
            return Some(Err(Reject::BadHeader));
        }
        if let Some((block, rest)) = bytes.split_at_checked(length) {
            self.rest = rest;
            Some(Ok(Block { category, records: &block[HEADER..], cut: false }))
        } else {
            Some(Ok(Block { category, records: &bytes[HEADER..], cut: true }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_follow_each_other_by_length() {
        let bytes = [10, 0, 4, 0xaa, 48, 0, 3, 10, 0, 9, 1, 2];
        let blocks: Vec<_> = Blocks::new(&bytes).collect();
        assert_eq!(
            blocks,
            [
                Ok(Block { category: 10, records: &[0xaa], cut: false }),
                Ok(Block { category: 48, records: &[], cut: false }),
                Ok(Block { category: 10, records: &[1, 2], cut: true }),
            ]
        );
    }

    #[test]
    fn an_impossible_length_ends_the_recording() {
        let blocks: Vec<_> = Blocks::new(&[10, 0, 2, 10, 0, 4, 0]).collect();
        assert_eq!(blocks, [Err(Reject::BadHeader)]);
        let blocks: Vec<_> = Blocks::new(&[10, 0]).collect();
        assert_eq!(blocks, [Err(Reject::TruncatedRecord)]);
    }
}
