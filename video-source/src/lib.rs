//! Real radar video in, dwells out: one azimuth, one elevation, one Doppler cell, as many range cells as the radar sends.
//!
//! ```text
//! file ─────▶ recording ┐
//!                       ├─▶ intake ─▶ cat240 | halo (spokes) ─▶ turning (position in the scan) ─▶ schedule (dwells)
//! network ──▶ live ─────┘
//! ```
//!
//! **Amplitudes** (C14). A code c of the video stands for the amplitude c + ½, the middle of its step, or, in codes of 1, 2 or 4 bits, for one
//! drawn from its step: amplitudes are in steps of the radar's converter, and a cell of code 0 is not without power. So what is 0 in
//! the video, be it weak or cut off by the radar, is noise of half a step and not the absence of noise, of which no threshold could be made. Nothing is assumed of how the radar has made its
//! codes: where they are logarithmic or have a threshold of their own, noise is not exponential and the probability of false alarm
//! not the set one. The largest code is the receiver's full scale.
//!
//! **Time.** That of the packets where the file is a capture, or the time of day of the records (I240/140); else the turn of
//! `radar.scan_period_s` goes round evenly from `run.epoch_s`. From the network it is the time of receipt.

pub mod cat240;
pub mod cells;
pub mod error;
pub mod halo;
mod intake;
mod listening;
pub mod live;
pub mod process;
pub mod recording;
mod schedule;
pub mod spoke;
pub mod turning;

pub use error::VideoError;
pub use live::LiveVideo;
pub use recording::VideoRecording;
pub use spoke::Spoke;
