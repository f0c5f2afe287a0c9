//! Plots in, tracks out: an IMM-PDA tracker that uses decision statistics.
//!
//! ```text
//! beam         where it is (sweep), which tracks it meets next (agenda)
//! plots        plot → y, R (measurement, (T5)-(T8)), kept by beam angle (store), found by place (index)
//! filter       normal distributions (gaussian); uav: the drone filter  (T1)-(T4), (T14)-(T17)
//! association  which plots may be a track's (gate, (T9)-(T11), (T13)) and how much each is (choice, (T12), (T20));
//!              several histories (hypotheses, (T21)), several tracks (rivals, joint (J2), (J3), resolution (J1), (J4)),
//!              false plots to expect (clutter_map)
//! tracks       store, life (T18), amplitude (T19), (T20.5), initiation (T18)
//! last_tracks  the last messages in files, for a tracker that is started again
//! operator     zones, tracks to begin and to end; orders: when what was asked for is done
//! tracker      all of it, one call per message
//! tuning       parameters learnt from plots, (ML1)-(ML4)
//! ```
//!
//! Pure: no clock, file, shared memory or thread (but for [`replay`], which reads and writes). Formulas:
//! `docs/theory/imm-pda.md`.

#![expect(clippy::needless_range_loop, reason = "one index into several arrays reads like the formula")]

pub mod association;
pub mod beam;
mod constants;
mod environment;
pub mod filter;
mod last_tracks;
mod operator;
pub mod orders;
pub mod plots;
pub mod process;
pub mod replay;
pub mod tracker;
pub mod tracks;
pub mod tuning;
mod zones;

pub use tracker::{Processed, Tracker};
