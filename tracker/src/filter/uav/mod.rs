//! The drone filter: an interacting multiple-model estimator of hover, near-constant velocity and manoeuvre (T1)-(T4), (T17).
//!
//! A mode that knows only positions (hover), or positions and velocities, is a prefix of the state: 18 + 72 + 3 numbers of a track. One more,
//! the memory, is the variance of acceleration that (T17) gives the near-constant-velocity mode at the start; the first prediction mixes it
//! into the manoeuvre mode, after which it is 0.

mod predict;

use common::config::TrackerConfig;
use common::tracks::{ESTIMATOR_IMM_UAV, KIND_CONSTANT_VELOCITY, KIND_HOVER, KIND_MANOEUVRE, Models};

use super::gaussian::{Gaussian, at, packed};
use super::propagate::Noise;
use super::{Filter, Group, Layout, Machine, Mixture, Row, TwoPlots};

/// Number of modes.
pub const MODES: usize = 3;
/// Index of the hover mode.
pub const HOVER: usize = 0;
/// Index of the near-constant-velocity mode.
pub const CONSTANT_VELOCITY: usize = 1;
/// Index of the manoeuvre mode.
pub const MANOEUVRE: usize = 2;

/// States that each mode knows: the leading ones.
const DIMENSIONS: [usize; MODES] = [3, 6, 9];
/// What the modes are in messages.
const KINDS: [u16; MODES] = [KIND_HOVER, KIND_CONSTANT_VELOCITY, KIND_MANOEUVRE];
/// The form of its states.
pub const LAYOUT: Layout = Layout::new(&DIMENSIONS, 1, CONSTANT_VELOCITY, MANOEUVRE);
/// Mode probabilities of a new track.
const START_PROBABILITY: [f64; MODES] = [0.33, 0.34, 0.33];

/// The filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uav {
    /// a₁ (m/s), a₂ (m/s²), a₃ (m/s³).
    pub noise: [f64; MODES],
    /// 3, or 2 for a radar without elevation: z and its derivatives then stay zero.
    pub axes: usize,
    /// Probability of staying in a mode for 1 s; else a target goes to either other mode alike.
    pub stay: f64,
    /// W of a new track.
    pub start_probability: [f64; MODES],
}

impl Uav {
    /// From the configuration, in `axes` dimensions.
    pub fn new(config: &TrackerConfig, axes: usize) -> Self {
        let noise = [config.hover_noise_mps, config.velocity_noise_mps2, config.manoeuvre_noise_mps3];
        Self { noise, axes, stay: config.stay_probability, start_probability: START_PROBABILITY }
    }

    fn noise_of(&self, mode: usize) -> Noise {
        Noise { amplitude: self.noise[mode], axes: self.axes }
    }
}

impl Filter for Uav {
    fn layout(&self) -> &Layout {
        &LAYOUT
    }

    fn estimator(&self) -> u16 {
        ESTIMATOR_IMM_UAV
    }

    fn greatest_acceleration_mps2(&self) -> f64 {
        self.noise[MANOEUVRE]
    }

    /// (T17); the hover mode starts at rest.
    fn start(&self, from: &TwoPlots<'_>, state: &mut [f64]) {
        state[..MODES].copy_from_slice(&self.start_probability);
        for (mode, &n) in DIMENSIONS.iter().enumerate() {
            let gaussian = if mode == HOVER { from.resting() } else { from.moving(self.noise_of(mode)) };
            let (mean, rest) = state[LAYOUT.start(mode)..].split_at_mut(n);
            mean.copy_from_slice(&gaussian.mean[..n]);
            rest[..packed(n)].copy_from_slice(&gaussian.covariance[..packed(n)]);
        }
        state[LAYOUT.memory_start()] = self.noise[CONSTANT_VELOCITY] * self.noise[CONSTANT_VELOCITY];
    }

    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group) {
        predict::predict(self, machine, lanes, posterior, step_s, prediction);
    }

    fn models(&self, state: Mixture<'_>) -> Models {
        let mut models = Models::default();
        for (kind, probability) in KINDS.into_iter().zip(state.weights()) {
            models.push(kind, *probability, 0.0);
        }
        models
    }

    /// The variance of acceleration of the near-constant-velocity mode at the start (T17).
    fn complete(&self, state: Mixture<'_>, component: Option<usize>, of: &mut Gaussian) {
        let weight = match component {
            None => state.weights()[CONSTANT_VELOCITY],
            Some(CONSTANT_VELOCITY) => 1.0,
            Some(_) => 0.0,
        };
        for axis in 6..6 + self.axes {
            of.covariance[at(axis, axis)] += weight * state.memory()[0];
        }
    }
}
