//! The three modes, and the constants of the filter.

use common::config::TrackerConfig;
use common::tracks::{KIND_CONSTANT_VELOCITY, KIND_HOVER, KIND_MANOEUVRE};

use crate::filter::layout::Layout;
use crate::filter::propagate::Noise;

/// Number of modes.
pub const MODES: usize = 3;
/// Index of the hover mode.
pub const HOVER: usize = 0;
/// Index of the near-constant-velocity mode.
pub const CONSTANT_VELOCITY: usize = 1;
/// Index of the manoeuvre mode.
pub const MANOEUVRE: usize = 2;

/// States that each mode knows: the leading ones.
pub(super) const DIMENSIONS: [usize; MODES] = [3, 6, 9];
/// What the modes are in messages.
pub(super) const KINDS: [u16; MODES] = [KIND_HOVER, KIND_CONSTANT_VELOCITY, KIND_MANOEUVRE];
/// The form of its states.
pub const LAYOUT: Layout = Layout::new(&DIMENSIONS, 1, CONSTANT_VELOCITY, MANOEUVRE);
/// How long a jerk lasts, s.
const JERK_S: f64 = 1.0;
/// Mode probabilities of a new track.
const START_PROBABILITY: [f64; MODES] = [0.33, 0.34, 0.33];

/// The filter: its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uav {
    /// a₁ (m/s), a₂ (m/s²), a₃ (m/s³).
    pub noise: [f64; MODES],
    /// Share of a₃ that counts: a jerk lasts one second at most, so that the acceleration changes between two looks by no more than a target can.
    pub jerk_share: f64,
    /// 3, or 2 for a radar without elevation: z and its derivatives then stay zero.
    pub axes: usize,
    /// Probability of staying in a mode for 1 s; else a target goes to either other mode alike.
    pub stay: f64,
    /// W of a new track.
    pub start_probability: [f64; MODES],
}

impl Uav {
    /// From the configuration, in `axes` dimensions, of a radar that turns in `period_s`.
    pub fn new(config: &TrackerConfig, axes: usize, period_s: f64) -> Self {
        let noise = [config.hover_noise_mps, config.velocity_noise_mps2, config.manoeuvre_noise_mps3];
        Self {
            noise,
            jerk_share: (JERK_S / period_s).min(1.0),
            axes,
            stay: config.stay_probability,
            start_probability: START_PROBABILITY,
        }
    }

    pub(super) fn noise_of(&self, mode: usize) -> Noise {
        let share = if mode == MANOEUVRE { self.jerk_share } else { 1.0 };
        Noise { amplitude: share * self.noise[mode], axes: self.axes }
    }
}
