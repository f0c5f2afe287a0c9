//! A single Kalman filter of near-constant velocity, in two or three dimensions.

use common::tracks::{ESTIMATOR_CV, KIND_CONSTANT_VELOCITY, Models};
use pulp::{Simd, WithSimd};

use super::gaussian::{at, packed};
use super::group::{Component, Group};
use super::lanes::{Lanes, Row, V};
use super::layout::Layout;
use super::machine::Machine;
use super::mixture::Mixture;
use super::propagate::{Before, Noise, propagate};
use super::seam::Filter;
use super::start::Origin;

/// States that it knows: position and velocity.
const KNOWN: usize = 6;
const PACKED: usize = packed(KNOWN);
/// The form of its states.
pub const LAYOUT: Layout = Layout::new(&[KNOWN], 0, 0, 0);

/// The filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVelocity {
    noise: Noise,
}

impl ConstantVelocity {
    /// With white acceleration of `noise_mps2` over each step, in `axes` dimensions.
    pub fn new(noise_mps2: f64, axes: usize) -> Self {
        Self { noise: Noise { amplitude: noise_mps2, axes } }
    }
}

impl Filter for ConstantVelocity {
    fn layout(&self) -> &Layout {
        &LAYOUT
    }

    fn estimator(&self) -> u16 {
        ESTIMATOR_CV
    }

    fn greatest_acceleration_mps2(&self) -> f64 {
        self.noise.amplitude
    }

    fn start(&self, from: &dyn Origin, state: &mut [f64]) {
        let gaussian = from.moving(self.noise);
        state[0] = 1.0;
        state[1..=KNOWN].copy_from_slice(&gaussian.mean[..KNOWN]);
        state[1 + KNOWN..][..PACKED].copy_from_slice(&gaussian.covariance[..PACKED]);
    }

    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group) {
        machine.arch(lanes).dispatch(Predict { lanes, noise: self.noise, posterior, step_s, prediction });
    }

    fn models(&self, _state: Mixture<'_>) -> Models {
        let mut models = Models::default();
        models.push(KIND_CONSTANT_VELOCITY, 1.0, 0.0);
        models
    }
}

struct Predict<'a> {
    lanes: usize,
    noise: Noise,
    posterior: &'a Group,
    step_s: &'a Row,
    prediction: &'a mut Group,
}

impl WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { noise, posterior, step_s, prediction, .. } = self;
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let before = State { lanes, component: posterior.component(0) };
            propagate(lanes, &before, noise, lanes.get(step_s), &mut prediction.component_mut::<KNOWN, PACKED>(0));
            lanes.put(&mut prediction.rows_mut()[0], lanes.splat(1.0));
        }
    }
}

/// The state of some lanes.
struct State<'a, S: Simd> {
    lanes: Lanes<S>,
    component: Component<'a, KNOWN, PACKED>,
}

impl<S: Simd> Before<S> for State<'_, S> {
    #[inline(always)]
    fn mean(&self, i: usize) -> V<S> {
        self.lanes.get(&self.component.mean[i])
    }

    #[inline(always)]
    fn covariance(&self, row: usize, column: usize) -> V<S> {
        self.lanes.get(&self.component.covariance[at(row, column)])
    }
}
