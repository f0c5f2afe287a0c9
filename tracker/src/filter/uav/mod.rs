//! The drone filter: an IMM of hover, near-constant velocity and manoeuvre.

pub mod batch;
pub mod group;
pub mod imm;
pub mod motion;
pub mod start;
pub mod update;
