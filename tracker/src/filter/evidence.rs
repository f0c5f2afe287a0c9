//! The plots that the tracks of a group may have caused, built by the shared association: slot m holds the m-th candidate of every lane.
//!
//! A lane with fewer candidates than slots has weight 0 in the rest. What else stands there is left from before: valid, and
//! multiplied by 0.

use super::lanes::{LANES, Row};
use crate::plots::measurement::{COORDINATES, Measurement};

/// One candidate of every lane.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::filter) struct Slot {
    /// (x, y, z), m.
    pub(in crate::filter) position: [Row; 3],
    /// ṙ, m/s.
    pub(in crate::filter) range_rate: Row,
    /// Plot's time minus the prediction's, s.
    pub(in crate::filter) offset_s: Row,
    /// a = ℓ/ρ, m³·m/s; 0 where there is no candidate.
    pub(in crate::filter) gain: Row,
    /// σ² of (r, β, ε, ṙ).
    pub(in crate::filter) variance: [Row; COORDINATES],
    /// 1 where elevation and range rate were measured, else 0.
    pub(in crate::filter) measured: [Row; 2],
    /// Whether every lane's plot has the errors of its plot in the slot before.
    pub(in crate::filter) as_before: bool,
    /// Whether elevation and range rate were measured in all lanes.
    pub(in crate::filter) complete: bool,
}

impl Slot {
    const EMPTY: Self = Self {
        position: [Row::ZERO; 3],
        range_rate: Row::ZERO,
        offset_s: Row::ZERO,
        gain: Row::ZERO,
        variance: [Row::splat(1.0); COORDINATES],
        measured: [Row::splat(1.0); 2],
        as_before: true,
        complete: true,
    };

    #[expect(clippy::float_cmp, reason = "equal bits or another D")]
    fn has_errors_of(&self, lane: usize, measurement: &Measurement) -> bool {
        (0..COORDINATES).all(|i| self.variance[i].0[lane] == measurement.variance[i])
            && (0..2).all(|i| self.measured[i].0[lane] == f64::from(measurement.measured[2 + i]))
    }
}

/// Candidates of a group, and what a miss is worth; reused from group to group.
#[derive(Debug, Default)]
pub struct Evidence {
    slots: Vec<Slot>,
    used: usize,
    count: [usize; LANES],
    /// b_j by component.
    pub(in crate::filter) none: Vec<Row>,
    /// Whether the one candidate of a lane is the target's for certain, whatever its density.
    pub(in crate::filter) decided: bool,
}

impl Evidence {
    /// With room for so many candidates of a track from the start.
    pub fn with_room(candidates: usize) -> Self {
        Self { slots: Vec::with_capacity(candidates), ..Self::default() }
    }

    /// No candidates and b_j = 1 in any lane, for states of `components` components.
    pub fn clear(&mut self, components: usize) {
        for slot in &mut self.slots[..self.used] {
            slot.gain = Row::ZERO;
            slot.as_before = true;
            slot.complete = true;
        }
        self.used = 0;
        self.count = [0; LANES];
        self.none.clear();
        self.none.resize(components, Row::splat(1.0));
        self.decided = false;
    }

    /// From now on the one candidate of each lane is the target's for certain, and b_j counts where there is none.
    pub fn decide(&mut self) {
        debug_assert!(self.count.iter().all(|&count| count <= 1), "several certain plots: {:?}", self.count);
        self.decided = true;
        for lane in (0..LANES).filter(|&lane| self.count[lane] > 0) {
            self.none.iter_mut().for_each(|row| row.0[lane] = 0.0);
        }
    }

    /// b_j = 1 − D P_Gj of the track in `lane`.
    pub fn set_none(&mut self, lane: usize, none: &[f64]) {
        for (row, value) in self.none.iter_mut().zip(none) {
            row.0[lane] = *value;
        }
    }

    /// Adds a plot that the track in `lane` may have caused, `offset_s` after the time of the prediction. `gain` is
    /// a = ℓ(q)/ρ(p), m³·m/s.
    pub fn add(&mut self, lane: usize, plot: &Measurement, offset_s: f64, gain: f64) {
        assert!(lane < LANES, "lane {lane} of {LANES}");
        let m = self.count[lane];
        self.count[lane] += 1;
        if m == self.slots.len() {
            self.slots.push(Slot::EMPTY);
        }
        self.used = self.used.max(m + 1);
        let (before, slot) = self.slots[..=m].split_at_mut(m);
        let slot = &mut slot[0];
        for i in 0..3 {
            slot.position[i].0[lane] = plot.position[i];
        }
        slot.range_rate.0[lane] = plot.polar[3];
        slot.offset_s.0[lane] = offset_s;
        slot.gain.0[lane] = gain;
        slot.as_before &= before.last().is_some_and(|before| before.has_errors_of(lane, plot));
        slot.complete &= plot.measured[2] && plot.measured[3];
        for i in 0..COORDINATES {
            slot.variance[i].0[lane] = plot.variance[i];
        }
        for i in 0..2 {
            slot.measured[i].0[lane] = f64::from(plot.measured[2 + i]);
        }
    }

    /// Candidates of the track in `lane`.
    pub fn count(&self, lane: usize) -> usize {
        self.count[lane]
    }

    /// Slots in use: the most candidates that a lane has.
    pub fn slots(&self) -> usize {
        self.used
    }

    /// a of the first slot; 0 in lanes without a candidate.
    pub(in crate::filter) fn first_gain(&self) -> Row {
        self.in_use().first().map_or(Row::ZERO, |slot| slot.gain)
    }

    pub(in crate::filter) fn in_use(&self) -> &[Slot] {
        &self.slots[..self.used]
    }
}
