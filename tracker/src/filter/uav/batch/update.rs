//! The update of a block with all its candidates: (T8), (T14), (T20).
//!
//! As [`crate::filter::uav::update`], mode by mode. D = H P* Hᵀ + R is inverted by halves (two divisions), once for successive
//! slots of the same errors:
//! ```text
//! D = [A B; Bᵀ C],  W = A⁻¹ B,  S = C − Bᵀ W:   D⁻¹ = [A⁻¹ + W S⁻¹ Wᵀ, −W S⁻¹; ·, S⁻¹],   |D| = |A| |S|
//! e_m = a_m (2π)^(−n/2) |D|^(−1/2) exp(−½ d_mᵀ y_m),   y_m = D⁻¹ d_m
//! L_j = b_j + Σ_m e_m,   w_m = e_m/L_j,   w_0 = b_j/L_j                                          (T20)
//! û = u* + B ȳ,   P̂ = P* + B [Σ_m w_m (y_m y_mᵀ − D⁻¹) − ȳ ȳᵀ] Bᵀ,   B = P* Hᵀ                  (T14)
//! ```
//! The squares of y are summed about their mean so far, which begins at 0 with the weight of "none".
//! A lane whose D is not positive definite gets e_m = 0, a mode without a positive finite L_j keeps its prediction.

use std::f64::consts::TAU;

use pulp::Simd;

use crate::filter::gaussian::at;
use crate::filter::uav::motion::MODES;
use crate::plots::measurement::{COORDINATES, PACKED_4};

use super::block::Mode;
use super::candidates::{Candidates, Slot};
use super::expect::Expectation;
use super::lanes::{Lanes, Mask, Row, V, dot};

/// What the scan was to one mode, or to the whole block.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Weights {
    /// L_j by mode.
    pub likelihood: [Row; MODES],
    /// w_j0 by mode.
    pub none: [Row; MODES],
    /// w_jm by slot, then mode.
    pub plots: Vec<[Row; MODES]>,
}

/// What is known of a mode before the scan.
#[derive(Clone, Copy)]
pub(super) struct Prior<'a, const N: usize, const P: usize> {
    /// u*, P*.
    pub(super) predicted: &'a Mode<N, P>,
    /// h, P* H₄ᵀ.
    pub(super) expected: &'a Expectation<N>,
}

/// D⁻¹ and the density at its peak, of some lanes.
#[derive(Clone, Copy)]
struct Likelihood<S: Simd> {
    inverse: [V<S>; PACKED_4],
    peak: V<S>,
}

/// Posterior of mode `j` in some lanes; its L_j, w_jm and w_j0 in `weights`.
#[inline(always)]
pub(super) fn update<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    j: usize,
    prior: Prior<'_, N, P>,
    candidates: &Candidates,
    inflation: f64,
    weights: &mut Weights,
    posterior: &mut Mode<N, P>,
) {
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let none = lanes.get(&candidates.none[j]);
    let mut total = none;
    let mut mean = [zero; COORDINATES];
    let mut spread = [zero; PACKED_4];
    let mut likelihood = Likelihood { inverse: [zero; PACKED_4], peak: zero };
    // Weight of the successive slots that share D.
    let mut sharing = zero;
    for (m, slot) in candidates.in_use().iter().enumerate() {
        if !slot.as_before {
            for k in 0..PACKED_4 {
                spread[k] -= sharing * likelihood.inverse[k];
            }
            sharing = zero;
            likelihood = factor(lanes, prior, slot, inflation);
        }
        let d = innovation(lanes, prior, slot);
        let y = solve(&likelihood.inverse, &d);
        let exponent = (dot(&d, &y) * lanes.splat(-0.5)).rounded();
        let e = (likelihood.peak * exponent.exp() * lanes.get(&slot.gain)).rounded();
        lanes.put(&mut weights.plots[m][j], e);
        sharing += e;
        let before = total;
        total += e;
        let share = zero.less(total).pick(e / total, zero);
        let mut apart = [zero; COORDINATES];
        for b in 0..COORDINATES {
            apart[b] = y[b] - mean[b];
            let step = (share * apart[b]).rounded();
            mean[b] += step;
            let scaled = (before * step).rounded();
            for a in 0..=b {
                spread[at(a, b)] += scaled * apart[a];
            }
        }
    }

    let sound = total.is_positive();
    let scale = sound.pick(total.inverse(), zero);
    lanes.put(&mut weights.likelihood[j], sound.pick(total, none));
    lanes.put(&mut weights.none[j], sound.pick(none * scale, one));
    for rows in &mut weights.plots[..candidates.slots()] {
        let weight = (lanes.get(&rows[j]) * scale).rounded();
        lanes.put(&mut rows[j], sound.pick(weight, zero));
    }
    for y in &mut mean {
        *y = sound.pick(*y, zero);
    }
    for k in 0..PACKED_4 {
        spread[k] = sound.pick((spread[k] - sharing * likelihood.inverse[k]) * scale, zero);
    }
    correct(lanes, prior, &mean, &spread, posterior);
}

/// D⁻¹ and the peak of N(·; 0, D) for the plots of `slot`.
#[inline(always)]
fn factor<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    prior: Prior<'_, N, P>,
    slot: &Slot,
    inflation: f64,
) -> Likelihood<S> {
    let Prior { predicted, expected } = prior;
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
fn innovation<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    prior: Prior<'_, N, P>,
    slot: &Slot,
) -> [V<S>; COORDINATES] {
    let Prior { predicted, expected } = prior;
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
fn solve<S: Simd>(s: &[V<S>; PACKED_4], d: &[V<S>; COORDINATES]) -> [V<S>; COORDINATES] {
    let mut y = *d;
    for i in 0..COORDINATES {
        y[i] = dot(&[s[at(i, 0)], s[at(i, 1)], s[at(i, 2)], s[at(i, 3)]], d);
    }
    y
}

/// û = u* + B ȳ, P̂ = P* + B M Bᵀ.
#[inline(always)]
fn correct<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    prior: Prior<'_, N, P>,
    y: &[V<S>; COORDINATES],
    spread: &[V<S>; PACKED_4],
    posterior: &mut Mode<N, P>,
) {
    let predicted = prior.predicted;
    for j in 0..N {
        let row = cross_row(lanes, prior, j);
        lanes.put(&mut posterior.mean[j], lanes.get(&predicted.mean[j]) + dot(&row, y));
        let moved = solve(spread, &row);
        for i in 0..=j {
            let k = at(i, j);
            let other = cross_row(lanes, prior, i);
            lanes.put(&mut posterior.covariance[k], lanes.get(&predicted.covariance[k]) + dot(&other, &moved));
        }
    }
}

/// Row i of B = P* Hᵀ.
#[inline(always)]
fn cross_row<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    prior: Prior<'_, N, P>,
    i: usize,
) -> [V<S>; COORDINATES] {
    let Prior { predicted, expected } = prior;
    let p = &predicted.covariance;
    [lanes.get(&p[at(i, 0)]), lanes.get(&p[at(i, 1)]), lanes.get(&p[at(i, 2)]), lanes.get(&expected.cross[i])]
}
