//! The measurement update of all modes with all candidates (T8), (T14)-(T16).
//!
//! With B = P* Hᵀ, d_m = y_m − h(u*), y_m = D_m⁻¹ d_m, the moments of the mixture over
//! "none" and every plot are
//! ```text
//! û = u* + B ȳ,   ȳ = Σ_m w_m y_m                                                (T14)
//! P̂ = P* + B M Bᵀ,   M = Σ_m w_m (y_m y_mᵀ − D_m⁻¹) − ȳ ȳᵀ
//! W_j ∝ W*_j L_j                                                                  (T15)
//! ```
//! This is (T14) with the spread terms, rearranged so that a plot costs 4×4 work whatever the
//! number of states, and P̂ is symmetric by construction. The squares of y are summed about their mean so far: a plot n standard
//! deviations from where the mode expects it has y yᵀ n² times as large as D⁻¹, whose rounding would spoil what is left of P*. D_m
//! depends on the plot's own errors; it is factored once for successive plots that share them.

use common::config::Association;

use crate::association::gate::Gate;
use crate::association::{Candidate, FalsePlots, Rules, Selection, Surroundings, select, weigh};
use crate::filter::gaussian::{Gaussian, at};
use crate::filter::uav::imm::Imm;
use crate::filter::uav::motion::{DIMENSIONS, MODES};
use crate::plots::measurement::{COORDINATES, Expected, Likelihood, Measurement, PACKED_4};

/// Room for one update, reused: nothing is allocated per scan once it has grown.
#[derive(Debug)]
pub struct Workspace {
    /// Plots in the gate.
    pub candidates: Vec<Candidate>,
    /// w_jm by candidate, then mode.
    pub weights: Vec<[f64; MODES]>,
    /// The modes' gates.
    pub gates: [Gate; MODES],
}

impl Default for Workspace {
    fn default() -> Self {
        // More than gates hold as a rule: one of several workspaces may not meet its largest gate for long.
        let (candidates, weights) = (Vec::with_capacity(64), Vec::with_capacity(64));
        Self { candidates, weights, gates: [Gate::default(); MODES] }
    }
}

impl Workspace {
    /// The plot of largest Σ_j W_j w_jm (the first of equals) and that weight, W being those of `posterior`.
    pub(crate) fn best(&self, posterior: &Imm) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        for (candidate, weight) in self.candidates.iter().zip(&self.weights) {
            let weight = posterior.average(weight);
            if best.is_none_or(|(_, most)| weight > most) {
                best = Some((candidate.plot, weight));
            }
        }
        best
    }
}

/// What one scan did to a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// û_j, P̂_j, W_j.
    pub posterior: Imm,
    /// The gate that was used.
    pub selection: Selection,
    /// Plots in it.
    pub plots_in_gate: usize,
    /// L_j: b_j + Σ_m e_jm λ_m, or the density of the one neighbour.
    pub mode_likelihood: [f64; MODES],
    /// w_j0: weight of "none of them".
    pub mode_none: [f64; MODES],
    /// Likelihood ratio "there is a target" to "there is none" (T18).
    pub existence_ratio: f64,
    /// The same as if there were no other tracks.
    pub ratio_alone: f64,
    /// Σ_j W_j w_j0.
    pub weight_none: f64,
    /// Index of the plot of largest Σ_j W_j w_jm among those offered, and that weight.
    pub best: Option<(usize, f64)>,
}

/// One scan of one track: gate, association and update of a prediction made for `time_ns`.
///
/// | argument       | symbol            | unit                      |
/// |----------------|-------------------|---------------------------|
/// | `prediction`   | u*_j, P*_j, W*_j  | m, m/s, m/s²              |
/// | `plots`        | y_m, σ_m, q_m     | m, rad, m/s               |
/// | `surroundings` | D, λ, ρ_c         | 1/(m³·m/s)                |
///
/// Without a plot in the gate the prediction is kept and only W_j changes. The same holds for a mode
/// whose D is not positive definite.
pub fn update<F: Fn(&[f64; COORDINATES]) -> FalsePlots>(
    prediction: &Imm,
    time_ns: u64,
    plots: &[Measurement],
    surroundings: &Surroundings<'_, F>,
    rules: &Rules,
    workspace: &mut Workspace,
) -> Outcome {
    let expected: [Expected; MODES] = std::array::from_fn(|j| Expected::new(j, &prediction.modes[j]));
    let Workspace { candidates, weights, gates } = workspace;
    *gates = expected.each_ref().map(|expected| Gate::new(expected, surroundings.radar, rules.alpha));
    let selection = select(prediction, gates, time_ns, plots, surroundings, rules, candidates);
    let plots_in_gate = candidates.len();
    let density = weigh(&selection, surroundings, plots, rules, candidates);
    let hard = matches!(rules.association, Association::Nearest | Association::Strongest);
    let d = surroundings.detection_probability;
    let missed = selection.missed();

    let mut posterior = *prediction;
    weights.clear();
    weights.resize(candidates.len(), [0.0; MODES]);
    let mut mode_likelihood = missed;
    let mut ln_likelihood = [0.0; MODES];
    let mut mode_none = [1.0; MODES];
    let (mut existence_ratio, mut ratio_alone) = (0.0, 0.0);
    for j in 0..MODES {
        if candidates.is_empty() {
            existence_ratio += prediction.probability[j] * missed[j];
            ratio_alone = existence_ratio;
            ln_likelihood[j] = missed[j].ln();
            continue;
        }
        let none = if hard { 0.0 } else { density * missed[j] / d };
        let mut moments = Moments::of_none(none);
        let (mut alone, mut ln_best) = (none, f64::NEG_INFINITY);
        for_each_density(candidates, plots, &expected[j], rules.inflation, |m, likelihood, d, y| {
            let ln_e = likelihood.ln_density(d, y);
            let e = ln_e.exp();
            let weight = if hard { 1.0 } else { e * candidates[m].ratio };
            alone += e * candidates[m].alone;
            ln_best = ln_e; // of the one that there is, where only that is asked for
            weights[m][j] = weight;
            moments.add(weight, likelihood, y);
        });
        let total = moments.weight;
        mode_likelihood[j] = if hard { ln_best.exp() } else { total };
        ln_likelihood[j] = if hard { ln_best } else { total.ln() };
        let ratio = |sum: f64, one: f64| {
            if hard { missed[j] + d * ln_best.exp() * one / density } else { sum * d / density }
        };
        existence_ratio += prediction.probability[j] * ratio(total, candidates[0].ratio);
        ratio_alone += prediction.probability[j] * ratio(alone, candidates[0].alone);
        if total > 0.0 && total.is_finite() {
            mode_none[j] = none / total;
            for weight in weights.iter_mut() {
                weight[j] /= total;
            }
            moments.apply(&expected[j], DIMENSIONS[j], &mut posterior.modes[j]);
        } else {
            mode_likelihood[j] = none;
            for weight in weights.iter_mut() {
                weight[j] = 0.0;
            }
        }
    }
    reweight(&mut posterior.probability, ln_likelihood);
    if !posterior.is_sound() {
        posterior = *prediction; // better an old state than a broken one
    }
    Outcome {
        posterior,
        selection,
        plots_in_gate,
        mode_likelihood,
        mode_none,
        existence_ratio,
        ratio_alone,
        weight_none: posterior.average(&mode_none),
        best: workspace.best(&posterior),
    }
}

/// W_j ∝ W*_j L_j (T15); unchanged where no mode explains anything.
pub(crate) fn reweight(probability: &mut [f64; MODES], ln_likelihood: [f64; MODES]) {
    let largest = ln_likelihood.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return;
    }
    let scaled: [f64; MODES] = std::array::from_fn(|j| probability[j] * (ln_likelihood[j] - largest).exp());
    let total: f64 = scaled.iter().sum();
    if total > 0.0 && total.is_finite() {
        *probability = scaled.map(|w| w / total);
    }
}

/// Running moments of the mixture over "none" and the candidates of one mode.
pub(crate) struct Moments {
    /// b + Σ_m e_m λ_m.
    weight: f64,
    /// ȳ, y being 0 for "none".
    mean: [f64; COORDINATES],
    /// M times the weight, packed.
    spread: [f64; PACKED_4],
}

impl Moments {
    /// Of "none" alone, its weight being b.
    pub(crate) fn of_none(weight: f64) -> Self {
        Self { weight, mean: [0.0; COORDINATES], spread: [0.0; PACKED_4] }
    }

    /// A plot of weight e λ: with W the weight before it,
    /// ```text
    /// ȳ += (y − ȳ) eλ/(W + eλ),   M weight += eλ W/(W + eλ) (y − ȳ)(y − ȳ)ᵀ − eλ D⁻¹
    /// ```
    pub(crate) fn add(&mut self, weight: f64, likelihood: &Likelihood, y: [f64; COORDINATES]) {
        let before = self.weight;
        self.weight += weight;
        let share = if self.weight > 0.0 { weight / self.weight } else { 0.0 };
        let apart: [f64; COORDINATES] = std::array::from_fn(|i| y[i] - self.mean[i]);
        for b in 0..COORDINATES {
            let step = share * apart[b];
            self.mean[b] += step;
            for a in 0..=b {
                self.spread[at(a, b)] += before * step * apart[a] - weight * likelihood.inverse[at(a, b)];
            }
        }
    }

    /// Adds B ȳ to the mean and B M Bᵀ to the covariance of the leading `n` states.
    pub(crate) fn apply(&self, expected: &Expected, n: usize, state: &mut Gaussian) {
        let (b, y) = (&expected.cross, self.mean);
        let spread = self.spread.map(|sum| sum / self.weight);
        for j in 0..n {
            let row = b[j];
            state.mean[j] += row[0] * y[0] + row[1] * y[1] + row[2] * y[2] + row[3] * y[3];
            let moved = Likelihood { inverse: spread, ln_peak: 0.0 }.solve(row);
            for i in 0..=j {
                let other = b[i];
                state.covariance[at(i, j)] +=
                    other[0] * moved[0] + other[1] * moved[1] + other[2] * moved[2] + other[3] * moved[3];
            }
        }
    }
}

/// Calls `take` with the index, D⁻¹, innovation d and D⁻¹ d of every candidate whose D is positive definite. D is factored
/// once for successive plots of the same errors.
pub(crate) fn for_each_density(
    candidates: &[Candidate],
    plots: &[Measurement],
    expected: &Expected,
    inflation: f64,
    mut take: impl FnMut(usize, &Likelihood, [f64; COORDINATES], [f64; COORDINATES]),
) {
    let mut factored: Option<(usize, Likelihood)> = None;
    for (m, candidate) in candidates.iter().enumerate() {
        let plot = &plots[candidate.plot];
        let likelihood = match factored {
            Some((same, likelihood)) if shares_errors(&plots[same], plot) => likelihood,
            _ => match expected.likelihood(plot, inflation) {
                Some(likelihood) => likelihood,
                None => continue,
            },
        };
        factored = Some((candidate.plot, likelihood));
        let d = expected.innovation(plot, candidate.offset_s);
        take(m, &likelihood, d, likelihood.solve(d));
    }
}

/// Whether two plots have the same D.
#[expect(clippy::float_cmp, reason = "equal bits or another D")]
fn shares_errors(a: &Measurement, b: &Measurement) -> bool {
    a.variance == b.variance && a.measured == b.measured
}
