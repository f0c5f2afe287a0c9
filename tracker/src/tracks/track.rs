//! One track between two detection opportunities.

use std::cmp::Reverse;

use common::config::TrackerConfig;
use common::tracks::{GATE_NONE, USED_PLOTS, UsedPlot};

use super::amplitude::Amplitude;
use super::handle::Handle;
use super::life::Life;
use super::states::Of;
use crate::association::clutter_map::OwnPlots;
use crate::association::hypotheses::Hypotheses;
use crate::association::scan::Outcome;
use crate::beam::opportunity::Opportunity;
use crate::constants;

/// What the last scan did, for the message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LastScan {
    /// `GATE_…`.
    pub gate_code: u32,
    /// V, m³·m/s.
    pub gate_volume: f64,
    /// Plots in the gate.
    pub plots_in_gate: u32,
    /// Weight of "none".
    pub weight_none: f64,
    /// Weight of the best plot.
    pub weight_best: f64,
    /// `seq` and index of the best plot.
    pub best_plot: (u64, u32),
    /// The plots of the largest weights.
    pub used: [UsedPlot; USED_PLOTS],
}

impl LastScan {
    /// A scan without a plot.
    pub const EMPTY: Self = Self {
        gate_code: GATE_NONE,
        gate_volume: 0.0,
        plots_in_gate: 0,
        weight_none: 1.0,
        weight_best: 0.0,
        best_plot: (0, u32::MAX),
        used: [UsedPlot::NONE; USED_PLOTS],
    };

    /// Of what a scan did to a track, before its plots are added.
    pub fn new(outcome: &Outcome) -> Self {
        Self {
            gate_code: outcome.selection.gate_code,
            gate_volume: outcome.selection.volume,
            plots_in_gate: outcome.plots_in_gate as u32,
            weight_none: outcome.weight_none,
            ..Self::EMPTY
        }
    }

    /// Adds a plot of its gates and its weight.
    pub fn add(&mut self, seq: u64, index: u32, weight: f64, gates: u32) {
        if weight > self.weight_best {
            self.weight_best = weight;
            self.best_plot = (seq, index);
        }
        let weight = weight as f32;
        let used = &mut self.used;
        if weight > used[USED_PLOTS - 1].weight {
            let place = used.partition_point(|other| other.weight >= weight);
            used[place..].rotate_right(1);
            used[place] = UsedPlot { seq, index, weight, gates, reserved: 0 };
        }
    }
}

/// A track but for its states, which are in the [`store`](super::store).
///
/// What is asked of every track that is due, and of its neighbours, comes first and shares cache lines.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LiveTrack {
    /// Its number.
    pub id: u64,
    /// The detection opportunity to come.
    pub next: Opportunity,
    /// Existence and counts.
    pub life: Life,
    /// Time of the posterior: the last detection opportunity.
    pub time_ns: u64,
    /// Unwrapped beam angle at that time.
    pub angle_rad: f64,
    /// Plots up to this angle have been offered to the track: none is offered twice.
    pub searched_to_rad: f64,
    /// Scans, once confirmed, with a plot of its own while no other track was within the radar's resolution.
    pub scans_apart: u32,
    /// Signal-to-noise ratio.
    pub amplitude: Amplitude,
    /// Its plots that the clutter map took for false ones.
    pub own_plots: OwnPlots,
    /// The opportunity before, whose scan it has been updated with.
    pub last: Opportunity,
    /// For the message.
    pub last_scan: LastScan,
    /// With (T21), the hypotheses whose mixture the posterior is.
    pub hypotheses: Option<Hypotheses>,
    /// With which stronger track it may be one.
    pub duplicate_of: Option<DuplicateOf>,
}

/// A stronger track that does what this one does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DuplicateOf {
    /// Which.
    pub track: Handle,
    /// In how many scans it, or another, took the same best plot, less those since in which none did.
    pub scans: u32,
    /// Age of this track in the last of them.
    pub age: u32,
}

impl LiveTrack {
    /// The opportunity to come, or the last one.
    pub fn opportunity(&self, of: Of) -> &Opportunity {
        match of {
            Of::NextScan => &self.next,
            Of::LastScan => &self.last,
        }
    }

    /// L of (T18), of what a scan says of the track among others. Where these take the plots of a confirmed one, two targets may have
    /// become a single plot: that speaks neither for it nor against it, for some scans.
    pub fn evidence(&self, outcome: &Outcome, among_others: f64) -> f64 {
        let ratio = outcome.existence_ratio * among_others;
        let taken = self.life.is_confirmed()
            && self.life.misses < constants::MERGED_SCANS
            && outcome.weight_none > constants::MISS_WEIGHT
            && ratio < 1.0
            && outcome.ratio_alone > 1.0;
        if taken { 1.0 } else { ratio }
    }

    /// Whether it has been seen apart from all other tracks, often enough not to be a duplicate of one of them.
    pub fn is_seen_apart(&self, config: &TrackerConfig) -> bool {
        self.scans_apart >= config.confirm_hits
    }

    /// Which of two tracks stays if they are one: the largest.
    pub fn rank(&self) -> (bool, u32, Reverse<u64>) {
        (self.life.is_confirmed(), self.life.hits, Reverse(self.id))
    }

    /// Notes that track `stronger` took the same best plot in this scan. Which of several did so may change from scan to scan.
    pub fn note_duplicate(&mut self, stronger: Handle) {
        let age = self.life.age;
        let scans = match self.duplicate_of {
            Some(other) if other.age == age => other.scans,
            Some(other) => other.scans.saturating_sub(age - other.age - 1) + 1,
            None => 1,
        };
        self.duplicate_of = Some(DuplicateOf { track: stronger, scans, age });
    }
}
