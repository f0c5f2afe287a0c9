//! Blocks found again after damaged bytes.
//!
//! There is no mark in the format by which to find a block: one begins where the one before ends. A lost, added or
//! damaged byte therefore takes the place of all that follows. A block is *sound* when its category is known, every record
//! of it can be read to its last byte and names its sensor, which other bytes hardly ever are. A block is believed when it
//! is sound and a sound one, or the end, follows, if need be behind blocks of categories that are not known; or when no
//! sound block begins inside it: a byte lost in a block may leave it readable, with its neighbour's first byte as its last.
//! Where none is believed, reading goes on at the next sound one; the bytes before it are those that were not read.
//!
//! All this is bounded, so that bytes made to look like blocks in blocks cost no more time than others do: for every byte that
//! is passed or looked at, a few records may be read to find out what is sound, and a block that needs more is not.

use std::ops::Range;

use crate::block::{HEADER, header};
use crate::editions::Editions;
use crate::error::DecodeError;
use crate::record::{Record, Records};

/// Bytes that gave no record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unused {
    /// A block of a category that is not known.
    Category {
        /// Which.
        category: u8,
        /// Its size, bytes.
        bytes: usize,
    },
    /// Bytes that could not be read.
    Unread {
        /// Where they lie.
        place: Range<usize>,
        /// Why.
        cause: Cause,
    },
}

/// Why bytes could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// No block begins with them.
    #[error("no block of a known category")]
    NoBlock,
    /// The recording, or the datagram, ends inside the block.
    #[error("cut off")]
    Cut,
    /// A record that cannot be read, and what follows it in its block.
    #[error(transparent)]
    Record(DecodeError),
    /// Part of a capture that holds no packet.
    #[error("{0}")]
    Capture(&'static str),
}

/// All records of blocks back to back, and between them what was not used: of every byte it is known which it is.
/// `bytes` begin `offset` bytes after the start of what is read.
pub fn records<'a>(
    editions: &'a Editions,
    bytes: &'a [u8],
    offset: usize,
) -> impl Iterator<Item = Result<Record<'a>, Unused>> + 'a {
    Pieces::new(editions, bytes).flat_map(move |piece| match piece {
        Piece::Block { category, records, cut } => match editions.of(category) {
            Some(edition) => {
                let place = offset + records.start..offset + records.end;
                records_of(Records::new(edition, &bytes[records], place.start), place, cut)
            }
            None => vec![Err(Unused::Category { category, bytes: HEADER + records.len() })],
        },
        Piece::Lost(lost) => {
            let place = offset + lost.start..offset + lost.end;
            vec![Err(Unused::Unread { place, cause: Cause::NoBlock })]
        }
    })
}

/// The records of one block, up to the first that cannot be read: the next one cannot be found.
fn records_of(mut records: Records<'_>, place: Range<usize>, cut: bool) -> Vec<Result<Record<'_>, Unused>> {
    let mut taken = Vec::new();
    let mut unread = place.clone();
    let mut cause = None;
    while let Some(record) = records.next() {
        match record {
            Ok(record) => taken.push(Ok(record)),
            Err(error) => cause = Some(Cause::Record(error)),
        }
        unread.start = place.end - records.left();
    }
    if cut {
        // One loss, wherever in its records the cut lies; without one of them the header was of no use either.
        cause = Some(Cause::Cut);
        unread.start -= if taken.is_empty() { HEADER.min(unread.start) } else { 0 };
    }
    taken.extend(cause.map(|cause| Err(Unused::Unread { place: unread, cause })));
    taken
}

/// A part of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// A block: its category, and where its records lie. The last block of a cut recording holds what is left of them.
    Block {
        /// Category of its records.
        category: u8,
        /// Its records, back to back.
        records: Range<usize>,
        /// Whether the recording ends inside the block.
        cut: bool,
    },
    /// Bytes that are no block.
    Lost(Range<usize>),
}

/// Records that may be read to find sound blocks, for every byte that is passed or looked at and from the beginning.
const RECORDS_A_BYTE: usize = 8;
const RECORDS_AT_FIRST: usize = 1 << 16;
/// Blocks of unknown categories that may stand between two sound ones.
const MOST_UNKNOWN: usize = 64;

/// The parts of a recording, one after the other: together every byte of it.
#[derive(Debug, Clone)]
pub struct Pieces<'a> {
    editions: &'a Editions,
    bytes: &'a [u8],
    at: usize,
    /// Records that the search may still read.
    allowance: usize,
}

impl<'a> Pieces<'a> {
    /// The parts of `bytes`, blocks back to back.
    pub fn new(editions: &'a Editions, bytes: &'a [u8]) -> Self {
        Self { editions, bytes, at: 0, allowance: RECORDS_AT_FIRST }
    }

    /// Category and end of the block at a place, if its header is possible and the recording does not end inside it.
    fn whole(&self, at: usize) -> Option<(u8, usize)> {
        let (category, length) = header(self.bytes.get(at..)?)?;
        (category > 0 && length >= HEADER && at + length <= self.bytes.len()).then_some((category, at + length))
    }

    /// The end of the sound block at a place.
    fn sound(&mut self, at: usize) -> Option<usize> {
        let mut allowance = self.allowance;
        let end = self.sound_within(at, &mut allowance);
        self.allowance = allowance;
        end
    }

    /// The same, if no more than `allowance` records tell; those that were read are taken off.
    fn sound_within(&self, at: usize, allowance: &mut usize) -> Option<usize> {
        let (category, end) = self.whole(at)?;
        let mut records = Records::new(self.editions.of(category)?, &self.bytes[at + HEADER..end], 0).peekable();
        records.peek()?;
        for record in records {
            *allowance = allowance.checked_sub(1)?;
            record.ok()?.item("010")?;
        }
        Some(end)
    }

    /// Whether reading can go on at a place.
    fn leads_on(&mut self, mut at: usize) -> bool {
        for _ in 0..MOST_UNKNOWN {
            if at == self.bytes.len() || self.sound(at).is_some() {
                return true;
            }
            match self.whole(at) {
                Some((category, end)) if self.editions.of(category).is_none() => at = end,
                _ => return false,
            }
        }
        false
    }

    /// The next sound block in a range.
    fn next_sound(&mut self, mut range: Range<usize>) -> Option<usize> {
        let mut allowance = self.allowance;
        let found = range.find(|&at| {
            allowance = allowance.saturating_add(RECORDS_A_BYTE);
            self.sound_within(at, &mut allowance).is_some()
        });
        self.allowance = allowance.min(RECORDS_AT_FIRST);
        found
    }

    fn go_on(&mut self, at: usize) {
        self.allowance = (self.allowance + RECORDS_A_BYTE * (at - self.at)).min(RECORDS_AT_FIRST);
        self.at = at;
    }

    fn block(&mut self, category: u8, end: usize, cut: bool) -> Piece {
        let records = (self.at + HEADER).min(end)..end;
        self.go_on(end);
        Piece::Block { category, records, cut }
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        let (at, length) = (self.at, self.bytes.len());
        if at == length {
            return None;
        }
        if let Some((category, end)) = self.whole(at) {
            let is_believed = self.sound(at).is_some() && self.leads_on(end);
            if is_believed || self.next_sound(at + 1..end).is_none() {
                return Some(self.block(category, end, false));
            }
        }
        let next = self.next_sound(at + 1..length);
        // The end of the recording lies in a block of a category that is known: what there is of it is used.
        let category = self.bytes[at];
        if next.is_none() && self.editions.of(category).is_some() {
            return Some(self.block(category, length, true));
        }
        self.go_on(next.unwrap_or(length));
        Some(Piece::Lost(at..self.at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A start-of-cycle message, alone in its block.
    const NORTH: [u8; 10] = [10, 0, 10, 0xd0, 0x00, 0x07, 0x02, 0x38, 0x41, 0x43];

    fn block(category: u8, at: usize, length: usize) -> Piece {
        Piece::Block { category, records: at + HEADER..at + length, cut: false }
    }

    fn pieces(bytes: &[u8]) -> Vec<Piece> {
        Pieces::new(&Editions::default(), bytes).collect()
    }

    #[test]
    fn blocks_follow_each_other_by_length() {
        let bytes = [&NORTH[..], &[21, 0, 5, 0x80, 0xaa], &NORTH].concat();
        assert_eq!(pieces(&bytes), [block(10, 0, 10), block(21, 10, 5), block(10, 15, 10)]);
    }

    /// Blocks that begin in blocks, each with thousands of records and all unsound at their ends: every byte is looked at, few
    /// times.
    #[test]
    fn the_search_is_bounded() {
        let mut bytes = vec![48, 0x7f, 0xff];
        bytes.extend([0xc0, 0x19, 0x07, 48, 0x7f, 0xff].repeat(11_000));
        bytes.truncate(65_505);
        let editions = Editions::default();
        let mut pieces = Pieces::new(&editions, &bytes);
        assert_eq!(pieces.next_sound(1..bytes.len()), None);
        // All that the allowance is for was spent, which is 60 times less than all there is to read.
        let mut allowance = RECORDS_AT_FIRST + RECORDS_A_BYTE * bytes.len();
        let spent = (1..bytes.len()).filter(|&at| pieces.sound_within(at, &mut allowance).is_some()).count();
        assert_eq!((spent, allowance), (0, 0));
        let end = [&bytes[..], &NORTH, &NORTH].concat();
        assert!(self::pieces(&end).ends_with(&[block(10, bytes.len() + 10, 10)]), "what follows is found");
    }

    #[test]
    fn padding_and_foreign_bytes_are_stepped_over() {
        for padding in [&[0_u8; 6][..], &[0xff; 5], &[10, 0, 0], &[10, 0, 2, 10, 0, 4]] {
            let bytes = [&NORTH, padding, &NORTH, &NORTH].concat();
            let second = NORTH.len() + padding.len();
            let lost = Piece::Lost(NORTH.len()..second);
            assert_eq!(pieces(&bytes), [block(10, 0, 10), lost, block(10, second, 10), block(10, second + 10, 10)]);
        }
    }

    /// Whichever byte is lost, changed or put in: every other block is read, and every byte is in one piece.
    #[test]
    fn one_bad_byte_costs_one_block() {
        let good = NORTH.repeat(6);
        for place in 0..good.len() {
            let mut lost = good.clone();
            lost.remove(place);
            let mut added = good.clone();
            added.insert(place, 0x5a);
            let mut changed = good.clone();
            changed[place] ^= 0xff;
            for bytes in [lost, added, changed] {
                let pieces = pieces(&bytes);
                let whole = |piece: &Piece| match piece {
                    Piece::Block { records, cut: false, .. } => bytes[records.clone()] == NORTH[HEADER..],
                    _ => false,
                };
                assert!(pieces.iter().filter(|piece| whole(piece)).count() >= 5, "{place}: {pieces:?}");
                let mut end = 0;
                for piece in pieces {
                    let (from, to) = match piece {
                        Piece::Block { records, .. } => (records.start - HEADER, records.end),
                        Piece::Lost(range) => (range.start, range.end),
                    };
                    assert_eq!(from, end);
                    end = to;
                }
                assert_eq!(end, bytes.len());
            }
        }
    }

    #[test]
    fn a_cut_block_holds_what_is_left_of_it() {
        let bytes = [&NORTH[..], &NORTH[..7]].concat();
        assert_eq!(pieces(&bytes)[1], Piece::Block { category: 10, records: 13..17, cut: true });
        assert_eq!(pieces(&[10, 0]), [Piece::Block { category: 10, records: 2..2, cut: true }]);
    }
}
