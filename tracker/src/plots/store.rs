//! Plots of the last turn and a half, ordered by the unwrapped angle of the beam.
//!
//! A track looks only at the plots between two angles, found by bisection.

use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::ops::Range;

use common::turning::Turning;

use crate::plots::crowd;
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;
use crate::tracks::handle::Handle;

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
    /// How far tracks claim it: the probability that it is one's, weights times existence taken as independent.
    pub claimed: f64,
    /// The strongest track that took it as its best plot, or the one that it started.
    pub owner: Option<Handle>,
}

/// The plots.
#[derive(Debug, Default)]
pub struct PlotStore {
    /// Angles of the entries: what is searched.
    angles_rad: Vec<f64>,
    entries: Vec<Entry>,
    measurements: Vec<Measurement>,
    /// Entries that have been settled (see [`PlotStore::settle`]).
    settled: usize,
    /// Plots before the newest message's.
    known: usize,
    /// Whether a plot has been added before its place in the order.
    disordered: bool,
    /// Where plots lie that belong in this order, reused.
    order: Vec<usize>,
    /// Azimuth cells of plots, reused.
    azimuths: Vec<f64>,
}

impl PlotStore {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.angles_rad.clear();
        self.entries.clear();
        self.measurements.clear();
        self.settled = 0;
        self.known = 0;
        self.disordered = false;
    }

    /// The angle at which to keep a plot seen at `angle_rad`: its own, or that of the newest settled plot if it lies no
    /// more than `tolerance_rad` behind it; `None` if it comes too late.
    pub fn admit(&self, angle_rad: f64, tolerance_rad: f64) -> Option<f64> {
        let settled_rad = if self.settled > 0 { self.entries[self.settled - 1].angle_rad } else { f64::NEG_INFINITY };
        (angle_rad >= settled_rad - tolerance_rad).then(|| angle_rad.max(settled_rad))
    }

    /// Adds a plot behind all others. [`PlotStore::sort`] must follow the last plot of a message.
    pub fn push(&mut self, entry: Entry, measurement: Measurement) {
        self.disordered |= self.entries.last().is_some_and(|last| by_angle(&entry, last).is_lt());
        self.angles_rad.push(entry.angle_rad);
        self.entries.push(entry);
        self.measurements.push(measurement);
    }

    /// Brings the plots that are not settled into order, and marks those that are many at one azimuth, of an antenna that turns.
    pub fn sort(&mut self, radar: &Radar, turning: Turning) {
        let disordered = std::mem::take(&mut self.disordered);
        if disordered {
            self.sort_unsettled();
        }
        let first = if disordered { self.settled } else { self.known };
        if turning != Turning::Standing {
            crowd::mark(&self.angles_rad, &mut self.measurements, first, radar, &mut self.azimuths);
        }
        self.known = self.entries.len();
    }

    fn sort_unsettled(&mut self) {
        let Self { angles_rad, entries, measurements, settled, order, .. } = self;
        let unsettled = *settled..entries.len();
        order.clear();
        order.extend(unsettled.clone());
        // Stable by its last key; a stable sort would allocate.
        order.sort_unstable_by(|&a, &b| by_angle(&entries[a], &entries[b]).then(a.cmp(&b)));
        for &plot in order.iter() {
            entries.push(entries[plot]);
            measurements.push(measurements[plot]);
        }
        entries.drain(unsettled.clone());
        measurements.drain(unsettled);
        angles_rad.truncate(*settled);
        angles_rad.extend(entries[*settled..].iter().map(|entry| entry.angle_rad));
    }

    /// Drops plots that no track or start can still ask for. Moves the rest only when much is to be dropped.
    pub fn drop_before(&mut self, covered_to_rad: f64) {
        let oldest = covered_to_rad - KEPT_TURNS * TAU;
        let gone = self.angles_rad.partition_point(|angle_rad| *angle_rad < oldest).min(self.settled);
        if gone > 64 && gone * 3 > self.entries.len() {
            self.angles_rad.drain(..gone);
            self.entries.drain(..gone);
            self.measurements.drain(..gone);
            self.settled -= gone;
            self.known -= gone;
        }
    }

    /// Indices of the plots from one angle to another.
    pub fn between(&self, from_rad: f64, to_rad: f64) -> Range<usize> {
        let from = self.angles_rad.partition_point(|angle_rad| *angle_rad < from_rad);
        let to = self.angles_rad.partition_point(|angle_rad| *angle_rad <= to_rad);
        from..to.max(from)
    }

    /// Measurement at an index.
    pub fn measurement(&self, index: usize) -> &Measurement {
        &self.measurements[index]
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
        self.settled += self.angles_rad[first..].partition_point(|angle| *angle < angle_rad);
        first..self.settled
    }
}

/// Order of plots; the last two keys make it independent of the order of arrival.
fn by_angle(a: &Entry, b: &Entry) -> Ordering {
    a.angle_rad.total_cmp(&b.angle_rad).then(a.seq.cmp(&b.seq)).then(a.index.cmp(&b.index))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn entry(angle_rad: f64, seq: u64, index: u32) -> Entry {
        Entry { angle_rad, seq, index, explained: 0.0, claimed: 0.0, owner: None }
    }

    proptest! {
        /// Against plots inserted one by one. Angles are whole numbers, so that many are equal; of each message's plots some are settled.
        #[test]
        fn plots_lie_in_order_and_settled_ones_stay(
            messages in prop::collection::vec((prop::collection::vec(0u32..20, 0..30), 0u32..20), 1..8),
        ) {
            let (mut store, mut expected) = (PlotStore::default(), Vec::<Entry>::new());
            let mut settled = 0;
            for (seq, (angles, settle)) in messages.into_iter().enumerate() {
                for (index, angle) in angles.into_iter().enumerate() {
                    let Some(angle_rad) = store.admit(f64::from(angle), 2.0) else { continue };
                    let entry = entry(angle_rad, seq as u64, index as u32);
                    store.push(entry, Measurement::at(1000.0, angle_rad));
                    let place = expected[settled..].partition_point(|other| by_angle(other, &entry).is_le());
                    expected.insert(settled + place, entry);
                }
                store.sort(&Radar { variance: [1.0; 4], cell: [1.0, 1e-9, 1.0, 1.0], measured: [true; 4], range_rate_interval_mps: 0.0 }, Turning::Clockwise);
                prop_assert_eq!(&store.entries, &expected);
                prop_assert!(store.entries.iter().zip(&store.measurements).all(|(a, b)| a.angle_rad.to_bits() == b.polar[1].to_bits()));
                settled = store.settle(f64::from(settle)).end;
            }
        }
    }
}
