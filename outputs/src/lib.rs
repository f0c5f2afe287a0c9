//! Tracks of a running chain into other systems.
//!
//! ```text
//! tracks ──▶ datagrams: ASTERIX categories 062 and 065 ──▶ UDP
//! ```
//!
//! The process is an observer: the chain never waits for it, and it may come and go at any time.

pub mod datagrams;
pub mod process;
