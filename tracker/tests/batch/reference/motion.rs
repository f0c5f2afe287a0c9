//! The three modes of motion (T1), one track at a time: the definition that the vectors must equal.
//!
//! Per axis, over a time step T and with the states [position, velocity, acceleration]:
//! ```text
//! F₁ = [1 0 0; 0 0 0; 0 0 0]      G₁ = a₁ [T 0 0]ᵀ
//! F₂ = [1 T 0; 0 1 0; 0 0 0]      G₂ = a₂ [T²/2 T 0]ᵀ            (T1)
//! F₃ = [1 T T²/2; 0 1 T; 0 0 1]   G₃ = a₃ [T³/6 T²/2 T]ᵀ
//! ```

use common::tracks::STATE;

use tracker::filter::gaussian::{Gaussian, at, packed};
use tracker::filter::uav::{CONSTANT_VELOCITY, HOVER, MODES};

/// States that each mode knows: the leading ones.
pub(crate) const DIMENSIONS: [usize; MODES] = [3, 6, 9];

/// Process noise and dimension of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    /// a₁ (m/s), a₂ (m/s²), a₃ (m/s³).
    pub(crate) noise: [f64; MODES],
    /// 3, or 2 for a radar without elevation: z and its derivatives then stay zero.
    pub(crate) axes: usize,
}

impl Motion {
    /// Mean and covariance of `mode` after `dt_s`, in place; of a Gaussian whose states beyond
    /// the mode's own are zero or not to be looked at.
    ///
    /// ```text
    /// u* = F ū,   P* = F P̄ Fᵀ + G Gᵀ                          (T3), (T4)
    /// ```
    ///
    /// F is the same for every axis, so each pair of axes is a 3×3 problem of its own.
    pub(crate) fn predict(&self, mode: usize, gaussian: &mut Gaussian, dt_s: f64) {
        let half_square = 0.5 * dt_s * dt_s;
        match mode {
            HOVER => {}
            CONSTANT_VELOCITY => {
                for axis in 0..3 {
                    gaussian.mean[axis] += dt_s * gaussian.mean[3 + axis];
                }
                drift(&mut gaussian.covariance, dt_s);
            }
            _ => {
                for axis in 0..3 {
                    gaussian.mean[axis] += dt_s * gaussian.mean[3 + axis] + half_square * gaussian.mean[6 + axis];
                    gaussian.mean[3 + axis] += dt_s * gaussian.mean[6 + axis];
                }
                accelerate(&mut gaussian.covariance, dt_s);
            }
        }
        for i in DIMENSIONS[mode]..STATE {
            gaussian.mean[i] = 0.0;
        }
        gaussian.covariance[packed(DIMENSIONS[mode])..].fill(0.0);
        let g = match mode {
            HOVER => [dt_s, 0.0, 0.0],
            CONSTANT_VELOCITY => [half_square, dt_s, 0.0],
            _ => [half_square * dt_s / 3.0, half_square, dt_s],
        }
        .map(|g| g * self.noise[mode]);
        for axis in 0..self.axes {
            for j in 0..=mode {
                for i in 0..=j {
                    gaussian.covariance[at(3 * i + axis, 3 * j + axis)] += g[i] * g[j];
                }
            }
        }
    }
}

/// F₂ P F₂ᵀ on the leading six states.
fn drift(p: &mut [f64], t: f64) {
    for b in 0..3 {
        for a in 0..=b {
            let vv = p[at(3 + a, 3 + b)];
            p[at(a, b)] += t * (p[at(a, 3 + b)] + p[at(b, 3 + a)] + t * vv);
        }
    }
    for b in 0..3 {
        for a in 0..3 {
            p[at(a, 3 + b)] += t * p[at(3 + a, 3 + b)];
        }
    }
}

/// F₃ P F₃ᵀ. F₃ = [1 T 0; 0 1 0; 0 0 1] · [1 0 −T²/2; 0 1 T; 0 0 1], since
/// p + T v + T²/2 a = (p − T²/2 a) + T (v + T a).
fn accelerate(p: &mut [f64], t: f64) {
    let q = 0.5 * t * t;
    // First factor: positions −= q a, velocities += T a.
    for b in 0..3 {
        for a in 0..=b {
            let aa = p[at(6 + a, 6 + b)];
            let (pa, pa_t) = (p[at(a, 6 + b)], p[at(b, 6 + a)]);
            let (va, va_t) = (p[at(3 + a, 6 + b)], p[at(3 + b, 6 + a)]);
            p[at(a, b)] += q * (q * aa - pa - pa_t);
            p[at(3 + a, 3 + b)] += t * (t * aa + va + va_t);
        }
    }
    for b in 0..3 {
        for a in 0..3 {
            let aa = p[at(6 + a, 6 + b)];
            p[at(a, 3 + b)] += t * p[at(a, 6 + b)] - q * p[at(3 + b, 6 + a)] - q * t * aa;
        }
    }
    for b in 0..3 {
        for a in 0..3 {
            let aa = p[at(6 + a, 6 + b)];
            p[at(a, 6 + b)] -= q * aa;
            p[at(3 + a, 6 + b)] += t * aa;
        }
    }
    // Second factor: positions += T v, with all columns of the acceleration.
    drift(p, t);
    for b in 0..3 {
        for a in 0..3 {
            p[at(a, 6 + b)] += t * p[at(3 + a, 6 + b)];
        }
    }
}

mod tests {
    use super::*;
    use nalgebra::{SMatrix, SVector};
    use proptest::prelude::*;

    type Matrix9 = SMatrix<f64, STATE, STATE>;

    /// (T1) as printed, in the order of messages.
    fn definition(mode: usize, noise: f64, t: f64) -> (Matrix9, Matrix9) {
        let (f, g) = match mode {
            HOVER => ([[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], [t, 0.0, 0.0]),
            CONSTANT_VELOCITY => ([[1.0, t, 0.0], [0.0, 1.0, 0.0], [0.0; 3]], [t * t / 2.0, t, 0.0]),
            _ => ([[1.0, t, t * t / 2.0], [0.0, 1.0, t], [0.0, 0.0, 1.0]], [t * t * t / 6.0, t * t / 2.0, t]),
        };
        let (mut full_f, mut full_q) = (Matrix9::zeros(), Matrix9::zeros());
        for axis in 0..3 {
            for i in 0..3 {
                for j in 0..3 {
                    full_f[(3 * axis + i, 3 * axis + j)] = f[i][j];
                    full_q[(3 * axis + i, 3 * axis + j)] = noise * noise * g[i] * g[j];
                }
            }
        }
        (full_f, full_q)
    }

    proptest! {
        #[test]
        fn blocks_equal_the_matrix_form(
            mean in prop::array::uniform9(-100.0..100.0_f64),
            root in prop::collection::vec(-10.0..10.0_f64, 81),
            mode in 0..MODES,
            t in 0.0..5.0_f64,
        ) {
            let mean = SVector::<f64, STATE>::from(mean);
            let root = Matrix9::from_iterator(root);
            let covariance = root * root.transpose();
            let motion = Motion { noise: [1.0, 2.0, 7.0], axes: 3 };
            let mut gaussian = Gaussian::from_message_order(&mean, &covariance);
            motion.predict(mode, &mut gaussian, t);
            let (f, q) = definition(mode, motion.noise[mode], t);
            let expected = Gaussian::from_message_order(&(f * mean), &(f * covariance * f.transpose() + q));
            for (a, b) in gaussian.mean.iter().zip(expected.mean).chain(gaussian.covariance.iter().zip(expected.covariance)) {
                prop_assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
            }
        }
    }
}
