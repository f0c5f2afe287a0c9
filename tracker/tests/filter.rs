//! Properties of the filter: whatever comes in, covariances stay symmetric and positive definite and probabilities sum to 1.

use std::f64::consts::FRAC_PI_2;

use common::amplitude::{Detector, FalsePower};
use common::config::{Association, Estimator, GateRule, Swerling, TrackerConfig};
use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::random::{Purpose, generator};
use nalgebra::{Matrix4, SMatrix, Vector3, Vector4};
use proptest::prelude::*;
use rand_distr::{Distribution, StandardNormal};
use tracker::association::hypotheses::{Hypotheses, Means, Room};
use tracker::association::one_track::OneTrack;
use tracker::association::scan::{Choice, Member};
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::gaussian::at;
use tracker::filter::{Filter, Machine, Mixture, TwoPlots, family};
use tracker::plots::measurement::{COORDINATES, LineOfSight, Measurement, position_covariance};
use tracker::plots::radar::Radar;

const CELL: [f64; COORDINATES] = [69.3, 0.006, 0.006, 34.6];

fn plot(place: Polar, range_rate_mps: f64, sigma_scale: f32, statistic: f32, flags: u32) -> Plot {
    Plot {
        range_m: place.range_m,
        azimuth_rad: place.azimuth_rad,
        elevation_rad: place.elevation_rad,
        range_rate_mps,
        sigma_range_m: 20.0 * sigma_scale,
        sigma_azimuth_rad: 0.0017 * sigma_scale,
        sigma_elevation_rad: 0.0017 * sigma_scale,
        sigma_range_rate_mps: 10.0 * sigma_scale,
        statistic,
        flags,
        ..Plot::default()
    }
}

/// One filter of each family, in two or three dimensions.
fn families(full: bool) -> Vec<Box<dyn Filter>> {
    let measured = [true, true, full, full];
    let radar =
        Radar { variance: [1.0; COORDINATES], cell: [1.0; COORDINATES], measured, range_rate_interval_mps: 0.0 };
    let config = TrackerConfig {
        hover_noise_mps: 1.0,
        velocity_noise_mps2: 1.0,
        manoeuvre_noise_mps3: 7.0,
        stay_probability: 0.9,
        ..TrackerConfig::default()
    };
    Estimator::ALL
        .map(|estimator| family(&TrackerConfig { estimator, ..config.clone() }, &radar, 1.0))
        .into_iter()
        .collect()
}

/// Positive definite on the states that each component knows, up to rounding: after a mode that is certain to be at rest, the noise
/// G Gᵀ of rank one is all there is of velocity and acceleration, so the smallest eigenvalues are zero.
fn is_positive_definite(filter: &dyn Filter, state: Mixture<'_>, axes: usize) -> bool {
    (0..filter.layout().len()).all(|j| {
        let p = state.covariance(j);
        let known: Vec<usize> = (0..filter.layout().known(j)).filter(|i| i % 3 < axes).collect();
        let n = known.len();
        let matrix =
            nalgebra::DMatrix::from_fn(n, n, |i, j| p[at(known[i], known[j])] * if i == j { 1.0 + 1e-12 } else { 1.0 });
        matrix.cholesky().is_some()
    })
}

/// A long random run: plots on and off the track, errors that differ, scans that are missed.
fn long_run(filter: Box<dyn Filter>, config: &TrackerConfig, full: bool, scans: u32) {
    let measured = [true, true, full, full];
    let radar =
        Radar { variance: CELL.map(|cell| cell * cell / 12.0), cell: CELL, measured, range_rate_interval_mps: 0.0 };
    let axes = if full { 3 } else { 2 };
    let rules = Rules::new(config);
    let target = Detector::new(1e-3, 32).target(Swerling::One, 30.0);
    let flags = if full { HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC } else { 0 };
    let mut rng = generator(7, Purpose::Test, u32::from(full), 0);
    let mut position = Vector3::new(800.0, 900.0, if full { 150.0 } else { 0.0 });
    let mut velocity = Vector3::new(-15.0, 10.0, 0.0);
    let mut normal = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let mut draw = |position: &Vector3<f64>, velocity: &Vector3<f64>, spread: f64, scale: f32| {
        let place = Polar::from_enu(position);
        let place = Polar {
            range_m: (place.range_m + normal(20.0 * spread)).abs() + 1.0,
            azimuth_rad: place.azimuth_rad + normal(0.0017 * spread),
            elevation_rad: if full { place.elevation_rad + normal(0.0017 * spread) } else { 0.0 },
        };
        let rate = common::geometry::range_rate_mps(position, velocity) + normal(10.0);
        Measurement::from_plot(&plot(place, rate, scale, 4.0, flags)).expect("possible")
    };
    let first = draw(&position, &velocity, 1.0, 1.0);
    position += velocity;
    let mut track = OneTrack::new(filter);
    track.start(&TwoPlots { previous: &first, last: &draw(&position, &velocity, 1.0, 1.0), step_s: 1.0 });
    for scan in 0..scans {
        if scan % 40 == 0 {
            velocity = Vector3::new(velocity.y, -velocity.x, 0.0);
        }
        position += velocity;
        let plots: Vec<Measurement> = (0..scan % 5)
            .map(|k| draw(&position, &velocity, if k == 0 { 1.0 } else { 4.0 }, 0.3 + 0.4 * k as f32))
            .collect();
        let surroundings = Surroundings {
            radar: &radar,
            detection_probability: target.detection_probability,
            target: Some(&target),
            shares: &[],
            clutter: |_: &Measurement| FalsePlots {
                density: 1e-9,
                power: FalsePower { mean_excess: 1.0, ..FalsePower::default() },
            },
        };
        let is_right =
            |track: &OneTrack| track.state().is_sound() && is_positive_definite(track.filter(), track.state(), axes);
        track.predict(1.0);
        assert!(is_right(&track), "prediction of scan {scan}");
        track.update(Member { time_ns: 0, plots: &plots, surroundings }, &radar, &rules);
        assert!(is_right(&track), "update of scan {scan}");
    }
}

#[test]
fn covariances_stay_positive_definite_over_long_runs() {
    let default = TrackerConfig::default();
    for association in [Association::PdaStatistics, Association::Pda, Association::Nearest, Association::Strongest] {
        for full in [true, false] {
            for filter in families(full) {
                long_run(filter, &TrackerConfig { association, ..default.clone() }, full, 20_000);
            }
        }
    }
    for filter in families(true) {
        long_run(filter, &TrackerConfig { gate_rule: GateRule::MostProbable, ..default.clone() }, true, 20_000);
    }
    for filter in families(true) {
        long_run(filter, &TrackerConfig { range_rate_inflation: 0.8, ..default.clone() }, true, 20_000);
    }
}

proptest! {
    /// Any finite plots, however absurd, leave a sound state.
    #[test]
    fn no_finite_input_breaks_a_track(
        places in prop::collection::vec((0.01..1e6_f64, -6.0..12.0_f64, -1.57..1.57_f64, -1e5..1e5_f64, 1e-6..5e2_f32, 0.0..1e6_f32, 0_u32..8), 2..8),
        step_s in 1e-3..1e3_f64,
        density in 1e-30..1.0_f64,
    ) {
        let plots: Vec<Measurement> = places
            .into_iter()
            .filter_map(|(range_m, azimuth_rad, elevation_rad, rate, scale, statistic, flags)| {
                let place = Polar { range_m, azimuth_rad, elevation_rad };
                Measurement::from_plot(&plot(place, rate, scale, statistic, flags))
            })
            .collect();
        prop_assume!(plots.len() >= 2);
        let radar = Radar { variance: CELL.map(|cell| cell * cell / 12.0), cell: CELL, measured: [true; COORDINATES], range_rate_interval_mps: 0.0 };
        let rules = Rules::new(&TrackerConfig::default());
        let target = Detector::new(1e-6, 16).target(Swerling::Three, 300.0);
        for filter in families(true) {
            let mut track = OneTrack::new(filter);
            track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s });
            for _ in 0..4 {
                let surroundings = Surroundings {
                    radar: &radar,
                    detection_probability: target.detection_probability,
                    target: Some(&target),
                    shares: &[],
                    clutter: |_: &Measurement| FalsePlots { density, power: FalsePower { mean_excess: 2.0, ..FalsePower::default() } },
                };
                track.predict(step_s);
                let outcome = track.update(Member { time_ns: 0, plots: &plots, surroundings }, &radar, &rules);
                let sum: f64 = track.state().weights().iter().sum();
                prop_assert!((sum - 1.0).abs() < 1e-9);
                prop_assert!(track.words().iter().all(|x| x.is_finite()));
                prop_assert!(!outcome.existence_ratio.is_nan() && !outcome.weight_none.is_nan());
            }
        }
    }
}

/// Range, azimuth, elevation, range rate, size of the errors, statistic, what is measured.
type Absurd = (f64, f64, f64, f64, f32, f32, u32);

fn absurd_plots(sizes: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Absurd>> {
    let plot = (
        prop_oneof![0.01..1e6_f64, Just(f64::MIN_POSITIVE), Just(1e7)],
        -6.0..12.0_f64,
        prop_oneof![-1.57..1.57_f64, Just(FRAC_PI_2), Just(-FRAC_PI_2)],
        prop_oneof![-1e5..1e5_f64, Just(0.0), Just(1e6), Just(-1e6)],
        prop_oneof![1e-6..1e4_f32, Just(1e-3)],
        prop_oneof![0.0..1e6_f32, Just(0.0), Just(9.9e8)],
        0_u32..8,
    );
    prop::collection::vec(plot, sizes)
}

fn converted(plots: &[Absurd]) -> Vec<Measurement> {
    let convert = |&(range_m, azimuth_rad, elevation_rad, rate, scale, statistic, flags): &Absurd| {
        let place = Polar { range_m, azimuth_rad, elevation_rad };
        Measurement::from_plot(&plot(place, rate, scale, statistic, flags))
    };
    plots.iter().filter_map(convert).collect()
}

proptest! {
    /// Hypotheses of any finite plots are sound, and their weights sum to 1.
    #[test]
    fn no_finite_input_breaks_hypotheses(
        scans in prop::collection::vec(absurd_plots(0..6), 1..5),
        start in absurd_plots(2..3),
        step_s in prop_oneof![1e-3..1e3_f64, Just(1.0)],
        density in prop_oneof![1e-30..1.0_f64, Just(1e-9)],
        share in prop_oneof![Just(1.0), Just(0.0), Just(1e-300), 0.0..1.0_f64],
    ) {
        let start = converted(&start);
        prop_assume!(start.len() == 2);
        let radar = Radar { variance: CELL.map(|cell| cell * cell / 12.0), cell: CELL, measured: [true; COORDINATES], range_rate_interval_mps: 0.0 };
        let rules = Rules { association: Association::Mht, ..Rules::new(&TrackerConfig::default()) };
        let target = Detector::new(1e-6, 16).target(Swerling::One, 300.0);
        for filter in families(true) {
        let layout = *filter.layout();
        let mut first = vec![0.0; layout.words()];
        filter.start(&TwoPlots { previous: &start[0], last: &start[1], step_s }, &mut first);
        prop_assume!(Mixture::new(&layout, &first).is_sound());
        let means = Means { filter: filter.as_ref(), machine: Machine::default(), rules: &rules };
        let (mut choice, mut room) = (Choice::default(), Room::new(&layout));
        let mut hypotheses = Hypotheses::new(&layout, &first, 6);
        for plots in &scans {
            let plots = converted(plots);
            let shares = vec![share; plots.len()];
            let surroundings = Surroundings {
                radar: &radar,
                detection_probability: target.detection_probability,
                target: Some(&target),
                shares: &shares,
                clutter: |_: &Measurement| FalsePlots { density, power: FalsePower { mean_excess: 2.0, ..FalsePower::default() } },
            };
            hypotheses.predict(means, step_s, &mut room);
            prop_assume!(hypotheses.states(&layout).all(|state| state.is_sound()));
            let outcome = hypotheses.update(means, 0, &plots, &surroundings, &mut room, &mut choice);
            prop_assert!(!hypotheses.is_empty() && hypotheses.len() <= 6);
            for state in hypotheses.states(&layout).chain([Mixture::new(&layout, room.posterior())]) {
                prop_assert!(state.is_sound(), "{state:?}");
            }
            prop_assert!((0.0..=1.0 + 1e-9).contains(&outcome.weight_none), "{}", outcome.weight_none);
            let sum: f64 = choice.weights.iter().sum();
            prop_assert!((sum + outcome.weight_none - 1.0).abs() < 1e-9, "{sum} {}", outcome.weight_none);
            prop_assert!(!outcome.existence_ratio.is_nan() && outcome.existence_ratio >= 0.0);
            prop_assert!(!outcome.ratio_alone.is_nan());
        }
        }
    }
}

/// (T6), range rate included, against two million drawn measurements: 0.5 % of the variance along every axis.
#[test]
fn measurement_covariance_agrees_with_monte_carlo() {
    let place = Polar { range_m: 900.0, azimuth_rad: 4.1, elevation_rad: 0.3 };
    let sigma = [20.0, 0.001_745, 0.001_745, 10.0];
    let frame = LineOfSight::at(place.to_enu().into());
    let position = position_covariance(&frame, [sigma[0] * sigma[0], sigma[1] * sigma[1], sigma[2] * sigma[2]]);
    let r = Matrix4::from_fn(|i, j| match (i, j) {
        (3, 3) => sigma[3] * sigma[3],
        (3, _) | (_, 3) => 0.0,
        _ => position[at(i, j)],
    });
    assert!(r.cholesky().is_some());
    let mut rng = generator(11, Purpose::Test, 0, 0);
    let mut sum = SMatrix::<f64, 4, 4>::zeros();
    let runs = 2_000_000;
    for _ in 0..runs {
        let mut normal = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
        let drawn = Polar {
            range_m: place.range_m + normal(sigma[0]),
            azimuth_rad: place.azimuth_rad + normal(sigma[1]),
            elevation_rad: place.elevation_rad + normal(sigma[2]),
        };
        let error = drawn.to_enu() - place.to_enu();
        let y = Vector4::new(error.x, error.y, error.z, normal(sigma[3]));
        sum += y * y.transpose();
    }
    sum /= f64::from(runs);
    let axes = [frame.radial, frame.along_azimuth, frame.along_elevation].map(|e| Vector4::new(e[0], e[1], e[2], 0.0));
    for axis in axes.into_iter().chain([Vector4::w()]) {
        let (drawn, formula) = ((axis.transpose() * sum * axis).x, (axis.transpose() * r * axis).x);
        assert!((drawn / formula - 1.0).abs() < 0.005, "{drawn} {formula}");
    }
}
