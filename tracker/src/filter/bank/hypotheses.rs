//! Several hypotheses on the mean acceleration: the multi-alternative filter (M1)-(M3).

use std::ops::AddAssign;

use common::config::{BankConfig, OutputRule};
use common::tracks::{ESTIMATOR_MULTI_ALTERNATIVE, KIND_MEAN_ACCELERATION, MODELS, Models, STATE};
use pulp::{Arch, Simd, WithSimd};

use super::axis::{PACKED, Sight, put, start_component};
use super::block::Block;
use super::coordinates::{self, ByCoordinate};
use super::rule::{MOST, Rule};
use super::singer::Singer;
use crate::filter::evidence::Evidence;
use crate::filter::gaussian::at;
use crate::filter::group::Group;
use crate::filter::lanes::{Lanes, Row, V};
use crate::filter::layout::Layout;
use crate::filter::machine::Machine;
use crate::filter::mixture::Mixture;
use crate::filter::prior::Prior;
use crate::filter::propagate::Noise;
use crate::filter::seam::{Filter, Update};
use crate::filter::start::Origin;

/// Share of the probability that a prediction spreads alike over all hypotheses: a manoeuvre may begin. It widens what the association expects.
const CHANGE: f64 = 0.25;

/// The bank: its hypotheses are the same on every coordinate.
///
/// ```text
/// half cell h = a_max/q,   ā_i = (2i − (q − 1)) h,   σ_w = h/3                                       (M2)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MultiAlternative {
    /// ā of each, m/s².
    means: Vec<f64>,
    /// σ_w, m/s².
    sigma_mps2: f64,
    /// a_max, m/s².
    greatest_mps2: f64,
    /// τ, s.
    tau_s: f64,
    /// n.
    window: usize,
    rule: Rule,
    axes: usize,
    layout: Layout,
}

impl MultiAlternative {
    /// Of `hypotheses` over ±`greatest_mps2`, in `axes` dimensions.
    pub fn new(hypotheses: usize, greatest_mps2: f64, tau_s: f64, window: usize, rule: Rule, axes: usize) -> Self {
        assert!((1..=MOST).contains(&hypotheses) && window > 0, "{hypotheses} hypotheses, {window} scans");
        let half = greatest_mps2 / hypotheses as f64;
        let mean = |i: usize| (2.0 * i as f64 - (hypotheses as f64 - 1.0)) * half;
        Self {
            means: (0..hypotheses).map(mean).collect(),
            sigma_mps2: half / 3.0,
            greatest_mps2,
            tau_s,
            window,
            rule,
            axes,
            layout: layout(hypotheses, window),
        }
    }

    /// As the configuration says.
    pub fn configured(bank: &BankConfig, axes: usize) -> Self {
        let rule = match bank.rule {
            OutputRule::Bayes => Rule::Bayes,
            OutputRule::Standard => Rule::Standard,
            OutputRule::SlidingBayes => Rule::SlidingBayes,
            OutputRule::Sliding => Rule::Sliding,
        };
        let (hypotheses, window) = (bank.hypotheses as usize, bank.window_scans as usize);
        Self::new(hypotheses, bank.greatest_acceleration_mps2, bank.correlation_time_s, window, rule, axes)
    }

    /// ā of each hypothesis, m/s².
    pub fn means(&self) -> &[f64] {
        &self.means
    }

    /// σ_w, m/s².
    pub fn sigma_mps2(&self) -> f64 {
        self.sigma_mps2
    }

    /// Where the numbers of a coordinate stand in a state.
    pub fn block(&self, axis: usize) -> Block {
        Block::new(&self.layout, axis, self.means.len(), self.window)
    }

    /// Shares of the hypotheses of a state on a coordinate.
    pub fn shares_of(&self, words: &[f64], axis: usize) -> [f64; MOST] {
        let mut scores = [0.0; MOST];
        for (i, score) in scores[..self.means.len()].iter_mut().enumerate() {
            *score = self.score(self.block(axis), i, |k| words[k]);
        }
        Arch::Scalar.dispatch(Shares { rule: self.rule, hypotheses: self.means.len(), scores })
    }

    /// Shares of the hypotheses on a coordinate, of some lanes.
    #[inline(always)]
    fn shares<S: Simd>(&self, lanes: Lanes<S>, axis: usize, group: &Group) -> [V<S>; MOST] {
        let mut scores = [lanes.splat(0.0); MOST];
        for (i, score) in scores[..self.means.len()].iter_mut().enumerate() {
            *score = self.score(self.block(axis), i, |k| lanes.get(&group.rows()[k]));
        }
        self.rule.shares(lanes, &scores[..self.means.len()])
    }

    /// L_i(n) or L_i(∞) of a hypothesis, whichever the rule judges by (M3).
    #[inline(always)]
    fn score<T: AddAssign>(&self, block: Block, i: usize, word: impl Fn(usize) -> T) -> T {
        if !self.rule.is_sliding() {
            return word(block.total(i));
        }
        let mut sum = word(block.recent(i, 0));
        for back in 1..self.window {
            sum += word(block.recent(i, back));
        }
        sum
    }

    /// Writes the coordinate of all hypotheses together into the component, their spread as of `spread` shares.
    #[inline(always)]
    fn report<S: Simd>(
        &self,
        lanes: Lanes<S>,
        axis: usize,
        shares: &[V<S>; MOST],
        spread: &[V<S>; MOST],
        group: &mut Group,
    ) {
        let (block, q) = (self.block(axis), self.means.len());
        let mut mean = [lanes.splat(0.0); 3];
        for i in 0..q {
            let state = self.state(lanes, block, i, group);
            for k in 0..3 {
                mean[k] += shares[i] * state[k];
            }
        }
        let mut p = packed(lanes, block, group);
        for i in 0..q {
            let state = self.state(lanes, block, i, group);
            for b in 0..3 {
                let scaled = (spread[i] * (state[b] - mean[b])).rounded();
                for a in 0..=b {
                    p[at(a, b)] += scaled * (state[a] - mean[a]);
                }
            }
        }
        put(lanes, axis, &mean, &p, group);
    }

    /// [ā + w, v, m] of a hypothesis.
    #[inline(always)]
    fn state<S: Simd>(&self, lanes: Lanes<S>, block: Block, i: usize, group: &Group) -> [V<S>; 3] {
        let [w, v, m] = hypothesis(lanes, block, i, group);
        [w + lanes.splat(self.means[i]), v, m]
    }
}

/// The form of its states.
pub(in crate::filter) fn layout(hypotheses: usize, window: usize) -> Layout {
    Layout::new(&[STATE], 3 * Block::words(hypotheses, window), 0, 0)
}

#[inline(always)]
fn packed<S: Simd>(lanes: Lanes<S>, block: Block, group: &Group) -> [V<S>; 6] {
    std::array::from_fn(|k| lanes.get(&group.rows()[block.covariance(k)]))
}

#[inline(always)]
fn hypothesis<S: Simd>(lanes: Lanes<S>, block: Block, i: usize, group: &Group) -> [V<S>; 3] {
    std::array::from_fn(|k| lanes.get(&group.rows()[block.hypothesis(i) + k]))
}

impl Filter for MultiAlternative {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn estimator(&self) -> u16 {
        ESTIMATOR_MULTI_ALTERNATIVE
    }

    fn greatest_acceleration_mps2(&self) -> f64 {
        self.greatest_mps2
    }

    /// (T17) by coordinate, velocity wrong by up to a_max T/2; all hypotheses alike.
    fn start(&self, from: &dyn Origin, state: &mut [f64]) {
        let gaussian = from.moving(Noise { amplitude: 0.5 * self.greatest_mps2, axes: self.axes });
        let (own, q) = (self.sigma_mps2 * self.sigma_mps2, self.means.len());
        let between = self.means.iter().map(|mean| mean * mean).sum::<f64>() / q as f64;
        state.fill(0.0);
        state[0] = 1.0;
        for axis in 0..self.axes {
            let block = self.block(axis);
            let p = start_component(&gaussian, axis, own + between, state);
            state[block.covariance(0)..][..6].copy_from_slice(&p);
            state[block.covariance(0)] = own;
            for i in 0..q {
                state[block.hypothesis(i)..][..3].copy_from_slice(&[0.0, gaussian.mean[3 + axis], gaussian.mean[axis]]);
            }
        }
    }

    fn predict(&self, machine: Machine, lanes: usize, posterior: &Group, step_s: &Row, prediction: &mut Group) {
        coordinates::predict(self, machine, lanes, posterior, step_s, prediction);
    }

    fn update(&self, machine: Machine, lanes: usize, prior: Prior<'_>, evidence: &Evidence, update: &mut Update) {
        coordinates::update(self, machine, lanes, prior, evidence, update);
    }

    /// Hypotheses on the coordinate that accelerates most.
    fn models(&self, state: Mixture<'_>) -> Models {
        let acceleration = |axis: usize| state.mean(0)[6 + axis].abs();
        let axis =
            (1..self.axes).fold(0, |most, axis| if acceleration(axis) > acceleration(most) { axis } else { most });
        let shares = self.shares_of(state.words(), axis);
        let mut models = Models::default();
        for (share, mean) in shares.iter().zip(&self.means).take(MODELS) {
            models.push(KIND_MEAN_ACCELERATION, *share, *mean);
        }
        models
    }
}

/// Shares of hypotheses of these scores.
struct Shares {
    rule: Rule,
    hypotheses: usize,
    scores: [f64; MOST],
}

impl WithSimd for Shares {
    type Output = [f64; MOST];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; MOST] {
        let lanes = Lanes::of(simd, 0);
        let scores = self.scores.map(|score| lanes.splat(score));
        self.rule.shares(lanes, &scores[..self.hypotheses]).map(|share| {
            let mut row = Row::ZERO;
            lanes.put(&mut row, share);
            row.0[0]
        })
    }
}

impl ByCoordinate for MultiAlternative {
    fn axes(&self) -> usize {
        self.axes
    }

    #[inline(always)]
    fn predict_lanes<S: Simd>(&self, lanes: Lanes<S>, step: V<S>, posterior: &Group, prediction: &mut Group) {
        let q = self.means.len();
        let singer = Singer::new(lanes, step, self.tau_s);
        let variance = lanes.splat(self.sigma_mps2 * self.sigma_mps2);
        for axis in 0..self.axes {
            let block = self.block(axis);
            let p = singer.spread(&packed(lanes, block, posterior), variance);
            for k in 0..6 {
                lanes.put(&mut prediction.rows_mut()[block.covariance(k)], p[k]);
            }
            for i in 0..q {
                let before = hypothesis(lanes, block, i, posterior);
                let after = singer.advance(before, lanes.splat(self.means[i]));
                for k in 0..3 {
                    lanes.put(&mut prediction.rows_mut()[block.hypothesis(i) + k], after[k]);
                }
            }
            let shares = self.shares(lanes, axis, prediction);
            let (keep, alike) = (lanes.splat(1.0 - CHANGE), lanes.splat(CHANGE / q as f64));
            let spread = shares.map(|share| keep * share + alike);
            self.report(lanes, axis, &shares, &spread, prediction);
        }
    }

    #[inline(always)]
    fn update_axis<S: Simd>(&self, sight: Sight<'_, S>, prediction: &Group, posterior: &mut Group) {
        let (lanes, axis, q) = (sight.lanes, sight.axis, self.means.len());
        let block = self.block(axis);
        let p = packed(lanes, block, prediction);
        let component = prediction.component::<STATE, PACKED>(0);
        let average = [6, 3, 0].map(|first| lanes.get(&component.mean[first + axis]));
        let after = sight.correct(&p, average);
        for k in 0..6 {
            lanes.put(&mut posterior.rows_mut()[block.covariance(k)], after[k]);
        }
        let mut scores = [lanes.splat(0.0); MOST];
        let mut largest = lanes.splat(f64::MIN);
        for i in 0..q {
            let before = hypothesis(lanes, block, i, prediction);
            let (state, score) = sight.update(&p, before, before[0] + lanes.splat(self.means[i]));
            for k in 0..3 {
                lanes.put(&mut posterior.rows_mut()[block.hypothesis(i) + k], state[k]);
            }
            scores[i] = score;
            largest = largest.max(score);
        }
        let shown = lanes.splat(0.0).less(sight.shown());
        let mut most = lanes.splat(f64::MIN);
        for i in 0..q {
            scores[i] = scores[i] - largest;
            most = most.max(lanes.get(&prediction.rows()[block.total(i)]) + scores[i]);
        }
        for i in 0..q {
            let total = lanes.get(&prediction.rows()[block.total(i)]);
            let row = &mut posterior.rows_mut()[block.total(i)];
            lanes.put(row, shown.pick(total + scores[i] - most, total));
            for back in 0..self.window {
                let own = lanes.get(&prediction.rows()[block.recent(i, back)]);
                let newer =
                    if back == 0 { scores[i] } else { lanes.get(&prediction.rows()[block.recent(i, back - 1)]) };
                lanes.put(&mut posterior.rows_mut()[block.recent(i, back)], shown.pick(newer, own));
            }
        }
        let shares = self.shares(lanes, axis, posterior);
        self.report(lanes, axis, &shares, &shares, posterior);
    }
}
