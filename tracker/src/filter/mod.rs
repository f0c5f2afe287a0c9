//! Estimation: normal distributions of a target's motion, and the families of filters that predict and update them.

pub mod gaussian;
pub mod uav;
