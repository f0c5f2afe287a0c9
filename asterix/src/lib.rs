//! ASTERIX, EUROCONTROL's binary format of surveillance data: a decoder and an encoder.
//!
//! A *datagram* or a recording holds *blocks*: a category, a length and records. A *record* begins with its FSPEC, a field
//! of bits that says which *items* of the category's profile follow. What the items of a category are, their sizes and
//! their units, is in tables ([`tables`]) that are made from the machine-readable specifications in the folder `specs`.
//!
//! Two ways lead to the values:
//!
//! - **Everything**: [`value::RecordValues`] is any record of any category as a tree, which can be changed, printed as JSON
//!   and encoded again.
//! - **Fast**: a [`Field`] is an element found by its name when the program is compiled ([`field!`]). [`report`] has what radars send
//!   (categories 001, 002, 010, 034, 048), [`cat062`] and [`cat065`] what trackers send, [`cat240`] video, in SI units, without allocation.
//!
//! ```
//! use asterix::block::Blocks;
//! use asterix::editions::Editions;
//! use asterix::record::Records;
//! use asterix::report::Message;
//! use asterix::value::RecordValues;
//!
//! // A north marker of the radar with SAC 25 and SIC 7, sent at noon.
//! let datagram = [34, 0, 10, 0xe0, 25, 7, 1, 0x54, 0x60, 0x00];
//! let editions = Editions::default();
//! for block in Blocks::new(&datagram) {
//!     let block = block?;
//!     let edition = editions.of(block.category).expect("a known category");
//!     for record in Records::new(edition, block.records, block.offset) {
//!         let record = record?;
//!         let Some(Message::Service(message)) = Message::of(&record) else { panic!("another message") };
//!         assert_eq!(message.time_of_day.map(|time| time.steps), Some(12 * 3600 * 128));
//!         let json = RecordValues::of(&record).to_string();
//!         assert!(json.ends_with(r#""030":{"raw":5529600,"value":43200,"unit":"s"}}"#));
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Writing is the other way round: [`BlockWriter`] takes records field by field, or as values.
//!
//! Bytes that cannot be read are an error that names category, record, item and place ([`DecodeError`]), never a panic.
//! [`recovery`] finds the blocks of a damaged recording again; [`recording`] finds them in captures of a network.

#[macro_use]
pub mod field;

pub mod block;
pub mod cat001;
pub mod cat002;
pub mod cat010;
pub mod cat034;
pub mod cat048;
pub mod cat062;
pub mod cat065;
pub mod cat240;
pub mod clock;
pub mod definition;
pub mod editions;
pub mod error;
mod json;
mod length;
pub mod random;
pub mod record;
pub mod recording;
pub mod recovery;
pub mod report;
pub mod tables;
pub mod value;
pub mod writer;

pub use error::{BlockError, DecodeError, EncodeError, Fault};
pub use field::{Field, FieldError};
pub use writer::{BlockWriter, RecordWriter};
