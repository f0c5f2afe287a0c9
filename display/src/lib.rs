//! The picture of a running chain.
//!
//! The process is an observer: the chain never waits for it, and it may come and go at any time.

pub mod process;
