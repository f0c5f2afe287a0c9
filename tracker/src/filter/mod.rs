//! Estimation: families of filters behind one seam, and the mathematics that they share.
//!
//! Whatever a family is, everyone else (gates, association, joint events, resolution, hypotheses, life, messages) sees its state as a short
//! list of weighted normal distributions, each of the leading 3, 6 or 9 states ([`Layout`], [`Mixture`]). The association turns the plots of
//! a scan into [`Evidence`] once, for every component; that is all that a family learns of a scan. A family ([`Filter`]) says how a state
//! starts, how it is predicted, and, where that is not the rule, how it is updated, merged and reported.
//!
//! ```text
//! layout, mixture   one state as numbers              lanes, functions  vectors of up to eight tracks
//! gaussian          order of states, packed triangles group             states of up to eight tracks
//! start             two plots make a state    (T17)   machine           the machine's instructions
//! propagate         F, G of a component  (T1), (T4)   expect            h(u*), gates       (T5), (T9)
//! uav, cv           the families                      evidence, absorb  the update   (T8), (T14), (T15)
//!                                                     moments           mean and covariance    (T16)
//! ```
//!
//! Formulas are written once, over vectors of up to eight tracks whose width is the machine's; one or two tracks are computed by the same code
//! with vectors of one ([`Machine`]). The filters know neither the beam nor where plots are stored nor the numbers of tracks.

#![expect(clippy::inline_always, reason = "vectors must stay in the function that was compiled for the machine")]

mod absorb;
pub mod cv;
mod evidence;
mod expect;
mod functions;
pub mod gaussian;
mod group;
mod lanes;
mod layout;
mod machine;
mod mixture;
mod moments;
mod propagate;
mod start;
pub mod uav;

use std::fmt::Debug;

use common::config::{Estimator, TrackerConfig};
use common::tracks::Models;

use crate::plots::measurement::COORDINATES;
use crate::plots::radar::Radar;

pub use absorb::{Densities, Weights, absorb};
pub use evidence::Evidence;
pub use expect::{Expectation, expect};
pub use group::Group;
pub use lanes::{LANES, Row};
pub use layout::Layout;
pub use machine::Machine;
pub use mixture::{Mixture, merge, most_probable};
pub use moments::Moments;
pub use start::TwoPlots;

/// Elements of the packed triangle of D.
const PACKED_4: usize = gaussian::packed(COORDINATES);

/// What is known of a group before a scan.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// u*, P*, W*.
    pub prediction: &'a Group,
    /// What each component expects.
    pub expected: &'a [Expectation],
    /// γ of (T7).
    pub inflation: f64,
}

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

    /// Writes the state of a target of which two plots are known.
    fn start(&self, from: &TwoPlots<'_>, state: &mut [f64]);

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
    fn complete(&self, _state: Mixture<'_>, _component: Option<usize>, _of: &mut gaussian::Gaussian) {}
}

/// The form of the states of a family.
pub fn layout_of(estimator: Estimator) -> Layout {
    match estimator {
        Estimator::ImmUav => uav::LAYOUT,
        Estimator::Cv => cv::LAYOUT,
    }
}

/// The family that the configuration names, for a radar.
pub fn family(config: &TrackerConfig, radar: &Radar) -> Box<dyn Filter> {
    let axes = if radar.measured[2] { 3 } else { 2 };
    match config.estimator {
        Estimator::ImmUav => Box::new(uav::Uav::new(config, axes)),
        Estimator::Cv => Box::new(cv::ConstantVelocity::new(config.cv_noise_mps2, axes)),
    }
}
