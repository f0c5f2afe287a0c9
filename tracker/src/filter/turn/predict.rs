//! Mixing and prediction of a group of turn models: (T2)-(T4) with F of [`super::advance`], as (V1) has it, Π as [`markov`] has it.

use common::tracks::MODELS;
use pulp::{Simd, WithSimd};

use super::advance::{Advance, KNOWN};
use super::filter::{PACKED, Turn};
use super::grid::Next;
use crate::filter::gaussian::at;
use crate::filter::group::{Component, Group};
use crate::filter::lanes::{LANES, Lanes, Row, V};
use crate::filter::machine::Machine;
use crate::filter::markov::{self, Transition};

/// u*, P*, W* of a group, and the rates that it was predicted with.
pub(super) fn predict(
    filter: &Turn,
    machine: Machine,
    lanes: usize,
    posterior: &Group,
    step_s: &Row,
    prediction: &mut Group,
) {
    let moved = move_grids(filter, lanes, posterior, prediction);
    machine.arch(lanes).dispatch(Predict { lanes, filter, posterior, step_s, moved: &moved, prediction });
}

/// Writes the rates of the next scan into the memory of the prediction. Returns how far rates have moved, by lane.
fn move_grids(filter: &Turn, lanes: usize, posterior: &Group, prediction: &mut Group) -> Row {
    let (models, memory) = (filter.layout.len(), filter.layout.memory_start());
    let mut moved = Row::ZERO;
    for lane in 0..LANES {
        let word = |first: usize, i: usize| posterior.rows()[first + i].0[lane];
        let of_models =
            |first: usize| std::array::from_fn::<f64, MODELS, _>(|i| if i < models { word(first, i) } else { 0.0 });
        let rates = of_models(memory);
        let next = if lane < lanes && word(memory, models) > 0.0 {
            filter.grid.next(rates, &of_models(0))
        } else {
            Next { rates, moved: 0 }
        };
        for (row, rate) in prediction.rows_mut()[memory..].iter_mut().zip(&next.rates[..models]) {
            row.0[lane] = *rate;
        }
        moved.0[lane] = next.moved.into();
    }
    prediction.rows_mut()[memory + models] = Row::ZERO;
    moved
}

struct Predict<'a> {
    lanes: usize,
    filter: &'a Turn,
    posterior: &'a Group,
    step_s: &'a Row,
    moved: &'a Row,
    prediction: &'a mut Group,
}

impl WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { filter, posterior, step_s, moved, prediction, .. } = self;
        let (models, memory) = (filter.layout.len(), filter.layout.memory_start());
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let zero = lanes.splat(0.0);
            let (step, moved) = (lanes.get(step_s), lanes.get(moved));
            let Transition { same, other } = Transition::new(lanes, models, filter.ln_kappa, step);
            let mut w = [zero; MODELS];
            for i in 0..models {
                w[i] = lanes.get(&posterior.weights()[i]);
            }
            let mut all = zero;
            for j in 0..models {
                let (mut column, mut shares) = ([other; MODELS], [zero; MODELS]);
                for i in 0..models {
                    let away = (moved + lanes.splat(j as f64 - i as f64)).abs();
                    column[i] = lanes.splat(0.5).less(away).pick(other, same);
                }
                let total = markov::mix(&column[..models], &w[..models], &mut shares[..models]); // (T2)
                lanes.put(&mut prediction.rows_mut()[j], total);
                all += total;
                let advance = Advance::new(lanes, lanes.get(&prediction.rows()[memory + j]), step);
                let (mean, covariance) = mix(lanes, posterior, &shares[..models]);
                propagate(lanes, j, filter, step, &advance, &mean, &covariance, prediction);
            }
            for j in 0..models {
                let weight = lanes.get(&prediction.rows()[j]) / all;
                lanes.put(&mut prediction.rows_mut()[j], weight);
            }
        }
    }
}

/// ū and P̄ of one model (T3), (T4).
#[inline(always)]
fn mix<S: Simd>(lanes: Lanes<S>, posterior: &Group, shares: &[V<S>]) -> ([V<S>; KNOWN], [V<S>; PACKED]) {
    let zero = lanes.splat(0.0);
    let (mut mean, mut covariance) = ([zero; KNOWN], [zero; PACKED]);
    for (i, share) in shares.iter().enumerate() {
        let from: Component<'_, KNOWN, PACKED> = posterior.component(i);
        for k in 0..KNOWN {
            mean[k] += *share * lanes.get(&from.mean[k]);
        }
    }
    for (i, share) in shares.iter().enumerate() {
        let from: Component<'_, KNOWN, PACKED> = posterior.component(i);
        let mut d = [zero; KNOWN];
        for b in 0..KNOWN {
            d[b] = lanes.get(&from.mean[b]) - mean[b];
            let scaled = (*share * d[b]).rounded();
            for a in 0..=b {
                covariance[at(a, b)] += *share * lanes.get(&from.covariance[at(a, b)]);
                covariance[at(a, b)] += scaled * d[a];
            }
        }
    }
    (mean, covariance)
}

/// u* = F ū, P* = F P̄ Fᵀ + σ_a² g gᵀ by axis, g = [T²/2 T].
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one model of one part of a group")]
fn propagate<S: Simd>(
    lanes: Lanes<S>,
    j: usize,
    filter: &Turn,
    step: V<S>,
    advance: &Advance<S>,
    mean: &[V<S>; KNOWN],
    covariance: &[V<S>; PACKED],
    prediction: &mut Group,
) {
    let out = prediction.component_mut::<KNOWN, PACKED>(j);
    let mean = advance.apply(mean);
    let mut half = [[lanes.splat(0.0); KNOWN]; KNOWN];
    for b in 0..KNOWN {
        lanes.put(&mut out.mean[b], mean[b]);
        let column = advance.apply(&std::array::from_fn(|a| covariance[at(a, b)]));
        for a in 0..KNOWN {
            half[a][b] = column[a];
        }
    }
    let variance = lanes.splat(filter.noise_mps2 * filter.noise_mps2);
    let g = [(step * step * lanes.splat(0.5)).rounded(), step];
    for a in 0..KNOWN {
        let row = advance.apply(&half[a]);
        for b in a..KNOWN {
            let mut p = row[b];
            if (b - a) % 3 == 0 && a % 3 < filter.axes {
                p += variance * g[a / 3] * g[b / 3];
            }
            lanes.put(&mut out.covariance[at(a, b)], p);
        }
    }
}
