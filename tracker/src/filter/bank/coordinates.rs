//! Prediction and update coordinate by coordinate, around what a filter does with one.

use pulp::{Simd, WithSimd};

use super::axis::{Sight, clear};
use crate::filter::absorb::{Weights, absorb};
use crate::filter::evidence::Evidence;
use crate::filter::expect::Expectation;
use crate::filter::group::Group;
use crate::filter::lanes::{Lanes, Row, V};
use crate::filter::machine::Machine;
use crate::filter::prior::Prior;
use crate::filter::seam::{Filter, Update};

/// A filter whose coordinates are filtered apart and stand in one component for everyone else.
pub(super) trait ByCoordinate: Filter {
    /// Coordinates that it filters: 3, or 2 for a radar without elevation.
    fn axes(&self) -> usize;

    /// Predicts every coordinate of some lanes over `step`, s. The memory still is that of the posterior.
    fn predict_lanes<S: Simd>(&self, lanes: Lanes<S>, step: V<S>, posterior: &Group, prediction: &mut Group);

    /// Updates one coordinate of some lanes by the plots of a scan.
    fn update_axis<S: Simd>(&self, sight: Sight<'_, S>, prediction: &Group, posterior: &mut Group);
}

/// [`Filter::predict`] of such a filter.
pub(super) fn predict(
    filter: &impl ByCoordinate,
    machine: Machine,
    lanes: usize,
    posterior: &Group,
    step_s: &Row,
    prediction: &mut Group,
) {
    let memory = filter.layout().memory_start()..filter.layout().words();
    prediction.rows_mut()[memory.clone()].copy_from_slice(&posterior.rows()[memory]);
    machine.arch(lanes).dispatch(Predict { lanes, filter, posterior, step_s, prediction });
}

/// [`Filter::update`] of such a filter: the weights of the plots are those of the component. A lane that it does not leave sound keeps its
/// prediction.
pub(super) fn update(
    filter: &impl ByCoordinate,
    machine: Machine,
    lanes: usize,
    prior: Prior<'_>,
    evidence: &Evidence,
    update: &mut Update,
) {
    let Update { posterior, weights, densities } = update;
    absorb(machine, lanes, prior, evidence, densities, weights, posterior);
    let [expected] = prior.expected else { unreachable!("one component expects one measurement") };
    let prediction = prior.prediction;
    machine.arch(lanes).dispatch(Take { lanes, filter, expected, evidence, weights, prediction, posterior });
    let sound = posterior.soundness(machine, lanes);
    for lane in (0..lanes).filter(|&lane| sound.0[lane] == 0.0) {
        posterior.copy_lane(lane, prediction);
    }
}

struct Predict<'a, F> {
    lanes: usize,
    filter: &'a F,
    posterior: &'a Group,
    step_s: &'a Row,
    prediction: &'a mut Group,
}

impl<F: ByCoordinate> WithSimd for Predict<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { filter, posterior, step_s, prediction, .. } = self;
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            lanes.put(&mut prediction.rows_mut()[0], lanes.splat(1.0));
            clear(lanes, filter.axes(), prediction);
            filter.predict_lanes(lanes, lanes.get(step_s), posterior, prediction);
        }
    }
}

struct Take<'a, F> {
    lanes: usize,
    filter: &'a F,
    expected: &'a Expectation,
    evidence: &'a Evidence,
    weights: &'a Weights,
    prediction: &'a Group,
    posterior: &'a mut Group,
}

impl<F: ByCoordinate> WithSimd for Take<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { filter, expected, evidence, weights, prediction, posterior, .. } = self;
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            clear(lanes, filter.axes(), posterior);
            for axis in 0..filter.axes() {
                filter.update_axis(Sight { lanes, axis, expected, evidence, weights }, prediction, posterior);
            }
        }
    }
}
