//! The batch path against the plain code, one track at a time, and the soundness of both.
//!
//! Agreement is measured on the scale on which rounding acts, norm by norm: a mean against its own size and the predicted
//! standard deviations, a covariance as correlations of the prediction.

mod flight;
mod plain;
mod soundness;

use common::random::{Purpose, generator};
use common::units::seconds_between;
use flight::{ALPHA, Flight, motion, radar};
use plain::Choice;
use pulp::Arch;
use rand::RngExt;
use tracker::association::gate::{Radar, own_probability};
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::uav::batch::{Bank, Block, Candidates, Forecast, Kernel, LANES, Offer, Row, Scan, Step, Weights};
use tracker::filter::uav::imm::{Imm, transition};
use tracker::filter::uav::motion::{DIMENSIONS, MODES};
use tracker::plots::measurement::COORDINATES;

/// Largest disagreement.
const TOLERANCE: f64 = 1e-12;
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
