//! What is known of a group before a scan.

use super::expect::Expectation;
use super::gaussian;
use super::group::Group;
use crate::plots::measurement::COORDINATES;

/// Elements of the packed triangle of D.
pub(in crate::filter) const PACKED_4: usize = gaussian::packed(COORDINATES);

/// What is known of a group before a scan.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// u*, P*, W*.
    pub prediction: &'a Group,
    /// What each component expects.
    pub expected: &'a [Expectation],
    /// γ of (T7).
    pub inflation: f64,
}
