//! How one run ended.

use evaluation::gospa::{Gospa, MeanGospa};
use evaluation::mean::Moments;
use evaluation::ospa::Ospa;

/// What became of two drones with one kind of association.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Outcome {
    /// A drone has another track than before.
    pub(super) changed: bool,
    /// A drone has no track.
    pub(super) lost: bool,
    /// A drone had two.
    pub(super) redundant: bool,
    /// Share of the last scans with both tracks in one place (of filters).
    pub(super) coalesced: f64,
    /// By scan.
    pub(super) ospa: Moments,
    /// By scan.
    pub(super) gospa: MeanGospa,
}

impl Outcome {
    /// Takes the distances of a scan.
    pub(super) fn add(&mut self, ospa: &Ospa, gospa: &Gospa) {
        self.ospa.add(ospa.distance);
        self.gospa.add(gospa);
    }

    /// Whether anything went wrong.
    pub(super) fn wrong(&self) -> bool {
        self.changed || self.lost
    }
}
