//! One scan of up to eight tracks: gates, candidates, evidence, and the update by their filter (T12)-(T15).
//!
//! Gates and candidates are chosen track by track; what the components expect and what the plots make of them is computed for all lanes.
//! ```text
//! existence ratio = Σ_j W*_j L_j,   L_j = b_j + Σ_m e_jm a_m;   of one certain plot: Σ_j W*_j (1 − D P_Gj + e_j a)       (T18)
//! ```

use common::config::Association;
use common::tracks::MODELS;
use common::units::seconds_between;

use crate::association::gate::Gate;
use crate::association::{Candidate, FalsePlots, Prospect, Rules, Selection, Surroundings, select, weigh};
use crate::filter::{Evidence, Expectation, Filter, Group, LANES, Layout, Machine, Prior, Update, expect};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// A track that the beam has passed.
#[derive(Debug)]
pub struct Member<'a, F> {
    /// Time of the prediction, ns UTC.
    pub time_ns: u64,
    /// The plots that are offered.
    pub plots: &'a [Measurement],
    /// D, λ, ρ.
    pub surroundings: Surroundings<'a, F>,
}

/// What one scan did to a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// The gate that was used.
    pub selection: Selection,
    /// Plots in it.
    pub plots_in_gate: usize,
    /// Likelihood ratio "there is a target" to "there is none" (T18).
    pub existence_ratio: f64,
    /// The same as if there were no other tracks.
    pub ratio_alone: f64,
    /// Σ_j W_j w_j0.
    pub weight_none: f64,
}

/// The plots in the gate of one track, and what each is to it.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The plots.
    pub candidates: Vec<Candidate>,
    /// Σ_j W_j w_jm of each.
    pub weights: Vec<f64>,
    /// The components' gates.
    pub gates: [Gate; MODELS],
}

impl Default for Choice {
    fn default() -> Self {
        // More than gates hold as a rule: one of several may not meet its largest gate for long.
        Self { candidates: Vec::with_capacity(64), weights: Vec::with_capacity(64), gates: [Gate::default(); MODELS] }
    }
}

impl Choice {
    /// The components in whose gates a plot lies, a bit each; the gates are those of a prediction for `time_ns`.
    pub fn gates_about(&self, plot: &Measurement, time_ns: u64) -> u32 {
        let offset_s = seconds_between(time_ns, plot.time_ns);
        self.gates
            .iter()
            .zip(0..)
            .fold(0, |inside, (gate, j)| inside | u32::from(gate.holds(&gate.offset(plot, offset_s), plot)) << j)
    }

    /// The plot of the largest weight (the first of equals), as an index of those offered, and that weight.
    pub fn best(&self) -> Option<(usize, f64)> {
        let all = self.candidates.iter().map(|candidate| candidate.plot).zip(self.weights.iter().copied());
        all.reduce(|best, other| if other.1 > best.1 { other } else { best })
    }
}

/// Up to eight tracks through one scan, reused.
#[derive(Debug)]
pub struct Scan {
    /// u*, P*, W* of each track, to be loaded before a scan.
    pub prediction: Group,
    /// What became of them.
    pub update: Update,
    /// By lane.
    pub choices: [Choice; LANES],
    /// By lane.
    pub outcomes: Vec<Outcome>,
    expected: Vec<Expectation>,
    evidence: Evidence,
}

impl Scan {
    /// Room for states of a form.
    pub fn new(layout: &Layout) -> Self {
        Self {
            prediction: Group::new(layout),
            update: Update::new(layout),
            choices: Default::default(),
            outcomes: Vec::with_capacity(LANES),
            expected: Vec::new(),
            evidence: Evidence::default(),
        }
    }

    /// Updates the predictions in the first lanes, one of each member.
    ///
    /// Without a plot in the gate the prediction is kept and only W_j changes. The same holds for a component whose D is not positive definite.
    pub fn update<'a, F: Fn(&Measurement) -> FalsePlots>(
        &mut self,
        filter: &dyn Filter,
        machine: Machine,
        members: impl ExactSizeIterator<Item = Member<'a, F>>,
        radar: &Radar,
        rules: &Rules,
    ) {
        debug_assert!(rules.association != Association::Mht, "several hypotheses are updated one by one");
        let Self { prediction, update, choices, outcomes, expected, evidence } = self;
        let (layout, lanes) = (*filter.layout(), members.len());
        let (components, decides) = (layout.len(), rules.association.decides());
        let own_probability = rules.own_probability(radar);
        expect(machine, lanes, radar, rules.alpha, prediction, expected);
        evidence.clear(components);
        outcomes.clear();
        for (lane, (member, choice)) in members.zip(choices.iter_mut()).enumerate() {
            let Member { time_ns, plots, surroundings } = member;
            let Choice { candidates, gates, .. } = choice;
            let mut weights = [0.0; MODELS];
            for j in 0..components {
                weights[j] = prediction.weight(j, lane);
                gates[j] = Gate::new(&expected[j], lane, rules.alpha);
            }
            let (weights, gates) = (&weights[..components], &gates[..components]);
            let prospect = Prospect { weights, gates, widest: layout.widest, time_ns, own_probability };
            let selection = select(&prospect, plots, &surroundings, rules, candidates);
            let plots_in_gate = candidates.len();
            weigh(&selection, &surroundings, plots, rules, candidates);
            evidence.set_none(lane, &selection.missed[..components]);
            for candidate in candidates.iter() {
                let gain = if decides { 1.0 } else { candidate.gain };
                evidence.add(lane, &plots[candidate.plot], candidate.offset_s, gain);
            }
            outcomes.push(Outcome {
                selection,
                plots_in_gate,
                existence_ratio: 0.0,
                ratio_alone: 0.0,
                weight_none: 1.0,
            });
        }
        if decides {
            evidence.decide();
        }
        let prior = Prior { prediction, expected, inflation: rules.inflation };
        filter.update(machine, lanes, prior, evidence, update);
        for (lane, (outcome, choice)) in outcomes.iter_mut().zip(choices).enumerate() {
            finish(lane, decides, prediction, update, outcome, choice);
        }
    }
}

/// Weights and evidence of one track.
fn finish(lane: usize, decides: bool, prediction: &Group, update: &Update, outcome: &mut Outcome, choice: &mut Choice) {
    let Update { posterior, weights, densities } = update;
    let components = prediction.layout().len();
    choice.weights.clear();
    choice.weights.extend((0..choice.candidates.len()).map(|m| weights.of_plot(m, lane, posterior)));
    outcome.weight_none = weights.of_none(lane, posterior);
    let (mut ratio, mut alone) = (0.0, 0.0);
    for j in 0..components {
        let weight = prediction.weight(j, lane);
        let missed = outcome.selection.missed[j];
        let (mut own, mut without_others) = (0.0, 0.0);
        if let Some(candidate) = choice.candidates.first().filter(|_| decides) {
            let density = densities.ln(0, j, lane).exp();
            own += missed + density * candidate.gain;
            without_others += missed + density * candidate.alone;
        } else {
            let likelihood = weights.likelihood[j].0[lane];
            own += likelihood;
            // L_j without other tracks: every plot's part of it, w_jm L_j, over the plot's share.
            without_others += weights.none[j].0[lane] * likelihood;
            for (m, candidate) in choice.candidates.iter().enumerate() {
                if candidate.gain > 0.0 {
                    let part = weights.plots[m * components + j].0[lane] * likelihood;
                    without_others += part * (candidate.alone / candidate.gain);
                }
            }
        }
        ratio += weight * own;
        alone += weight * without_others;
    }
    outcome.existence_ratio = ratio;
    outcome.ratio_alone = alone;
}
