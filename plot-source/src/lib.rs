//! Real plots in place of the simulator: ASTERIX recordings.
//!
//! ```text
//! bytes ──▶ asterix ──▶ radar ──▶ rotation ──▶ sectors ──▶ plots
//!               └────▶ truth, registration ──────────────▶ truth
//! ```
//!
//! [`Source`] turns the recording of a radar, and that of a cooperative sensor where there
//! is one, into the messages that the simulator and the plot extractor would publish.
//! Only time, range and azimuth of a report reach the plots: no track number, address,
//! velocity or size. Nothing in the bytes can make it fail: what cannot be read is stepped over and
//! counted to the byte, what cannot be used is counted by reason.

pub mod asterix;
pub mod clock;
pub mod contents;
pub mod continuity;
pub mod error;
pub mod process;
pub mod radar;
pub mod registration;
pub mod rotation;
pub mod sectors;
pub mod source;
pub mod truth;

pub use error::SourceError;
pub use source::{Scan, Source};
