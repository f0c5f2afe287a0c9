//! The picture of a chain in a browser, and the same over HTTP and WebSocket for programs.
//!
//! ```text
//! messages ──▶ picture: what can be drawn ──▶ wire: as it is sent ──▶ serve: to whom
//! ```
//!
//! Messages come from shared memory ([`process`], an observer: the chain never waits for it, and it may come and go at any
//! time) or from a recording ([`view`], and [`plan`] for a drawing of one time). `docs/display-api.md` describes what programs can read.

mod commands;
pub mod feed;
mod page;
pub mod picture;
pub mod plan;
pub mod process;
pub mod serve;
pub mod view;
pub mod wire;
