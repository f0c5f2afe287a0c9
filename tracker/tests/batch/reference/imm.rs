//! The interacting multiple-model estimator, one track at a time: mixing, prediction and output (T2)-(T4), (T16), as they are written.

use common::tracks::{PACKED, STATE};

use super::motion::{DIMENSIONS, Motion};
use tracker::filter::gaussian::{Gaussian, at, packed};
use tracker::filter::uav::{MODES, Uav};
use tracker::filter::{Filter, Mixture};

/// Π: probability of the step from mode i (row) to mode j (column).
pub(crate) type Transition = [[f64; MODES]; MODES];

/// One Gaussian and one probability per mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Imm {
    /// û, P̂ (or u*, P* when predicted) by mode.
    pub(crate) modes: [Gaussian; MODES],
    /// W (or W*) by mode; they sum to 1.
    pub(crate) probability: [f64; MODES],
}

/// Π over `dt_s` of the chain that stays in its mode with probability `stay` over 1 s and else
/// goes to either other mode alike.
///
/// ```text
/// Π(dt) = Π(1 s)^dt:  eigenvalues 1 and κ = (3 stay − 1)/2, so  Π_ii = 1/3 + 2/3 κ^dt
/// ```
///
/// Needs `stay` > 1/3. Powers of 1 s give the printed matrix exactly only up to rounding.
pub(crate) fn transition(stay: f64, dt_s: f64) -> Transition {
    let kappa = (0.5 * (3.0 * stay - 1.0)).powf(dt_s);
    let same = (1.0 + 2.0 * kappa) / 3.0;
    let other = (1.0 - kappa) / 3.0;
    let mut matrix = [[other; MODES]; MODES];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = same;
    }
    matrix
}

impl Imm {
    /// Mixing and prediction by `dt_s`.
    ///
    /// ```text
    /// W*_j = Σ_i Π_ij W_i                                                             (T2)
    /// ū_j  = Σ_i Π_ij W_i û_i / W*_j,   u*_j = F_j ū_j                                (T3)
    /// P*_j = F_j { Σ_i (Π_ij W_i / W*_j) [P̂_i + (û_i − ū_j)(û_i − ū_j)ᵀ] } F_jᵀ + G_j G_jᵀ   (T4)
    /// ```
    ///
    /// F is the destination mode's; only the states it keeps are mixed.
    #[must_use]
    pub(crate) fn predict(&self, transition: &Transition, motion: &Motion, dt_s: f64) -> Self {
        let mut predicted = Self { modes: [Gaussian::ZERO; MODES], probability: [0.0; MODES] };
        for (j, &n) in DIMENSIONS.iter().enumerate() {
            let joint: [f64; MODES] = std::array::from_fn(|i| transition[i][j] * self.probability[i]);
            let total: f64 = joint.iter().sum(); // (T2)
            // A mode that cannot be reached keeps the mixture as its state, at no weight.
            let share = if total > 0.0 { joint.map(|w| w / total) } else { self.probability };
            let mixed = &mut predicted.modes[j];
            for (weight, mode) in share.iter().zip(&self.modes) {
                for i in 0..n {
                    mixed.mean[i] += weight * mode.mean[i];
                }
            }
            for (weight, mode) in share.iter().zip(&self.modes) {
                accumulate(mixed, *weight, mode, n);
            }
            motion.predict(j, mixed, dt_s); // (T3), (T4)
            predicted.probability[j] = total;
        }
        predicted
    }

    /// The modes of a state of the filter under test.
    pub(crate) fn of(state: Mixture<'_>) -> Self {
        Self {
            modes: std::array::from_fn(|j| state.gaussian(j)),
            probability: std::array::from_fn(|j| state.weights()[j]),
        }
    }

    /// The state of the filter under test; what a mode does not know is dropped.
    pub(crate) fn words(&self, filter: &Uav) -> Vec<f64> {
        let layout = filter.layout();
        let mut words = vec![0.0; layout.words()];
        words[..MODES].copy_from_slice(&self.probability);
        for (j, gaussian) in self.modes.iter().enumerate() {
            let n = layout.known(j);
            let (mean, covariance) = words[layout.start(j)..].split_at_mut(n);
            mean.copy_from_slice(&gaussian.mean[..n]);
            covariance[..packed(n)].copy_from_slice(&gaussian.covariance[..packed(n)]);
        }
        words
    }

    /// Mean and covariance of the whole mixture (T16).
    pub(crate) fn mixture(&self) -> Gaussian {
        let mut mixture = Gaussian { mean: [0.0; STATE], covariance: [0.0; PACKED] };
        for (weight, mode) in self.probability.iter().zip(&self.modes) {
            for i in 0..STATE {
                mixture.mean[i] += weight * mode.mean[i];
            }
        }
        for (weight, mode) in self.probability.iter().zip(&self.modes) {
            accumulate(&mut mixture, *weight, mode, STATE);
        }
        mixture
    }

    /// No NaN, no infinity, no negative variance in any mode; probabilities sum to 1.
    pub(crate) fn is_sound(&self) -> bool {
        self.modes.iter().all(is_sound) && (self.probability.iter().sum::<f64>() - 1.0).abs() < 1e-9
    }
}

const _: () = assert!(packed(DIMENSIONS[MODES - 1]) == PACKED);

fn is_sound(gaussian: &Gaussian) -> bool {
    gaussian.mean.iter().chain(&gaussian.covariance).all(|value| value.is_finite())
        && (0..STATE).all(|i| gaussian.covariance[at(i, i)] >= 0.0)
}

/// Adds `weight` · (P + d dᵀ), d = `other` − u, to the leading `n` states' covariance: one term of
/// a mixture whose mean is already known.
fn accumulate(sum: &mut Gaussian, weight: f64, other: &Gaussian, n: usize) {
    let d: [f64; STATE] = std::array::from_fn(|i| if i < n { other.mean[i] - sum.mean[i] } else { 0.0 });
    for j in 0..n {
        for i in 0..=j {
            sum.covariance[at(i, j)] += weight * (other.covariance[at(i, j)] + d[i] * d[j]);
        }
    }
}

mod tests {
    use super::*;

    #[test]
    fn the_chain_over_one_second_is_the_printed_one_and_composes() {
        let one = transition(0.9, 1.0);
        assert!((one[0][0] - 0.9).abs() < 1e-15 && (one[0][1] - 0.05).abs() < 1e-15);
        let half = transition(0.9, 0.5);
        for i in 0..MODES {
            for j in 0..MODES {
                let twice: f64 = (0..MODES).map(|k| half[i][k] * half[k][j]).sum();
                assert!((twice - one[i][j]).abs() < 1e-14);
            }
        }
    }
}
