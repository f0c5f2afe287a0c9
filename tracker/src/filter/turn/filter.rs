//! Turn models as a family.

use common::config::{Estimator, TrackerConfig};
use common::tracks::{
    ESTIMATOR_ADAPTIVE_GRID, ESTIMATOR_IMM_TURN, ESTIMATOR_SWITCHING_GRID, KIND_COORDINATED_TURN, Models,
};

use super::adaptive::AdaptiveGrid;
use super::advance::KNOWN;
use super::grid::{Carry, Grid};
use super::predict;
use super::switching::SwitchingGrid;
use crate::filter::absorb::absorb;
use crate::filter::evidence::Evidence;
use crate::filter::gaussian::packed;
use crate::filter::group::Group;
use crate::filter::lanes::Row;
use crate::filter::layout::Layout;
use crate::filter::machine::Machine;
use crate::filter::markov;
use crate::filter::mixture::Mixture;
use crate::filter::prior::Prior;
use crate::filter::propagate::Noise;
use crate::filter::seam::{Filter, Update};
use crate::filter::start::Origin;

pub(super) const PACKED: usize = packed(KNOWN);
/// μ₀ of the model of least rate; the rest is shared alike.
const STRAIGHT_PROBABILITY: f64 = 0.9;

/// The filter: its grid and constants.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Which rates its models have.
    pub grid: Grid,
    /// σ_a, m/s².
    pub noise_mps2: f64,
    /// 3, or 2 for a radar without elevation: z and its derivative then stay zero.
    pub axes: usize,
    /// Speed up to which targets start tracks, m/s.
    pub start_speed_mps: f64,
    /// ln κ of the Markov chain, 1/s.
    pub(super) ln_kappa: f64,
    pub(super) layout: Layout,
}

impl Turn {
    /// With models of a grid, of which a target keeps one over `over_s` with probability `stay`.
    pub fn new(grid: Grid, noise_mps2: f64, axes: usize, start_speed_mps: f64, stay: f64, over_s: f64) -> Self {
        let (ln_kappa, layout) = (markov::ln_kappa(grid.models(), stay, over_s), layout(grid.models()));
        Self { grid, noise_mps2, axes, start_speed_mps, ln_kappa, layout }
    }

    /// The family that the configuration names, in `axes` dimensions.
    pub fn configured(config: &TrackerConfig, axes: usize) -> Self {
        let turn = &config.turn;
        let rates = || turn.rates_deg_per_s.iter().map(|rate| rate.to_radians()).collect();
        let grid = match config.estimator {
            Estimator::AdaptiveGrid => {
                let spacing = turn.spacing_deg_per_s.to_radians();
                Grid::Adaptive(AdaptiveGrid {
                    first: [-spacing, 0.0, spacing],
                    greatest: turn.greatest_rate_deg_per_s.to_radians(),
                    spacing,
                    recentre: turn.recentre_probability,
                    narrow: turn.narrow_probability,
                    widen: turn.widen_probability,
                })
            }
            Estimator::SwitchingGrid => Grid::Switching(SwitchingGrid {
                rates: rates(),
                threshold: turn.switch_probability,
                carry: Carry::ByPlace,
                undecided_steps_right: false,
            }),
            _ => Grid::Known(rates()),
        };
        Self::new(grid, turn.noise_mps2, axes, config.start_speed_mps, turn.stay_probability, 1.0)
    }
}

/// The form of states of a number of models.
pub(in crate::filter) fn layout(models: usize) -> Layout {
    Layout::new(&[KNOWN; common::tracks::MODELS][..models], models + 1, models / 2, models / 2)
}

impl Filter for Turn {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn estimator(&self) -> u16 {
        match self.grid {
            Grid::Known(_) => ESTIMATOR_IMM_TURN,
            Grid::Adaptive(_) => ESTIMATOR_ADAPTIVE_GRID,
            Grid::Switching(_) => ESTIMATOR_SWITCHING_GRID,
        }
    }

    /// In the fastest turn of the fastest target.
    fn greatest_acceleration_mps2(&self) -> f64 {
        self.noise_mps2 + self.grid.greatest() * self.start_speed_mps
    }

    /// (T17) without the term of the noise, which the first prediction adds.
    fn start(&self, from: &dyn Origin, state: &mut [f64]) {
        let gaussian = from.moving(Noise { amplitude: 0.0, axes: self.axes });
        let rates = self.grid.first();
        let straight = (1..rates.len()).fold(0, |best, j| if rates[j].abs() < rates[best].abs() { j } else { best });
        let turning = (1.0 - STRAIGHT_PROBABILITY) / (rates.len() - 1).max(1) as f64;
        for j in 0..rates.len() {
            state[j] = if j == straight { 1.0 - turning * (rates.len() - 1) as f64 } else { turning };
            let (mean, rest) = state[self.layout.start(j)..].split_at_mut(KNOWN);
            mean.copy_from_slice(&gaussian.mean[..KNOWN]);
            rest[..PACKED].copy_from_slice(&gaussian.covariance[..PACKED]);
        }
        let memory = self.layout.memory_start();
        state[memory..memory + rates.len()].copy_from_slice(rates);
        state[memory + rates.len()] = 0.0;
    }

    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group) {
        predict::predict(self, machine, lanes, posterior, step_s, prediction);
    }

    /// As the rule; and whether the scan has shown the target.
    fn update(&self, machine: Machine, lanes: usize, prior: Prior<'_>, evidence: &Evidence, update: &mut Update) {
        let Update { posterior, weights, densities } = update;
        absorb(machine, lanes, prior, evidence, densities, weights, posterior);
        let shown = self.layout.words() - 1;
        for lane in 0..lanes {
            let none = weights.of_none(lane, posterior);
            posterior.rows_mut()[shown].0[lane] = if none < 0.5 { 1.0 } else { 0.0 };
        }
    }

    fn models(&self, state: Mixture<'_>) -> Models {
        let mut models = Models::default();
        for (probability, rate) in state.weights().iter().zip(state.memory()) {
            models.push(KIND_COORDINATED_TURN, *probability, *rate);
        }
        models
    }
}
