//! Mixing and prediction of a group: (T2)-(T4).
//!
//! With modes 1 (hover), 2, 3 and their shares s_i = Π_ij W_i / W*_j, the spread of the means takes two
//! terms: that of 2 and 3 about their common mean, and that of 1 and the pair.
//! ```text
//! û₂₃ = (s₂ û₂ + s₃ û₃)/s₂₃,   s₂₃ = s₂ + s₃
//! ū   = s₁ û₁ + s₂₃ û₂₃                                                                       (T3)
//! P̄   = Σ_i s_i P̂_i + (s₂ s₃/s₂₃) (û₂ − û₃)(û₂ − û₃)ᵀ + s₁ s₂₃ (û₁ − û₂₃)(û₁ − û₂₃)ᵀ            (T4)
//! ```
//! No difference of weights is taken, so rounding cannot make P̄ indefinite. Π is that of [`markov`].

use pulp::{Simd, WithSimd};

use super::modes::{CONSTANT_VELOCITY, DIMENSIONS, HOVER, LAYOUT, MANOEUVRE, MODES, Uav};
use crate::filter::gaussian::{at, packed};
use crate::filter::group::{Component, Group};
use crate::filter::lanes::{Lanes, Row, V};
use crate::filter::machine::Machine;
use crate::filter::markov::{self, Transition};
use crate::filter::propagate::{Before, propagate};

/// u*, P*, W* of a group.
pub(super) fn predict(
    filter: &Uav,
    machine: Machine,
    lanes: usize,
    posterior: &Group,
    step_s: &Row,
    prediction: &mut Group,
) {
    machine.arch(lanes).dispatch(Predict { lanes, filter, posterior, step_s, prediction });
}

struct Predict<'a> {
    lanes: usize,
    filter: &'a Uav,
    posterior: &'a Group,
    step_s: &'a Row,
    prediction: &'a mut Group,
}

impl WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { filter, posterior, step_s, prediction, .. } = self;
        let ln_kappa = markov::ln_kappa(MODES, filter.stay, 1.0);
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let t = lanes.get(step_s);
            let Transition { same, other } = Transition::new(lanes, MODES, ln_kappa, t);
            let mut w = [lanes.splat(0.0); MODES];
            for i in 0..MODES {
                w[i] = lanes.get(&posterior.weights()[i]);
            }
            let mut shares = [[lanes.splat(0.0); MODES]; MODES];
            for j in 0..MODES {
                let mut column = [other; MODES];
                column[j] = same;
                lanes.put(&mut prediction.rows_mut()[j], markov::mix(&column, &w, &mut shares[j])); // (T2)
            }
            let modes = Modes::of(posterior);
            mix::<S, { DIMENSIONS[HOVER] }, 6>(lanes, modes, HOVER, shares[HOVER], filter, t, prediction);
            let share = shares[CONSTANT_VELOCITY];
            mix::<S, { DIMENSIONS[CONSTANT_VELOCITY] }, 21>(
                lanes,
                modes,
                CONSTANT_VELOCITY,
                share,
                filter,
                t,
                prediction,
            );
            let share = shares[MANOEUVRE];
            mix::<S, { DIMENSIONS[MANOEUVRE] }, 45>(lanes, modes, MANOEUVRE, share, filter, t, prediction);
            lanes.put(&mut prediction.rows_mut()[LAYOUT.memory_start()], lanes.splat(0.0));
        }
    }
}

/// The modes before, and the variance of acceleration that a new track's second one has.
#[derive(Clone, Copy)]
struct Modes<'a> {
    hover: Component<'a, 3, { packed(3) }>,
    constant_velocity: Component<'a, 6, { packed(6) }>,
    manoeuvre: Component<'a, 9, { packed(9) }>,
    at_start: &'a Row,
}

impl<'a> Modes<'a> {
    fn of(group: &'a Group) -> Self {
        Self {
            hover: group.component(HOVER),
            constant_velocity: group.component(CONSTANT_VELOCITY),
            manoeuvre: group.component(MANOEUVRE),
            at_start: &group.rows()[LAYOUT.memory_start()],
        }
    }
}

/// (T3), (T4) of one destination mode.
#[inline(always)]
fn mix<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    from: Modes<'_>,
    mode: usize,
    share: [V<S>; MODES],
    filter: &Uav,
    t: V<S>,
    prediction: &mut Group,
) {
    let mixing = Mixing::<S, N>::new(lanes, from, share, filter.axes);
    let out = &mut prediction.component_mut::<N, P>(mode);
    propagate(lanes, &mixing, filter.noise_of(mode), t, out);
}

/// ū and P̄ of N states, before they are computed.
struct Mixing<'a, S: Simd, const N: usize> {
    lanes: Lanes<S>,
    from: Modes<'a>,
    share: [V<S>; MODES],
    /// ū.
    mean: [V<S>; N],
    /// û₂ − û₃, and the same times s₂ s₃/s₂₃.
    outer: [[V<S>; N]; 2],
    /// û₁ − û₂₃, and the same times s₁ s₂₃.
    inner: [[V<S>; N]; 2],
    /// States of acceleration with a variance at the start.
    axes: usize,
}

impl<'a, S: Simd, const N: usize> Mixing<'a, S, N> {
    #[inline(always)]
    fn new(lanes: Lanes<S>, from: Modes<'a>, share: [V<S>; MODES], axes: usize) -> Self {
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
        Self { lanes, from, share, mean, outer, inner, axes }
    }
}

impl<S: Simd, const N: usize> Before<S> for Mixing<'_, S, N> {
    #[inline(always)]
    fn mean(&self, i: usize) -> V<S> {
        self.mean[i]
    }

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
        if row == column && (6..6 + self.axes).contains(&row) {
            p += share[CONSTANT_VELOCITY] * lanes.get(from.at_start);
        }
        p
    }
}
