//! The filters' vectors against plain code, one track at a time, and the soundness of what they make.
//!
//! Agreement is measured on the scale on which rounding acts, norm by norm: a mean against its own size and the predicted
//! standard deviations, a covariance as correlations of the prediction.

mod flight;
mod reference;
mod soundness;

use common::random::{Purpose, generator};
use flight::{ALPHA, Flight, filter, motion, radar};
use pulp::Arch;
use rand::RngExt;
use reference::imm::{Imm, transition};
use reference::motion::DIMENSIONS;
use reference::rule::{self, Choice};
use tracker::association::gate::Gate;
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::uav::{MODES, Uav};
use tracker::filter::{Evidence, Expectation, Filter, Group, LANES, Machine, Mixture, Prior, Row, Update, expect};
use tracker::plots::measurement::COORDINATES;
use tracker::plots::radar::Radar;

/// Largest disagreement.
const TOLERANCE: f64 = 1e-12;
/// Below e⁻⁷⁰⁸ the vectors' exponential is 0; gains are up to 10¹¹.
const LEAST_DENSITY: f64 = 1e-290;
/// Roundings of a size that two ways to compute an exponent may differ by.
const ROUNDINGS: f64 = 16.0;

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

/// A state of the filter under test.
fn state_of(group: &Group, lane: usize) -> Imm {
    let mut words = vec![0.0; group.layout().words()];
    group.store(lane, &mut words);
    Imm::of(Mixture::new(group.layout(), &words))
}

/// Everything that a scan of a group needs.
struct Lanes {
    filter: Uav,
    machine: Machine,
    radar: Radar,
    inflation: f64,
    prediction: Group,
    expected: Vec<Expectation>,
    evidence: Evidence,
    update: Update,
}

impl Lanes {
    fn new(filter: Uav, arch: Arch, radar: Radar, inflation: f64) -> Self {
        let layout = filter.layout();
        Self {
            filter,
            machine: Machine::on(arch),
            radar,
            inflation,
            prediction: Group::new(layout),
            expected: Vec::new(),
            evidence: Evidence::default(),
            update: Update::new(layout),
        }
    }

    fn load(&mut self, lane: usize, track: &Imm) {
        self.update.posterior.load(lane, &track.words(&self.filter));
    }

    fn predict(&mut self, lanes: usize, step_s: &Row) {
        self.filter.predict(self.machine, lanes, &self.update.posterior, step_s, &mut self.prediction);
        self.expect(lanes);
    }

    fn expect(&mut self, lanes: usize) {
        expect(self.machine, lanes, &self.radar, ALPHA, &self.prediction, &mut self.expected);
        self.evidence.clear(MODES);
    }

    fn update(&mut self, lanes: usize) {
        let prior = Prior { prediction: &self.prediction, expected: &self.expected, inflation: self.inflation };
        self.filter.update(self.machine, lanes, prior, &self.evidence, &mut self.update);
    }
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

/// Groups of 1 to 8 tracks through 60 scans. Every lane has its own time step, 0 to 8 candidates, errors of
/// their own or shared, times of their own, in some runs elevation or range rate missing.
#[test]
fn a_pass_is_the_plain_code() {
    let (mut compared, mut to_tolerance) = (0_u32, 0_u32);
    for run in 0..48 {
        let mut rng = generator(3, Purpose::Test, run, 0);
        let (full, lanes) = (run % 3 != 0, 1 + run as usize % LANES);
        let inflation = if run % 4 == 0 { 0.8 } else { 0.0 };
        let filter = filter(full, rng.random_range(0.5..0.99));
        let (radar, motion) = (radar(full), motion(&filter));
        let arch = instructions()[run as usize % instructions().len()];
        let mut group = Lanes::new(filter, arch, radar, inflation);
        let mut flights: Vec<Flight> = (0..lanes).map(|_| Flight::new(&mut rng, full)).collect();
        let mut plain: Vec<Imm> = flights.iter().map(|flight| flight.start(&mut rng)).collect();
        let mut step_s = Row::ZERO;
        for (lane, track) in plain.iter().enumerate() {
            group.load(lane, track);
        }
        for scan in 0..60 {
            let predictions: Vec<Imm> = (0..lanes)
                .map(|lane| {
                    let dt_s = rng.random_range(0.2..3.0);
                    step_s.0[lane] = dt_s;
                    flights[lane].fly(&mut rng, dt_s);
                    plain[lane].predict(&transition(filter.stay, dt_s), &motion, dt_s)
                })
                .collect();
            group.predict(lanes, &step_s);
            let mut choices = vec![Vec::new(); lanes];
            let mut misses = vec![[0.0; MODES]; lanes];
            for lane in 0..lanes {
                let prediction = &predictions[lane];
                let what = format!("prediction {run} {scan}");
                assert_same(&state_of(&group.prediction, lane), prediction, prediction, &what);
                assert_expectation(&group.expected, lane, prediction, &radar);
                misses[lane] = std::array::from_fn(|_| rng.random_range(0.01..0.9));
                group.evidence.set_none(lane, &misses[lane]);
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
                    group.evidence.add(lane, &plot, choice.offset_s, choice.gain);
                    choices[lane].push(choice);
                }
            }
            group.update(lanes);
            for lane in 0..lanes {
                let what = format!("run {run}, scan {scan}, lane {lane}");
                let posterior = rule::update(&predictions[lane], &choices[lane], misses[lane], inflation);
                assert_same(&state_of(&group.update.posterior, lane), &posterior.imm, &predictions[lane], &what);
                let weights = &group.update.weights;
                for j in 0..MODES {
                    // 10⁻¹², or what the exponent's size and the condition of D leave of sixteen digits.
                    let tolerance = |growth: f64| TOLERANCE.max(ROUNDINGS * f64::EPSILON * growth);
                    let within = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * b.abs() + LEAST_DENSITY;
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
                    for (m, (plots, growth)) in posterior.plots.iter().zip(&posterior.growth).enumerate() {
                        let (a, b) = (weights.plots[m * MODES + j].0[lane], plots[j]);
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
                group.load(lane, &plain[lane]);
            }
        }
    }
    assert!(f64::from(to_tolerance) > 0.9 * f64::from(compared), "{to_tolerance} of {compared} weights to 10⁻¹²");
}

/// Centre, variances, widths and volume of every gate.
fn assert_expectation(expected: &[Expectation], lane: usize, prediction: &Imm, radar: &Radar) {
    let plain = rule::expect(prediction);
    let gates = rule::gates(&plain, radar, ALPHA);
    for j in 0..MODES {
        let Gate { centre, predicted, drift, half, .. } = Gate::new(&expected[j], lane, ALPHA);
        let plain_drift = plain[j].drift();
        for i in 0..COORDINATES {
            let unit = gates[j].half[i];
            assert!((centre[i] - gates[j].centre[i]).abs() < TOLERANCE * (unit + gates[j].centre[i].abs()), "{j} {i}");
            assert!((predicted[i] - gates[j].predicted[i]).abs() < TOLERANCE * unit * unit, "{j} {i}");
            assert!((half[i] - unit).abs() < TOLERANCE * unit, "{j} {i}");
            assert!((drift[i] - plain_drift[i]).abs() < 1e-10 * (unit + plain_drift[i].abs()), "{j} {i}");
        }
    }
}

/// What (T17) gives the near-constant-velocity mode of acceleration's variance is mixed into the manoeuvre mode once, as if that mode knew it.
#[test]
fn the_variance_of_acceleration_at_the_start_is_mixed_once() {
    let filter = filter(true, 0.9);
    let mut rng = generator(9, Purpose::Test, 0, 0);
    let flight = Flight::new(&mut rng, true);
    let [first, second] = [0, 1].map(|_| flight.plot(&mut rng, 1.0, 1.0, [true; COORDINATES]));
    let mut words = vec![0.0; filter.layout().words()];
    filter.start(&tracker::filter::TwoPlots { previous: &first, last: &second, step_s: 1.0 }, &mut words);
    let mut plain = Imm::of(Mixture::new(filter.layout(), &words));
    for axis in 6..9 {
        plain.modes[1].covariance[at(axis, axis)] = filter.noise[1] * filter.noise[1];
    }
    let mut whole = Mixture::new(filter.layout(), &words).moments();
    filter.complete(Mixture::new(filter.layout(), &words), None, &mut whole);
    assert!(disagreement(&whole, &plain.mixture(), &whole, 9) < TOLERANCE);
    let mut group = Lanes::new(filter, Arch::new(), radar(true), 0.0);
    group.update.posterior.load(0, &words);
    for step in 0..2 {
        group.predict(1, &Row::splat(1.0));
        plain = plain.predict(&transition(0.9, 1.0), &motion(&filter), 1.0);
        assert_same(&state_of(&group.prediction, 0), &plain, &plain, &format!("step {step}"));
        group.update.posterior = group.prediction.clone();
    }
}

/// Moments of several components together, and soundness, in lanes.
#[test]
fn moments_of_lanes_are_those_of_the_mixture() {
    let filter = filter(true, 0.9);
    let mut rng = generator(11, Purpose::Test, 0, 0);
    for arch in instructions() {
        let mut group = Group::new(filter.layout());
        let tracks: Vec<Imm> = (0..LANES).map(|_| Flight::new(&mut rng, true).start(&mut rng)).collect();
        for (lane, track) in tracks.iter().enumerate() {
            group.load(lane, &track.words(&filter));
        }
        let mut moments = tracker::filter::Moments::default();
        moments.evaluate(Machine::on(arch), LANES, &group);
        for (lane, track) in tracks.iter().enumerate() {
            let mixture = track.mixture();
            assert!(disagreement(&moments.gaussian(lane), &mixture, &mixture, 9) < TOLERANCE, "lane {lane}");
        }
        assert!(group.soundness(Machine::on(arch), LANES).0.iter().all(|sound| *sound > 0.0));
        let mut broken = tracks[3].words(&filter);
        broken[7] = f64::NAN;
        group.load(3, &broken);
        broken[7] = 0.0;
        broken[filter.layout().start(2) + 9 + at(4, 4)] = -1e-3;
        group.load(5, &broken);
        let sound = group.soundness(Machine::on(arch), LANES).0;
        assert!((0..LANES).all(|lane| (sound[lane] > 0.0) == (lane != 3 && lane != 5)), "{sound:?}");
    }
}
