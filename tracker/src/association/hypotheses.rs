//! IMM-MHT: one track as several hypotheses of which plots were its own (T21).
//!
//! A hypothesis is an IMM with a weight. Each scan every hypothesis has as children "none" and each plot in its gates:
//! ```text
//! none     ln w + ln(1 − D P_G)
//! plot m   ln w + ln[ ℓ(q_m)/ρ₀(p_m) Σ_j W*_j N_jm ],   N_jm = N(y_m; h(u*_j), D_j)             (T21)
//! ```
//! Children far below the best are dropped, like ones are merged (Salmond 1990), the best are kept. The decision between plots is
//! so put off until the hypotheses have come together or died, where PDA takes a mean at once. Output is the mixture of all children
//! before merging.

use nalgebra::{SMatrix, SVector};

use crate::association::gate::Gate;
use crate::association::{Candidate, FalsePlots, Rules, Selection, Surroundings, select};
use crate::filter::gaussian::{Gaussian, at};
use crate::filter::uav::imm::{Imm, Transition};
use crate::filter::uav::motion::{DIMENSIONS, MODES, Motion};
use crate::filter::uav::update::{Moments, Outcome, Workspace, for_each_density, reweight};
use crate::plots::measurement::{COORDINATES, Expected, Measurement};

/// Children this far below the best in ln w are dropped.
const DROPPED: f64 = 11.5;
/// Hypotheses of a smaller distance are merged.
const ALIKE: f64 = 0.5;
/// Components in which hypotheses are compared: position and velocity.
const COMPARED: usize = 6;

/// One history of associations.
#[derive(Debug, Clone, PartialEq)]
struct Hypothesis {
    ln_weight: f64,
    imm: Imm,
    /// Position and velocity of the mixture of its modes: where it is compared with others.
    place: SVector<f64, COMPARED>,
}

impl Hypothesis {
    fn new(ln_weight: f64, imm: &Imm) -> Self {
        let place = SVector::from_fn(|i, _| (0..MODES).map(|j| imm.probability[j] * imm.modes[j].mean[i]).sum());
        Self { ln_weight, imm: *imm, place }
    }
}

/// A child to be: what it descends from.
#[derive(Debug, Clone, Copy)]
struct Child {
    ln_weight: f64,
    parent: usize,
    /// Index of the plot; `None` for a miss.
    plot: Option<usize>,
}

/// The hypotheses of one track, the most probable first.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypotheses {
    kept: Vec<Hypothesis>,
    most: usize,
}

/// Room for one update, reused.
#[derive(Debug, Default)]
pub struct Room {
    /// What each hypothesis expects.
    expected: Vec<[Expected; MODES]>,
    children: Vec<Child>,
    born: Vec<Hypothesis>,
    own: Candidates,
}

/// The plots in the gates of one hypothesis and Σ_j W*_j N_jm of each.
#[derive(Debug, Default)]
struct Candidates {
    candidates: Vec<Candidate>,
    densities: Vec<f64>,
}

impl Hypotheses {
    /// One certain hypothesis; at most `most` are kept after a scan.
    pub fn new(imm: &Imm, most: usize) -> Self {
        let mut hypotheses = Self { kept: Vec::with_capacity(most), most };
        hypotheses.restart(imm);
        hypotheses
    }

    /// Begins again with one certain hypothesis.
    pub fn restart(&mut self, imm: &Imm) {
        self.kept.clear();
        self.kept.push(Hypothesis::new(0.0, imm));
    }

    /// Number of hypotheses.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Never true: a track has at least one.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// The filters, the most probable first.
    pub fn filters(&self) -> impl Iterator<Item = &Imm> {
        self.kept.iter().map(|hypothesis| &hypothesis.imm)
    }

    /// Mixing and prediction of every hypothesis (T2)-(T4).
    pub fn predict(&mut self, transition: &Transition, motion: &Motion, dt_s: f64) {
        for hypothesis in &mut self.kept {
            hypothesis.imm = hypothesis.imm.predict(transition, motion, dt_s);
        }
    }

    /// One scan of predicted hypotheses. The arguments are those of [`crate::filter::uav::update::update`],
    /// and so is the outcome: its posterior is the mixture of all children by mode, and `workspace` holds every plot in
    /// any gate with the share of children that took it, alike for all modes.
    pub fn update<F: Fn(&[f64; COORDINATES]) -> FalsePlots>(
        &mut self,
        time_ns: u64,
        plots: &[Measurement],
        surroundings: &Surroundings<'_, F>,
        rules: &Rules,
        workspace: &mut Workspace,
        room: &mut Room,
    ) -> Outcome {
        let (selection, evidence, alone) = self.branch(time_ns, plots, surroundings, rules, workspace, room);
        workspace.candidates.clear();
        workspace.weights.clear();
        room.children.sort_unstable_by(|a, b| {
            b.ln_weight.total_cmp(&a.ln_weight).then((a.parent, a.plot).cmp(&(b.parent, b.plot)))
        });
        let least = room.children[0].ln_weight - DROPPED;
        room.children.retain(|child| child.ln_weight >= least);
        room.children.truncate(CHILDREN_PER_KEPT * self.most);
        let total = ln_sum(room.children.iter().map(|child| child.ln_weight));
        let mut weight_none = 0.0;
        for child in &mut room.children {
            child.ln_weight -= total;
            let weight = child.ln_weight.exp();
            match child.plot {
                None => weight_none += weight,
                Some(plot) => note(plot, weight, plots, time_ns, workspace),
            }
        }
        self.bear(time_ns, plots, rules, room);
        let posterior = mixture(&room.born);
        merge(&mut room.born, self.most, &mut self.kept);
        let mut best: Option<(usize, f64)> = None;
        for (candidate, weight) in workspace.candidates.iter().zip(&workspace.weights) {
            if best.is_none_or(|(_, most)| weight[0] > most) {
                best = Some((candidate.plot, weight[0]));
            }
        }
        Outcome {
            posterior,
            selection,
            plots_in_gate: workspace.candidates.len(),
            mode_likelihood: [evidence; MODES],
            mode_none: [weight_none; MODES],
            existence_ratio: evidence,
            ratio_alone: alone,
            weight_none,
            best,
        }
    }

    /// Fills `room` with the children of every hypothesis; selection and gates are those of the best one. Second and third are the
    /// evidence for a target among other tracks, and as if there were none.
    fn branch<F: Fn(&[f64; COORDINATES]) -> FalsePlots>(
        &self,
        time_ns: u64,
        plots: &[Measurement],
        surroundings: &Surroundings<'_, F>,
        rules: &Rules,
        workspace: &mut Workspace,
        room: &mut Room,
    ) -> (Selection, f64, f64) {
        let Room { expected, children, own, .. } = room;
        expected.clear();
        children.clear();
        let mut first = None;
        let (mut evidence, mut alone) = (0.0, 0.0);
        for (parent, hypothesis) in self.kept.iter().enumerate() {
            let imm = &hypothesis.imm;
            let expects: [Expected; MODES] = std::array::from_fn(|j| Expected::new(j, &imm.modes[j]));
            let gates = expects.each_ref().map(|expected| Gate::new(expected, surroundings.radar, rules.alpha));
            if parent == 0 {
                workspace.gates = gates;
            }
            let selection = select(imm, &gates, time_ns, plots, surroundings, rules, &mut own.candidates);
            let missed = (0..MODES)
                .map(|j| imm.probability[j] * (1.0 - selection.detection_probability * selection.probability[j]))
                .sum::<f64>();
            let prior = hypothesis.ln_weight.exp();
            evidence += prior * missed;
            alone += prior * missed;
            children.push(Child { ln_weight: hypothesis.ln_weight + missed.ln(), parent, plot: None });
            let densities = &mut own.densities;
            densities.clear();
            densities.resize(own.candidates.len(), 0.0);
            for j in 0..MODES {
                for_each_density(&own.candidates, plots, &expects[j], rules.inflation, |m, likelihood, d, y| {
                    densities[m] += imm.probability[j] * likelihood.ln_density(d, y).exp();
                });
            }
            for (candidate, density) in own.candidates.iter().zip(densities) {
                let plot = &plots[candidate.plot];
                let ratio = *density * surroundings.ratio_to_noise(plot, rules);
                let shared = ratio * surroundings.share(candidate.plot);
                alone += prior * ratio;
                evidence += prior * shared;
                let ln_weight = hypothesis.ln_weight + shared.ln();
                if ln_weight > f64::NEG_INFINITY {
                    children.push(Child { ln_weight, parent, plot: Some(candidate.plot) });
                }
            }
            expected.push(expects);
            first.get_or_insert(selection);
        }
        (first.expect("a track has at least one hypothesis"), evidence, alone)
    }

    /// The children's states.
    fn bear(&self, time_ns: u64, plots: &[Measurement], rules: &Rules, room: &mut Room) {
        room.born.clear();
        for child in &room.children {
            let parent = &self.kept[child.parent];
            let mut imm = parent.imm;
            if let Some(index) = child.plot {
                let plot = &plots[index];
                let offset_s = common::units::seconds_between(time_ns, plot.time_ns);
                let mut ln_likelihood = [f64::NEG_INFINITY; MODES];
                for (j, expected) in room.expected[child.parent].iter().enumerate() {
                    if let Some(likelihood) = expected.likelihood(plot, rules.inflation) {
                        let d = expected.innovation(plot, offset_s);
                        let y = likelihood.solve(d);
                        let mut moments = Moments::of_none(0.0);
                        moments.add(1.0, &likelihood, y); // the plot is the target's for certain: (T8)
                        moments.apply(expected, DIMENSIONS[j], &mut imm.modes[j]);
                        ln_likelihood[j] = likelihood.ln_density(d, y);
                    }
                }
                reweight(&mut imm.probability, ln_likelihood);
            }
            room.born.push(Hypothesis::new(child.ln_weight, if imm.is_sound() { &imm } else { &parent.imm }));
        }
    }
}

/// Children that are worked out per hypothesis kept.
const CHILDREN_PER_KEPT: usize = 4;

/// Adds to the share of a plot.
fn note(plot: usize, weight: f64, plots: &[Measurement], time_ns: u64, workspace: &mut Workspace) {
    let Workspace { candidates, weights, .. } = workspace;
    if let Some(index) = candidates.iter().position(|candidate| candidate.plot == plot) {
        weights[index] = weights[index].map(|share| share + weight);
    } else {
        let offset_s = common::units::seconds_between(time_ns, plots[plot].time_ns);
        candidates.push(Candidate { plot, offset_s, ratio: 1.0, alone: 1.0, distance: 0.0 });
        weights.push([weight; MODES]);
    }
}

/// Moments of the whole mixture, mode by mode. Weights need not be normalised.
fn mixture(hypotheses: &[Hypothesis]) -> Imm {
    let total = ln_sum(hypotheses.iter().map(|hypothesis| hypothesis.ln_weight));
    let mut mixture = Imm { modes: [Gaussian::ZERO; MODES], probability: [0.0; MODES] };
    for j in 0..MODES {
        let n = DIMENSIONS[j];
        let share = |hypothesis: &Hypothesis| (hypothesis.ln_weight - total).exp() * hypothesis.imm.probability[j];
        let sum: f64 = hypotheses.iter().map(share).sum();
        mixture.probability[j] = sum;
        let share = |hypothesis: &Hypothesis| {
            if sum > 0.0 { share(hypothesis) / sum } else { (hypothesis.ln_weight - total).exp() }
        };
        for hypothesis in hypotheses {
            for i in 0..n {
                mixture.modes[j].mean[i] += share(hypothesis) * hypothesis.imm.modes[j].mean[i];
            }
        }
        for hypothesis in hypotheses {
            mixture.modes[j].accumulate(share(hypothesis), &hypothesis.imm.modes[j], n);
        }
    }
    mixture
}

/// Clusters about the heaviest that is left, until `most` are made or none is left; normalised.
///
/// ```text
/// d² = (x_i − x_c)ᵀ P_c⁻¹ (x_i − x_c) < 0.5     x: position and velocity of the hypothesis' mean
/// ```
fn merge(born: &mut Vec<Hypothesis>, most: usize, kept: &mut Vec<Hypothesis>) {
    kept.clear();
    heaviest_first(born);
    while !born.is_empty() && kept.len() < most {
        let centre = born[0].place;
        let factor = compared_covariance(&born[0].imm.mixture()).cholesky();
        let alike = |other: &Hypothesis| {
            let difference = other.place - centre;
            factor.as_ref().is_some_and(|factor| difference.dot(&factor.solve(&difference)) < ALIKE)
        };
        let mut cluster = 1;
        for index in 1..born.len() {
            if alike(&born[index]) {
                born.swap(cluster, index);
                cluster += 1;
            }
        }
        let ln_weight = ln_sum(born[..cluster].iter().map(|hypothesis| hypothesis.ln_weight));
        let imm = if cluster == 1 { born[0].imm } else { mixture(&born[..cluster]) };
        kept.push(Hypothesis::new(ln_weight, &imm));
        born.drain(..cluster);
        heaviest_first(born);
    }
    let total = ln_sum(kept.iter().map(|hypothesis| hypothesis.ln_weight));
    for hypothesis in kept.iter_mut() {
        hypothesis.ln_weight -= total;
    }
    heaviest_first(kept);
}

/// In place: a stable sort would allocate.
fn heaviest_first(hypotheses: &mut [Hypothesis]) {
    hypotheses
        .sort_unstable_by(|a, b| b.ln_weight.total_cmp(&a.ln_weight).then_with(|| a.place[0].total_cmp(&b.place[0])));
}

fn compared_covariance(gaussian: &Gaussian) -> SMatrix<f64, COMPARED, COMPARED> {
    SMatrix::from_fn(|i, j| gaussian.covariance[at(i, j)] * if i == j { 1.0 + 1e-9 } else { 1.0 })
}

/// ln Σ exp.
pub(crate) fn ln_sum(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + values.map(|value| (value - largest).exp()).sum::<f64>().ln()
}
