//! The drone filter: an interacting multiple-model estimator of hover, near-constant velocity and manoeuvre (T1)-(T4), (T17).
//!
//! A mode that knows only positions (hover), or positions and velocities, is a prefix of the state: 18 + 72 + 3 numbers of a track. One more,
//! the memory, is the variance of acceleration that (T17) gives the near-constant-velocity mode at the start; the first prediction mixes it
//! into the manoeuvre mode, after which it is 0.

mod filter;
mod modes;
mod predict;

pub use modes::{CONSTANT_VELOCITY, HOVER, LAYOUT, MANOEUVRE, MODES, Uav};
