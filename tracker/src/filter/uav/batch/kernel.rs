//! The two vector stages of a pass, compiled for several machines; the best one is chosen as it runs.

use common::tracks::STATE;
use pulp::{Arch, Simd, WithSimd};

use crate::association::gate::{Gate, Radar};
use crate::filter::gaussian::at;
use crate::filter::uav::motion::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, MODES, Motion};

use super::block::{Block, Mode};
use super::candidates::Candidates;
use super::expect::{Expectation, expect};
use super::lanes::{LANES, Lanes, Row, V};
use super::predict::{Step, predict};
use super::update::{Prior, Weights, update};

/// What the modes of a block expect of the scan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Forecast {
    /// u*, P*, W*.
    pub prediction: Block,
    /// Of the hover mode.
    pub hover: Expectation<3>,
    /// Of the near-constant-velocity mode.
    pub constant_velocity: Expectation<6>,
    /// Of the manoeuvre mode.
    pub manoeuvre: Expectation<STATE>,
}

impl Forecast {
    /// U of (T20): the largest of the modes' gates, in resolution cells.
    pub fn cells(&self, lane: usize) -> f64 {
        self.hover.cells.0[lane].max(self.constant_velocity.cells.0[lane]).max(self.manoeuvre.cells.0[lane])
    }

    /// The modes' gates of half width `alpha` standard deviations, the α that the kernel was given.
    pub fn gates(&self, lane: usize, alpha: f64) -> [Gate; MODES] {
        [self.hover.gate(lane, alpha), self.constant_velocity.gate(lane, alpha), self.manoeuvre.gate(lane, alpha)]
    }
}

/// The filter's constants, and the machine's instructions.
#[derive(Debug, Clone, Copy)]
pub struct Kernel {
    arch: Arch,
    /// The three modes.
    pub motion: Motion,
    /// What is measured, and how well.
    pub radar: Radar,
    /// α of (T9).
    pub alpha: f64,
    /// γ of (T7).
    pub inflation: f64,
}

impl Kernel {
    /// For the machine that it runs on.
    pub fn new(motion: Motion, radar: Radar, alpha: f64, inflation: f64) -> Self {
        Self { arch: Arch::new(), motion, radar, alpha, inflation }
    }

    /// With other instructions than the machine's best, to compare.
    #[must_use]
    pub fn on(self, arch: Arch) -> Self {
        Self { arch, ..self }
    }

    /// Prediction by `step`, expected measurements and gates.
    pub fn predict(&self, posterior: &Block, step: &Step, forecast: &mut Forecast) {
        self.arch.dispatch(Predict { kernel: self, posterior, step, forecast });
    }

    /// Expected measurements and gates of predictions made elsewhere.
    pub fn expect(&self, forecast: &mut Forecast) {
        self.arch.dispatch(Expect { kernel: self, forecast });
    }

    /// Association with `candidates` and update.
    ///
    /// A lane whose posterior would not be sound (a number that is not finite, a negative variance) keeps its prediction.
    pub fn update(&self, forecast: &Forecast, candidates: &Candidates, weights: &mut Weights, posterior: &mut Block) {
        if weights.plots.len() < candidates.slots() {
            weights.plots.resize(candidates.slots(), [Row::ZERO; MODES]);
        }
        let sound = self.arch.dispatch(Update { kernel: self, forecast, candidates, weights, posterior });
        for lane in (0..LANES).filter(|&lane| sound.0[lane] == 0.0) {
            posterior.copy_lane(lane, &forecast.prediction);
        }
    }

    #[inline(always)]
    fn expect_part<S: Simd>(&self, lanes: Lanes<S>, forecast: &mut Forecast) {
        let Forecast { prediction, hover, constant_velocity, manoeuvre } = forecast;
        expect(lanes, &prediction.hover, &self.radar, self.alpha, hover);
        expect(lanes, &prediction.constant_velocity, &self.radar, self.alpha, constant_velocity);
        expect(lanes, &prediction.manoeuvre, &self.radar, self.alpha, manoeuvre);
    }
}

struct Predict<'a> {
    kernel: &'a Kernel,
    posterior: &'a Block,
    step: &'a Step,
    forecast: &'a mut Forecast,
}

impl WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, posterior, step, forecast } = self;
        for part in 0..Lanes::<S>::PARTS {
            let lanes = Lanes::of(simd, part);
            predict(lanes, posterior, step, &kernel.motion, &mut forecast.prediction);
            kernel.expect_part(lanes, forecast);
        }
    }
}

struct Expect<'a> {
    kernel: &'a Kernel,
    forecast: &'a mut Forecast,
}

impl WithSimd for Expect<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..Lanes::<S>::PARTS {
            self.kernel.expect_part(Lanes::of(simd, part), self.forecast);
        }
    }
}

struct Update<'a> {
    kernel: &'a Kernel,
    forecast: &'a Forecast,
    candidates: &'a Candidates,
    weights: &'a mut Weights,
    posterior: &'a mut Block,
}

impl WithSimd for Update<'_> {
    /// 1 in the lanes whose posterior is sound, else 0.
    type Output = Row;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Row {
        let Self { kernel: Kernel { inflation, .. }, forecast: expected, candidates, weights, posterior } = self;
        let from = &expected.prediction;
        let mut all_sound = Row::ZERO;
        for part in 0..Lanes::<S>::PARTS {
            let lanes = Lanes::of(simd, part);
            let into = &mut *posterior;
            let hover = Prior { predicted: &from.hover, expected: &expected.hover };
            let steady = Prior { predicted: &from.constant_velocity, expected: &expected.constant_velocity };
            let manoeuvre = Prior { predicted: &from.manoeuvre, expected: &expected.manoeuvre };
            update(lanes, HOVER, hover, candidates, *inflation, weights, &mut into.hover);
            update(lanes, CONSTANT_VELOCITY, steady, candidates, *inflation, weights, &mut into.constant_velocity);
            update(lanes, MANOEUVRE, manoeuvre, candidates, *inflation, weights, &mut into.manoeuvre);
            reweight(lanes, from, weights, into);
            let soundness = [
                soundness(lanes, &into.hover),
                soundness(lanes, &into.constant_velocity),
                soundness(lanes, &into.manoeuvre),
            ];
            let worst = soundness[0].min(soundness[1]).min(soundness[2]);
            lanes.put(&mut all_sound, worst);
        }
        all_sound
    }
}

/// W_j ∝ W*_j L_j (T20); unchanged where no mode explains anything.
#[inline(always)]
fn reweight<S: Simd>(lanes: Lanes<S>, prediction: &Block, weights: &Weights, posterior: &mut Block) {
    let before = lanes.all(&prediction.probability);
    let likelihood = lanes.all(&weights.likelihood);
    let largest = likelihood[0].max(likelihood[1]).max(likelihood[2]);
    let mut after = before;
    for j in 0..MODES {
        after[j] = (before[j] * (likelihood[j] / largest)).rounded();
    }
    let total = after[0] + after[1] + after[2];
    let explained = largest.is_positive().and(total.is_positive());
    for j in 0..MODES {
        lanes.put(&mut posterior.probability[j], explained.pick(after[j] / total, before[j]));
    }
}

/// 1 where every number is finite and no variance negative, else 0.
#[inline(always)]
fn soundness<S: Simd, const N: usize, const P: usize>(lanes: Lanes<S>, mode: &Mode<N, P>) -> V<S> {
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    // x · 0 is NaN where x is not finite.
    let mut nothing = zero;
    for row in &mode.mean {
        nothing += lanes.get(row) * zero;
    }
    for row in &mode.covariance {
        nothing += lanes.get(row) * zero;
    }
    let mut least = one;
    for i in 0..N {
        least = least.min(lanes.get(&mode.covariance[at(i, i)]));
    }
    nothing.less(one).and((-least).less(lanes.splat(f64::MIN_POSITIVE))).pick(one, zero)
}
