//! Records: which items there are, and where.

use crate::definition::{Edition, Item, Profile, Slot};
use crate::error::{DecodeError, Fault};
use crate::length::{flagged, octets};

/// Positions of the longest FSPEC that is read, nine octets of seven.
const POSITIONS: usize = 63;

/// A record whose items have been found; nothing is copied.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// Its edition.
    pub edition: &'static Edition,
    /// Its profile.
    pub profile: &'static Profile,
    /// Its octets, from the FSPEC on.
    pub bytes: &'a [u8],
    /// Where it begins, bytes from the start of what is read.
    pub offset: usize,
    /// The FSPEC: the highest bit is the first position.
    present: u64,
    starts: [u16; POSITIONS],
}

/// An item of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found<'a> {
    /// Its position in the profile, from 0.
    pub position: usize,
    /// Its definition; none for random field sequencing.
    pub item: Option<&'static Item>,
    /// Its octets.
    pub bytes: &'a [u8],
    /// Where they begin in the record.
    pub offset: usize,
}

impl<'a> Record<'a> {
    /// The record at the start of `bytes`, which are those of a block from here on; or item, place and fault.
    fn scan(edition: &'static Edition, bytes: &'a [u8], offset: usize) -> Result<Self, (&'static str, usize, Fault)> {
        let mut at = flagged(bytes).map_err(|fault| ("FSPEC", 0, fault))?;
        let mut present = 0_u64;
        for (index, octet) in bytes[..at].iter().enumerate() {
            let named = u64::from(octet >> 1);
            if index < POSITIONS / 7 {
                present |= named << (57 - 7 * index);
            } else if named != 0 {
                let position = index * 7 + named.leading_zeros() as usize - 56;
                return Err(("FSPEC", 0, Fault::UndefinedPosition(position)));
            }
        }
        let mut profile = edition.profiles.first().ok_or(("FSPEC", 0, Fault::UndefinedPosition(1)))?;
        let mut starts = [0; POSITIONS];
        let mut left = present;
        while left != 0 {
            let position = left.leading_zeros() as usize;
            left &= !(1 << 63 >> position);
            starts[position] = at as u16;
            let rest = &bytes[at..];
            let (name, length) = match profile.slots.get(position) {
                Some(Slot::Item(item)) => {
                    let length = octets(&item.shape, rest);
                    if let (Some(choice), Ok(_)) = (&edition.choice, &length)
                        && choice.item == item.name
                    {
                        let value = bits(rest, choice.bit, choice.bits).unwrap_or(0);
                        let chosen = choice.profiles.iter().find(|(of, _)| *of == value);
                        profile = chosen.map_or(profile, |&(_, index)| &edition.profiles[index]);
                    }
                    (item.name, length)
                }
                Some(Slot::Sequence) => ("RFS", sequence(profile, rest)),
                _ => ("?", Err(Fault::UndefinedPosition(position + 1))),
            };
            at += length.map_err(|fault| (name, at, fault))?;
        }
        Ok(Self { edition, profile, bytes: &bytes[..at], offset, present, starts })
    }

    /// The octets of the item at a position of the profile, from 0, if the record has it.
    #[inline]
    pub fn octets(&self, position: usize) -> Option<&'a [u8]> {
        let start = usize::from(*self.starts.get(position)?);
        let rest = self.present << position;
        if rest >> 63 == 0 {
            return None;
        }
        let after = rest << 1;
        match after {
            0 => self.bytes.get(start..),
            _ => self.bytes.get(start..usize::from(self.starts[position + 1 + after.leading_zeros() as usize])),
        }
    }

    /// Its items, in order.
    pub fn items(&self) -> impl Iterator<Item = Found<'a>> + '_ {
        (0..POSITIONS).filter_map(|position| {
            let bytes = self.octets(position)?;
            let item = match self.profile.slots.get(position)? {
                Slot::Item(item) => Some(*item),
                _ => None,
            };
            Some(Found { position, item, bytes, offset: usize::from(self.starts[position]) })
        })
    }

    /// The item of a name, if the record has it.
    pub fn item(&self, name: &str) -> Option<Found<'a>> {
        self.items().find(|found| found.item.is_some_and(|item| item.name == name))
    }
}

/// Octets of random field sequencing: a count, and that many pairs of a position and its item.
fn sequence(profile: &Profile, bytes: &[u8]) -> Result<usize, Fault> {
    let truncated = Fault::Truncated { needed: bytes.len() + 1, left: bytes.len() };
    let mut at = 1;
    for _ in 0..*bytes.first().ok_or(truncated)? {
        let position = usize::from(*bytes.get(at).ok_or(truncated)?);
        let Some(Slot::Item(item)) = profile.slots.get(position.wrapping_sub(1)) else {
            return Err(Fault::UndefinedPosition(position));
        };
        at += 1;
        at += octets(&item.shape, &bytes[at..])?;
    }
    Ok(at)
}

/// The value of up to 64 bits, from the highest bit of the first octet on.
#[inline]
pub(crate) fn bits(bytes: &[u8], first: u16, count: u16) -> Option<u64> {
    let (from, to) = (usize::from(first) / 8, usize::from(first + count).div_ceil(8));
    let value = bytes.get(from..to)?.iter().fold(0_u128, |value, &octet| value << 8 | u128::from(octet));
    let below = to * 8 - usize::from(first + count);
    Some((value >> below) as u64 & (u64::MAX >> (64 - count)))
}

/// The records of a block, one after the other; ends after the first that cannot be read.
#[derive(Debug, Clone)]
pub struct Records<'a> {
    edition: &'static Edition,
    bytes: &'a [u8],
    at: usize,
    offset: usize,
    read: usize,
    failed: bool,
}

impl<'a> Records<'a> {
    /// The records in `bytes`, at most 65,532 of them, which begin `offset` bytes after the start of what is read.
    pub fn new(edition: &'static Edition, bytes: &'a [u8], offset: usize) -> Self {
        let bytes = &bytes[..bytes.len().min(usize::from(u16::MAX))];
        Self { edition, bytes, at: 0, offset, read: 0, failed: false }
    }

    /// Octets from the next record on, or from the one that cannot be read.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Result<Record<'a>, DecodeError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.failed || self.at == self.bytes.len() {
            return None;
        }
        self.read += 1;
        let begin = self.offset + self.at;
        match Record::scan(self.edition, &self.bytes[self.at..], begin) {
            Ok(record) => {
                self.at += record.bytes.len();
                Some(Ok(record))
            }
            Err((item, at, fault)) => {
                self.failed = true;
                let (category, record, offset) = (self.edition.category, self.read, begin + at);
                Some(Err(DecodeError { category, record, item, offset, fault }))
            }
        }
    }
}
