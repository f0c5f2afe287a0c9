//! A simulated scanning 3-D radar: flies targets, turns a stacked beam and gives the
//! amplitude of every resolution cell of every dwell.
//!
//! ```text
//! motion ─▶ scene (targets as the beam passes) ─▶ echoes + clutter ─┐
//!                                                  receiver noise ──┴▶ |s + n| per cell
//! ```
//!
//! Physics and symbols: (C1), (C2) of `docs/theory/cells-and-plots.md`. The library knows no
//! clock and no shared memory; [`process`] is the shell around it.

pub mod clutter;
pub mod dwell;
pub mod echo;
mod error;
pub mod fluctuation;
pub mod motion;
pub mod noise;
pub mod process;
pub mod response;
pub mod scene;

pub use dwell::DwellSimulator;
pub use error::SimError;
