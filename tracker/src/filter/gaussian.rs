//! Mean and covariance of a target's motion, in the order that the filters work in.
//!
//! ```text
//! u = [x y z | ẋ ẏ ż | ẍ ÿ z̈]        derivative by derivative, ENU; m, m/s, m/s²
//! P = upper triangle, column by column: element (i ≤ j) at j (j + 1)/2 + i
//! ```
//!
//! So a component that knows only positions, or positions and velocities, is a prefix of
//! both: its 3 or 6 states, its 6 or 21 covariances. One triangle is stored, which makes
//! every covariance symmetric by construction. Messages keep the order
//! [x ẋ ẍ y ẏ ÿ z ż z̈] of the design; [`Gaussian::to_message`] translates.

use common::tracks::{self, PACKED, STATE};
use nalgebra::{SMatrix, SVector};

/// Index of element (row, column) of a symmetric matrix in its packed triangle.
pub const fn at(row: usize, column: usize) -> usize {
    if row <= column { column * (column + 1) / 2 + row } else { row * (row + 1) / 2 + column }
}

/// Elements of the packed triangle of an n×n matrix.
pub const fn packed(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Place of component i of u in the order of messages.
pub const MESSAGE_ORDER: [usize; STATE] = [0, 3, 6, 1, 4, 7, 2, 5, 8];

/// Place of element (row, column) of P in the packed covariance of messages.
pub const fn message_index(row: usize, column: usize) -> usize {
    tracks::pack(MESSAGE_ORDER[row], MESSAGE_ORDER[column])
}

/// A normal distribution of the nine states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// u.
    pub mean: [f64; STATE],
    /// Packed triangle of P.
    pub covariance: [f64; PACKED],
}

impl Gaussian {
    /// All zero: a certain target at the antenna.
    pub const ZERO: Self = Self { mean: [0.0; STATE], covariance: [0.0; PACKED] };

    /// From vector and matrix in the order of messages; the lower triangle is not read.
    pub fn from_message_order(mean: &SVector<f64, STATE>, covariance: &SMatrix<f64, STATE, STATE>) -> Self {
        let mut gaussian = Self::ZERO;
        for i in 0..STATE {
            gaussian.mean[i] = mean[MESSAGE_ORDER[i]];
            for j in i..STATE {
                let (row, column) = (MESSAGE_ORDER[i], MESSAGE_ORDER[j]);
                gaussian.covariance[at(i, j)] = covariance[(row.min(column), row.max(column))];
            }
        }
        gaussian
    }

    /// Mean and packed covariance as [`common::tracks::Track`] carries them.
    pub fn to_message(&self) -> ([f64; STATE], [f64; PACKED]) {
        let (mut mean, mut covariance) = ([0.0; STATE], [0.0; PACKED]);
        for i in 0..STATE {
            mean[MESSAGE_ORDER[i]] = self.mean[i];
            for j in i..STATE {
                covariance[message_index(i, j)] = self.covariance[at(i, j)];
            }
        }
        (mean, covariance)
    }

    /// From mean and packed covariance as [`common::tracks::Track`] carries them.
    pub fn from_message(mean: &[f64; STATE], covariance: &[f64; PACKED]) -> Self {
        let mut gaussian = Self::ZERO;
        for j in 0..STATE {
            gaussian.mean[j] = mean[MESSAGE_ORDER[j]];
            for i in 0..=j {
                gaussian.covariance[at(i, j)] = covariance[message_index(i, j)];
            }
        }
        gaussian
    }

    /// (x, y, z), m.
    pub fn position(&self) -> [f64; 3] {
        [self.mean[0], self.mean[1], self.mean[2]]
    }

    /// (ẋ, ẏ, ż), m/s.
    pub fn velocity(&self) -> [f64; 3] {
        [self.mean[3], self.mean[4], self.mean[5]]
    }

    /// Adds `weight` · (P + d dᵀ), d = `other` − u, to the leading `n` states' covariance: one term of
    /// a mixture whose mean is already known.
    pub(crate) fn accumulate(&mut self, weight: f64, other: &Self, n: usize) {
        let mut d = [0.0; STATE];
        for i in 0..n {
            d[i] = other.mean[i] - self.mean[i];
        }
        let mut index = 0;
        for j in 0..n {
            let scaled = weight * d[j];
            for d_i in &d[..=j] {
                self.covariance[index] += weight * other.covariance[index] + scaled * d_i;
                index += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_a_prefix() {
        assert_eq!(at(8, 8), PACKED - 1);
        assert_eq!(at(2, 2) + 1, packed(3));
        assert_eq!(at(5, 5) + 1, packed(6));
        assert_eq!(at(1, 4), at(4, 1));
    }

    #[test]
    fn message_order_and_back() {
        let mean = SVector::<f64, STATE>::from_fn(|i, _| i as f64);
        let covariance = SMatrix::<f64, STATE, STATE>::from_fn(|i, j| (i.min(j) * 10 + i.max(j)) as f64);
        let gaussian = Gaussian::from_message_order(&mean, &covariance);
        assert_eq!(gaussian.velocity().map(f64::to_bits), [1.0, 4.0, 7.0].map(f64::to_bits));
        let (back, packed) = gaussian.to_message();
        assert_eq!(back.as_slice(), mean.as_slice());
        assert_eq!(Gaussian::from_message(&back, &packed), gaussian);
        for i in 0..STATE {
            for j in 0..STATE {
                assert_eq!(packed[tracks::pack(i, j)].to_bits(), covariance[(i, j)].to_bits());
            }
        }
    }
}
