//! The measurement update of a group with all its candidates: (T8), (T14), (T20).
//!
//! Component by component. D = H P* Hᵀ + R is inverted by halves (two divisions), once for successive slots of the same errors:
//! ```text
//! D = [A B; Bᵀ C],  W = A⁻¹ B,  S = C − Bᵀ W:   D⁻¹ = [A⁻¹ + W S⁻¹ Wᵀ, −W S⁻¹; ·, S⁻¹],   |D| = |A| |S|
//! e_m = a_m (2π)^(−n/2) |D|^(−1/2) exp(−½ d_mᵀ y_m),   y_m = D⁻¹ d_m
//! L_j = b_j + Σ_m e_m,   w_m = e_m/L_j,   w_0 = b_j/L_j                                          (T20)
//! û = u* + B ȳ,   P̂ = P* + B [Σ_m w_m (y_m y_mᵀ − D⁻¹) − ȳ ȳᵀ] Bᵀ,   B = P* Hᵀ                  (T14)
//! W_j ∝ W*_j L_j                                                                                (T15)
//! ```
//! This is (T14) with the spread terms, rearranged so that a plot costs 4×4 work whatever the number of states, and P̂ is symmetric by
//! construction. The squares of y are summed about their mean so far, which begins at 0 with the weight of "none": a plot n standard
//! deviations from where the component expects it has y yᵀ n² times as large as D⁻¹, whose rounding would spoil what is left of P*.
//! R is evaluated at the component's predicted position (T6), so the order of plots cannot matter. A coordinate that was not measured gets
//! unit variance, no coupling and no innovation.
//! A lane whose D is not positive definite gets e_m = 0, a component without a positive finite L_j keeps its prediction.

use std::f64::consts::TAU;

use common::tracks::MODELS;
use pulp::{Simd, WithSimd};

use super::evidence::{Evidence, Slot};
use super::expect::Expectation;
use super::gaussian::at;
use super::group::{Component, ComponentMut, Group, for_known};
use super::lanes::{Lanes, Mask, Row, V, dot};
use super::machine::Machine;
use super::prior::{PACKED_4, Prior};
use crate::plots::measurement::COORDINATES;

/// What the scan was to the components of a group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Weights {
    /// L_j by component. Of certain plots, their densities over the largest of a component.
    pub likelihood: Vec<Row>,
    /// w_j0 by component.
    pub none: Vec<Row>,
    /// w_jm by slot, then component.
    pub plots: Vec<Row>,
}

impl Weights {
    /// Σ_j W_j w_jm in `lane`, W being those of `posterior`.
    pub fn of_plot(&self, m: usize, lane: usize, posterior: &Group) -> f64 {
        let components = posterior.layout().len();
        let by_component = self.plots[m * components..].iter().zip(posterior.weights());
        by_component.map(|(row, weight)| weight.0[lane] * row.0[lane]).sum()
    }

    /// Σ_j W_j w_j0 in `lane`.
    pub fn of_none(&self, lane: usize, posterior: &Group) -> f64 {
        self.none.iter().zip(posterior.weights()).map(|(row, weight)| weight.0[lane] * row.0[lane]).sum()
    }

    fn make_room(&mut self, components: usize, slots: usize) {
        self.likelihood.resize(components, Row::ZERO);
        self.none.resize(components, Row::ZERO);
        if self.plots.len() < components * slots {
            self.plots.resize(components * slots, Row::ZERO);
        }
    }
}

/// Densities of candidates under each component, by slot, then component.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Densities {
    /// N(0; 0, D_jm); 0 where D is not positive definite.
    peak: Vec<Row>,
    /// −½ dᵀ D⁻¹ d.
    exponent: Vec<Row>,
    components: usize,
}

impl Densities {
    /// ln N(y_m; h_j, D_jm) of slot `m` and component `j` in `lane`.
    pub fn ln(&self, m: usize, j: usize, lane: usize) -> f64 {
        let index = m * self.components + j;
        self.peak[index].0[lane].ln() + self.exponent[index].0[lane]
    }

    /// The densities of all candidates.
    pub fn evaluate(&mut self, machine: Machine, lanes: usize, prior: Prior<'_>, evidence: &Evidence) {
        self.components = prior.prediction.layout().len();
        let rows = self.components * evidence.slots();
        self.peak.resize(rows, Row::ZERO);
        self.exponent.resize(rows, Row::ZERO);
        machine.arch(lanes).dispatch(Evaluate { lanes, prior, evidence, densities: self });
    }
}

struct Evaluate<'a> {
    lanes: usize,
    prior: Prior<'a>,
    evidence: &'a Evidence,
    densities: &'a mut Densities,
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { prior, evidence, densities, .. } = self;
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            for j in 0..densities.components {
                for_known!(
                    prior.prediction.layout().known(j),
                    evaluate_component(lanes, j, prior, evidence, densities)
                );
            }
        }
    }
}

#[inline(always)]
fn evaluate_component<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    j: usize,
    prior: Prior<'_>,
    evidence: &Evidence,
    densities: &mut Densities,
) {
    let from = From::<N, P>::new(prior, j);
    let zero = lanes.splat(0.0);
    let mut likelihood = Likelihood { inverse: [zero; PACKED_4], peak: zero };
    for (m, slot) in evidence.in_use().iter().enumerate() {
        if !slot.as_before {
            likelihood = factor(lanes, from, slot, prior.inflation);
        }
        let d = innovation(lanes, from, slot);
        let y = solve(&likelihood.inverse, &d);
        let index = m * densities.components + j;
        lanes.put(&mut densities.peak[index], likelihood.peak);
        lanes.put(&mut densities.exponent[index], dot(&d, &y) * lanes.splat(-0.5));
    }
}

/// The posterior of every component by (T14), of their weights by (T15), and the memory of the prediction.
///
/// A lane whose posterior would not be sound (a number that is not finite, a negative variance) keeps its prediction.
pub fn absorb(
    machine: Machine,
    lanes: usize,
    prior: Prior<'_>,
    evidence: &Evidence,
    densities: &mut Densities,
    weights: &mut Weights,
    posterior: &mut Group,
) {
    let layout = *prior.prediction.layout();
    weights.make_room(layout.len(), evidence.slots());
    let memory = layout.memory_start()..layout.words();
    posterior.rows_mut()[memory.clone()].copy_from_slice(&prior.prediction.rows()[memory]);
    if evidence.decided {
        densities.evaluate(machine, lanes, prior, evidence);
    }
    let relative = relative_densities(lanes, evidence, densities);
    let mut sound = Row::ZERO;
    let (sound_row, relative) = (&mut sound, relative.as_ref());
    machine.arch(lanes).dispatch(Absorb { lanes, prior, evidence, relative, weights, posterior, sound: sound_row });
    for lane in (0..lanes).filter(|&lane| sound.0[lane] == 0.0) {
        posterior.copy_lane(lane, prior.prediction);
    }
}

/// Of certain plots: their densities by component over the largest, so that none of them underflows.
fn relative_densities(lanes: usize, evidence: &Evidence, densities: &Densities) -> Option<[Row; MODELS]> {
    if !evidence.decided {
        return None;
    }
    let mut relative = [Row::splat(1.0); MODELS];
    for lane in (0..lanes).filter(|&lane| evidence.count(lane) > 0) {
        let components = 0..densities.components;
        let largest = components.clone().map(|j| densities.ln(0, j, lane)).fold(f64::NEG_INFINITY, f64::max);
        for j in components {
            relative[j].0[lane] = if largest.is_finite() { (densities.ln(0, j, lane) - largest).exp() } else { 1.0 };
        }
    }
    Some(relative)
}

struct Absorb<'a> {
    lanes: usize,
    prior: Prior<'a>,
    evidence: &'a Evidence,
    relative: Option<&'a [Row; MODELS]>,
    weights: &'a mut Weights,
    posterior: &'a mut Group,
    /// 1 in the lanes whose posterior is sound, else 0.
    sound: &'a mut Row,
}

impl WithSimd for Absorb<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { prior, evidence, weights, posterior, .. } = self;
        let layout = *prior.prediction.layout();
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let mut worst = lanes.splat(1.0);
            for j in 0..layout.len() {
                let sound =
                    for_known!(layout.known(j), absorb_component(lanes, j, prior, evidence, weights, posterior));
                worst = worst.min(sound);
                if let Some(relative) = self.relative {
                    let candidate = lanes.splat(0.0).less(lanes.get(&evidence.first_gain()));
                    let row = &mut weights.likelihood[j];
                    let value = candidate.pick(lanes.get(&relative[j]), lanes.get(row));
                    lanes.put(row, value);
                }
            }
            reweight(lanes, prior.prediction, weights, posterior);
            lanes.put(self.sound, worst);
        }
    }
}

/// W_j ∝ W*_j L_j (T15); unchanged where no component explains anything.
#[inline(always)]
fn reweight<S: Simd>(lanes: Lanes<S>, prediction: &Group, weights: &Weights, posterior: &mut Group) {
    let (zero, components) = (lanes.splat(0.0), prediction.layout().len());
    let mut largest = zero;
    for likelihood in &weights.likelihood {
        largest = largest.max(lanes.get(likelihood));
    }
    let (mut after, mut total) = ([zero; MODELS], zero);
    for j in 0..components {
        let ratio = lanes.get(&weights.likelihood[j]) / largest;
        after[j] = (lanes.get(&prediction.rows()[j]) * ratio).rounded();
        total += after[j];
    }
    let explained = largest.is_positive().and(total.is_positive());
    for j in 0..components {
        let before = lanes.get(&prediction.rows()[j]);
        lanes.put(&mut posterior.rows_mut()[j], explained.pick(after[j] / total, before));
    }
}

/// What is known of a component before the scan.
#[derive(Clone, Copy)]
struct From<'a, const N: usize, const P: usize> {
    /// u*, P*.
    predicted: Component<'a, N, P>,
    /// h, P* H₄ᵀ.
    expected: &'a Expectation,
}

impl<'a, const N: usize, const P: usize> From<'a, N, P> {
    #[inline(always)]
    fn new(prior: Prior<'a>, j: usize) -> Self {
        Self { predicted: prior.prediction.component(j), expected: &prior.expected[j] }
    }
}

/// D⁻¹ and the density at its peak, of some lanes.
#[derive(Clone, Copy)]
struct Likelihood<S: Simd> {
    inverse: [V<S>; PACKED_4],
    peak: V<S>,
}

/// Posterior of component `j` in some lanes; its L_j, w_jm and w_j0 in `weights`. Returns 1 where it is sound, else 0.
#[inline(always)]
fn absorb_component<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    j: usize,
    prior: Prior<'_>,
    evidence: &Evidence,
    weights: &mut Weights,
    posterior: &mut Group,
) -> V<S> {
    let (from, components) = (From::<N, P>::new(prior, j), prior.prediction.layout().len());
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let none = lanes.get(&evidence.none[j]);
    let mut total = none;
    let mut mean = [zero; COORDINATES];
    let mut spread = [zero; PACKED_4];
    let mut likelihood = Likelihood { inverse: [zero; PACKED_4], peak: zero };
    // Weight of the successive slots that share D.
    let mut sharing = zero;
    for (m, slot) in evidence.in_use().iter().enumerate() {
        if !slot.as_before {
            for k in 0..PACKED_4 {
                spread[k] -= sharing * likelihood.inverse[k];
            }
            sharing = zero;
            likelihood = factor(lanes, from, slot, prior.inflation);
        }
        let d = innovation(lanes, from, slot);
        let y = solve(&likelihood.inverse, &d);
        let gain = lanes.get(&slot.gain);
        let e = if evidence.decided {
            zero.less(likelihood.peak).and(zero.less(gain)).pick(one, zero)
        } else {
            let exponent = (dot(&d, &y) * lanes.splat(-0.5)).rounded();
            (likelihood.peak * exponent.exp() * gain).rounded()
        };
        lanes.put(&mut weights.plots[m * components + j], e);
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
    for m in 0..evidence.slots() {
        let row = &mut weights.plots[m * components + j];
        let weight = (lanes.get(row) * scale).rounded();
        lanes.put(row, sound.pick(weight, zero));
    }
    for y in &mut mean {
        *y = sound.pick(*y, zero);
    }
    for k in 0..PACKED_4 {
        spread[k] = sound.pick((spread[k] - sharing * likelihood.inverse[k]) * scale, zero);
    }
    correct(lanes, from, &mean, &spread, &mut posterior.component_mut(j))
}

/// D⁻¹ and the peak of N(·; 0, D) for the plots of `slot`.
#[inline(always)]
fn factor<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: From<'_, N, P>,
    slot: &Slot,
    inflation: f64,
) -> Likelihood<S> {
    let From { predicted, expected } = from;
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
    from: From<'_, N, P>,
    slot: &Slot,
) -> [V<S>; COORDINATES] {
    let From { predicted, expected } = from;
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

/// û = u* + B ȳ, P̂ = P* + B M Bᵀ. Returns 1 where every number is finite and no variance negative, else 0.
#[inline(always)]
fn correct<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: From<'_, N, P>,
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
    from: From<'_, N, P>,
    i: usize,
) -> [V<S>; COORDINATES] {
    let From { predicted, expected } = from;
    let p = &predicted.covariance;
    [lanes.get(&p[at(i, 0)]), lanes.get(&p[at(i, 1)]), lanes.get(&p[at(i, 2)]), lanes.get(&expected.cross[i])]
}
