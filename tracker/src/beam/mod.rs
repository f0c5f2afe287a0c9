//! The beam: where it is, and which tracks it meets next.

pub mod agenda;
pub mod opportunity;
pub mod sweep;
