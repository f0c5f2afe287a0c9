//! What every process of the chain agrees on: messages, frames and geometry,
//! the statistics of amplitudes, configuration, topics and their ports.
//!
//! ```text
//! radar-sim ──dwells──▶ plot-extractor ──plots──▶ tracker ──tracks──▶ recorder
//! ```
//!
//! Depends on no other crate of the workspace. Shared memory appears only in [`ipc`].

pub mod amplitude;
pub mod angle;
mod bad_input;
pub mod clutter_map;
pub mod commands;
pub mod config;
pub mod dwell;
mod fnv;
pub mod geodesy;
pub mod geometry;
pub mod health;
pub mod ipc;
pub mod label;
pub mod latency;
pub mod latency_log;
pub mod layout;
pub mod logging;
pub mod message;
pub mod messages;
pub mod network;
pub mod pace;
pub mod plots;
pub mod printable;
pub mod process;
pub mod random;
pub mod realtime;
pub mod recording;
pub mod report;
pub mod status;
mod stop;
pub mod system_tracks;
pub mod time;
pub mod topic;
pub mod topology;
pub mod tracks;
pub mod truth;
pub mod turning;
pub mod units;
