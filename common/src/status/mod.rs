//! What the processes of a chain say of themselves, for all who show it: launcher, `status`, metrics, display.

mod board;
mod json;

pub use board::{Board, LAUNCHER, SiteBoard, counted_inputs};
pub use json::to_json;
