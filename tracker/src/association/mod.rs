//! Association: which plots may be a track's, and how much each of them is.

mod choice;
pub mod clutter_map;
pub mod gate;
pub mod hypotheses;
pub mod joint;
pub mod neighbours;
pub mod one_track;
pub mod resolution;
pub mod rivals;
pub mod scan;

pub use choice::*;
