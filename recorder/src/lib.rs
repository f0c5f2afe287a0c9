//! Records every service with losses accounted for; latency histograms, scores and the report.
//!
//! ```text
//! services ──▶ fold ──▶ report.json        fold: losses, latencies, processes, scoring
//!     └──────▶ recording ─▶ MCAP files ──▶ info, verify, export, diff, score, replay
//! ```
//!
//! Everything is a fold over messages that keeps sums and a few seconds of context, never
//! a run: live, over a recording, and over both when a recorder was restarted.

mod books;
pub mod command_line;
pub mod commands;
pub mod diff;
mod discard;
pub mod export;
pub mod fold;
pub mod info;
mod latencies;
mod losses;
pub mod process;
mod processes;
pub mod recording;
pub mod replay;
pub mod replay_process;
mod report_place;
mod retention;
mod schedule;
pub mod scoring;
pub mod verify;
pub mod window;

pub use discard::discard_empty;
pub use fold::Fold;
