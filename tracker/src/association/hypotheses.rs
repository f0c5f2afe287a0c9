//! IMM-MHT: one track as several hypotheses of which plots were its own (T21).
//!
//! A hypothesis is a state of the filter with a weight, and has a lane of its own when it is predicted and updated. Each scan every hypothesis has as children "none" and each plot in its gates:
//! ```text
//! none     ln w + ln(1 − D P_G)
//! plot m   ln w + ln[ ℓ(q_m)/ρ₀(p_m) Σ_j W*_j N_jm ],   N_jm = N(y_m; h(u*_j), D_j)             (T21)
//! ```
//! Children far below the best are dropped, like ones are merged (Salmond 1990), the best are kept. The decision between plots is
//! so put off until the hypotheses have come together or died, where PDA takes a mean at once. Output is the mixture of all children
//! before merging.

use common::config::TrackerConfig;
use common::tracks::MODELS;
use nalgebra::{SMatrix, SVector};

use crate::association::gate::Gate;
use crate::association::scan::{Choice, Outcome};
use crate::association::{Candidate, FalsePlots, GateLoad, Prospect, Rules, Selection, Surroundings, select};
use crate::filter::gaussian::{Gaussian, at};
use crate::filter::{
    Densities, Evidence, Expectation, Filter, Group, LANES, Layout, Machine, Mixture, Prior, Row, Update, expect,
};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// Children this far below the best in ln w are dropped.
const DROPPED: f64 = 11.5;
/// Hypotheses of a smaller distance are merged.
const ALIKE: f64 = 0.5;
/// Components in which hypotheses are compared: position and velocity.
const COMPARED: usize = 6;

/// One history of associations; its state is at the same place of a list beside.
#[derive(Debug, Clone, PartialEq)]
struct Hypothesis {
    ln_weight: f64,
    /// Position and velocity of the mixture of its components: where it is compared with others.
    place: SVector<f64, COMPARED>,
}

impl Hypothesis {
    fn new(ln_weight: f64, state: Mixture<'_>) -> Self {
        Self { ln_weight, place: SVector::from_fn(|i, _| state.mean_of(i)) }
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

/// Hypotheses and their states, one after the other.
#[derive(Debug, Clone, Default, PartialEq)]
struct Family {
    all: Vec<Hypothesis>,
    states: Vec<f64>,
}

impl Family {
    fn clear(&mut self) {
        self.all.clear();
        self.states.clear();
    }

    fn push(&mut self, layout: &Layout, ln_weight: f64, state: &[f64]) {
        let state = &state[..layout.words()];
        self.all.push(Hypothesis::new(ln_weight, Mixture::new(layout, state)));
        self.states.extend_from_slice(state);
    }

    fn state(&self, layout: &Layout, index: usize) -> &[f64] {
        &self.states[index * layout.words()..][..layout.words()]
    }

    fn swap(&mut self, layout: &Layout, a: usize, b: usize) {
        if a != b {
            let (a, b) = (a.min(b), a.max(b));
            self.all.swap(a, b);
            let (left, right) = self.states.split_at_mut(b * layout.words());
            left[a * layout.words()..][..layout.words()].swap_with_slice(&mut right[..layout.words()]);
        }
    }

    fn ln_total(&self) -> f64 {
        ln_sum(self.all.iter().map(|hypothesis| hypothesis.ln_weight))
    }

    /// Place of the heaviest from `first` on.
    fn heaviest(&self, first: usize) -> usize {
        let order = |&a: &usize, &b: &usize| {
            let (a, b) = (&self.all[a], &self.all[b]);
            b.ln_weight.total_cmp(&a.ln_weight).then_with(|| a.place[0].total_cmp(&b.place[0]))
        };
        (first..self.all.len()).min_by(order).unwrap_or(first)
    }
}

/// The hypotheses of one track, the most probable first.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypotheses {
    kept: Family,
    most: usize,
}

/// Room for one update, reused.
#[derive(Debug)]
pub struct Room {
    prediction: Group,
    expected: Vec<Expectation>,
    evidence: Evidence,
    densities: Densities,
    update: Update,
    children: Vec<Child>,
    candidates: [Vec<Candidate>; LANES],
    born: Family,
    shares: Vec<f64>,
    state: Vec<f64>,
    posterior: Vec<f64>,
}

impl Room {
    /// For states of a form.
    pub fn new(layout: &Layout) -> Self {
        Self {
            prediction: Group::new(layout),
            expected: Vec::new(),
            evidence: Evidence::default(),
            densities: Densities::default(),
            update: Update::new(layout),
            children: Vec::new(),
            // As in a choice: more than gates hold as a rule.
            candidates: std::array::from_fn(|_| Vec::with_capacity(64)),
            born: Family::default(),
            shares: Vec::new(),
            state: vec![0.0; layout.words()],
            posterior: vec![0.0; layout.words()],
        }
    }

    /// The mixture of all children of the last update, component by component.
    pub fn posterior(&self) -> &[f64] {
        &self.posterior
    }
}

/// A filter, and what it is computed with and by.
#[derive(Debug, Clone, Copy)]
pub struct Means<'a> {
    /// The family of the states.
    pub filter: &'a dyn Filter,
    /// The machine's instructions.
    pub machine: Machine,
    /// How plots are chosen.
    pub rules: &'a Rules,
}

impl Hypotheses {
    /// One certain hypothesis; at most `most` are kept after a scan.
    pub fn new(layout: &Layout, state: &[f64], most: usize) -> Self {
        let (all, states) = (Vec::with_capacity(most), Vec::with_capacity(most * layout.words()));
        let mut hypotheses = Self { kept: Family { all, states }, most };
        hypotheses.restart(layout, state);
        hypotheses
    }

    /// For a new track, if the configuration asks for hypotheses.
    pub fn most(config: &TrackerConfig) -> Option<usize> {
        (config.association == common::config::Association::Mht).then_some(config.hypotheses as usize)
    }

    /// Begins again with one certain hypothesis.
    pub fn restart(&mut self, layout: &Layout, state: &[f64]) {
        self.kept.clear();
        self.kept.push(layout, 0.0, state);
    }

    /// Number of hypotheses.
    pub fn len(&self) -> usize {
        self.kept.all.len()
    }

    /// Never true: a track has at least one.
    pub fn is_empty(&self) -> bool {
        self.kept.all.is_empty()
    }

    /// Their states, the most probable first.
    pub fn states<'a>(&'a self, layout: &'a Layout) -> impl Iterator<Item = Mixture<'a>> {
        (0..self.len()).map(|index| Mixture::new(layout, self.kept.state(layout, index)))
    }

    /// Mixing and prediction of every hypothesis (T2)-(T4).
    pub fn predict(&mut self, means: Means<'_>, dt_s: f64, room: &mut Room) {
        let words = means.filter.layout().words();
        let Room { prediction, update, .. } = room;
        for states in self.kept.states.chunks_mut(LANES * words) {
            let lanes = states.len() / words;
            for (lane, state) in states.chunks(words).enumerate() {
                update.posterior.load(lane, state);
            }
            means.filter.predict(means.machine, lanes, &update.posterior, &Row::splat(dt_s), prediction);
            for (lane, state) in states.chunks_mut(words).enumerate() {
                prediction.store(lane, state);
            }
        }
        for (index, hypothesis) in self.kept.all.iter_mut().enumerate() {
            let state = Mixture::new(means.filter.layout(), &self.kept.states[index * words..][..words]);
            *hypothesis = Hypothesis::new(hypothesis.ln_weight, state);
        }
    }

    /// One scan of predicted hypotheses. The mixture of all children by component is then in `room`, and `choice` holds every plot in
    /// any gate with the share of children that took it, and the gates of the best hypothesis.
    pub fn update<F: Fn(&Measurement) -> FalsePlots>(
        &mut self,
        means: Means<'_>,
        time_ns: u64,
        plots: &[Measurement],
        surroundings: &Surroundings<'_, F>,
        room: &mut Room,
        choice: &mut Choice,
    ) -> Outcome {
        let Branches { selection, evidence, alone } = self.branch(means, time_ns, plots, surroundings, room, choice);
        choice.candidates.clear();
        choice.weights.clear();
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
                Some(plot) => add_share(plot, weight, plots, time_ns, choice),
            }
        }
        self.bear(means, time_ns, plots, surroundings.radar, room);
        merge_all(means.filter, &room.born, 0..room.born.all.len(), &mut room.shares, &mut room.posterior);
        merge(means.filter, room, self.most, &mut self.kept);
        Outcome {
            selection,
            plots_in_gate: choice.candidates.len(),
            existence_ratio: evidence,
            ratio_alone: alone,
            weight_none,
        }
    }

    /// Fills `room` with the children of every hypothesis; selection and gates are those of the best one.
    fn branch<F: Fn(&Measurement) -> FalsePlots>(
        &self,
        means: Means<'_>,
        time_ns: u64,
        plots: &[Measurement],
        surroundings: &Surroundings<'_, F>,
        room: &mut Room,
        choice: &mut Choice,
    ) -> Branches {
        let Room { prediction, expected, evidence: found, densities, children, candidates, .. } = room;
        let Means { filter, machine, rules } = means;
        let layout = *filter.layout();
        children.clear();
        let (mut best, mut evidence, mut alone) = (None, 0.0, 0.0);
        let mut load = GateLoad::default();
        let own_probability = rules.own_probability(surroundings.radar);
        for first in (0..self.len()).step_by(LANES) {
            let lanes = LANES.min(self.len() - first);
            for lane in 0..lanes {
                prediction.load(lane, self.kept.state(&layout, first + lane));
            }
            expect(machine, lanes, surroundings.radar, rules.alpha, prediction, expected);
            found.clear(layout.len());
            let mut missed = [0.0; LANES];
            for lane in 0..lanes {
                let (mut weights, mut gates) = ([0.0; MODELS], [Gate::default(); MODELS]);
                for j in 0..layout.len() {
                    weights[j] = prediction.weight(j, lane);
                    gates[j] = Gate::new(&expected[j], lane, rules.alpha);
                }
                if best.is_none() {
                    choice.gates = gates;
                }
                let (weights, gates) = (&weights[..layout.len()], &gates[..layout.len()]);
                let prospect = Prospect { weights, gates, widest: layout.widest, time_ns, own_probability };
                let selection = select(&prospect, plots, surroundings, rules, &mut candidates[lane]);
                for candidate in &candidates[lane] {
                    found.add(lane, &plots[candidate.plot], candidate.offset_s, 1.0);
                }
                if best.is_none() {
                    load = GateLoad::new(&candidates[lane], plots, selection.volume);
                }
                missed[lane] = weights.iter().zip(&selection.missed).map(|(weight, missed)| weight * missed).sum();
                best.get_or_insert(selection);
            }
            let prior = Prior { prediction, expected, inflation: rules.inflation };
            densities.evaluate(machine, lanes, prior, found);
            for lane in 0..lanes {
                let parent = first + lane;
                let own_ln_weight = self.kept.all[parent].ln_weight;
                let own_weight = own_ln_weight.exp();
                evidence += own_weight * missed[lane];
                alone += own_weight * missed[lane];
                children.push(Child { ln_weight: own_ln_weight + missed[lane].ln(), parent, plot: None });
                for (m, candidate) in candidates[lane].iter().enumerate() {
                    let density: f64 =
                        (0..layout.len()).map(|j| prediction.weight(j, lane) * densities.ln(m, j, lane).exp()).sum();
                    let ratio = density * surroundings.ratio_to_noise(&plots[candidate.plot], load, rules);
                    let shared = ratio * surroundings.share(candidate.plot);
                    alone += own_weight * ratio;
                    evidence += own_weight * shared;
                    let ln_weight = own_ln_weight + shared.ln();
                    if ln_weight > f64::NEG_INFINITY {
                        children.push(Child { ln_weight, parent, plot: Some(candidate.plot) });
                    }
                }
            }
        }
        Branches { selection: best.expect("a track has at least one hypothesis"), evidence, alone }
    }

    /// The children's states: each takes its plot for certain (T8).
    fn bear(&self, means: Means<'_>, time_ns: u64, plots: &[Measurement], radar: &Radar, room: &mut Room) {
        let Room { prediction, expected, evidence, update, children, born, state, .. } = room;
        let Means { filter, machine, rules } = means;
        let layout = filter.layout();
        born.clear();
        for family in children.chunks(LANES) {
            evidence.clear(layout.len());
            for (lane, child) in family.iter().enumerate() {
                prediction.load(lane, self.kept.state(layout, child.parent));
                if let Some(plot) = child.plot {
                    let offset_s = common::units::seconds_between(time_ns, plots[plot].time_ns);
                    evidence.add(lane, &plots[plot], offset_s, 1.0);
                }
            }
            evidence.decide();
            expect(machine, family.len(), radar, rules.alpha, prediction, expected);
            let prior = Prior { prediction, expected, inflation: rules.inflation };
            filter.update(machine, family.len(), prior, evidence, update);
            for (lane, child) in family.iter().enumerate() {
                update.posterior.store(lane, state);
                born.push(layout, child.ln_weight, state);
            }
        }
    }
}

/// What a scan says before its children are pruned.
struct Branches {
    /// Of the best hypothesis.
    selection: Selection,
    /// For a target among other tracks.
    evidence: f64,
    /// As if there were none.
    alone: f64,
}

/// Children that are worked out per hypothesis kept.
const CHILDREN_PER_KEPT: usize = 4;

/// Adds to the share of a plot.
fn add_share(plot: usize, weight: f64, plots: &[Measurement], time_ns: u64, choice: &mut Choice) {
    if let Some(index) = choice.candidates.iter().position(|candidate| candidate.plot == plot) {
        choice.weights[index] += weight;
    } else {
        let offset_s = common::units::seconds_between(time_ns, plots[plot].time_ns);
        let gates = choice.gates_about(&plots[plot], time_ns);
        choice.candidates.push(Candidate { plot, offset_s, gain: 1.0, alone: 1.0, gates, distance: 0.0 });
        choice.weights.push(weight);
    }
}

/// Moments of some hypotheses, component by component. Their weights need not be normalised.
fn merge_all(
    filter: &dyn Filter,
    family: &Family,
    some: std::ops::Range<usize>,
    shares: &mut Vec<f64>,
    into: &mut [f64],
) {
    let words = filter.layout().words();
    let total = ln_sum(family.all[some.clone()].iter().map(|hypothesis| hypothesis.ln_weight));
    shares.clear();
    shares.extend(family.all[some.clone()].iter().map(|hypothesis| (hypothesis.ln_weight - total).exp()));
    filter.merge(shares, &family.states[some.start * words..some.end * words], into);
}

/// Clusters about the heaviest that is left, until `most` are made or none is left; normalised.
///
/// ```text
/// d² = (x_i − x_c)ᵀ P_c⁻¹ (x_i − x_c) < 0.5     x: position and velocity of the hypothesis' mean
/// ```
fn merge(filter: &dyn Filter, room: &mut Room, most: usize, kept: &mut Family) {
    let (layout, Room { born, shares, state, .. }) = (filter.layout(), room);
    kept.clear();
    let mut first = 0;
    while first < born.all.len() && kept.all.len() < most {
        let heaviest = born.heaviest(first);
        born.swap(layout, first, heaviest);
        let centre = born.all[first].place;
        let factor = compared_covariance(&Mixture::new(layout, born.state(layout, first)).moments()).cholesky();
        let alike = |other: &Hypothesis| {
            let difference = other.place - centre;
            factor.as_ref().is_some_and(|factor| difference.dot(&factor.solve(&difference)) < ALIKE)
        };
        let mut cluster = 1;
        for index in first + 1..born.all.len() {
            if alike(&born.all[index]) {
                born.swap(layout, first + cluster, index);
                cluster += 1;
            }
        }
        let end = first + cluster;
        let ln_weight = ln_sum(born.all[first..end].iter().map(|hypothesis| hypothesis.ln_weight));
        if end == first + 1 {
            kept.push(layout, ln_weight, born.state(layout, first));
        } else {
            merge_all(filter, born, first..end, shares, state);
            kept.push(layout, ln_weight, state);
        }
        first = end;
    }
    let total = kept.ln_total();
    for hypothesis in &mut kept.all {
        hypothesis.ln_weight -= total;
    }
    for place in 0..kept.all.len() {
        let heaviest = kept.heaviest(place);
        kept.swap(layout, place, heaviest);
    }
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
