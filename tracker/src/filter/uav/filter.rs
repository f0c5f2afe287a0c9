//! The drone filter as a family.

use common::tracks::{ESTIMATOR_IMM_UAV, Models};

use super::modes::{CONSTANT_VELOCITY, DIMENSIONS, HOVER, KINDS, LAYOUT, MANOEUVRE, MODES, Uav};
use super::predict;
use crate::filter::gaussian::{Gaussian, at, packed};
use crate::filter::group::Group;
use crate::filter::lanes::Row;
use crate::filter::layout::Layout;
use crate::filter::machine::Machine;
use crate::filter::mixture::Mixture;
use crate::filter::propagate::Noise;
use crate::filter::seam::Filter;
use crate::filter::start::Origin;

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
    fn start(&self, from: &dyn Origin, state: &mut [f64]) {
        state[..MODES].copy_from_slice(&self.start_probability);
        for (mode, &n) in DIMENSIONS.iter().enumerate() {
            let noise = Noise { amplitude: self.noise[mode], axes: self.axes };
            let gaussian = if mode == HOVER { from.resting() } else { from.moving(noise) };
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
