//! One track without beam, store and other tracks: what studies of a filter follow.

use crate::association::gate::Gate;
use crate::association::scan::{Member, Outcome, Scan};
use crate::association::{FalsePlots, Rules};
use crate::filter::{Evidence, Expectation, Filter, Group, Machine, Mixture, Prior, Row, TwoPlots, expect};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// A state, its filter and a scan.
#[derive(Debug)]
pub struct OneTrack {
    filter: Box<dyn Filter>,
    machine: Machine,
    state: Vec<f64>,
    group: Group,
    expected: Vec<Expectation>,
    evidence: Evidence,
    /// Candidates and weights of the last update, in the first lane.
    pub scan: Scan,
}

impl OneTrack {
    /// A track of a filter, before its start.
    pub fn new(filter: Box<dyn Filter>) -> Self {
        let layout = *filter.layout();
        Self {
            machine: Machine::default(),
            state: vec![0.0; layout.words()],
            group: Group::new(&layout),
            expected: Vec::new(),
            evidence: Evidence::default(),
            scan: Scan::new(&layout),
            filter,
        }
    }

    /// The filter.
    pub fn filter(&self) -> &dyn Filter {
        self.filter.as_ref()
    }

    /// The state: the prediction or the posterior, whichever was last made.
    pub fn state(&self) -> Mixture<'_> {
        Mixture::new(self.filter.layout(), &self.state)
    }

    /// The state as words.
    pub fn words(&self) -> &[f64] {
        &self.state
    }

    /// Takes a state.
    pub fn set(&mut self, words: &[f64]) {
        self.state.copy_from_slice(words);
    }

    /// Begins with two plots (T17).
    pub fn start(&mut self, from: &TwoPlots<'_>) {
        self.filter.start(from, &mut self.state);
    }

    /// Predicts by `dt_s`.
    pub fn predict(&mut self, dt_s: f64) {
        self.scan.update.posterior.load(0, &self.state);
        let (posterior, prediction) = (&self.scan.update.posterior, &mut self.group);
        self.filter.predict(self.machine, 1, posterior, &Row::splat(dt_s), prediction);
        self.group.store(0, &mut self.state);
    }

    /// The gates of a predicted state, by component.
    pub fn gates(&mut self, words: &[f64], radar: &Radar, alpha: f64) -> Vec<Gate> {
        self.group.load(0, words);
        expect(self.machine, 1, radar, alpha, &self.group, &mut self.expected);
        self.expected.iter().map(|expected| Gate::new(expected, 0, alpha)).collect()
    }

    /// Updates a prediction by one scan.
    pub fn update<F: Fn(&Measurement) -> FalsePlots>(
        &mut self,
        member: Member<'_, F>,
        radar: &Radar,
        rules: &Rules,
    ) -> Outcome {
        self.scan.prediction.load(0, &self.state);
        self.scan.update(self.filter.as_ref(), self.machine, [member].into_iter(), radar, rules);
        self.scan.update.posterior.store(0, &mut self.state);
        self.scan.outcomes[0]
    }

    /// Updates a prediction by a plot that is the track's for certain, with R at the plot. Nothing is gated, so the radar does not matter.
    pub fn take(&mut self, plot: &Measurement) {
        let Self { filter, machine, state, group, expected, evidence, scan } = self;
        group.load(0, state);
        expect(*machine, 1, &Radar::IN_PLANE, 1.0, group, expected);
        let at = plot.line_of_sight();
        for expected in &mut *expected {
            expected.place_errors(0, &at);
        }
        evidence.clear(expected.len());
        evidence.add(0, plot, 0.0, 1.0);
        evidence.decide();
        filter.update(*machine, 1, Prior { prediction: group, expected, inflation: 0.0 }, evidence, &mut scan.update);
        scan.update.posterior.store(0, state);
    }
}
