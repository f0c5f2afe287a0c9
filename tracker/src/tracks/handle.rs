//! The name of a track by which it is found without a search.

/// Where a track is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Handle {
    /// Its number.
    pub id: u64,
    /// Its place.
    pub place: u32,
}
