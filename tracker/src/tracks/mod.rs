//! Tracks: their life, what is known of their targets' power, and where they are kept.

pub mod amplitude;
pub mod bounds;
pub mod handle;
pub mod initiation;
pub mod life;
pub mod message;
pub mod states;
pub mod store;
pub mod track;
