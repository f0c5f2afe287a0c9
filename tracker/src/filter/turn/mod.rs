//! Coordinated turns (V1)-(V4): interacting models of turn rates that are known, follow the target, or step through known ones.
//!
//! A model knows position and velocity. In the plane it turns at its rate; the height is an axis of constant velocity. The three families differ
//! only in the rates of the next scan ([`Grid`]), which are the memory of a state:
//! ```text
//! [ rate of each model, rad/s | 1 if the last scan has shown the target, else 0 ]
//! ```
//! A scan that has not shown the target tells nothing of its turn: the rates stay.

mod adaptive;
mod advance;
mod filter;
mod grid;
mod predict;
mod switching;

pub use adaptive::AdaptiveGrid;
pub use filter::Turn;
pub(super) use filter::layout;
pub use grid::{Carry, Grid};
pub use switching::SwitchingGrid;
