//! What a recording holds, to the byte.

use std::collections::BTreeMap;
use std::net::SocketAddr;

use asterix::editions::{EditionError, Editions};
use asterix::recording::Received;
use asterix::recovery::{Cause, Unused};
use asterix::report::{Message, SourceId};
use asterix::{Fault, cat001, cat002, cat010, cat034, cat048};
use common::config::PlotSourceConfig;
use common::health::{Reject, Rejected};

/// Categories that are read.
const CATEGORIES: [u8; 5] = [cat001::CATEGORY, cat002::CATEGORY, cat010::CATEGORY, cat034::CATEGORY, cat048::CATEGORY];

/// The newest editions of what is read, but for those that are configured.
///
/// # Errors
/// [`EditionError`].
pub fn editions(config: &PlotSourceConfig) -> Result<Editions, EditionError> {
    Ok(Editions::default().with_named(config.editions.iter().map(String::as_str))?.only(&CATEGORIES))
}

/// The categories that are read, in words.
fn categories_read() -> String {
    in_words(CATEGORIES)
}

/// Categories that are named one by one.
const MOST_NAMED: usize = 8;

/// Records of other sensors are strays where they are fewer than one in so many.
const STRAY_SHARE: u64 = 20;

/// Counts of all that a recording holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Contents {
    /// Records that could be read.
    pub records: u64,
    /// Records of a capture that stand in it again: of a second line.
    pub repeated: u64,
    /// Records that could be read, by sensor.
    pub sources: BTreeMap<SourceId, u64>,
    /// Blocks of other categories.
    pub categories: BTreeMap<u8, u64>,
    /// Datagrams of a capture that are not ASTERIX, by destination.
    pub foreign: BTreeMap<SocketAddr, u64>,
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
    pub fn take(&mut self, received: Result<Received<'_>, Unused>, rejected: &mut Rejected) -> Result<Message, Reject> {
        match received {
            Ok(received) => {
                let message = Message::of(&received.record).ok_or(Reject::OtherCategory)?;
                self.records += 1;
                if let Some(source) = message.source() {
                    *self.sources.entry(source).or_default() += 1;
                }
                Ok(message)
            }
            Err(Unused::Category { category, .. }) => {
                *self.categories.entry(category).or_default() += 1;
                Err(Reject::OtherCategory)
            }
            Err(Unused::Unread { place, cause }) => {
                self.unread_bytes += place.len() as u64;
                self.unread_places += 1;
                self.first_unread.get_or_insert(place.start);
                rejected.count_many(Reject::UnreadByte, place.len() as u64);
                Err(reason(&cause))
            }
        }
    }

    /// The categories in words, and which are read: for a file without any record.
    pub fn categories_found(&self) -> Option<String> {
        let found = match self.categories.len() {
            0 => return None,
            1 => "category",
            _ => "categories",
        };
        let categories = in_words(self.categories.keys().copied());
        Some(format!("{found} {categories} found, {} supported", categories_read()))
    }

    /// The sensors in words, with their records.
    pub fn sources_found(&self) -> String {
        let names: Vec<String> = self.sources.iter().map(|(id, count)| format!("{id} ({count} records)")).collect();
        names.join(", ")
    }

    /// The one of several sensors beside which the others have so few records that they may be of damaged bytes.
    pub fn dominating(&self, own: &[SourceId]) -> Option<SourceId> {
        let records = |source: &SourceId| self.sources.get(source).copied().unwrap_or(0);
        let all: u64 = own.iter().map(records).sum();
        own.iter().copied().find(|source| (all - records(source)) * STRAY_SHARE < all)
    }

    /// What the user should know of the file, one line each.
    pub fn notes(&self) -> Vec<String> {
        let blocks = self.categories.iter();
        let mut notes: Vec<String> = if self.categories.len() <= MOST_NAMED {
            blocks.map(|(category, blocks)| format!("category {category:03}: {blocks} blocks not read")).collect()
        } else {
            let (categories, blocks) = (self.categories.len(), self.categories.values().sum::<u64>());
            vec![format!("{categories} other categories: {blocks} blocks not read; most of it may be no ASTERIX")]
        };
        let foreign = self.foreign.iter();
        notes.extend(foreign.map(|(to, datagrams)| format!("{datagrams} datagrams to {to} are not ASTERIX")));
        if self.repeated > 0 {
            notes.push(format!("{} records captured before, not used again", self.repeated));
        }
        if let Some(first) = self.first_unread {
            let (bytes, places) = (self.unread_bytes, self.unread_places);
            let place = if places == 1 { "at".to_string() } else { format!("in {places} places, the first at") };
            notes.push(format!("{bytes} bytes could not be read, {place} byte {first}"));
        }
        notes
    }
}

/// Why bytes could not be read, as it is counted.
pub(crate) fn reason(cause: &Cause) -> Reject {
    match cause {
        Cause::NoBlock | Cause::Capture(_) => Reject::BadHeader,
        Cause::Cut => Reject::TruncatedRecord,
        Cause::Record(error) => match error.fault {
            Fault::Truncated { .. } => Reject::TruncatedRecord,
            Fault::UndefinedPosition(_) | Fault::UndefinedPart(_) => Reject::UnknownItem,
            Fault::LengthZero => Reject::BadHeader,
        },
    }
}

/// `001, 010 and 048`.
fn in_words(categories: impl IntoIterator<Item = u8>) -> String {
    let names: Vec<String> = categories.into_iter().map(|category| format!("{category:03}")).collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}
