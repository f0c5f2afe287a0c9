//! Mixing and prediction of a block: (T2)-(T4), by pairs of axes.
//!
//! With modes 1 (hover), 2, 3 and their shares s_i = Π_ij W_i / W*_j, the spread of the means takes two
//! terms: that of 2 and 3 about their common mean, and that of 1 and the pair.
//! ```text
//! û₂₃ = (s₂ û₂ + s₃ û₃)/s₂₃,   s₂₃ = s₂ + s₃
//! ū   = s₁ û₁ + s₂₃ û₂₃                                                                       (T3)
//! P̄   = Σ_i s_i P̂_i + (s₂ s₃/s₂₃) (û₂ − û₃)(û₂ − û₃)ᵀ + s₁ s₂₃ (û₁ − û₂₃)(û₁ − û₂₃)ᵀ            (T4)
//! ```
//! No difference of weights is taken, so rounding cannot make P̄ indefinite. F is the same for every axis: the states of two
//! axes are a 3×3 problem (2×2, 1×1 for the modes that know less), which stays in registers from P̂ to P*.

use pulp::Simd;

use crate::filter::gaussian::at;
use crate::filter::uav::imm::Transition;
use crate::filter::uav::motion::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, MODES, Motion};

use super::block::{Block, Mode};
use super::lanes::{Lanes, Row, V, dot};

/// Time step and Markov chain of each track.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// T, s.
    pub dt_s: Row,
    /// Π over T: from mode i (row) to mode j (column).
    pub transition: [[Row; MODES]; MODES],
}

impl Default for Step {
    /// No time, in which every track stays in its mode.
    fn default() -> Self {
        let stays = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        Self::splat(0.0, &stays)
    }
}

impl Step {
    /// The same for all lanes.
    pub fn splat(dt_s: f64, transition: &Transition) -> Self {
        Self { dt_s: Row::splat(dt_s), transition: transition.map(|row| row.map(Row::splat)) }
    }

    /// For the track in `lane`.
    pub fn set(&mut self, lane: usize, dt_s: f64, transition: &Transition) {
        self.dt_s.0[lane] = dt_s;
        for (rows, values) in self.transition.iter_mut().zip(transition) {
            for (row, value) in rows.iter_mut().zip(values) {
                row.0[lane] = *value;
            }
        }
    }
}

/// u*, P*, W* of some lanes.
#[inline(always)]
pub(super) fn predict<S: Simd>(
    lanes: Lanes<S>,
    posterior: &Block,
    step: &Step,
    motion: &Motion,
    prediction: &mut Block,
) {
    let t = lanes.get(&step.dt_s);
    let w = lanes.all(&posterior.probability);
    let mut shares = [[lanes.splat(0.0); MODES]; MODES];
    for j in 0..MODES {
        let chain =
            [lanes.get(&step.transition[0][j]), lanes.get(&step.transition[1][j]), lanes.get(&step.transition[2][j])];
        let total = dot(&chain, &w); // (T2)
        lanes.put(&mut prediction.probability[j], total);
        let inverse = total.inverse();
        let reachable = lanes.splat(0.0).less(total);
        for i in 0..MODES {
            // A mode that cannot be reached keeps the mixture as its state, at no weight.
            shares[j][i] = reachable.pick(chain[i] * w[i] * inverse, w[i]);
        }
    }
    Mixture::new(lanes, posterior, shares[HOVER]).predict(motion.noise[HOVER], motion.axes, t, &mut prediction.hover);
    Mixture::new(lanes, posterior, shares[CONSTANT_VELOCITY]).predict(
        motion.noise[CONSTANT_VELOCITY],
        motion.axes,
        t,
        &mut prediction.constant_velocity,
    );
    Mixture::new(lanes, posterior, shares[MANOEUVRE]).predict(
        motion.noise[MANOEUVRE],
        motion.axes,
        t,
        &mut prediction.manoeuvre,
    );
}

/// ū and P̄ of N states, before they are computed.
struct Mixture<'a, S: Simd, const N: usize> {
    lanes: Lanes<S>,
    from: &'a Block,
    share: [V<S>; MODES],
    /// ū.
    mean: [V<S>; N],
    /// û₂ − û₃, and the same times s₂ s₃/s₂₃.
    outer: [[V<S>; N]; 2],
    /// û₁ − û₂₃, and the same times s₁ s₂₃.
    inner: [[V<S>; N]; 2],
}

impl<'a, S: Simd, const N: usize> Mixture<'a, S, N> {
    #[inline(always)]
    fn new(lanes: Lanes<S>, from: &'a Block, share: [V<S>; MODES]) -> Self {
        let zero = lanes.splat(0.0);
        let [s_1, s_2, s_3] = share;
        let s_23 = s_2 + s_3;
        let inverse = zero.less(s_23).pick(s_23.inverse(), zero);
        let (part_2, part_3) = ((s_2 * inverse).rounded(), (s_3 * inverse).rounded());
        let (outer_weight, inner_weight) = ((s_2 * part_3).rounded(), (s_1 * s_23).rounded());
        let (mut mean, mut outer, mut inner) = ([zero; N], [[zero; N]; 2], [[zero; N]; 2]);
        for i in 0..N {
            let u_1 = if i < 3 { lanes.get(&from.hover.mean[i]) } else { zero };
            let u_2 = if i < 6 { lanes.get(&from.constant_velocity.mean[i]) } else { zero };
            let u_3 = lanes.get(&from.manoeuvre.mean[i]);
            let u_23 = part_2 * u_2 + part_3 * u_3;
            mean[i] = s_1 * u_1 + s_23 * u_23;
            outer[0][i] = u_2 - u_3;
            inner[0][i] = u_1 - u_23;
            outer[1][i] = (outer_weight * outer[0][i]).rounded();
            inner[1][i] = (inner_weight * inner[0][i]).rounded();
        }
        Self { lanes, from, share, mean, outer, inner }
    }

    /// P̄ of two states.
    #[inline(always)]
    fn covariance(&self, row: usize, column: usize) -> V<S> {
        let Self { lanes, from, share, outer, inner, .. } = self;
        let mut p = outer[0][row] * outer[1][column] + inner[0][row] * inner[1][column];
        let k = at(row, column);
        if k < from.hover.covariance.len() {
            p += share[HOVER] * lanes.get(&from.hover.covariance[k]);
        }
        if k < from.constant_velocity.covariance.len() {
            p += share[CONSTANT_VELOCITY] * lanes.get(&from.constant_velocity.covariance[k]);
        }
        p += share[MANOEUVRE] * lanes.get(&from.manoeuvre.covariance[k]);
        p
    }

    /// u* = F ū, P* = F P̄ Fᵀ + G Gᵀ.
    #[inline(always)]
    fn predict<const P: usize>(&self, noise: f64, axes: usize, t: V<S>, out: &mut Mode<N, P>) {
        let lanes = self.lanes;
        let known = N / 3;
        // T, T²/2, T³/6; G is a times the last `known` of them, backwards.
        let half_square = (t * t * lanes.splat(0.5)).rounded();
        let powers = [t, half_square, (half_square * t * lanes.splat(1.0 / 3.0)).rounded()];
        for axis in 0..3 {
            let mut u = [lanes.splat(0.0); 3];
            for i in 0..known {
                u[i] = self.mean[3 * i + axis];
            }
            advance(&mut u, known, &powers);
            for i in 0..known {
                lanes.put(&mut out.mean[3 * i + axis], u[i]);
            }
        }
        let variance = lanes.splat(noise * noise);
        for b in 0..3 {
            for a in 0..=b {
                let mut columns = [[lanes.splat(0.0); 3]; 3];
                for j in 0..known {
                    for i in 0..known {
                        columns[j][i] = self.covariance(3 * i + a, 3 * j + b);
                    }
                    advance(&mut columns[j], known, &powers);
                }
                for i in 0..known {
                    let mut row = [columns[0][i], columns[1][i], columns[2][i]];
                    advance(&mut row, known, &powers);
                    if a == b && a < axes {
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
