//! One scan of many tracks: predict, gate, associate and update, three modes of nine states.
//!
//! Ids are `tracks x plots in each gate`; times are per whole scan.

use std::f64::consts::TAU;
use std::hint::black_box;

use common::amplitude::Detector;
use common::config::{Swerling, TrackerConfig};
use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::random::{Purpose, generator};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::gate::Radar;
use tracker::imm::{Imm, transition};
use tracker::measurement::{COORDINATES, Measurement};
use tracker::motion::Motion;
use tracker::start::two_plots;
use tracker::update::{Workspace, update};

const SIGMA: [f32; COORDINATES] = [20.0, 0.001_745, 0.001_745, 10.0];

struct Case {
    track: Imm,
    plots: Vec<Measurement>,
}

fn measurement(place: Polar, range_rate_mps: f64, statistic: f32) -> Measurement {
    let plot = Plot {
        range_m: place.range_m,
        azimuth_rad: place.azimuth_rad,
        elevation_rad: place.elevation_rad,
        range_rate_mps,
        sigma_range_m: SIGMA[0],
        sigma_azimuth_rad: SIGMA[1],
        sigma_elevation_rad: SIGMA[2],
        sigma_range_rate_mps: SIGMA[3],
        statistic,
        flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
        ..Plot::default()
    };
    Measurement::from_plot(&plot).expect("possible")
}

/// A track of two plots and the plots in the gate of its next scan.
fn case(run: u32, plots: u32, motion: &Motion) -> Case {
    let mut rng = generator(1, Purpose::Test, run, 0);
    let mut near = |place: Polar, spread: f64| Polar {
        range_m: place.range_m + spread * 20.0 * rng.random_range(-1.0..1.0),
        azimuth_rad: place.azimuth_rad + spread * 0.0017 * rng.random_range(-1.0..1.0),
        elevation_rad: place.elevation_rad + spread * 0.0017 * rng.random_range(-1.0..1.0),
    };
    let centre = Polar { range_m: 2000.0, azimuth_rad: TAU * f64::from(run % 97) / 97.0, elevation_rad: 0.1 };
    let (previous, last) = (measurement(near(centre, 1.0), 0.0, 5.0), measurement(near(centre, 1.0), 0.0, 5.0));
    let track = two_plots(&previous, &last, 1.0, motion, [0.33, 0.34, 0.33]);
    let plots = (0..plots).map(|_| measurement(near(centre, 0.8), 3.0, 4.5)).collect();
    Case { track, plots }
}

fn tracker_cycle(criterion: &mut Criterion) {
    let config = TrackerConfig::default();
    let motion = Motion { noise: [1.0, 1.0, 7.0], axes: 3 };
    let rules = Rules::new(&config);
    let cell = SIGMA.map(|sigma| f64::from(sigma) * 12.0_f64.sqrt());
    let radar = Radar { variance: cell.map(|cell| cell * cell / 12.0), cell, measured: [true; COORDINATES] };
    let target = Detector::new(1e-2, 0).target(Swerling::One, 20.0);
    let surroundings = Surroundings {
        radar: &radar,
        detection_probability: target.detection_probability,
        target: Some(&target),
        shares: &[],
        clutter: |_: &[f64; COORDINATES]| FalsePlots { density: 1e-8, mean_excess: 0.0 },
    };
    let chain = transition(0.9, 1.0);
    let mut workspace = Workspace::default();
    let mut group = criterion.benchmark_group("tracker_cycle");
    for (tracks, plots) in [(1_u32, 5_u32), (1000, 5)] {
        let cases: Vec<Case> = (0..tracks).map(|run| case(run, plots, &motion)).collect();
        let mut out = vec![None; cases.len()];
        group.throughput(Throughput::Elements(u64::from(tracks)));
        group.bench_function(BenchmarkId::from_parameter(format!("{tracks}x{plots}")), |bencher| {
            bencher.iter(|| {
                let mut associated = 0;
                for (case, out) in cases.iter().zip(&mut out) {
                    let prediction = black_box(&case.track).predict(&chain, &motion, 1.0);
                    let outcome = update(&prediction, 0, &case.plots, &surroundings, &rules, &mut workspace);
                    associated += outcome.plots_in_gate;
                    *out = Some(outcome);
                }
                assert_eq!(associated, cases.len() * plots as usize); // a fast wrong answer is not a result
            });
        });
        assert!(out.iter().flatten().all(|outcome| outcome.posterior.is_sound()));
    }
    group.finish();
}

criterion_group!(benches, tracker_cycle);
criterion_main!(benches);
