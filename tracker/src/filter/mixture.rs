//! One state as the short list of weighted normal distributions that it is.

use common::tracks::STATE;
use nalgebra::Vector3;

use super::gaussian::{Gaussian, at, packed};
use super::layout::Layout;

/// The state of one track, as a family's [`Layout`] says.
#[derive(Debug, Clone, Copy)]
pub struct Mixture<'a> {
    layout: &'a Layout,
    words: &'a [f64],
}

impl<'a> Mixture<'a> {
    /// Of a state in the form of `layout`.
    pub fn new(layout: &'a Layout, words: &'a [f64]) -> Self {
        debug_assert!(words.len() >= layout.words(), "{} words, not {}", words.len(), layout.words());
        Self { layout, words }
    }

    /// The words.
    pub fn words(&self) -> &'a [f64] {
        &self.words[..self.layout.words()]
    }

    /// W by component; they sum to 1.
    pub fn weights(&self) -> &'a [f64] {
        &self.words[..self.layout.len()]
    }

    /// u of component `j`: the states that it knows.
    pub fn mean(&self, j: usize) -> &'a [f64] {
        &self.words[self.layout.start(j)..][..self.layout.known(j)]
    }

    /// Packed P of component `j`.
    pub fn covariance(&self, j: usize) -> &'a [f64] {
        let n = self.layout.known(j);
        &self.words[self.layout.start(j) + n..][..packed(n)]
    }

    /// What the family keeps besides.
    pub fn memory(&self) -> &'a [f64] {
        &self.words[self.layout.memory_start()..self.layout.words()]
    }

    /// Component `j`, 0 in what it does not know.
    pub fn gaussian(&self, j: usize) -> Gaussian {
        let mut gaussian = Gaussian::ZERO;
        let n = self.layout.known(j);
        gaussian.mean[..n].copy_from_slice(self.mean(j));
        gaussian.covariance[..packed(n)].copy_from_slice(self.covariance(j));
        gaussian
    }

    /// Range rate of the mean, m/s; 0 at the antenna.
    pub fn range_rate_mps(&self) -> f64 {
        let [position, velocity] = [0, 3].map(|first| Vector3::from_fn(|axis, _| self.mean_of(first + axis)));
        common::geometry::range_rate_mps(&position, &velocity)
    }

    /// Σ_j W_j u_j of state `i`.
    pub fn mean_of(&self, i: usize) -> f64 {
        let weights = self.weights().iter().enumerate();
        weights.map(|(j, weight)| weight * self.mean(j).get(i).copied().unwrap_or(0.0)).sum()
    }

    /// Mean and covariance of all components together (T16).
    pub fn moments(&self) -> Gaussian {
        let mut all = Gaussian { mean: std::array::from_fn(|i| self.mean_of(i)), ..Gaussian::ZERO };
        for (j, weight) in self.weights().iter().enumerate() {
            all.accumulate(*weight, &self.gaussian(j), STATE);
        }
        all
    }

    /// Index of the most probable component (the first of equals).
    pub fn most_probable(&self) -> usize {
        most_probable(self.weights())
    }

    /// No NaN, no infinity, no negative variance in any component; weights sum to 1.
    pub fn is_sound(&self) -> bool {
        self.words[..self.layout.words()].iter().all(|word| word.is_finite())
            && (self.weights().iter().sum::<f64>() - 1.0).abs() < 1e-9
            && (0..self.layout.len()).all(|j| (0..self.layout.known(j)).all(|i| self.covariance(j)[at(i, i)] >= 0.0))
    }
}

/// Index of the largest weight (the first of equals).
pub fn most_probable(weights: &[f64]) -> usize {
    let mut best = 0;
    for j in 1..weights.len() {
        if weights[j] > weights[best] {
            best = j;
        }
    }
    best
}

/// Moments of states of one form, component by component; `shares` sum to 1. The memory is that of the first.
pub fn merge(layout: &Layout, shares: &[f64], states: &[f64], into: &mut [f64]) {
    let words = layout.words();
    let state = |index: usize| Mixture::new(layout, &states[index * words..][..words]);
    into[..words].copy_from_slice(&states[..words]);
    for j in 0..layout.len() {
        let n = layout.known(j);
        let total: f64 = shares.iter().enumerate().map(|(index, share)| share * state(index).weights()[j]).sum();
        let weight = |index: usize| {
            if total > 0.0 { shares[index] * state(index).weights()[j] / total } else { shares[index] }
        };
        let mut merged = Gaussian::ZERO;
        for index in 0..shares.len() {
            let weight = weight(index);
            for (sum, value) in merged.mean.iter_mut().zip(state(index).mean(j)) {
                *sum += weight * value;
            }
        }
        for index in 0..shares.len() {
            merged.accumulate(weight(index), &state(index).gaussian(j), n);
        }
        into[j] = total;
        let start = layout.start(j);
        into[start..start + n].copy_from_slice(&merged.mean[..n]);
        into[start + n..][..packed(n)].copy_from_slice(&merged.covariance[..packed(n)]);
    }
}
