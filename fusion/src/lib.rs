//! Tertiary processing: the tracks of several radars become one set of system tracks.
//!
//! Formulas and their numbers (F1)-(F11): `docs/theory/fusion.md`.

pub mod association;
pub mod class;
pub mod comparison;
pub mod gaussian;
pub mod grouping;
pub mod outliers;
pub mod registration;
pub mod rules;
