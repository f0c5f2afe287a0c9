//! Real plots in place of the simulator: ASTERIX recordings, and radars on a network.
//!
//! ```text
//! bytes ──▶ (asterix) ──▶ radar ──▶ rotation ──▶ sectors ──▶ plots
//!                 └────▶ truth, registration ──────────────▶ truth
//! ```
//!
//! [`Source`] turns the recording of a radar, and that of a cooperative sensor where there
//! is one, into the messages that the simulator and the plot extractor would publish.
//! Only what the radar measured reaches the plots: time, range, azimuth, range rate, height, amplitude; no track
//! number, address, velocity or size. Nothing in the bytes can make it fail: what cannot be read is stepped over and
//! counted to the byte, what cannot be used is counted by reason.

pub mod antenna;
pub mod contents;
pub mod continuity;
pub mod error;
pub mod habits;
pub mod hearing;
pub mod level;
mod listening;
pub mod live;
pub mod process;
pub mod radar;
pub mod radar_clock;
pub mod registration;
pub mod repeats;
pub mod rotation;
pub mod scan_lines;
pub mod sectors;
pub mod source;
pub mod table;
pub mod truth;
pub mod turning;
pub mod unlike;

pub use error::SourceError;
pub use source::{Scan, Source};
