//! Monte Carlo experiments.

pub mod follow;
pub mod trajectory;
pub mod world;
