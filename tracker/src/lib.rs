//! Plots in, tracks out: an IMM-PDA tracker that uses decision statistics.
//!
//! One idea per file, in the order in which a plot meets them:
//! ```text
//! sweep         where the beam is            measurement  plot → y, R; what a mode expects     (T5)-(T8)
//! plot_store    plots by beam angle          gate         which plots may be the track's       (T9)-(T11), (T13)
//! plot_index    plots by azimuth and range   association  and how much each one is             (T12), (T20)
//! state         mean and covariance          update       all modes with all plots             (T14)-(T16)
//! motion        the three modes  (T1)        start, initiation  two plots make a track         (T17), (T18)
//! imm           mixing  (T2)-(T4)            joint        plots that several tracks want       (J2), (J3)
//! clutter_map   false plots to expect        resolution   two targets in one plot              (J1), (J4)
//! amplitude     SNR        (T19), (T20.5)    life         existence, confirmation, end         (T18), (T20.6)
//! hypotheses    several histories  (T21)
//! track         one track between passages   site         the radar, as its headers tell
//! roster        tracks, each in its place    agenda       whom the beam passes next
//! neighbours    who is near a place          rivals       which tracks may want the same plots
//! tracker       all of it, one call per message
//! batch         eight tracks at a time   (T2)-(T5), (T20)    group        prediction and update of several tracks by it
//! ```
//!
//! Pure: no clock, file, shared memory or thread (but for [`replay`], which reads and writes). Formulas:
//! `docs/theory/imm-pda.md`.

#![expect(clippy::needless_range_loop, reason = "one index into several arrays reads like the formula")]

pub mod agenda;
pub mod amplitude;
pub mod association;
pub mod batch;
pub mod clutter_map;
pub mod gate;
pub mod group;
pub mod hypotheses;
pub mod imm;
pub mod initiation;
pub mod joint;
pub mod life;
pub mod measurement;
pub mod motion;
pub mod neighbours;
pub mod plot_index;
pub mod plot_store;
pub mod process;
pub mod replay;
pub mod resolution;
pub mod rivals;
pub mod roster;
mod site;
pub mod start;
pub mod state;
pub mod sweep;
pub mod track;
pub mod tracker;
pub mod update;

pub use tracker::{Taken, Tracker};
