//! What a state begins with: two plots (T17), or what a tracker before has published of the track.
//!
//! Two plots:
//! ```text
//! position y_k,  velocity (y_k − y_(k−1))/T,  acceleration 0
//! P_pp = R_k,  P_pv = R_k/T,  P_vv = (R_k + R_(k−1))/T² + a_j² T² I,  P_aa = a_j² I
//! ```
//!
//! Full 3×3 blocks, the actual T. The term a_j²T² is the source's, on the safe side of the component's own noise.

use super::gaussian::{Gaussian, at};
use super::propagate::Noise;
use crate::plots::measurement::{Measurement, position_covariance};

/// What is known of a target when its state begins.
pub trait Origin {
    /// The state of a target that moves, with a component's noise.
    fn moving(&self, noise: Noise) -> Gaussian;

    /// The state of a target at rest: its position only.
    fn resting(&self) -> Gaussian;
}

/// The two plots that a track begins with.
#[derive(Debug, Clone, Copy)]
pub struct TwoPlots<'a> {
    /// The earlier one.
    pub previous: &'a Measurement,
    /// The later one, at whose time the track begins.
    pub last: &'a Measurement,
    /// T > 0, s.
    pub step_s: f64,
}

impl Origin for TwoPlots<'_> {
    fn moving(&self, noise: Noise) -> Gaussian {
        let (r_last, r_previous) = (errors(self.last), errors(self.previous));
        let mut gaussian = self.resting();
        let (step_s, square) = (self.step_s, noise.amplitude * noise.amplitude);
        for b in 0..3 {
            gaussian.mean[3 + b] = (self.last.position[b] - self.previous.position[b]) / step_s;
            for a in 0..3 {
                gaussian.covariance[at(a, 3 + b)] = r_last[at(a, b)] / step_s;
            }
            for a in 0..=b {
                gaussian.covariance[at(3 + a, 3 + b)] = (r_last[at(a, b)] + r_previous[at(a, b)]) / (step_s * step_s);
            }
        }
        for axis in 0..noise.axes {
            gaussian.covariance[at(3 + axis, 3 + axis)] += square * step_s * step_s;
            gaussian.covariance[at(6 + axis, 6 + axis)] = square;
        }
        gaussian
    }

    fn resting(&self) -> Gaussian {
        let mut gaussian = Gaussian::ZERO;
        gaussian.mean[..3].copy_from_slice(&self.last.position);
        gaussian.covariance[..6].copy_from_slice(&errors(self.last));
        gaussian
    }
}

/// A track that another tracker has followed: the moments of its state.
#[derive(Debug, Clone, Copy)]
pub struct Followed(pub Gaussian);

impl Origin for Followed {
    /// Accelerations that the filter before did not know are as likely as at the start of a track.
    fn moving(&self, noise: Noise) -> Gaussian {
        let Self(mut gaussian) = *self;
        for own in (0..noise.axes).map(|axis| at(6 + axis, 6 + axis)) {
            if gaussian.covariance[own] <= 0.0 {
                gaussian.covariance[own] = noise.amplitude * noise.amplitude;
            }
        }
        gaussian
    }

    fn resting(&self) -> Gaussian {
        let mut gaussian = Gaussian::ZERO;
        gaussian.mean[..3].copy_from_slice(&self.0.mean[..3]);
        gaussian.covariance[..6].copy_from_slice(&self.0.covariance[..6]);
        gaussian
    }
}

/// R of a plot at its own place.
fn errors(plot: &Measurement) -> [f64; 6] {
    position_covariance(&plot.line_of_sight(), [plot.variance[0], plot.variance[1], plot.variance[2]])
}
