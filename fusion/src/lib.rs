//! Tertiary processing: the tracks of several radars become one set of system tracks.
//!
//! Formulas and their numbers (F1)-(F11): `docs/theory/fusion.md`.

pub mod association;
pub mod class;
mod clocks;
pub mod comparison;
mod engine;
mod feed;
pub mod gaussian;
mod grid;
pub mod gross_bias;
pub mod grouping;
pub mod local;
pub mod measurement;
pub mod motion;
mod outgoing;
pub mod outliers;
mod pacing;
pub mod process;
pub mod registration;
mod remarks;
pub mod rules;
mod settings;
pub mod simulation;
mod system;

pub use engine::Fusion;
pub use settings::{Counts, Settings, Site};
pub use system::{CONTRIBUTORS, Contributor, SystemTrack};
