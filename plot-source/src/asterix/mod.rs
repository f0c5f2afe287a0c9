//! ASTERIX: EUROCONTROL's binary format of surveillance data.
//!
//! A recording is a sequence of blocks (category, length, records); a record begins with
//! its FSPEC, a bit field that says which items of the category's profile follow.

pub mod block;
pub mod cat010;
pub mod unlike;

use std::ops::Range;

use block::{HEADER, Piece, Pieces};
use cat010::{Record, Records};
use common::health::Reject;

/// A part of a recording that gave no record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unused {
    /// A block of a category that is not read.
    Category {
        /// Which.
        category: u8,
        /// Its size, bytes.
        bytes: usize,
    },
    /// Bytes that could not be read, and why.
    Unread {
        /// Where they lie in the recording.
        place: Range<usize>,
        /// Why.
        reason: Reject,
    },
}

impl Unused {
    /// Why it was not used.
    pub fn reason(&self) -> Reject {
        match self {
            Self::Category { .. } => Reject::OtherCategory,
            Self::Unread { reason, .. } => *reason,
        }
    }
}

/// All category 010 records of a recording in file order, and between them what was not used: of every byte it is known
/// which it is.
pub fn records(bytes: &[u8]) -> impl Iterator<Item = Result<Record, Unused>> {
    Pieces::new(bytes).flat_map(move |piece| match piece {
        Piece::Block { category: cat010::CATEGORY, records, cut } => records_of(bytes, records, cut),
        Piece::Block { category, records, .. } => {
            vec![Err(Unused::Category { category, bytes: HEADER + records.len() })]
        }
        Piece::Lost(place) => vec![Err(Unused::Unread { place, reason: Reject::BadHeader })],
    })
}

/// The records of one block, up to the first that cannot be read: the next one cannot be found.
fn records_of(bytes: &[u8], place: Range<usize>, cut: bool) -> Vec<Result<Record, Unused>> {
    let mut taken = Vec::new();
    let mut unread = place.clone();
    let mut reason = None;
    let mut records = Records::new(&bytes[place.clone()]);
    while let Some(record) = records.next() {
        match record {
            Ok(record) => taken.push(Ok(record)),
            Err(cause) => reason = Some(cause),
        }
        unread.start = place.end - records.left();
    }
    if cut {
        // One loss, wherever in its records the cut lies; without one of them the header was of no use either.
        reason = Some(Reject::TruncatedRecord);
        unread.start -= if taken.is_empty() { HEADER.min(unread.start) } else { 0 };
    }
    taken.extend(reason.map(|reason| Err(Unused::Unread { place: unread, reason })));
    taken
}
