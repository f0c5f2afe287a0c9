//! Plots of the last turn and a half, ordered by the unwrapped angle of the beam.
//!
//! A track looks only at the plots between two angles, found by bisection.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::measurement::Measurement;
use crate::roster::Handle;

/// Plots older than this behind the newest are dropped, turns.
const KEPT_TURNS: f64 = 1.6;

/// What is known of a plot besides its measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Unwrapped angle, rad.
    pub angle_rad: f64,
    /// `seq` of its message.
    pub seq: u64,
    /// Index in its message.
    pub index: u32,
    /// How far confirmed tracks explain it: the largest association weight.
    pub explained: f64,
    /// How far any track claims it: the largest weight times existence.
    pub claimed: f64,
    /// The strongest track that took it as its best plot, or the one that it started.
    pub owner: Option<Handle>,
}

/// The plots.
#[derive(Debug, Default)]
pub struct PlotStore {
    entries: Vec<Entry>,
    measurements: Vec<Measurement>,
    /// Entries that have been settled (see [`PlotStore::settle`]).
    settled: usize,
}

impl PlotStore {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.measurements.clear();
        self.settled = 0;
    }

    /// The angle at which to keep a plot seen at `angle_rad`: its own, or that of the newest settled plot if it lies no
    /// more than `tolerance_rad` behind it; `None` if it comes too late.
    pub fn admit(&self, angle_rad: f64, tolerance_rad: f64) -> Option<f64> {
        let settled_rad = if self.settled > 0 { self.entries[self.settled - 1].angle_rad } else { f64::NEG_INFINITY };
        (angle_rad >= settled_rad - tolerance_rad).then(|| angle_rad.max(settled_rad))
    }

    /// Adds a plot at its place. Plots come nearly in order, so few are moved.
    pub fn insert(&mut self, entry: Entry, measurement: Measurement) {
        let mut place = self.entries.len();
        while place > self.settled && precedes(&entry, &self.entries[place - 1]) {
            place -= 1;
        }
        self.entries.insert(place, entry);
        self.measurements.insert(place, measurement);
    }

    /// Drops plots that no track or start can still ask for. Moves the rest only when much is to be dropped.
    pub fn drop_before(&mut self, covered_to_rad: f64) {
        let oldest = covered_to_rad - KEPT_TURNS * TAU;
        let gone = self.entries.partition_point(|entry| entry.angle_rad < oldest).min(self.settled);
        if gone > 64 && gone * 3 > self.entries.len() {
            self.entries.drain(..gone);
            self.measurements.drain(..gone);
            self.settled -= gone;
        }
    }

    /// Indices of the plots from one angle to another.
    pub fn between(&self, from_rad: f64, to_rad: f64) -> Range<usize> {
        let from = self.entries.partition_point(|entry| entry.angle_rad < from_rad);
        let to = self.entries.partition_point(|entry| entry.angle_rad <= to_rad);
        from..to.max(from)
    }

    /// Measurements of a range of indices.
    pub fn measurements(&self, range: Range<usize>) -> &[Measurement] {
        &self.measurements[range]
    }

    /// Entry at an index.
    pub fn entry(&self, index: usize) -> &Entry {
        &self.entries[index]
    }

    /// Entry at an index, to be marked.
    pub fn entry_mut(&mut self, index: usize) -> &mut Entry {
        &mut self.entries[index]
    }

    /// The plots before `angle_rad`, about which all tracks have had their say; each is returned once.
    pub fn settle(&mut self, angle_rad: f64) -> Range<usize> {
        let first = self.settled;
        self.settled += self.entries[first..].partition_point(|entry| entry.angle_rad < angle_rad);
        first..self.settled
    }
}

/// Order of plots; the last two keys make it independent of the order of arrival.
fn precedes(a: &Entry, b: &Entry) -> bool {
    (a.angle_rad, a.seq, a.index) < (b.angle_rad, b.seq, b.index)
}
