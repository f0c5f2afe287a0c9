//! The Markov chain of models that a target keeps, or leaves for any other alike, over any time step.
//!
//! Of n models, of which a target keeps one over 1 s with probability p:
//! ```text
//! Π(T) = Π(1 s)^T:  eigenvalues 1 and κ^T, κ = (n p − 1)/(n − 1), so  Π_ii = (1 + (n − 1) κ^T)/n,   Π_ij = (1 − κ^T)/n
//! W*_j = Σ_i Π_ij W_i,   s_i = Π_ij W_i/W*_j                                                      (T2)
//! ```

use pulp::Simd;

use super::lanes::{Lanes, V};

/// ln κ per second, of models of which a target keeps one over `over_s` (s) with probability `stay`. A single model is never left.
pub(in crate::filter) fn ln_kappa(models: usize, stay: f64, over_s: f64) -> f64 {
    let n = models as f64;
    if models > 1 { ((n * stay - 1.0) / (n - 1.0)).ln() / over_s } else { 0.0 }
}

/// Π of some lanes over their time steps.
#[derive(Clone, Copy)]
pub(in crate::filter) struct Transition<S: Simd> {
    /// Π_ii.
    pub(in crate::filter) same: V<S>,
    /// Π_ij.
    pub(in crate::filter) other: V<S>,
}

impl<S: Simd> Transition<S> {
    /// Over `step`, s.
    #[inline(always)]
    pub(in crate::filter) fn new(lanes: Lanes<S>, models: usize, ln_kappa: f64, step: V<S>) -> Self {
        let (one, per_model) = (lanes.splat(1.0), lanes.splat(1.0 / models as f64));
        let power = (step * lanes.splat(ln_kappa)).rounded().exp();
        Self {
            same: ((power * lanes.splat(models as f64 - 1.0) + one) * per_model).rounded(),
            other: ((one - power) * per_model).rounded(),
        }
    }
}

/// Fills in s_i of a model from its column of Π and the weights before. Returns W*_j. A model that cannot be reached takes the weights as its
/// shares: it keeps the mixture as its state, at no weight.
#[inline(always)]
pub(in crate::filter) fn mix<S: Simd>(column: &[V<S>], weights: &[V<S>], shares: &mut [V<S>]) -> V<S> {
    let mut total = (column[0] * weights[0]).rounded();
    for i in 1..weights.len() {
        total += column[i] * weights[i];
    }
    let (reachable, inverse) = (total.splat(0.0).less(total), total.inverse());
    for i in 0..weights.len() {
        shares[i] = reachable.pick(column[i] * weights[i] * inverse, weights[i]);
    }
    total
}
