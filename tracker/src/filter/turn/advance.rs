//! A coordinated turn of some lanes over a time step: F(ω) applied to a state.
//!
//! ```text
//! x' = x + A ẋ − B ẏ,   y' = y + B ẋ + A ẏ,   z' = z + T ż
//! ẋ' = c ẋ − s ẏ,       ẏ' = s ẋ + c ẏ,       ż' = ż                                                  (V1)
//! c = cos ωT,  s = sin ωT,  A = s/ω,  B = (1 − c)/ω
//! ```
//! With the half angle h = ωT/2 these are c = 1 − 2 sin²h, s = 2 sin h cos h, A = T (sin h/h) cos h, B = T (sin h/h) sin h, which lose no
//! digits at small rates.

use pulp::Simd;

use crate::filter::lanes::{Lanes, V};

/// States of a model.
pub(super) const KNOWN: usize = 6;

/// The elements of F.
#[derive(Clone, Copy)]
pub(super) struct Advance<S: Simd> {
    step: V<S>,
    along: V<S>,
    across: V<S>,
    cosine: V<S>,
    sine: V<S>,
}

impl<S: Simd> Advance<S> {
    /// At `rate` over `step`; rad/s and s.
    #[inline(always)]
    pub(super) fn new(lanes: Lanes<S>, rate: V<S>, step: V<S>) -> Self {
        let (one, two) = (lanes.splat(1.0), lanes.splat(2.0));
        let half = (rate * step * lanes.splat(0.5)).rounded();
        let (sine, cosine) = half.sin_cos();
        let ratio = lanes.splat(0.0).less(half.abs()).pick(sine / half, one);
        let chord = (step * ratio).rounded();
        let twice = (two * sine).rounded();
        Self {
            step,
            along: (chord * cosine).rounded(),
            across: (chord * sine).rounded(),
            cosine: one - twice * sine,
            sine: (twice * cosine).rounded(),
        }
    }

    /// F u.
    #[inline(always)]
    pub(super) fn apply(&self, u: &[V<S>; KNOWN]) -> [V<S>; KNOWN] {
        let [x, y, z, v_x, v_y, v_z] = *u;
        [
            x + self.along * v_x - self.across * v_y,
            y + self.across * v_x + self.along * v_y,
            z + self.step * v_z,
            self.cosine * v_x - self.sine * v_y,
            self.sine * v_x + self.cosine * v_y,
            v_z,
        ]
    }
}
