//! Prediction of one component along its axes: (T1), (T4), with F and G of the number of states that it knows.
//!
//! Per axis, over a time step T and with the states [position, velocity, acceleration]:
//! ```text
//! F₁ = [1 0 0; 0 0 0; 0 0 0]      G₁ = a₁ [T 0 0]ᵀ
//! F₂ = [1 T 0; 0 1 0; 0 0 0]      G₂ = a₂ [T²/2 T 0]ᵀ            (T1)
//! F₃ = [1 T T²/2; 0 1 T; 0 0 1]   G₃ = a₃ [T³/6 T²/2 T]ᵀ
//! ```
//! F is the same for every axis: the states of two axes are a 3×3 problem (2×2, 1×1 for components that know less), which stays in
//! registers from P̄ to P*.

use pulp::Simd;

use super::gaussian::at;
use super::group::ComponentMut;
use super::lanes::{Lanes, V};

/// Process noise of a component, and the dimension of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// a of (T1): m/s, m/s² or m/s³.
    pub(in crate::filter) amplitude: f64,
    /// 3, or 2 for a radar without elevation: z and its derivatives then stay zero.
    pub(in crate::filter) axes: usize,
}

/// ū and P̄ before they are propagated.
pub(in crate::filter) trait Before<S: Simd> {
    /// ū of a state.
    fn mean(&self, i: usize) -> V<S>;

    /// P̄ of two states.
    fn covariance(&self, row: usize, column: usize) -> V<S>;
}

/// u* = F ū, P* = F P̄ Fᵀ + G Gᵀ over the time `t` (T3), (T4).
#[inline(always)]
pub(in crate::filter) fn propagate<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    before: &impl Before<S>,
    noise: Noise,
    t: V<S>,
    out: &mut ComponentMut<'_, N, P>,
) {
    let known = N / 3;
    // T, T²/2, T³/6; G is a times the last `known` of them, backwards.
    let half_square = (t * t * lanes.splat(0.5)).rounded();
    let powers = [t, half_square, (half_square * t * lanes.splat(1.0 / 3.0)).rounded()];
    for axis in 0..3 {
        let mut u = [lanes.splat(0.0); 3];
        for i in 0..known {
            u[i] = before.mean(3 * i + axis);
        }
        advance(&mut u, known, &powers);
        for i in 0..known {
            lanes.put(&mut out.mean[3 * i + axis], u[i]);
        }
    }
    let variance = lanes.splat(noise.amplitude * noise.amplitude);
    for b in 0..3 {
        for a in 0..=b {
            let mut columns = [[lanes.splat(0.0); 3]; 3];
            for j in 0..known {
                for i in 0..known {
                    columns[j][i] = before.covariance(3 * i + a, 3 * j + b);
                }
                advance(&mut columns[j], known, &powers);
            }
            for i in 0..known {
                let mut row = [columns[0][i], columns[1][i], columns[2][i]];
                advance(&mut row, known, &powers);
                if a == b && a < noise.axes {
                    for j in i..known {
                        row[j] += variance * powers[known - 1 - i] * powers[known - 1 - j];
                    }
                }
                for j in if a == b { i } else { 0 }..known {
                    lanes.put(&mut out.covariance[at(3 * i + a, 3 * j + b)], row[j]);
                }
            }
        }
    }
}

/// F of one axis applied to [p v a], the leading `known` of them.
#[inline(always)]
fn advance<S: Simd>(x: &mut [V<S>; 3], known: usize, powers: &[V<S>; 3]) {
    if known > 1 {
        x[0] += powers[0] * x[1];
    }
    if known > 2 {
        x[0] += powers[1] * x[2];
        x[1] += powers[0] * x[2];
    }
}
