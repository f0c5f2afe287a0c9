//! Which turn rates the models have in the next scan.

use common::tracks::MODELS;

use super::adaptive::AdaptiveGrid;
use super::switching::SwitchingGrid;

/// Index of the left, central and right model of three.
pub(super) const LEFT: usize = 0;
pub(super) const CENTRE: usize = 1;
pub(super) const RIGHT: usize = 2;

/// How the rates follow from what a scan has shown.
#[derive(Debug, Clone, PartialEq)]
pub enum Grid {
    /// They are known (V2), rad/s.
    Known(Vec<f64>),
    /// Three rates move with the target, and closer or farther apart (V3).
    Adaptive(AdaptiveGrid),
    /// Three neighbours out of known rates (V4).
    Switching(SwitchingGrid),
}

/// What models of a moved grid begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carry {
    /// The states and probabilities of the models that stood in their places.
    ByPlace,
    /// Those of the models of their rates, where there were any.
    ByRate,
}

/// The rates of the next scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Next {
    /// Of each model, rad/s.
    pub(super) rates: [f64; MODELS],
    /// How many places a rate has moved to the left, by [`Carry::ByRate`].
    pub(super) moved: i8,
}

impl Grid {
    /// Number of models.
    pub fn models(&self) -> usize {
        match self {
            Self::Known(rates) => rates.len(),
            Self::Adaptive(_) | Self::Switching(_) => 3,
        }
    }

    /// Rates of a new track.
    pub(super) fn first(&self) -> &[f64] {
        match self {
            Self::Known(rates) => rates,
            Self::Adaptive(grid) => &grid.first,
            Self::Switching(grid) => grid.first(),
        }
    }

    /// Largest of all rates that a model can have, rad/s.
    pub(super) fn greatest(&self) -> f64 {
        let largest = |rates: &[f64]| rates.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        match self {
            Self::Known(rates) => largest(rates),
            Self::Adaptive(grid) => grid.greatest,
            Self::Switching(grid) => largest(&grid.rates),
        }
    }

    /// Rates after a scan at whose end models of `rates` had the probabilities `mu`.
    pub(super) fn next(&self, rates: [f64; MODELS], mu: &[f64; MODELS]) -> Next {
        let three = |all: &[f64; MODELS]| [all[LEFT], all[CENTRE], all[RIGHT]];
        let mut next = Next { rates, moved: 0 };
        match self {
            Self::Known(_) => {}
            Self::Adaptive(grid) => next.rates[..3].copy_from_slice(&grid.adapt(three(&rates), three(mu))),
            Self::Switching(grid) => {
                let (switched, step) = grid.switch(three(&rates), three(mu));
                next.rates[..3].copy_from_slice(&switched);
                next.moved = if grid.carry == Carry::ByRate { step } else { 0 };
            }
        }
        next
    }
}
