//! What a recording holds, to the byte.

use std::collections::BTreeMap;
use std::fmt;

use common::health::{Reject, Rejected};

use crate::asterix::Unused;
use crate::asterix::cat010::{self, Record};

/// SAC and SIC of a sensor (I010/010).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceId(pub u16);

impl fmt::Display for SourceId {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [sac, sic] = self.0.to_be_bytes();
        write!(out, "SAC {sac} SIC {sic}")
    }
}

/// Counts of all that a recording holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Contents {
    /// Records that could be read.
    pub records: u64,
    /// Records that could be read, by sensor.
    pub sources: BTreeMap<SourceId, u64>,
    /// Blocks of other categories.
    pub categories: BTreeMap<u8, u64>,
    /// Bytes that could not be read.
    pub unread_bytes: u64,
    /// How many pieces they were in.
    pub unread_places: u64,
    /// Where the first of them is.
    pub first_unread: Option<usize>,
}

impl Contents {
    /// Counts a record, or why there is none.
    ///
    /// # Errors
    /// The reason.
    pub fn take(&mut self, record: Result<Record, Unused>, rejected: &mut Rejected) -> Result<Record, Reject> {
        match &record {
            Ok(record) => {
                self.records += 1;
                if let Some(source) = record.source_id {
                    *self.sources.entry(SourceId(source)).or_default() += 1;
                }
            }
            Err(Unused::Category { category, .. }) => *self.categories.entry(*category).or_default() += 1,
            Err(Unused::Unread { place, .. }) => {
                self.unread_bytes += place.len() as u64;
                self.unread_places += 1;
                self.first_unread.get_or_insert(place.start);
                rejected.count_many(Reject::UnreadByte, place.len() as u64);
            }
        }
        record.map_err(|unused| unused.reason())
    }

    /// The categories in words, and which is read: for a file without any record.
    pub fn categories_found(&self) -> Option<String> {
        let names: Vec<String> = self.categories.keys().map(|category| format!("{category:03}")).collect();
        let (last, others) = names.split_last()?;
        let found = if others.is_empty() {
            format!("category {last}")
        } else {
            format!("categories {} and {last}", others.join(", "))
        };
        Some(format!("{found} found, {:03} supported", cat010::CATEGORY))
    }

    /// The sensors in words, with their records.
    pub fn sources_found(&self) -> String {
        let names: Vec<String> = self.sources.iter().map(|(id, count)| format!("{id} ({count} records)")).collect();
        names.join(", ")
    }

    /// What the user should know of the file, one line each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self
            .categories
            .iter()
            .map(|(category, blocks)| format!("category {category:03}: {blocks} blocks not read"))
            .collect();
        if let Some(first) = self.first_unread {
            let (bytes, places) = (self.unread_bytes, self.unread_places);
            let place = if places == 1 { "at".to_string() } else { format!("in {places} places, the first at") };
            notes.push(format!("{bytes} bytes could not be read, {place} byte {first}"));
        }
        notes
    }
}
