//! ASTERIX: EUROCONTROL's binary format of surveillance data.
//!
//! A recording is a sequence of blocks (category, length, records); a record begins with
//! its FSPEC, a bit field that says which items of the category's profile follow.

pub mod block;
pub mod cat010;
