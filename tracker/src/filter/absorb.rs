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

use common::tracks::MODELS;
use pulp::{Simd, WithSimd};

use super::evidence::Evidence;
use super::gaussian::at;
use super::group::{Group, for_known};
use super::innovation::{Likelihood, Predicted, correct, factor, innovation, solve};
use super::lanes::{Lanes, Row, V, dot};
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
    /// With room for so many components of candidates from the start.
    pub fn with_room(rows: usize) -> Self {
        Self { peak: Vec::with_capacity(rows), exponent: Vec::with_capacity(rows), components: 0 }
    }

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
    let from = Predicted::<N, P>::new(prior, j);
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
    let (from, components) = (Predicted::<N, P>::new(prior, j), prior.prediction.layout().len());
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
