//! One coordinate of a group: what the plots of a scan say of it, and where it stands in the component that all others see.

use common::tracks::STATE;
use pulp::Simd;

use crate::filter::absorb::Weights;
use crate::filter::evidence::Evidence;
use crate::filter::expect::Expectation;
use crate::filter::gaussian::{Gaussian, at};
use crate::filter::group::Group;
use crate::filter::lanes::{Lanes, V};

/// Elements of the packed covariance of the component.
pub(super) const PACKED: usize = crate::filter::gaussian::packed(STATE);
/// Which derivative each of [w v m] is in the component.
const ORDER: [usize; 3] = [2, 1, 0];

/// The plots of a scan along one coordinate.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a, S: Simd> {
    pub(super) lanes: Lanes<S>,
    pub(super) axis: usize,
    pub(super) expected: &'a Expectation,
    pub(super) evidence: &'a Evidence,
    pub(super) weights: &'a Weights,
}

/// One plot along one coordinate.
#[derive(Clone, Copy)]
pub(super) struct Mark<S: Simd> {
    /// Its weight; 0 where it says nothing of the coordinate.
    pub(super) weight: V<S>,
    /// m.
    pub(super) position: V<S>,
    /// After the prediction, s, and half of its square.
    pub(super) offset: [V<S>; 2],
    /// m².
    pub(super) variance: V<S>,
}

impl<S: Simd> Mark<S> {
    /// z − m of a state [a v m] at the plot's time.
    #[inline(always)]
    pub(super) fn innovation(&self, [a, v, m]: [V<S>; 3]) -> V<S> {
        self.position - m - self.offset[0] * v - self.offset[1] * a
    }
}

impl<S: Simd> Sight<'_, S> {
    /// Number of plots of the lane that has most.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.evidence.slots()
    }

    /// Plot `m`.
    #[inline(always)]
    pub(super) fn mark(&self, m: usize) -> Mark<S> {
        let Self { lanes, axis, expected, evidence, weights } = *self;
        let (slot, zero) = (&evidence.in_use()[m], lanes.splat(0.0));
        let e_beta = if axis < 2 { lanes.get(&expected.along_azimuth[axis]) } else { zero };
        let e = [lanes.get(&expected.radial[axis]), e_beta, lanes.get(&expected.along_elevation[axis])];
        let [r, beta, epsilon, _] = lanes.all(&slot.variance);
        let scales = [
            r,
            (beta * lanes.get(&expected.square[0])).rounded(),
            (epsilon * lanes.get(&expected.square[1])).rounded(),
        ];
        let mut variance = zero;
        for k in 0..3 {
            variance += scales[k] * e[k] * e[k];
        }
        let mut weight = lanes.get(&weights.plots[m]);
        if axis == 2 {
            weight = (weight * lanes.get(&slot.measured[0])).rounded();
        }
        let offset = lanes.get(&slot.offset_s);
        Mark {
            weight: zero.less(variance).pick(weight, zero),
            position: lanes.get(&slot.position[axis]),
            offset: [offset, (offset * offset * lanes.splat(0.5)).rounded()],
            variance: zero.less(variance).pick(variance, lanes.splat(1.0)),
        }
    }

    /// What all plots together make of P and of the gain c = P* [0 0 1]ᵀ, for a state [a v m] that all hypotheses share on the average:
    /// ```text
    /// P̂ = P* + c cᵀ { Σ_m w_m [(y_m − ȳ)² − 1/S_m] + w_0 ȳ² },   y_m = d_m/S_m,   ȳ = Σ_m w_m y_m
    /// ```
    #[inline(always)]
    pub(super) fn correct(&self, p: &[V<S>; 6], mean: [V<S>; 3]) -> [V<S>; 6] {
        let zero = self.lanes.splat(0.0);
        let (mut none, mut average, mut gain) = (self.lanes.splat(1.0), zero, zero);
        for m in 0..self.len() {
            let mark = self.mark(m);
            let inverse = (p[5] + mark.variance).inverse();
            none = none - mark.weight;
            gain -= mark.weight * inverse;
            average += mark.weight * mark.innovation(mean) * inverse;
        }
        for m in 0..self.len() {
            let mark = self.mark(m);
            let apart = mark.innovation(mean) / (p[5] + mark.variance) - average;
            gain += mark.weight * apart * apart;
        }
        gain += none.max(zero) * average * average;
        let c = [p[3], p[4], p[5]];
        let mut out = *p;
        for b in 0..3 {
            for a in 0..=b {
                out[at(a, b)] += c[a] * c[b] * gain;
            }
        }
        out
    }

    /// [w v m] of a hypothesis after all plots, and Σ_m w_m ln N(d_m; 0, S_m) but for what all hypotheses share.
    #[inline(always)]
    pub(super) fn update(&self, p: &[V<S>; 6], state: [V<S>; 3], acceleration: V<S>) -> ([V<S>; 3], V<S>) {
        let [w, v, m] = state;
        let (mut moved, mut score) = (self.lanes.splat(0.0), self.lanes.splat(0.0));
        for index in 0..self.len() {
            let mark = self.mark(index);
            let d = mark.innovation([acceleration, v, m]);
            let y = d / (p[5] + mark.variance);
            moved += mark.weight * y;
            score -= mark.weight * self.lanes.splat(0.5) * d * y;
        }
        ([w + p[3] * moved, v + p[4] * moved, m + p[5] * moved], score)
    }

    /// Mean of d²/S over the plots, for a state [a v m].
    #[inline(always)]
    pub(super) fn square(&self, p: &[V<S>; 6], state: [V<S>; 3]) -> V<S> {
        let zero = self.lanes.splat(0.0);
        let (mut sum, mut total) = (zero, zero);
        for index in 0..self.len() {
            let mark = self.mark(index);
            let d = mark.innovation(state);
            sum += mark.weight * d * (d / (p[5] + mark.variance));
            total += mark.weight;
        }
        zero.less(total).pick(sum / total, zero)
    }

    /// 1 where the scan has shown the target along the coordinate, else 0.
    #[inline(always)]
    pub(super) fn shown(&self) -> V<S> {
        let zero = self.lanes.splat(0.0);
        let mut sum = zero;
        for m in 0..self.len() {
            sum += self.mark(m).weight;
        }
        self.lanes.splat(0.5).less(sum).pick(self.lanes.splat(1.0), zero)
    }
}

/// Mean [a v m] and covariance of a coordinate into the component of a group.
#[inline(always)]
pub(super) fn put<S: Simd>(lanes: Lanes<S>, axis: usize, mean: &[V<S>; 3], p: &[V<S>; 6], group: &mut Group) {
    let out = group.component_mut::<STATE, PACKED>(0);
    for b in 0..3 {
        let j = 3 * ORDER[b] + axis;
        lanes.put(&mut out.mean[j], mean[b]);
        for a in 0..=b {
            lanes.put(&mut out.covariance[at(3 * ORDER[a] + axis, j)], p[at(a, b)]);
        }
    }
}

/// Writes the start of a coordinate, with an acceleration of 0 and this variance, into the component of a state. Returns its covariance of
/// [a v m], packed.
pub(super) fn start_component(from: &Gaussian, axis: usize, acceleration: f64, state: &mut [f64]) -> [f64; 6] {
    let (m, v) = (axis, 3 + axis);
    let p = [acceleration, 0.0, from.covariance[at(v, v)], 0.0, from.covariance[at(m, v)], from.covariance[at(m, m)]];
    let (mean, covariance) = state[1..].split_at_mut(STATE);
    (mean[v], mean[m]) = (from.mean[v], from.mean[m]);
    for b in 0..3 {
        for a in 0..=b {
            covariance[at(3 * ORDER[a] + axis, 3 * ORDER[b] + axis)] = p[at(a, b)];
        }
    }
    p
}

/// Zeroes what couples coordinates in the component, and the coordinates from `axes` on.
#[inline(always)]
pub(super) fn clear<S: Simd>(lanes: Lanes<S>, axes: usize, group: &mut Group) {
    let (zero, out) = (lanes.splat(0.0), group.component_mut::<STATE, PACKED>(0));
    for j in 0..STATE {
        if j % 3 >= axes {
            lanes.put(&mut out.mean[j], zero);
        }
        for i in 0..=j {
            if i % 3 != j % 3 || j % 3 >= axes {
                lanes.put(&mut out.covariance[at(i, j)], zero);
            }
        }
    }
}
