//! Tracks and plots of a running chain into other systems.
//!
//! ```text
//!             ┌ asterix_tracks  062, 065      ┐            ┌ datagrams  UDP, also to a group
//! tracks ──▶ targets ┼ cot  nmea  json        ├─▶ frames ─▶┼ peer       TCP, connected again when it breaks
//!             └ sapient                       │            └ listeners  TCP, whoever connects
//! plots  ──▶   asterix_plots  048, 034        ┘
//! ```
//!
//! [`origins`] remembers what else is known of a track: its plots, the tracks that it was made of, its label.
//!
//! A [`format::Format`] makes frames of messages, a [`lines::Line`] carries them. The process is an observer: the chain never
//! waits for it, it never waits for a peer, and what a peer does not take is counted.

pub mod asterix_plots;
pub mod asterix_tracks;
pub mod cot;
pub mod format;
pub mod json;
pub mod lines;
pub mod nmea;
pub mod origins;
pub mod output;
pub mod process;
pub mod sapient;
pub mod targets;
