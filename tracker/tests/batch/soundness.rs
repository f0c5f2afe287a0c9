//! Whatever comes in, what the vectors and the plain code make of it is sound, and rounding does not show.

use std::f64::consts::TAU;

use common::amplitude::FalsePower;
use common::config::{Association, TrackerConfig};
use common::random::{Purpose, generator};
use nalgebra::DMatrix;
use proptest::prelude::*;
use tracker::association::scan::{Member, Scan};
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::uav::MODES;
use tracker::filter::{Filter, LANES, Machine, Row};
use tracker::plots::measurement::{COORDINATES, Measurement};

use crate::flight::{ALPHA, Flight, SIGMA, filter, measurement, motion, radar, two_plots};
use crate::reference::imm::{Imm, transition};
use crate::reference::motion::DIMENSIONS;
use crate::reference::rule::{self, Choice};
use crate::{Lanes, assert_expectation, close, disagreement, instructions, state_of};

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
    let filter = filter(true, 0.9);
    let mut rng = generator(4, Purpose::Test, 0, 0);
    let mut group = Lanes::new(filter, pulp::Arch::new(), radar(true), 0.0);
    let mut flights: Vec<Flight> = Vec::new();
    let measured = [true; COORDINATES];
    for scan in 0..1_000_000 / LANES {
        if scan % 500 == 0 {
            flights = (0..LANES).map(|_| Flight::new(&mut rng, true)).collect();
            for (lane, flight) in flights.iter().enumerate() {
                group.load(lane, &flight.start(&mut rng));
            }
        }
        let dt_s = if scan % 7 == 0 { 5.0 } else { 1.0 };
        group.predict(LANES, &Row::splat(dt_s));
        for (lane, flight) in flights.iter_mut().enumerate() {
            flight.fly(&mut rng, dt_s);
            group.evidence.set_none(lane, &[0.1; MODES]);
            for k in 0..(scan + 3 * lane) % 5 {
                let scale = [1.0, 1.0, 0.1, 5.0][(scan / 5 + lane) % 4];
                let plot = flight.plot(&mut rng, if k == 0 { 1.0 } else { 4.0 }, scale, measured);
                group.evidence.add(lane, &plot, 0.0, 1e9);
            }
        }
        group.update(LANES);
        for lane in 0..LANES {
            let track = state_of(&group.update.posterior, lane);
            assert!(track.is_sound(), "lane {lane} of scan {scan}");
            assert!(is_positive_definite(&track, filter.axes), "lane {lane} of scan {scan}");
        }
    }
}

/// P* that rounding has left with less than nothing along the line of sight: gates stay finite, and a plot is worth the same to both.
#[test]
fn a_predicted_variance_below_zero_is_none() {
    let (radar, filter) = (radar(true), filter(true, 0.9));
    let polar = [10_000.0, TAU / 8.0, 0.0, 0.0];
    let plot = measurement(polar, 10.0, [true; COORDINATES]);
    let mut track = two_plots(&filter, &plot, &plot, 1.0);
    for (mode, n) in DIMENSIONS.into_iter().enumerate() {
        // Towards 45°: (p_xx + 2 p_xy + p_yy)/2, of the position and of the velocity.
        for (x, variance, below) in [(0, 1e6, 1e4), (3, 1e4, 5e3)].into_iter().filter(|(x, ..)| x + 1 < n) {
            let p = &mut track.modes[mode].covariance;
            (p[at(x, x)], p[at(x + 1, x + 1)], p[at(x, x + 1)]) = (variance, variance, -variance - below);
            (0..n).filter(|i| i / 3 != x / 3).for_each(|i| (p[at(i, x)], p[at(i, x + 1)]) = (0.0, 0.0));
        }
    }
    let mut group = Lanes::new(filter, pulp::Arch::new(), radar, 0.0);
    group.prediction.load(3, &track.words(&filter));
    group.expect(LANES);
    assert_expectation(&group.expected, 3, &track, &radar);
    let gates = rule::gates(&rule::expect(&track), &radar, ALPHA);
    assert!(gates.iter().all(|gate| gate.volume(&radar).is_finite() && gate.predicted[0] == 0.0));
    assert!(gates[1..].iter().all(|gate| gate.predicted[3] == 0.0));
    let choice = Choice { plot, offset_s: 0.0, gain: 1e12 };
    group.evidence.set_none(3, &[0.1; MODES]);
    group.evidence.add(3, &choice.plot, choice.offset_s, choice.gain);
    group.update(LANES);
    let weights = &group.update.weights;
    let plain = rule::update(&track, &[choice], [0.1; MODES], 0.0);
    for (mode, likelihood) in plain.likelihood.into_iter().enumerate() {
        assert!(likelihood > 0.2 && close(weights.likelihood[mode].0[3], likelihood), "{mode}: {likelihood}");
    }
}

/// What a single plot that is the target's for certain leaves of P* does not depend on where it lies (T8). Its y yᵀ, 900 times as large as
/// D⁻¹ at 30 standard deviations, must not take the place of what is left.
#[test]
fn the_covariance_after_one_certain_plot_does_not_depend_on_its_place() {
    let (filter, radar) = (filter(true, 0.9), radar(true));
    let (range_m, measured) = (10_000.0, [true, true, true, false]);
    let start = measurement([range_m, 0.7, 0.3, 0.0], 30.0, measured);
    let plot = |deviations: f64| measurement([range_m + deviations * 30.0 * SIGMA[0], 0.7, 0.3, 0.0], 0.03, measured);
    let prediction = two_plots(&filter, &start, &start, 1.0);
    let prediction = prediction.predict(&transition(0.9, 1e-3), &motion(&filter), 1e-3);
    let after = |deviations: f64| {
        let mut posteriors = Vec::new();
        for (arch, lanes) in instructions().into_iter().flat_map(|arch| [(arch, 1), (arch, LANES)]) {
            let mut group = Lanes::new(filter, arch, radar, 0.0);
            group.prediction.load(0, &prediction.words(&filter));
            group.expect(lanes);
            group.evidence.set_none(0, &[0.0; MODES]);
            group.evidence.add(0, &plot(deviations), 0.0, 1e250);
            group.update(lanes);
            posteriors.push(state_of(&group.update.posterior, 0));
        }
        let rules = Rules { association: Association::Nearest, alpha: 1e3, ..Rules::new(&TrackerConfig::default()) };
        let clutter = |_: &Measurement| FalsePlots {
            density: 1e-9,
            power: FalsePower { mean_excess: 1.0, ..FalsePower::default() },
        };
        let surroundings =
            Surroundings { radar: &radar, detection_probability: 0.9, target: None, shares: &[], clutter };
        let mut scan = Scan::new(filter.layout());
        scan.prediction.load(0, &prediction.words(&filter));
        let plots = [plot(deviations)];
        let member = Member { time_ns: 0, plots: &plots, surroundings };
        scan.update(&filter, Machine::default(), [member].into_iter(), &radar, &rules);
        posteriors.push(state_of(&scan.update.posterior, 0));
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
        let filter = filter(true, 0.9);
        let motion = motion(&filter);
        let mut plain = two_plots(&filter, &plots[0].0, &plots[1].0, step_s);
        let chain = transition(0.9, step_s);
        let choices: Vec<Choice> =
            plots.iter().map(|(plot, gain)| Choice { plot: *plot, offset_s, gain: *gain }).collect();
        let mut batch = plain;
        for instructions in instructions() {
            let mut group = Lanes::new(filter, instructions, radar(true), 0.0);
            for _ in 0..3 {
                group.load(5, &batch);
                group.predict(LANES, &Row::splat(step_s));
                group.evidence.set_none(5, &none);
                for choice in &choices {
                    group.evidence.add(5, &choice.plot, choice.offset_s, choice.gain);
                }
                group.update(LANES);
                batch = state_of(&group.update.posterior, 5);
                let weights = &group.update.weights;
                let predictions = [state_of(&group.prediction, 5), plain.predict(&chain, &motion, step_s)];
                plain = rule::update(&predictions[1], &choices, none, 0.0).imm;
                for (track, prediction) in [batch, plain].iter().zip(&predictions) {
                    let sum: f64 = track.probability.iter().sum();
                    prop_assert!((sum - 1.0).abs() < 1e-9, "{sum}");
                    prop_assert!(track.is_sound() || !prediction.is_sound());
                }
                for j in (0..MODES).filter(|_| predictions[0].is_sound()) {
                    prop_assert!(!weights.likelihood[j].0[5].is_nan());
                    let sum: f64 = (0..choices.len()).map(|m| weights.plots[m * MODES + j].0[5]).sum();
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
