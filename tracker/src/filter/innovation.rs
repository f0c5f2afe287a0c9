//! The innovation of a component at a plot: d and its covariance D, D⁻¹ with the density at its peak, and the correction by them.
//! The formulas are at the head of [`super::absorb`].

use std::f64::consts::TAU;

use pulp::Simd;

use super::evidence::Slot;
use super::expect::Expectation;
use super::gaussian::at;
use super::group::{Component, ComponentMut};
use super::lanes::{Lanes, Mask, Row, V, dot};
use super::prior::{PACKED_4, Prior};
use crate::plots::measurement::COORDINATES;

/// What is known of a component before the scan.
#[derive(Clone, Copy)]
pub(super) struct Predicted<'a, const N: usize, const P: usize> {
    /// u*, P*.
    pub(super) predicted: Component<'a, N, P>,
    /// h, P* H₄ᵀ.
    pub(super) expected: &'a Expectation,
}

impl<'a, const N: usize, const P: usize> Predicted<'a, N, P> {
    #[inline(always)]
    pub(super) fn new(prior: Prior<'a>, j: usize) -> Self {
        Self { predicted: prior.prediction.component(j), expected: &prior.expected[j] }
    }
}

/// D⁻¹ and the density at its peak, of some lanes.
#[derive(Clone, Copy)]
pub(super) struct Likelihood<S: Simd> {
    pub(super) inverse: [V<S>; PACKED_4],
    pub(super) peak: V<S>,
}

/// D⁻¹ and the peak of N(·; 0, D) for the plots of `slot`.
#[inline(always)]
pub(super) fn factor<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: Predicted<'_, N, P>,
    slot: &Slot,
    inflation: f64,
) -> Likelihood<S> {
    let Predicted { predicted, expected } = from;
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let mut d = [zero; PACKED_4];
    for k in 0..6 {
        d[k] = lanes.get(&predicted.covariance[k]);
    }
    // R of (T6).
    let variance = lanes.all(&slot.variance);
    let scales = [
        variance[0],
        (variance[1] * lanes.get(&expected.square[0])).rounded(),
        (variance[2] * lanes.get(&expected.square[1])).rounded(),
    ];
    let [sine, cosine] = lanes.all(&expected.along_azimuth);
    let axes = [lanes.all(&expected.radial), [sine, cosine, zero], lanes.all(&expected.along_elevation)];
    for axis in 0..3 {
        // The azimuth's direction is level.
        for b in 0..if axis == 1 { 2 } else { 3 } {
            let scaled = (scales[axis] * axes[axis][b]).rounded();
            for a in 0..=b {
                d[at(a, b)] += scaled * axes[axis][a];
            }
        }
    }
    for i in 0..3 {
        d[at(i, 3)] = lanes.get(&expected.cross[i]);
    }
    d[9] = lanes.splat(1.0 + inflation) * lanes.get(&expected.variance[3]) + variance[3];
    let measured = [is_set(lanes, &slot.measured[0]), is_set(lanes, &slot.measured[1])];
    if !slot.complete {
        for (index, measured) in [(2, measured[0]), (3, measured[1])] {
            for other in 0..COORDINATES {
                d[at(index, other)] = measured.pick(d[at(index, other)], if index == other { one } else { zero });
            }
        }
    }
    let mut likelihood = invert(lanes, &d);
    if !slot.complete {
        let root_tau = lanes.splat(TAU.sqrt());
        for (index, measured) in [(2, measured[0]), (3, measured[1])] {
            likelihood.inverse[at(index, index)] = measured.pick(likelihood.inverse[at(index, index)], zero);
            likelihood.peak = measured.pick(likelihood.peak, likelihood.peak * root_tau);
        }
    }
    likelihood
}

#[inline(always)]
fn is_set<S: Simd>(lanes: Lanes<S>, row: &Row) -> Mask<S> {
    lanes.splat(0.5).less(lanes.get(row))
}

/// D⁻¹ and (2π)⁻² |D|^(−1/2), by halves; both 0 where D is not positive definite.
#[inline(always)]
fn invert<S: Simd>(lanes: Lanes<S>, d: &[V<S>; PACKED_4]) -> Likelihood<S> {
    let zero = lanes.splat(0.0);
    let [a_00, a_01, a_11, ..] = *d;
    let (a, a_determinant) = invert_half([a_00, a_01, a_11]);
    // W = A⁻¹ B by rows; B is [d₃ d₆; d₄ d₇].
    let b = [[d[3], d[6]], [d[4], d[7]]];
    let mut w = [[zero; 2]; 2];
    for j in 0..2 {
        w[0][j] = a[0] * b[0][j] + a[1] * b[1][j];
        w[1][j] = a[1] * b[0][j] + a[2] * b[1][j];
    }
    let schur = [
        d[5] - b[0][0] * w[0][0] - b[1][0] * w[1][0],
        d[8] - b[0][0] * w[0][1] - b[1][0] * w[1][1],
        d[9] - b[0][1] * w[0][1] - b[1][1] * w[1][1],
    ];
    let (s, s_determinant) = invert_half(schur);
    let root = (a_determinant * s_determinant).rounded().sqrt();
    let sound = a_00.is_positive().and(a_determinant.is_positive()).and(schur[0].is_positive());
    let sound = sound.and(s_determinant.is_positive()).and(root.is_positive());
    // V = W S⁻¹ by rows.
    let mut v = [[zero; 2]; 2];
    for i in 0..2 {
        v[i][0] = w[i][0] * s[0] + w[i][1] * s[1];
        v[i][1] = w[i][0] * s[1] + w[i][1] * s[2];
    }
    let mut inverse = [
        a[0] + v[0][0] * w[0][0] + v[0][1] * w[0][1],
        a[1] + v[0][0] * w[1][0] + v[0][1] * w[1][1],
        a[2] + v[1][0] * w[1][0] + v[1][1] * w[1][1],
        -v[0][0],
        -v[1][0],
        s[0],
        -v[0][1],
        -v[1][1],
        s[1],
        s[2],
    ];
    for element in &mut inverse {
        *element = sound.pick(*element, zero);
    }
    Likelihood { inverse, peak: sound.pick((root * lanes.splat(TAU * TAU)).rounded().inverse(), zero) }
}

/// Inverse and determinant of [a b; b c].
#[inline(always)]
fn invert_half<S: Simd>([a, b, c]: [V<S>; 3]) -> ([V<S>; 3], V<S>) {
    let determinant = a * c - b * b;
    let scale = determinant.inverse();
    ([(c * scale).rounded(), -(b * scale).rounded(), (a * scale).rounded()], determinant)
}

/// d = y − h(u*), h moved to the plot's time; 0 where not measured.
#[inline(always)]
pub(super) fn innovation<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: Predicted<'_, N, P>,
    slot: &Slot,
) -> [V<S>; COORDINATES] {
    let Predicted { predicted, expected } = from;
    let mut d = [lanes.splat(0.0); COORDINATES];
    let offset = lanes.get(&slot.offset_s);
    let half_square = (offset * offset * lanes.splat(0.5)).rounded();
    for i in 0..3 {
        let mut place = lanes.get(&predicted.mean[i]);
        if N > 3 {
            place += lanes.get(&predicted.mean[3 + i]) * offset;
        }
        if N > 6 {
            place += lanes.get(&predicted.mean[6 + i]) * half_square;
        }
        d[i] = lanes.get(&slot.position[i]) - place;
    }
    let range_rate = lanes.get(&expected.centre[3]) + lanes.get(&expected.drift[3]) * offset;
    d[3] = lanes.get(&slot.range_rate) - range_rate;
    if !slot.complete {
        let zero = lanes.splat(0.0);
        for i in 0..2 {
            d[2 + i] = is_set(lanes, &slot.measured[i]).pick(d[2 + i], zero);
        }
    }
    d
}

/// s · d of a packed 4×4 matrix.
#[inline(always)]
pub(super) fn solve<S: Simd>(s: &[V<S>; PACKED_4], d: &[V<S>; COORDINATES]) -> [V<S>; COORDINATES] {
    let mut y = *d;
    for i in 0..COORDINATES {
        y[i] = dot(&[s[at(i, 0)], s[at(i, 1)], s[at(i, 2)], s[at(i, 3)]], d);
    }
    y
}

/// û = u* + B ȳ, P̂ = P* + B M Bᵀ. Returns 1 where every number is finite and no variance negative, else 0.
#[inline(always)]
pub(super) fn correct<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: Predicted<'_, N, P>,
    y: &[V<S>; COORDINATES],
    spread: &[V<S>; PACKED_4],
    posterior: &mut ComponentMut<'_, N, P>,
) -> V<S> {
    let predicted = from.predicted;
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    // x · 0 is NaN where x is not finite.
    let (mut nothing, mut least) = (zero, one);
    for j in 0..N {
        let row = cross_row(lanes, from, j);
        let mean = lanes.get(&predicted.mean[j]) + dot(&row, y);
        nothing += mean * zero;
        lanes.put(&mut posterior.mean[j], mean);
        let moved = solve(spread, &row);
        for i in 0..=j {
            let k = at(i, j);
            let other = cross_row(lanes, from, i);
            let covariance = lanes.get(&predicted.covariance[k]) + dot(&other, &moved);
            nothing += covariance * zero;
            if i == j {
                least = least.min(covariance);
            }
            lanes.put(&mut posterior.covariance[k], covariance);
        }
    }
    nothing.less(one).and((-least).less(lanes.splat(f64::MIN_POSITIVE))).pick(one, zero)
}

/// Row i of B = P* Hᵀ.
#[inline(always)]
fn cross_row<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: Predicted<'_, N, P>,
    i: usize,
) -> [V<S>; COORDINATES] {
    let Predicted { predicted, expected } = from;
    let p = &predicted.covariance;
    [lanes.get(&p[at(i, 0)]), lanes.get(&p[at(i, 1)]), lanes.get(&p[at(i, 2)]), lanes.get(&expected.cross[i])]
}
