//! One hypothesis whose bandwidth adapts: the baseline of the bank (M4).

use common::config::BandwidthConfig;
use common::tracks::{ESTIMATOR_ADAPTIVE_BANDWIDTH, KIND_MANOEUVRE, Models, STATE};
use pulp::Simd;

use super::axis::{Sight, put, start_component};
use super::coordinates::{self, ByCoordinate};
use super::singer::Singer;
use crate::filter::evidence::Evidence;
use crate::filter::group::Group;
use crate::filter::lanes::{Lanes, Row, V};
use crate::filter::layout::Layout;
use crate::filter::machine::Machine;
use crate::filter::mixture::Mixture;
use crate::filter::prior::Prior;
use crate::filter::propagate::Noise;
use crate::filter::seam::{Filter, Update};
use crate::filter::start::Origin;

/// Where a coordinate's numbers stand in its words: P and [w v m] of the bandwidth in use.
const NOW: usize = 0;
/// P and [w v m] as predicted with the wide one.
const WIDE: usize = 9;
/// 1 where the wide one is in use, else 0.
const IS_WIDE: usize = 18;
/// Scans since it is.
const SINCE: usize = 19;
/// Calm ones of them, in a row.
const CALM: usize = 20;
/// The last squared normalised innovations.
const RECENT: usize = 21;

/// A filter of correlated acceleration that is narrow while innovations are small, by coordinate.
///
/// ```text
/// narrow → wide   mean of the last innovations d²/S > threshold: the scan is predicted again, wide            (M4)
/// wide → narrow   after `calm_scans` scans with |w| < calm √P_ww, counted from the `hold`-th scan on
/// ```
/// A track begins wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveBandwidth {
    /// τ, narrow and wide, s.
    pub tau_s: [f64; 2],
    /// σ_w, narrow and wide, m/s².
    pub sigma_mps2: [f64; 2],
    /// The greatest acceleration along a coordinate, m/s².
    pub greatest_mps2: f64,
    /// Mean of the last squared normalised innovations from which it becomes wide.
    pub threshold: f64,
    /// How many innovations that is.
    pub recent: usize,
    /// Calm scans after which it becomes narrow.
    pub calm_scans: usize,
    /// Deviations of w up to which a scan is calm.
    pub calm: f64,
    /// Scans that it stays wide before calm ones count.
    pub hold: usize,
    axes: usize,
    layout: Layout,
}

impl AdaptiveBandwidth {
    /// As the configuration says; with the same correlation time in both, calm within one deviation.
    pub fn configured(of: &BandwidthConfig, axes: usize) -> Self {
        Self {
            tau_s: [of.correlation_time_s; 2],
            sigma_mps2: [of.narrow_mps2, of.wide_mps2],
            greatest_mps2: of.greatest_acceleration_mps2,
            threshold: of.threshold,
            recent: INNOVATIONS,
            calm_scans: of.calm_scans as usize,
            calm: 1.0,
            hold: of.hold_scans as usize,
            axes,
            layout: LAYOUT,
        }
    }

    /// The same with another number of innovations that count.
    #[must_use]
    pub fn with_recent(self, recent: usize) -> Self {
        Self { recent, layout: layout(recent), ..self }
    }

    fn block(&self, axis: usize) -> usize {
        self.layout.memory_start() + axis * (RECENT + self.recent)
    }

    /// Whether a coordinate of a state is wide.
    pub fn is_wide(&self, state: Mixture<'_>, axis: usize) -> bool {
        state.words()[self.block(axis) + IS_WIDE] > 0.0
    }
}

/// Innovations that count, as configured.
const INNOVATIONS: usize = 4;
/// The form of its states, as configured.
pub(in crate::filter) const LAYOUT: Layout = layout(INNOVATIONS);

const fn layout(recent: usize) -> Layout {
    Layout::new(&[STATE], 3 * (RECENT + recent), 0, 0)
}

/// P and [w v m] from a word on.
#[inline(always)]
fn state<S: Simd>(lanes: Lanes<S>, first: usize, group: &Group) -> ([V<S>; 6], [V<S>; 3]) {
    let word = |k: usize| lanes.get(&group.rows()[first + k]);
    (std::array::from_fn(word), std::array::from_fn(|k| word(6 + k)))
}

#[inline(always)]
fn put_state<S: Simd>(lanes: Lanes<S>, first: usize, p: &[V<S>; 6], x: &[V<S>; 3], group: &mut Group) {
    for (row, value) in group.rows_mut()[first..].iter_mut().zip(p.iter().chain(x)) {
        lanes.put(row, *value);
    }
}

impl Filter for AdaptiveBandwidth {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn estimator(&self) -> u16 {
        ESTIMATOR_ADAPTIVE_BANDWIDTH
    }

    fn greatest_acceleration_mps2(&self) -> f64 {
        self.greatest_mps2
    }

    /// (T17) by coordinate, velocity wrong by up to a_max T/2.
    fn start(&self, from: &dyn Origin, state: &mut [f64]) {
        let gaussian = from.moving(Noise { amplitude: 0.5 * self.greatest_mps2, axes: self.axes });
        state.fill(0.0);
        state[0] = 1.0;
        for axis in 0..self.axes {
            let p = start_component(&gaussian, axis, self.sigma_mps2[1] * self.sigma_mps2[1], state);
            let block = &mut state[self.block(axis)..];
            block[NOW..NOW + 6].copy_from_slice(&p);
            block[NOW + 6..NOW + 9].copy_from_slice(&[0.0, gaussian.mean[3 + axis], gaussian.mean[axis]]);
            block[IS_WIDE] = 1.0;
        }
    }

    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group) {
        coordinates::predict(self, machine, lanes, posterior, step_s, prediction);
    }

    fn update(&self, machine: Machine, lanes: usize, prior: Prior<'_>, evidence: &Evidence, update: &mut Update) {
        coordinates::update(self, machine, lanes, prior, evidence, update);
    }

    fn models(&self, _state: Mixture<'_>) -> Models {
        let mut models = Models::default();
        models.push(KIND_MANOEUVRE, 1.0, 0.0);
        models
    }
}

impl ByCoordinate for AdaptiveBandwidth {
    fn axes(&self) -> usize {
        self.axes
    }

    #[inline(always)]
    fn predict_lanes<S: Simd>(&self, lanes: Lanes<S>, step: V<S>, posterior: &Group, prediction: &mut Group) {
        let zero = lanes.splat(0.0);
        let singers = self.tau_s.map(|tau_s| Singer::new(lanes, step, tau_s));
        for axis in 0..self.axes {
            let block = self.block(axis);
            let (p, x) = state(lanes, block + NOW, posterior);
            let spread =
                |which: usize| singers[which].spread(&p, lanes.splat(self.sigma_mps2[which] * self.sigma_mps2[which]));
            let (narrow, wide) = (spread(0), spread(1));
            let [x_narrow, x_wide] = singers.map(|singer| singer.advance(x, zero));
            let is_wide = zero.less(lanes.get(&posterior.rows()[block + IS_WIDE]));
            let p_now: [V<S>; 6] = std::array::from_fn(|k| is_wide.pick(wide[k], narrow[k]));
            let x_now: [V<S>; 3] = std::array::from_fn(|k| is_wide.pick(x_wide[k], x_narrow[k]));
            put_state(lanes, block + NOW, &p_now, &x_now, prediction);
            put_state(lanes, block + WIDE, &wide, &x_wide, prediction);
            // A manoeuvre may begin: the association expects what is wide.
            put(lanes, axis, &x_now, &wide, prediction);
        }
    }

    #[inline(always)]
    fn update_axis<S: Simd>(&self, sight: Sight<'_, S>, prediction: &Group, posterior: &mut Group) {
        let (lanes, axis) = (sight.lanes, sight.axis);
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let block = self.block(axis);
        let word = |k: usize| lanes.get(&prediction.rows()[block + k]);
        let shown = zero.less(sight.shown());
        let (p_now, x_now) = state(lanes, block + NOW, prediction);
        let (p_wide, x_wide) = state(lanes, block + WIDE, prediction);

        let square = sight.square(&p_now, x_now);
        let mut sum = zero;
        for back in 0..self.recent {
            let newer = if back == 0 { square } else { word(RECENT + back - 1) };
            let kept = shown.pick(newer, word(RECENT + back));
            lanes.put(&mut posterior.rows_mut()[block + RECENT + back], kept);
            sum += kept;
        }
        let was_wide = word(IS_WIDE);
        let exceeds = lanes.splat(self.threshold * self.recent as f64).less(sum).pick(one, zero);
        let begins = shown.pick(exceeds * (one - was_wide), zero);
        let begins_now = zero.less(begins);
        let p: [V<S>; 6] = std::array::from_fn(|k| begins_now.pick(p_wide[k], p_now[k]));
        let x: [V<S>; 3] = std::array::from_fn(|k| begins_now.pick(x_wide[k], x_now[k]));
        let p_after = sight.correct(&p, x);
        let (x_after, _) = sight.update(&p, x, x[0]);

        let is_wide = zero.less(was_wide + begins);
        let since = begins_now.pick(one, word(SINCE) + one);
        let calm_limit = (lanes.splat(self.calm * self.calm) * p_after[0]).rounded();
        let is_calm = (x_after[0] * x_after[0]).rounded().less(calm_limit);
        let counts = lanes.splat(self.hold as f64).less(since).and(is_calm);
        let calm = counts.pick(begins_now.pick(zero, word(CALM)) + one, zero);
        let stays = calm.less(lanes.splat(self.calm_scans as f64));
        let wide_after = is_wide.and(stays).pick(one, zero);
        for (k, value) in [(IS_WIDE, wide_after), (SINCE, since), (CALM, calm)] {
            lanes.put(&mut posterior.rows_mut()[block + k], shown.pick(value, word(k)));
        }
        put_state(lanes, block + NOW, &p_after, &x_after, posterior);
        put(lanes, axis, &x_after, &p_after, posterior);
    }
}
