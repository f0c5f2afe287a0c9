//! One track between two passages of the beam.

use std::cmp::Reverse;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use common::angle;
use common::config::TrackerConfig;
use common::tracks::{GATE_NONE, Track, USED_PLOTS, UsedPlot};
use common::units::seconds_between;
use nalgebra::{SMatrix, SVector};

use crate::association::gate::{Gate, Radar};
use crate::association::hypotheses::Hypotheses;
use crate::beam::sweep::{Sweep, shift};
use crate::filter::gaussian::at;
use crate::filter::uav::imm::{Imm, transition};
use crate::filter::uav::motion::{MODES, Motion};
use crate::filter::uav::update::Outcome;
use crate::plots::measurement::{Expected, Measurement};
use crate::tracks::amplitude::Amplitude;
use crate::tracks::handle::Handle;
use crate::tracks::life::Life;

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
        used: [UsedPlot { seq: 0, index: 0, weight: 0.0, gates: 0, reserved: 0 }; USED_PLOTS],
    };

    /// Of what a scan did to a track; `claims` are the plots in its gate and their weights;
    /// `origin` tells `seq`, index and measurement of such a plot, `gates` are those of the modes at `time_ns`.
    pub fn new<'a>(
        outcome: &Outcome,
        claims: &[(usize, f64)],
        origin: impl Fn(usize) -> (u64, u32, &'a Measurement),
        gates: &[Gate; MODES],
        time_ns: u64,
    ) -> Self {
        let mut used = Self::EMPTY.used;
        let mut best = (Self::EMPTY.best_plot, 0.0);
        for &(plot, weight) in claims {
            let (seq, index, measurement) = origin(plot);
            if weight > best.1 {
                best = ((seq, index), weight);
            }
            let weight = weight as f32;
            if weight <= used[USED_PLOTS - 1].weight {
                continue;
            }
            let place = used.partition_point(|other| other.weight >= weight);
            used[place..].rotate_right(1);
            let offset_s = seconds_between(time_ns, measurement.time_ns);
            let mask = gates.iter().zip(0..).fold(0, |mask, (gate, mode)| {
                mask | u32::from(gate.holds(&gate.offset(measurement, offset_s), measurement)) << mode
            });
            used[place] = UsedPlot { seq, index, weight, gates: mask, reserved: 0 };
        }
        Self {
            gate_code: outcome.selection.gate_code,
            gate_volume: outcome.selection.volume,
            plots_in_gate: outcome.plots_in_gate as u32,
            weight_none: outcome.weight_none,
            weight_best: best.1,
            best_plot: best.0,
            used,
        }
    }
}

/// Prediction for the next passage of the beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// u*, P*, W*.
    pub prediction: Imm,
    /// When the beam will pass.
    pub time_ns: u64,
    /// Unwrapped beam angle at that time.
    pub angle_rad: f64,
    /// Half width of the gates in azimuth, about that angle.
    pub half_width_rad: f64,
    /// Between which ranges the gates lie, for plots of nominal errors, m.
    pub range_m: [f64; 2],
}

impl Passage {
    /// Of a prediction for `time_ns` when the beam stands at `angle_rad`; `gates` are its modes'. The beam turns once in `period_s`.
    pub fn new(prediction: Imm, gates: &[Gate; MODES], time_ns: u64, angle_rad: f64, period_s: f64) -> Self {
        let mut half_width_rad: f64 = 0.0;
        for gate in gates {
            let shift_rad = angle::difference(gate.centre[1], angle_rad).abs();
            half_width_rad = half_width_rad.max(shift_rad + gate.half[1] * GATE_MARGIN);
        }
        let half_width_rad = half_width_rad.min(FRAC_PI_2);
        // What is at the edges is passed that much earlier or later.
        let early_s = half_width_rad / TAU * period_s;
        let mut range_m = [f64::INFINITY, f64::NEG_INFINITY];
        for gate in gates {
            let half_m = gate.half[0] * GATE_MARGIN + gate.drift[0].abs() * early_s;
            range_m = [range_m[0].min(gate.centre[0] - half_m), range_m[1].max(gate.centre[0] + half_m)];
        }
        Self { prediction, time_ns, angle_rad, half_width_rad, range_m }
    }

    /// Angle at which the gates begin.
    pub fn begins_rad(&self) -> f64 {
        self.angle_rad - self.half_width_rad
    }

    /// Angle at which all plots of the gates have arrived.
    pub fn due_rad(&self) -> f64 {
        self.angle_rad + self.half_width_rad
    }
}

/// A track.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveTrack {
    /// Its number.
    pub id: u64,
    /// û, P̂, W at `time_ns`.
    pub posterior: Imm,
    /// With (T21), the hypotheses whose mixture `posterior` is.
    pub hypotheses: Option<Hypotheses>,
    /// Time of the last passage.
    pub time_ns: u64,
    /// Unwrapped beam angle of the last passage.
    pub angle_rad: f64,
    /// Plots up to this angle have been offered to the track: none is offered twice.
    pub searched_to_rad: f64,
    /// The passage to come.
    pub next: Passage,
    /// The passage before: what the track expected of the turn it has been updated with.
    pub last: Passage,
    /// Existence and counts.
    pub life: Life,
    /// Signal-to-noise ratio.
    pub amplitude: Amplitude,
    /// For the message.
    pub last_scan: LastScan,
    /// With which stronger track it may be one.
    pub twin: Option<Twin>,
    /// Scans, once confirmed, with a plot of its own while no other track was within the radar's resolution.
    pub scans_apart: u32,
}

/// A stronger track that does what this one does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Twin {
    /// Which.
    pub track: Handle,
    /// In how many scans it, or another, took the same best plot, less those since in which none did.
    pub scans: u32,
    /// Age of this track in the last of them.
    pub age: u32,
}

/// How tracks move, from the configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Process noise and dimension.
    pub motion: Motion,
    /// Probability of staying in a mode for 1 s.
    pub stay: f64,
    /// α.
    pub alpha: f64,
}

impl Kinematics {
    /// From the configuration, for a radar.
    pub fn new(config: &TrackerConfig, radar: &Radar) -> Self {
        let noise = [config.hover_noise_mps, config.velocity_noise_mps2, config.manoeuvre_noise_mps3];
        let motion = Motion { noise, axes: if radar.measured[2] { 3 } else { 2 } };
        Self { motion, stay: config.stay_probability, alpha: config.gate_alpha }
    }

    /// When the beam meets the target of `posterior`, valid at `time_ns` when the beam stood at `angle_rad`, in about `turns` turns.
    ///
    /// The beam meets the target where both are; two steps of a fixed point suffice, as targets move slowly
    /// in azimuth, and where they do not (above the antenna) azimuth means little.
    pub fn meeting(&self, posterior: &Imm, time_ns: u64, angle_rad: f64, turns: f64, sweep: &Sweep) -> Meeting {
        let mean = |i: usize| (0..MODES).map(|j| posterior.probability[j] * posterior.modes[j].mean[i]).sum::<f64>();
        let (position, velocity) = ([mean(0), mean(1)], [mean(3), mean(4)]);
        let now_rad = position[0].atan2(position[1]);
        let mut change_rad = 0.0;
        for _ in 0..2 {
            let after_s = sweep.period_s() * (turns + change_rad / TAU);
            let (x, y) = (position[0] + velocity[0] * after_s, position[1] + velocity[1] * after_s);
            change_rad = angle::difference(x.atan2(y), now_rad);
        }
        // The last passage was at the expected azimuth, not quite at the estimated one.
        let offset_rad = angle::difference(now_rad, angle_rad);
        let next_rad = angle_rad + turns * TAU + (offset_rad + change_rad).clamp(-PI, PI);
        let step_s = sweep.period_s() * (next_rad - angle_rad) / TAU;
        Meeting { from_ns: time_ns, to_ns: shift(time_ns, step_s), angle_rad: next_rad }
    }

    /// Predicts `posterior` to a meeting.
    pub fn passage(&self, posterior: &Imm, meeting: &Meeting, sweep: &Sweep, radar: &Radar) -> Passage {
        let step_s = meeting.step_s();
        let prediction = posterior.predict(&transition(self.stay, step_s), &self.motion, step_s);
        let gates = std::array::from_fn(|j| Gate::new(&Expected::new(j, &prediction.modes[j]), radar, self.alpha));
        Passage::new(prediction, &gates, meeting.to_ns, meeting.angle_rad, sweep.period_s())
    }
}

/// Where and when the beam meets a target again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Time of what is known of the target, ns UTC.
    pub from_ns: u64,
    /// Time of the meeting, ns UTC.
    pub to_ns: u64,
    /// Unwrapped beam angle at that time.
    pub angle_rad: f64,
}

impl Meeting {
    /// The time between, s; never negative.
    pub fn step_s(&self) -> f64 {
        seconds_between(self.from_ns, self.to_ns).max(0.0)
    }
}

/// Weight of "none" above which a scan counts as one without a plot.
pub const MISS_WEIGHT: f64 = 0.5;
/// Scans for which two targets may be a single plot before that speaks against one of them.
const MERGED_SCANS: u32 = 12;
/// Components in which tracks are compared: position and velocity.
const COMPARED: usize = 6;
/// Plots may have larger errors than the nominal ones.
const GATE_MARGIN: f64 = 1.3;

impl LiveTrack {
    /// L of (T18), of what a scan says of the track among others. Where these take the plots of a confirmed one, two targets may have
    /// become a single plot: that speaks neither for it nor against it, for some scans.
    pub fn evidence(&self, outcome: &Outcome, among_others: f64) -> f64 {
        let ratio = outcome.existence_ratio * among_others;
        let taken = self.life.is_confirmed()
            && self.life.misses < MERGED_SCANS
            && outcome.weight_none > MISS_WEIGHT
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
    pub fn note_twin(&mut self, stronger: Handle) {
        let age = self.life.age;
        let scans = match self.twin {
            Some(twin) if twin.age == age => twin.scans,
            Some(twin) => twin.scans.saturating_sub(age - twin.age - 1) + 1,
            None => 1,
        };
        self.twin = Some(Twin { track: stronger, scans, age });
    }

    /// Squared distance of position and velocity from another track's, in standard deviations of both:
    /// ```text
    /// d² = Δᵀ (P_a + P_b)⁻¹ Δ
    /// ```
    /// Errors of tracks that share plots are alike, so that of one target is smaller than χ² of 6 (or 4) degrees of freedom. The other track
    /// is moved to the time of this one along its mean.
    pub fn squared_distance(&self, other: &Self) -> f64 {
        let (a, b) = (self.posterior.mixture(), other.posterior.mixture());
        let later_s = seconds_between(other.time_ns, self.time_ns);
        let difference = SVector::<f64, COMPARED>::from_fn(|i, _| {
            a.mean[i] - b.mean[i] - if i < 3 { b.mean[3 + i] * later_s } else { 0.0 }
        });
        let both = SMatrix::<f64, COMPARED, COMPARED>::from_fn(|i, j| {
            let sum = a.covariance[at(i, j)] + b.covariance[at(i, j)];
            if i == j { sum * (1.0 + 1e-9) + f64::MIN_POSITIVE } else { sum }
        });
        both.cholesky().map_or(f64::INFINITY, |factor| difference.dot(&factor.solve(&difference)))
    }

    /// The message of this track.
    pub fn message(&self) -> Track {
        let (state, covariance) = self.posterior.mixture().to_message();
        let (mode_state, mode_covariance) = self.posterior.modes[self.posterior.most_probable()].to_message();
        Track {
            time_ns: self.time_ns,
            id: self.id,
            state,
            mode_state,
            covariance,
            mode_covariance,
            mode_probability: self.posterior.probability,
            existence: self.life.existence,
            gate_volume: self.last_scan.gate_volume,
            weight_none: self.last_scan.weight_none,
            weight_best: self.last_scan.weight_best,
            best_plot_seq: self.last_scan.best_plot.0,
            best_plot_index: self.last_scan.best_plot.1,
            plots_in_gate: self.last_scan.plots_in_gate,
            state_code: self.life.state,
            gate_code: self.last_scan.gate_code,
            age_scans: self.life.age,
            hits: self.life.hits,
            misses: self.life.misses,
            snr_db: self.amplitude.snr_db() as f32,
            used: self.last_scan.used,
        }
    }
}
