//! Exponentially correlated acceleration over a time step (M1).
//!
//! State [w v m]: fluctuation of acceleration, velocity, position. With x = T/τ, e = e⁻ˣ, p₁ = 1 − e, p₂ = x − 1 + e:
//! ```text
//! F = [e 0 0; p₁τ 1 0; p₂τ² T 1],   a mean acceleration adds ā [0 T T²/2]                        (M1)
//! Q/σ² = [ p₁(1 + e)   τ p₁²       2τ² I₁₁ ]     I₀₂ = ∫₀ˣ (1 − e⁻ᵘ)² du        = Σ c_k(0, 2)
//!        [    ·        2τ² I₀₂     τ³ p₂²  ]     I₁₁ = ∫₀ˣ e⁻ᵘ (u − 1 + e⁻ᵘ) du = Σ c_k(1, 1)
//!        [    ·           ·        2τ⁴ I₂₂ ]     I₂₂ = ∫₀ˣ (u − 1 + e⁻ᵘ)² du    = Σ c_k(2, 2), k ≥ 4
//! c_k(a, b) = (−1)ᵏ (2ᵏ − a k − b)/k! · xᵏ⁺¹/(k + 1)
//! ```
//! The closed forms of the integrals lose seven digits at x = 1/30, so up to x = 1 the series are taken.

use pulp::Simd;

use crate::filter::functions::polynomial;
use crate::filter::lanes::{Lanes, V};

/// Terms of each series: the next ones are below 10⁻¹⁶ at x = 1.
const TERMS: usize = 24;

/// Coefficients of Σ c_k(a, b), `from` k on; highest power first, down to x³ (k = 2).
const fn series(a: f64, b: f64, from: usize) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let (mut k, mut factorial, mut power, mut sign) = (2, 2.0, 4.0, 1.0);
    while k < TERMS + 2 {
        if k >= from {
            coefficients[TERMS + 1 - k] = sign * (power - a * k as f64 - b) / factorial / (k + 1) as f64;
        }
        k += 1;
        factorial *= k as f64;
        power *= 2.0;
        sign = -sign;
    }
    coefficients
}

/// Those of p₂/x² = Σ (−x)ᵏ/(k + 2)!.
const fn exponential() -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let (mut k, mut factorial, mut sign) = (0, 2.0, 1.0);
    while k < TERMS {
        coefficients[TERMS - 1 - k] = sign / factorial;
        factorial *= (k + 3) as f64;
        sign = -sign;
        k += 1;
    }
    coefficients
}

const P_2: [f64; TERMS] = exponential();
const I_02: [f64; TERMS] = series(0.0, 2.0, 2);
const I_11: [f64; TERMS] = series(1.0, 1.0, 2);
const I_22: [f64; TERMS] = series(2.0, 2.0, 4);

/// F, Q/σ² and the response to a mean acceleration, of some lanes.
#[derive(Clone, Copy)]
pub(super) struct Singer<S: Simd> {
    step: V<S>,
    half_square: V<S>,
    kept: V<S>,
    to_velocity: V<S>,
    to_position: V<S>,
    /// Packed as ww, wv, vv, wm, vm, mm.
    noise: [V<S>; 6],
}

impl<S: Simd> Singer<S> {
    /// Over `step` with the correlation time `tau_s`, s.
    #[inline(always)]
    pub(super) fn new(lanes: Lanes<S>, step: V<S>, tau_s: f64) -> Self {
        let (one, two, half) = (lanes.splat(1.0), lanes.splat(2.0), lanes.splat(0.5));
        let tau = lanes.splat(tau_s);
        let x = (step * lanes.splat(1.0 / tau_s)).rounded();
        let near = x.less(one);
        let (square, decay) = ((x * x).rounded(), (-x).exp());
        let cube = (square * x).rounded();
        let p_2 = near.pick(square * polynomial(x, &P_2), x - one + decay);
        let p_1 = x - p_2;
        let kept = one - p_1;
        let both = (p_1 * (one + kept)).rounded();
        // ∫ (u − 1)² du + 2 ∫ (u − 1) e⁻ᵘ du + ∫ e⁻²ᵘ du
        let beyond = x - one;
        let cubes = (((beyond * beyond).rounded() * beyond + one) * lanes.splat(1.0 / 3.0)).rounded();
        let last = (x * kept).rounded();
        let i_02 = near.pick(cube * polynomial(x, &I_02), x - two * p_1 + half * both);
        let i_11 = near.pick(cube * polynomial(x, &I_11), half * both - last);
        let i_22 = near.pick(cube * polynomial(x, &I_22), cubes - two * last + half * both);
        let tau_2 = (tau * tau).rounded();
        let twice = (two * tau_2).rounded();
        Self {
            step,
            half_square: (step * step * half).rounded(),
            kept,
            to_velocity: (p_1 * tau).rounded(),
            to_position: (p_2 * tau_2).rounded(),
            noise: [
                both,
                (tau * p_1 * p_1).rounded(),
                (twice * i_02).rounded(),
                (twice * i_11).rounded(),
                (tau_2 * tau * p_2 * p_2).rounded(),
                (twice * tau_2 * i_22).rounded(),
            ],
        }
    }

    /// F [w v m] + ā [0 T T²/2].
    #[inline(always)]
    pub(super) fn advance(&self, [w, v, m]: [V<S>; 3], mean_acceleration: V<S>) -> [V<S>; 3] {
        let moved = m + self.to_position * w + self.step * v;
        [
            (self.kept * w).rounded(),
            v + self.to_velocity * w + self.step * mean_acceleration,
            moved + self.half_square * mean_acceleration,
        ]
    }

    /// F P Fᵀ + σ² Q of a packed P.
    #[inline(always)]
    pub(super) fn spread(&self, p: &[V<S>; 6], variance: V<S>) -> [V<S>; 6] {
        let [ww, wv, vv, wm, vm, mm] = *p;
        let zero = self.step.splat(0.0);
        let columns = [[ww, wv, wm], [wv, vv, vm], [wm, vm, mm]].map(|column| self.advance(column, zero));
        let rows = [0, 1, 2].map(|i| self.advance([columns[0][i], columns[1][i], columns[2][i]], zero));
        let mut out = [rows[0][0], rows[0][1], rows[1][1], rows[0][2], rows[1][2], rows[2][2]];
        for k in 0..6 {
            out[k] += variance * self.noise[k];
        }
        out
    }
}
