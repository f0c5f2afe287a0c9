//! Many tracks, scan by scan: the blocks, the index of the plots, and the choice of candidates by (T20).

use crate::association::gate::own_probability;
use crate::filter::uav::imm::{Imm, Transition};
use crate::filter::uav::motion::MODES;
use crate::plots::index::{PlotIndex, Window};
use crate::plots::measurement::{COORDINATES, Measurement};

use common::angle;
use common::units::{NS_PER_S, seconds_between};
use std::f64::consts::FRAC_PI_2;

use super::block::Block;
use super::candidates::Candidates;
use super::expect::Expectation;
use super::kernel::{Forecast, Kernel};
use super::lanes::LANES;
use super::predict::Step;
use super::update::Weights;

/// Intervals are widened by this against rounding.
const WIDENED: f64 = 1.0 + 1e-9;

/// One scan as the bank takes it.
#[derive(Debug, Clone, Copy)]
pub struct Scan<'a> {
    /// The plots.
    pub plots: &'a [Measurement],
    /// a = ℓ(q)/ρ(p) of each, m³·m/s.
    pub gains: &'a [f64],
    /// Time to predict to, ns.
    pub time_ns: u64,
    /// Since the scan before, s.
    pub dt_s: f64,
    /// Π over it.
    pub transition: &'a Transition,
}

/// How a track looks at the scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offer {
    /// t: plots with q below it do not count.
    pub threshold: f64,
    /// D, probability of detection with this threshold.
    pub detection_probability: f64,
}

/// What a block was given and made of it, for the caller to read.
#[derive(Debug, Clone, Copy)]
pub struct Passed<'a> {
    /// Number of the track in lane 0.
    pub first: usize,
    /// Lanes in use.
    pub lanes: usize,
    /// Predictions, expectations and gates.
    pub forecast: &'a Forecast,
    /// L_j, w_jm, w_j0.
    pub weights: &'a Weights,
    /// Plot of each slot, by lane.
    pub plots: &'a [Vec<u32>; LANES],
    /// û, P̂, W.
    pub posterior: &'a Block,
}

/// Tracks at a common time.
#[derive(Debug)]
pub struct Bank {
    kernel: Kernel,
    blocks: Vec<Block>,
    len: usize,
    index: PlotIndex,
    /// The block at hand: read from memory in one go, which its parts in the order of the formulas are not.
    here: Box<Block>,
    forecast: Forecast,
    candidates: Candidates,
    weights: Weights,
    chosen: [Vec<u32>; LANES],
    /// Plots in the window of the lane at hand.
    near: Vec<u32>,
}

impl Bank {
    /// No tracks.
    pub fn new(kernel: Kernel) -> Self {
        Self {
            kernel,
            blocks: Vec::new(),
            len: 0,
            index: PlotIndex::default(),
            here: Box::default(),
            forecast: Forecast::default(),
            candidates: Candidates::default(),
            weights: Weights::default(),
            chosen: Default::default(),
            near: Vec::new(),
        }
    }

    /// Adds a track.
    pub fn push(&mut self, track: &Imm) {
        let lane = self.len % LANES;
        if lane == 0 {
            self.blocks.push(Block::default());
        }
        if let Some(block) = self.blocks.last_mut() {
            block.load(lane, track);
        }
        self.len += 1;
    }

    /// Number of tracks.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// A track, by order of adding.
    pub fn track(&self, index: usize) -> Imm {
        assert!(index < self.len, "track {index} of {}", self.len);
        self.blocks[index / LANES].store(index % LANES)
    }

    /// One scan of all tracks. `offer` is asked for each track, given U, and `passed` is told of each block.
    pub fn scan(
        &mut self,
        scan: &Scan<'_>,
        mut offer: impl FnMut(usize, f64) -> Offer,
        mut passed: impl FnMut(Passed<'_>),
    ) {
        let Self { kernel, blocks, len, index, here, forecast, candidates, weights, chosen, near } = self;
        let mut reach = Reach::new(kernel.alpha, scan.time_ns);
        index.build(scan.plots.iter().inspect(|plot| reach.widen(plot)));
        let step = Step::splat(scan.dt_s, scan.transition);
        let own = own_probability(kernel.alpha, kernel.radar.dimensions());
        for (number, block) in blocks.iter_mut().enumerate() {
            let first = number * LANES;
            let lanes = LANES.min(*len - first);
            **here = *block;
            kernel.predict(here, &step, forecast);
            candidates.clear();
            for lane in 0..lanes {
                let offer = offer(first + lane, forecast.cells(lane));
                candidates.set_none(lane, [1.0 - offer.detection_probability * own; MODES]);
                let gates = Gates::new(forecast, lane, &reach);
                chosen[lane].clear();
                index.find(&gates.window, near);
                for &near in near.iter() {
                    let plot = &scan.plots[near as usize];
                    if plot.power < offer.threshold {
                        continue;
                    }
                    let offset_s = seconds_between(scan.time_ns, plot.time_ns);
                    if gates.hold(plot, offset_s, &reach) {
                        candidates.add(lane, plot, offset_s, scan.gains[near as usize]);
                        chosen[lane].push(near);
                    }
                }
            }
            kernel.update(forecast, candidates, weights, block);
            passed(Passed { first, lanes, forecast, weights, plots: chosen, posterior: block });
        }
    }
}

/// How far from a gate's centre a plot of the scan may lie and still be inside.
#[derive(Debug, Clone, Copy)]
struct Reach {
    square_alpha: f64,
    /// Time of the scan, ns.
    time_ns: u64,
    /// Largest σ²; ∞ if a plot lacks the coordinate.
    variance: [f64; COORDINATES],
    /// Largest distance of a plot's time from the scan's, ns.
    offset_ns: u64,
}

impl Reach {
    fn new(alpha: f64, time_ns: u64) -> Self {
        Self { square_alpha: alpha * alpha, time_ns, variance: [0.0; COORDINATES], offset_ns: 0 }
    }

    fn widen(&mut self, plot: &Measurement) {
        for i in 0..COORDINATES {
            let variance = if plot.measured[i] { plot.variance[i] } else { f64::INFINITY };
            self.variance[i] = self.variance[i].max(variance);
        }
        self.offset_ns = self.offset_ns.max(self.time_ns.abs_diff(plot.time_ns));
    }

    fn offset_s(&self) -> f64 {
        self.offset_ns as f64 / NS_PER_S
    }
}

/// The gate of one mode of one track.
#[derive(Clone, Copy)]
struct Gate {
    centre: [f64; COORDINATES],
    drift: [f64; COORDINATES],
    /// α² p*.
    square: [f64; COORDINATES],
}

/// The gates of one track, the manoeuvre mode's first: it is seldom not the widest.
struct Gates {
    modes: [Gate; MODES],
    /// Ends of the smallest intervals that hold all of them, for any plot of the scan; not of β.
    hull: [[f64; 2]; COORDINATES],
    window: Window,
}

impl Gates {
    fn new(forecast: &Forecast, lane: usize, reach: &Reach) -> Self {
        let modes = [
            Gate::new(&forecast.manoeuvre, lane, reach.square_alpha),
            Gate::new(&forecast.constant_velocity, lane, reach.square_alpha),
            Gate::new(&forecast.hover, lane, reach.square_alpha),
        ];
        let middle = modes[0].centre[1];
        let mut hull = [[f64::INFINITY, f64::NEG_INFINITY]; COORDINATES];
        let mut half_azimuth_rad = 0.0_f64;
        for mode in &modes {
            for i in 0..COORDINATES {
                let half = (mode.square[i] + reach.square_alpha * reach.variance[i]).sqrt();
                let moved = (mode.drift[i] * reach.offset_s()).abs();
                if i == 1 {
                    let shift = angle::difference(mode.centre[1], middle).abs();
                    half_azimuth_rad = half_azimuth_rad.max(shift + half.min(FRAC_PI_2) + moved);
                } else {
                    let reached = WIDENED * (half + moved);
                    hull[i] = [hull[i][0].min(mode.centre[i] - reached), hull[i][1].max(mode.centre[i] + reached)];
                }
            }
        }
        let window = Window { azimuth_rad: middle, half_azimuth_rad, range_m: hull[0], elevation_rad: hull[2] };
        Self { modes, hull, window }
    }

    /// Whether `plot` lies in any of them (T9).
    fn hold(&self, plot: &Measurement, offset_s: f64, reach: &Reach) -> bool {
        let near = |i: usize| self.hull[i][0] <= plot.polar[i] && plot.polar[i] <= self.hull[i][1];
        if !(near(2) && near(3)) {
            return false;
        }
        // No gate refuses what was not measured.
        let square =
            std::array::from_fn(
                |i| {
                    if plot.measured[i] { reach.square_alpha * plot.variance[i] } else { f64::INFINITY }
                },
            );
        self.modes.iter().any(|gate| gate.holds(&plot.polar, &square, offset_s))
    }
}

impl Gate {
    fn new<const N: usize>(expected: &Expectation<N>, lane: usize, square_alpha: f64) -> Self {
        let of = |rows: &[super::lanes::Row; COORDINATES]| rows.map(|row| row.0[lane]);
        Self {
            centre: of(&expected.centre),
            drift: of(&expected.drift),
            square: of(&expected.variance).map(|p| square_alpha * p),
        }
    }

    /// As [`crate::association::gate::Gate::holds`]; all coordinates at once, as most plots asked about are inside.
    fn holds(&self, polar: &[f64; COORDINATES], square: &[f64; COORDINATES], offset_s: f64) -> bool {
        let mut offset: [f64; COORDINATES] =
            std::array::from_fn(|i| polar[i] - (self.centre[i] + self.drift[i] * offset_s));
        if offset[1].abs() > FRAC_PI_2 {
            offset[1] = angle::difference(offset[1], 0.0);
        }
        let inside = (0..COORDINATES).filter(|&i| offset[i] * offset[i] <= self.square[i] + square[i]).count();
        inside == COORDINATES && offset[1].abs() <= FRAC_PI_2
    }
}
