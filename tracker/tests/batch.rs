//! The batch path against the plain code, one track at a time.
//!
//! Agreement is measured on the scale on which rounding acts, norm by norm: a mean against its own size and the predicted
//! standard deviations, a covariance as correlations of the prediction.

mod plain;

use std::f64::consts::TAU;

use common::config::{Association, TrackerConfig};
use common::geometry::{Polar, range_rate_mps};
use common::random::{Purpose, generator};
use common::units::seconds_between;
use nalgebra::{DMatrix, Vector3};
use plain::Choice;
use proptest::prelude::*;
use pulp::Arch;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::batch::{Bank, Block, Candidates, Forecast, Kernel, LANES, Offer, Row, Scan, Step, Weights};
use tracker::gate::{Radar, own_probability};
use tracker::imm::{Imm, transition};
use tracker::measurement::{COORDINATES, Measurement};
use tracker::motion::{DIMENSIONS, MODES, Motion};
use tracker::start::two_plots;
use tracker::state::{Gaussian, at};
use tracker::update::{Workspace, update};

const SIGMA: [f64; COORDINATES] = [20.0, 0.0017, 0.0017, 10.0];
const CELL: [f64; COORDINATES] = [69.3, 0.006, 0.006, 34.6];
const ALPHA: f64 = 3.0;
/// Largest disagreement.
const TOLERANCE: f64 = 1e-12;
/// Roundings of a size that two ways to compute an exponent may differ by.
const ROUNDINGS: f64 = 16.0;

fn radar(full: bool) -> Radar {
    Radar { variance: SIGMA.map(|sigma| sigma * sigma), cell: CELL, measured: [true, true, full, full] }
}

fn motion(full: bool) -> Motion {
    Motion { noise: [1.0, 1.0, 7.0], axes: if full { 3 } else { 2 } }
}

fn measurement(polar: [f64; COORDINATES], scale: f64, measured: [bool; COORDINATES]) -> Measurement {
    let polar: [f64; COORDINATES] = std::array::from_fn(|i| if measured[i] { polar[i] } else { 0.0 });
    let place = Polar { range_m: polar[0], azimuth_rad: polar[1], elevation_rad: polar[2] };
    Measurement {
        time_ns: 0,
        position: place.to_enu().into(),
        polar,
        variance: std::array::from_fn(|i| if measured[i] { (SIGMA[i] * scale).powi(2) } else { 0.0 }),
        power: 20.0,
        measured,
        has_power: true,
    }
}

/// A target that turns now and then.
struct Flight {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    full: bool,
}

impl Flight {
    fn new(rng: &mut impl Rng, full: bool) -> Self {
        let place = Polar {
            range_m: rng.random_range(300.0..20_000.0),
            azimuth_rad: rng.random_range(0.0..TAU),
            elevation_rad: if full { rng.random_range(0.0..1.2) } else { 0.0 },
        };
        let speed = rng.random_range(0.0..40.0);
        let velocity = Vector3::new(speed, rng.random_range(-20.0..20.0), if full { 1.0 } else { 0.0 });
        Self { position: place.to_enu(), velocity, full }
    }

    fn fly(&mut self, rng: &mut impl Rng, dt_s: f64) {
        if rng.random_range(0.0..1.0) < 0.1 {
            self.velocity = Vector3::new(self.velocity.y, -self.velocity.x, self.velocity.z);
        }
        if self.position.norm() < 200.0 || self.position.norm() > 30_000.0 {
            self.velocity = self.position.normalize() * if self.position.norm() < 200.0 { 30.0 } else { -30.0 };
        }
        self.position += self.velocity * dt_s;
    }

    /// A plot `spread` standard deviations of size `scale` from the target.
    fn plot(&self, rng: &mut impl Rng, spread: f64, scale: f64, measured: [bool; COORDINATES]) -> Measurement {
        let mut normal = |i: usize| spread * scale * SIGMA[i] * sample(rng);
        let place = Polar::from_enu(&self.position);
        let rate = range_rate_mps(&self.position, &self.velocity);
        let elevation_rad = if self.full { place.elevation_rad + normal(2) } else { 0.0 };
        let polar =
            [(place.range_m + normal(0)).abs() + 1.0, place.azimuth_rad + normal(1), elevation_rad, rate + normal(3)];
        measurement(polar, scale, measured)
    }

    fn start(&self, rng: &mut impl Rng) -> Imm {
        let measured = [true, true, self.full, self.full];
        let (first, second) = (self.plot(rng, 1.0, 1.0, measured), self.plot(rng, 1.0, 1.0, measured));
        two_plots(&first, &second, 1.0, &motion(self.full), [0.33, 0.34, 0.33])
    }
}

fn sample(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Root mean square of the differences of two means and of two covariances on the scale of `scale`, whichever is larger.
fn disagreement(a: &Gaussian, b: &Gaussian, scale: &Gaussian, n: usize) -> f64 {
    let deviation = |i: usize| scale.covariance[at(i, i)].sqrt() + f64::MIN_POSITIVE;
    let (mut mean, mut covariance) = (0.0, 0.0);
    for j in 0..n {
        mean += ((a.mean[j] - b.mean[j]) / (b.mean[j].abs() + deviation(j))).powi(2);
        for i in 0..n {
            let difference = a.covariance[at(i, j)] - b.covariance[at(i, j)];
            covariance += (difference / (deviation(i) * deviation(j))).powi(2);
        }
    }
    (mean.max(covariance) / n as f64).sqrt()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * b.abs().max(1e-30)
}

fn assert_same(batch: &Imm, plain: &Imm, scale: &Imm, what: &str) {
    for j in 0..MODES {
        let worst = disagreement(&batch.modes[j], &plain.modes[j], &scale.modes[j], DIMENSIONS[j]);
        assert!(worst <= TOLERANCE, "{what}: mode {j} differs by {worst:e}");
        let (a, b) = (batch.probability[j], plain.probability[j]);
        assert!((a - b).abs() <= TOLERANCE, "{what}: W of mode {j} {a} {b}");
    }
}

/// Those of this machine, of older ones, and none.
fn instructions() -> Vec<Arch> {
    let all = vec![Arch::new(), Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    let all = all.into_iter().chain(pulp::x86::V3::try_new().map(Arch::V3)).collect();
    all
}

/// Blocks of 1 to 8 tracks through 60 scans. Every lane has its own time step and Markov chain, 0 to 8 candidates, errors of
/// their own or shared, times of their own, in some runs elevation or range rate missing.
#[test]
fn a_pass_is_the_plain_code() {
    let (mut compared, mut to_tolerance) = (0_u32, 0_u32);
    for run in 0..48 {
        let mut rng = generator(3, Purpose::Test, run, 0);
        let (full, lanes) = (run % 3 != 0, 1 + run as usize % LANES);
        let inflation = if run % 4 == 0 { 0.8 } else { 0.0 };
        let (radar, motion) = (radar(full), motion(full));
        let kernel =
            Kernel::new(motion, radar, ALPHA, inflation).on(instructions()[run as usize % instructions().len()]);
        let mut flights: Vec<Flight> = (0..lanes).map(|_| Flight::new(&mut rng, full)).collect();
        let mut plain: Vec<Imm> = flights.iter().map(|flight| flight.start(&mut rng)).collect();
        let mut block = Block::default();
        for (lane, track) in plain.iter_mut().enumerate() {
            block.load(lane, track);
            *track = block.store(lane); // without what a mode does not know
        }
        let mut step = Step::splat(1.0, &transition(0.9, 1.0));
        let (mut forecast, mut offered, mut weights) = (Forecast::default(), Candidates::default(), Weights::default());
        for scan in 0..60 {
            let predictions: Vec<Imm> = (0..lanes)
                .map(|lane| {
                    let dt_s = rng.random_range(0.2..3.0);
                    let chain = transition(rng.random_range(0.5..0.99), dt_s);
                    step.set(lane, dt_s, &chain);
                    flights[lane].fly(&mut rng, dt_s);
                    plain[lane].predict(&chain, &motion, dt_s)
                })
                .collect();
            kernel.predict(&block, &step, &mut forecast);
            offered.clear();
            let mut choices = vec![Vec::new(); lanes];
            let mut misses = vec![[0.0; MODES]; lanes];
            for lane in 0..lanes {
                let prediction = &predictions[lane];
                assert_same(
                    &forecast.prediction.store(lane),
                    prediction,
                    prediction,
                    &format!("prediction {run} {scan}"),
                );
                assert_expectation(&forecast, lane, prediction, &radar);
                misses[lane] = std::array::from_fn(|_| rng.random_range(0.01..0.9));
                offered.set_none(lane, misses[lane]);
                let own_errors = rng.random_range(0..3) == 0;
                for _ in 0..rng.random_range(0..9) {
                    let scale = if own_errors { rng.random_range(0.3..3.0) } else { 1.0 };
                    let missing = run % 2 == 0 && rng.random_range(0..4) == 0;
                    let measured =
                        [true, true, full && !(missing && scan % 2 == 0), full && !(missing && scan % 3 == 0)];
                    let spread = if rng.random_range(0..2) == 0 { 1.0 } else { 3.0 };
                    let plot = flights[lane].plot(&mut rng, spread, scale, measured);
                    let choice = Choice {
                        plot,
                        offset_s: rng.random_range(-0.02..0.02),
                        gain: 10.0_f64.powf(rng.random_range(3.0..11.0)),
                    };
                    offered.add(lane, &plot, choice.offset_s, choice.gain);
                    choices[lane].push(choice);
                }
            }
            kernel.update(&forecast, &offered, &mut weights, &mut block);
            for lane in 0..lanes {
                let what = format!("run {run}, scan {scan}, lane {lane}");
                let posterior = plain::update(&predictions[lane], &choices[lane], misses[lane], inflation);
                assert_same(&block.store(lane), &posterior.imm, &predictions[lane], &what);
                for j in 0..MODES {
                    // 10⁻¹², or what the exponent's size and the condition of D leave of sixteen digits.
                    let tolerance = |growth: f64| TOLERANCE.max(ROUNDINGS * f64::EPSILON * growth);
                    let within =
                        |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * b.abs() + f64::MIN_POSITIVE;
                    let of_sum: f64 = posterior
                        .plots
                        .iter()
                        .zip(&posterior.growth)
                        .map(|(weight, growth)| weight[j] * growth[j])
                        .sum();
                    let (a, b) = (weights.likelihood[j].0[lane], posterior.likelihood[j]);
                    assert!(within(a, b, tolerance(of_sum)), "{what}: L {a} {b}, {of_sum}");
                    let (a, b) = (weights.none[j].0[lane], posterior.none[j]);
                    assert!(within(a, b, tolerance(of_sum)), "{what}: none {a} {b}, {of_sum}");
                    for ((rows, plots), growth) in weights.plots.iter().zip(&posterior.plots).zip(&posterior.growth) {
                        let (a, b) = (rows[j].0[lane], plots[j]);
                        assert!(
                            within(a, b, tolerance(of_sum + growth[j])),
                            "{what}: w {a} {b}, {} {of_sum}",
                            growth[j]
                        );
                        compared += 1;
                        to_tolerance += u32::from(within(a, b, TOLERANCE));
                    }
                }
                // Both go on from the same state: what is bounded is one pass, not the growth of rounding over many.
                plain[lane] = posterior.imm;
                block.load(lane, &plain[lane]);
            }
        }
    }
    assert!(f64::from(to_tolerance) > 0.9 * f64::from(compared), "{to_tolerance} of {compared} weights to 10⁻¹²");
}

/// Centre, variances, widths and volume of every gate.
fn assert_expectation(forecast: &Forecast, lane: usize, prediction: &Imm, radar: &Radar) {
    let expected = plain::expect(prediction);
    let gates = plain::gates(&expected, radar, ALPHA);
    let of = |rows: &[Row; COORDINATES]| rows.map(|row| row.0[lane]);
    let batch = [
        (&forecast.hover.centre, &forecast.hover.variance, &forecast.hover.half, &forecast.hover.drift),
        (
            &forecast.constant_velocity.centre,
            &forecast.constant_velocity.variance,
            &forecast.constant_velocity.half,
            &forecast.constant_velocity.drift,
        ),
        (&forecast.manoeuvre.centre, &forecast.manoeuvre.variance, &forecast.manoeuvre.half, &forecast.manoeuvre.drift),
    ]
    .map(|(centre, variance, half, drift)| (of(centre), of(variance), of(half), of(drift)));
    for j in 0..MODES {
        let (centre, variance, half, drift) = batch[j];
        let plain_drift = expected[j].drift();
        for i in 0..COORDINATES {
            let unit = gates[j].half[i];
            assert!((centre[i] - gates[j].centre[i]).abs() < TOLERANCE * (unit + gates[j].centre[i].abs()), "{j} {i}");
            assert!((variance[i] - gates[j].predicted[i]).abs() < TOLERANCE * unit * unit, "{j} {i}");
            assert!((half[i] - unit).abs() < TOLERANCE * unit, "{j} {i}");
            assert!((drift[i] - plain_drift[i]).abs() < 1e-10 * (unit + plain_drift[i].abs()), "{j} {i}");
        }
    }
    let largest = gates.iter().map(|gate| plain::cells(gate, radar)).fold(0.0, f64::max);
    assert!(close(forecast.cells(lane), largest), "{} {largest}", forecast.cells(lane));
}

/// Positive definite on the states that the mode knows, up to rounding.
fn is_positive_definite(imm: &Imm, axes: usize) -> bool {
    (0..MODES).all(|mode| {
        let p = &imm.modes[mode].covariance;
        let known: Vec<usize> = (0..DIMENSIONS[mode]).filter(|i| i % 3 < axes).collect();
        let n = known.len();
        let deviation: Vec<f64> = known.iter().map(|&i| p[at(i, i)].sqrt()).collect();
        let correlation = DMatrix::from_fn(n, n, |i, j| {
            p[at(known[i], known[j])] / (deviation[i] * deviation[j]) + if i == j { 1e-12 } else { 0.0 }
        });
        correlation.cholesky().is_some()
    })
}

/// A million track-scans: whatever the plots, covariances stay positive definite and probabilities sum to 1.
#[test]
fn a_million_scans_stay_sound() {
    let (motion, kernel) = (motion(true), Kernel::new(motion(true), radar(true), ALPHA, 0.0));
    let mut rng = generator(4, Purpose::Test, 0, 0);
    let (mut forecast, mut offered, mut weights) = (Forecast::default(), Candidates::default(), Weights::default());
    let mut block = Block::default();
    let mut flights: Vec<Flight> = Vec::new();
    let measured = [true; COORDINATES];
    for scan in 0..1_000_000 / LANES {
        if scan % 500 == 0 {
            flights = (0..LANES).map(|_| Flight::new(&mut rng, true)).collect();
            for (lane, flight) in flights.iter().enumerate() {
                block.load(lane, &flight.start(&mut rng));
            }
        }
        let dt_s = if scan % 7 == 0 { 5.0 } else { 1.0 };
        kernel.predict(&block, &Step::splat(dt_s, &transition(0.9, dt_s)), &mut forecast);
        offered.clear();
        for (lane, flight) in flights.iter_mut().enumerate() {
            flight.fly(&mut rng, dt_s);
            offered.set_none(lane, [0.1; MODES]);
            for k in 0..(scan + 3 * lane) % 5 {
                let scale = [1.0, 1.0, 0.1, 5.0][(scan / 5 + lane) % 4];
                offered.add(lane, &flight.plot(&mut rng, if k == 0 { 1.0 } else { 4.0 }, scale, measured), 0.0, 1e9);
            }
        }
        kernel.update(&forecast, &offered, &mut weights, &mut block);
        for lane in 0..LANES {
            let track = block.store(lane);
            assert!(track.is_sound(), "lane {lane} of scan {scan}");
            assert!(is_positive_definite(&track, motion.axes), "lane {lane} of scan {scan}");
        }
    }
}

/// P* that rounding has left with less than nothing along the line of sight: gates stay finite, and a plot is worth the same to both.
#[test]
fn a_predicted_variance_below_zero_is_none() {
    let (radar, motion) = (radar(true), motion(true));
    let kernel = Kernel::new(motion, radar, ALPHA, 0.0);
    let polar = [10_000.0, TAU / 8.0, 0.0, 0.0];
    let plot = measurement(polar, 10.0, [true; COORDINATES]);
    let mut track = two_plots(&plot, &plot, 1.0, &motion, [0.33, 0.34, 0.33]);
    for (mode, n) in DIMENSIONS.into_iter().enumerate() {
        // Towards 45°: (p_xx + 2 p_xy + p_yy)/2, of the position and of the velocity.
        for (x, variance, below) in [(0, 1e6, 1e4), (3, 1e4, 5e3)].into_iter().filter(|(x, ..)| x + 1 < n) {
            let p = &mut track.modes[mode].covariance;
            (p[at(x, x)], p[at(x + 1, x + 1)], p[at(x, x + 1)]) = (variance, variance, -variance - below);
            (0..n).filter(|i| i / 3 != x / 3).for_each(|i| (p[at(i, x)], p[at(i, x + 1)]) = (0.0, 0.0));
        }
    }
    let (mut block, mut forecast) = (Block::default(), Forecast::default());
    block.load(3, &track);
    forecast.prediction = block;
    kernel.expect(&mut forecast);
    assert_expectation(&forecast, 3, &track, &radar);
    let gates = plain::gates(&plain::expect(&track), &radar, ALPHA);
    assert!(gates.iter().all(|gate| gate.volume(&radar).is_finite() && gate.predicted[0] == 0.0));
    assert!(gates[1..].iter().all(|gate| gate.predicted[3] == 0.0));
    let choice = Choice { plot, offset_s: 0.0, gain: 1e12 };
    let (mut offered, mut weights) = (Candidates::default(), Weights::default());
    offered.clear();
    offered.set_none(3, [0.1; MODES]);
    offered.add(3, &choice.plot, choice.offset_s, choice.gain);
    kernel.update(&forecast, &offered, &mut weights, &mut block);
    let plain = plain::update(&track, &[choice], [0.1; MODES], 0.0);
    for (mode, likelihood) in plain.likelihood.into_iter().enumerate() {
        assert!(likelihood > 0.2 && close(weights.likelihood[mode].0[3], likelihood), "{mode}: {likelihood}");
    }
}

/// What a single plot that is the target's for certain leaves of P* does not depend on where it lies (T8). Its y yᵀ, 900 times as large as
/// D⁻¹ at 30 standard deviations, must not take the place of what is left.
#[test]
fn the_covariance_after_one_certain_plot_does_not_depend_on_its_place() {
    let (motion, radar) = (motion(true), radar(true));
    let kernels = instructions().into_iter().map(|on| Kernel::new(motion, radar, ALPHA, 0.0).on(on));
    let (range_m, measured) = (10_000.0, [true, true, true, false]);
    let start = measurement([range_m, 0.7, 0.3, 0.0], 30.0, measured);
    let plot = |deviations: f64| measurement([range_m + deviations * 30.0 * SIGMA[0], 0.7, 0.3, 0.0], 0.03, measured);
    let prediction = two_plots(&start, &start, 1.0, &motion, [0.33, 0.34, 0.33]);
    let prediction = prediction.predict(&transition(0.9, 1e-3), &motion, 1e-3);
    let after = |deviations: f64| {
        let mut posteriors = Vec::new();
        for kernel in kernels.clone() {
            let (mut forecast, mut offered) = (Forecast::default(), Candidates::default());
            let (mut weights, mut block) = (Weights::default(), Block::default());
            forecast.prediction.load(0, &prediction);
            kernel.expect(&mut forecast);
            offered.clear();
            offered.set_none(0, [0.0; MODES]);
            offered.add(0, &plot(deviations), 0.0, 1e250);
            kernel.update(&forecast, &offered, &mut weights, &mut block);
            posteriors.push(block.store(0));
        }
        let rules = Rules { association: Association::Nearest, alpha: 1e3, ..Rules::new(&TrackerConfig::default()) };
        let clutter = |_: &[f64; COORDINATES]| FalsePlots { density: 1e-9, mean_excess: 1.0 };
        let surroundings =
            Surroundings { radar: &radar, detection_probability: 0.9, target: None, shares: &[], clutter };
        let outcome = update(&prediction, 0, &[plot(deviations)], &surroundings, &rules, &mut Workspace::default());
        posteriors.push(outcome.posterior);
        posteriors
    };
    for (near, far) in after(0.0).iter().zip(&after(30.0)) {
        for (mode, n) in DIMENSIONS.into_iter().enumerate() {
            let (near, far) = (&near.modes[mode], Gaussian { mean: near.modes[mode].mean, ..far.modes[mode] });
            let worst = disagreement(&far, near, near, n);
            assert!(worst < 1e-9, "mode {mode} differs by {worst:e}");
        }
    }
}

proptest! {
    /// Any finite plots, however absurd, leave a sound state: here and in the plain code.
    #[test]
    fn no_finite_input_breaks_a_track(
        places in prop::collection::vec(
            (0.01..1e7_f64, -6.0..12.0_f64, -1.57..1.57_f64, -1e6..1e6_f64, -7.0..6.0_f64, -300.0..300.0_f64, 0..4_u32),
            3..9,
        ),
        log_step in -6.0..4.0_f64,
        offset_s in -1e4..1e4_f64,
        none in prop::array::uniform3(0.0..1.0_f64),
    ) {
        let plots: Vec<(Measurement, f64)> = places
            .into_iter()
            .map(|(r, b, e, rate, log_scale, log_gain, missing)| {
                let measured = [true, true, missing & 1 == 0, missing & 2 == 0];
                (measurement([r, b, e, rate], 10.0_f64.powf(log_scale), measured), 10.0_f64.powf(log_gain))
            })
            .collect();
        let step_s = 10.0_f64.powf(log_step);
        let motion = motion(true);
        let mut plain = two_plots(&plots[0].0, &plots[1].0, step_s, &motion, [0.33, 0.34, 0.33]);
        let (mut block, mut forecast) = (Block::default(), Forecast::default());
        let (mut offered, mut weights) = (Candidates::default(), Weights::default());
        block.load(5, &plain);
        let chain = transition(0.9, step_s);
        let choices: Vec<Choice> =
            plots.iter().map(|(plot, gain)| Choice { plot: *plot, offset_s, gain: *gain }).collect();
        for instructions in instructions() {
            let kernel = Kernel::new(motion, radar(true), ALPHA, 0.0).on(instructions);
            for _ in 0..3 {
                kernel.predict(&block, &Step::splat(step_s, &chain), &mut forecast);
                offered.clear();
                offered.set_none(5, none);
                for choice in &choices {
                    offered.add(5, &choice.plot, choice.offset_s, choice.gain);
                }
                kernel.update(&forecast, &offered, &mut weights, &mut block);
                let predictions = [forecast.prediction.store(5), plain.predict(&chain, &motion, step_s)];
                plain = plain::update(&predictions[1], &choices, none, 0.0).imm;
                for (track, prediction) in [block.store(5), plain].iter().zip(&predictions) {
                    let sum: f64 = track.probability.iter().sum();
                    prop_assert!((sum - 1.0).abs() < 1e-9, "{sum}");
                    prop_assert!(track.is_sound() || !prediction.is_sound());
                }
                for j in (0..MODES).filter(|_| predictions[0].is_sound()) {
                    prop_assert!(!weights.likelihood[j].0[5].is_nan());
                    let sum: f64 = weights.plots[..choices.len()].iter().map(|rows| rows[j].0[5]).sum();
                    prop_assert!((sum + weights.none[j].0[5] - 1.0).abs() < 1e-9, "{sum}");
                }
                if !predictions.iter().all(Imm::is_sound) {
                    // Plots of 10³⁰⁰, or errors of 10¹² m beside some of a metre, can leave a sound covariance whose prediction is
                    // not: the tracker ends such a track.
                    break;
                }
            }
        }
    }
}

/// A bank of tracks that see each other's plots: index, gates, threshold and update against looking at every plot.
#[test]
fn a_bank_is_the_plain_rule() {
    let (radar, motion) = (radar(true), motion(true));
    let mut rng = generator(5, Purpose::Test, 0, 0);
    let mut flights: Vec<Flight> = (0..83).map(|_| Flight::new(&mut rng, true)).collect();
    let mut bank = Bank::new(Kernel::new(motion, radar, ALPHA, 0.0));
    for flight in &flights {
        bank.push(&flight.start(&mut rng));
    }
    let mut plain: Vec<Imm> = (0..bank.len()).map(|track| bank.track(track)).collect();
    let chain = transition(0.9, 1.0);
    let offer = |cells: f64| Offer { threshold: (cells / 100.0).ln().max(3.0), detection_probability: 0.8 };
    for scan in 1..50_u64 {
        let time_ns = scan * 1_000_000_000;
        let mut plots = Vec::new();
        for flight in &mut flights {
            flight.fly(&mut rng, 1.0);
            for k in 0..rng.random_range(0..6) {
                let mut plot = flight.plot(&mut rng, if k == 0 { 1.0 } else { 5.0 }, 1.0, [true; COORDINATES]);
                plot.power = rng.random_range(2.0..20.0);
                plot.time_ns = time_ns + rng.random_range(0..10_000_000);
                plots.push(plot);
            }
        }
        let gains: Vec<f64> = plots.iter().map(|plot| 1e6 * plot.power.exp()).collect();
        let mut found = vec![Vec::new(); bank.len()];
        bank.scan(
            &Scan { plots: &plots, gains: &gains, time_ns, dt_s: 1.0, transition: &chain },
            |_, cells| offer(cells),
            |passed| {
                for lane in 0..passed.lanes {
                    found[passed.first + lane].clone_from(&passed.plots[lane]);
                }
            },
        );
        let miss = 1.0 - 0.8 * own_probability(ALPHA, 4);
        for (track, plain) in plain.iter_mut().enumerate() {
            let prediction = plain.predict(&chain, &motion, 1.0);
            let expected = plain::expect(&prediction);
            let gates = plain::gates(&expected, &radar, ALPHA);
            let threshold = offer(gates.iter().map(|gate| plain::cells(gate, &radar)).fold(0.0, f64::max)).threshold;
            let mut chosen = Vec::new();
            for (index, plot) in plots.iter().enumerate() {
                let offset_s = seconds_between(time_ns, plot.time_ns);
                if plot.power >= threshold && plain::is_inside(plot, offset_s, &gates) {
                    chosen.push((index as u32, Choice { plot: *plot, offset_s, gain: gains[index] }));
                }
            }
            found[track].sort_unstable();
            assert_eq!(found[track], chosen.iter().map(|(index, _)| *index).collect::<Vec<u32>>(), "{track} {scan}");
            let choices: Vec<Choice> = chosen.into_iter().map(|(_, choice)| choice).collect();
            *plain = plain::update(&prediction, &choices, [miss; MODES], 0.0).imm;
            for j in 0..MODES {
                // Rounding grows from scan to scan, and the order of the plots differs.
                let same =
                    disagreement(&bank.track(track).modes[j], &plain.modes[j], &prediction.modes[j], DIMENSIONS[j]);
                assert!(same < 1e-9, "{track} {scan} {j} {same:e}");
            }
        }
    }
}
