//! The seam between families of filters and everyone else.

use std::fmt::Debug;

use common::tracks::Models;

use super::absorb::{Densities, Weights, absorb};
use super::evidence::Evidence;
use super::gaussian::Gaussian;
use super::group::Group;
use super::lanes::Row;
use super::layout::Layout;
use super::machine::Machine;
use super::mixture::{Mixture, merge};
use super::prior::Prior;
use super::start::Origin;

/// What a scan makes of a group.
#[derive(Debug)]
pub struct Update {
    /// û, P̂, W.
    pub posterior: Group,
    /// L_j, w_jm, w_j0.
    pub weights: Weights,
    /// Where densities are asked for.
    pub densities: Densities,
}

impl Update {
    /// Room for states of a form.
    pub fn new(layout: &Layout) -> Self {
        Self { posterior: Group::new(layout), weights: Weights::default(), densities: Densities::default() }
    }
}

/// A family of filters: how states of its [`Layout`] begin, move and learn.
pub trait Filter: Debug + Send + Sync {
    /// The form of its states.
    fn layout(&self) -> &Layout;

    /// Its number in messages: `ESTIMATOR_…` of [`common::tracks`].
    fn estimator(&self) -> u16;

    /// Change of range rate in a second that a target which starts a track may make, m/s².
    fn greatest_acceleration_mps2(&self) -> f64;

    /// Writes the state of a target of which two plots are known, or that has been followed before.
    fn start(&self, from: &dyn Origin, state: &mut [f64]);

    /// Gives a state that has just begun the probabilities of models that it had before, if they are the same models.
    fn believe(&self, before: &Models, state: &mut [f64]) {
        let layout = self.layout();
        let own = self.models(Mixture::new(layout, state));
        let same = own.count == layout.len()
            && own.count == before.count
            && own.kind == before.kind
            && own.parameter.map(f64::to_bits) == before.parameter.map(f64::to_bits);
        if same {
            state[..own.count].copy_from_slice(&before.probability[..own.count]);
        }
    }

    /// Predicts the states in `lanes` lanes by the time of each lane, s.
    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group);

    /// Updates the predictions in `lanes` lanes by the evidence of a scan. As a rule every component takes all of it.
    fn update(&self, machine: Machine, lanes: usize, prior: Prior<'_>, evidence: &Evidence, update: &mut Update) {
        let Update { posterior, weights, densities } = update;
        absorb(machine, lanes, prior, evidence, densities, weights, posterior);
    }

    /// One state with the moments of several; `shares` sum to 1. As a rule component by component.
    fn merge(&self, shares: &[f64], states: &[f64], into: &mut [f64]) {
        merge(self.layout(), shares, states, into);
    }

    /// What the state says of the target's way to move, for messages.
    fn models(&self, state: Mixture<'_>) -> Models;

    /// Adds to a covariance what a state says of states that its components do not know: of one component, or of all together. As a rule
    /// nothing.
    fn complete(&self, _state: Mixture<'_>, _component: Option<usize>, _of: &mut Gaussian) {}
}
