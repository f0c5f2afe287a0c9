//! ASTERIX: EUROCONTROL's binary format of surveillance data.
//!
//! A recording is a sequence of blocks (category, length, records); a record begins with
//! its FSPEC, a bit field that says which items of the category's profile follow.

pub mod block;
pub mod cat010;

use block::{Block, Blocks};
use cat010::{Record, Records};
use common::health::Reject;

/// All category 010 records of a recording in file order, with one reason for each piece that cannot be read.
pub fn records(bytes: &[u8]) -> impl Iterator<Item = Result<Record, Reject>> {
    Blocks::new(bytes).flat_map(|block| {
        let (records, cut, refused) = match block {
            Ok(Block { category: cat010::CATEGORY, records, cut }) => (records, cut, None),
            Ok(_) => (&[][..], false, Some(Reject::OtherCategory)),
            Err(reason) => (&[][..], false, Some(reason)),
        };
        // A cut block is one loss, wherever in its records the cut lies.
        let whole = Records::new(records).filter(move |record| record.is_ok() || !cut);
        whole.chain(refused.or(cut.then_some(Reject::TruncatedRecord)).map(Err))
    })
}
