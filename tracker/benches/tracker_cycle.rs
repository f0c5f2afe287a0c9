//! One scan of many tracks: index of the plots, predict, gate, associate and update; three modes of nine states.
//!
//! Ids are `tracks x plots in each gate`; times are per whole scan, on one core, in f64.
//!
//! The tracks stand on a lattice of azimuth, range (2 to 50 km) and elevation (0 to 0.4 rad), so far apart that their
//! gates (some ±14 mrad and ±175 m at the start) do not overlap: each holds its own five plots. Plots and tracks come in the order in
//! which a turning beam meets them. The plots stay the same from scan to scan, so each track settles and what is timed is
//! the steady state.
//!
//! **Limits.** Arithmetic: 5040 multiplications and additions a track and 159 a plot, 5835 here: 182 cycles of two eight-lane fused
//! operations, 0.065 µs at 2.8 GHz (squares about a running mean are 27 more a plot, three of them divisions, and 75 fewer a track).
//! Memory: a track is 744 bytes, read and written in each scan; its five plots are 560 bytes, read once for the index and once for the
//! gates, and 140 are the index: 2.8 kB. 1000 tracks stay in the second-level cache; 10,000 and more do not; figures are in
//! `docs/results.md`. The same number of neighbours stands about each track at every number of tracks (five above each other), or else
//! time would measure those.
//!
//! `plot_index` is the index alone: sorting, and one window of four expected plots about each plot.
//!
//! The gains a = ℓ/ρ are given: they belong to the plots and cost the same whatever the filter.

use std::f64::consts::TAU;
use std::hint::black_box;

use common::amplitude::Detector;
use common::config::{Swerling, TrackerConfig};
use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::random::{Purpose, generator};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use tracker::association::gate::Radar;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::uav::batch::{Bank, Kernel, Offer, Scan};
use tracker::filter::uav::imm::{Imm, transition};
use tracker::filter::uav::motion::Motion;
use tracker::filter::uav::start::two_plots;
use tracker::filter::uav::update::{Workspace, update};
use tracker::plots::index::{PlotIndex, Window};
use tracker::plots::measurement::{COORDINATES, Measurement};

/// Plots in each gate.
const PLOTS: usize = 5;
const SIGMA: [f32; COORDINATES] = [20.0, 0.001_745, 0.001_745, 10.0];
/// The default settings.
const MOTION: Motion = Motion { noise: [0.9, 0.8, 7.5], axes: 3 };
const ALPHA: f64 = 3.5;
const INFLATION: f64 = 0.45;

/// Azimuths, ranges and elevations of the lattice.
type Lattice = [u32; 3];

/// Tracks of two plots each, and the plots of their next scans.
struct Scene {
    tracks: Vec<Imm>,
    /// By track.
    plots: Vec<[Measurement; PLOTS]>,
}

fn measurement(place: Polar, range_rate_mps: f64, statistic: f32, error: f32) -> Measurement {
    let plot = Plot {
        range_m: place.range_m,
        azimuth_rad: place.azimuth_rad,
        elevation_rad: place.elevation_rad,
        range_rate_mps,
        sigma_range_m: SIGMA[0] * error,
        sigma_azimuth_rad: SIGMA[1] * error,
        sigma_elevation_rad: SIGMA[2] * error,
        sigma_range_rate_mps: SIGMA[3] * error,
        statistic,
        flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
        ..Plot::default()
    };
    Measurement::from_plot(&plot).expect("possible")
}

/// `own_errors`: each plot has its own σ.
fn scene([azimuths, ranges, elevations]: Lattice, own_errors: bool) -> Scene {
    let mut rng = generator(1, Purpose::Test, 0, 0);
    let mut scene = Scene { tracks: Vec::new(), plots: Vec::new() };
    for azimuth in 0..azimuths {
        for range in 0..ranges {
            for elevation in 0..elevations {
                let mut near = |spread: f64, range_rate: f64, statistic: f32| {
                    let place = Polar {
                        range_m: 2000.0 + 48_000.0 * f64::from(range) / f64::from(ranges),
                        azimuth_rad: TAU * f64::from(azimuth) / f64::from(azimuths),
                        elevation_rad: 0.01 + 0.4 * f64::from(elevation) / f64::from(elevations),
                    };
                    let mut off = |sigma: f32| spread * f64::from(sigma) * rng.random_range(-1.0..1.0);
                    let place = Polar {
                        range_m: place.range_m + off(SIGMA[0]),
                        azimuth_rad: (place.azimuth_rad + off(SIGMA[1])).rem_euclid(TAU),
                        elevation_rad: place.elevation_rad + off(SIGMA[2]),
                    };
                    let error = if own_errors { rng.random_range(0.7..1.4) } else { 1.0 };
                    measurement(place, range_rate, statistic, error)
                };
                let (previous, last) = (near(1.0, 0.0, 5.0), near(1.0, 0.0, 5.0));
                scene.tracks.push(two_plots(&previous, &last, 1.0, &MOTION, [0.33, 0.34, 0.33]));
                scene.plots.push(std::array::from_fn(|_| near(0.8, 3.0, 4.5)));
            }
        }
    }
    scene
}

fn radar() -> Radar {
    let cell = SIGMA.map(|sigma| f64::from(sigma) * 12.0_f64.sqrt());
    Radar { variance: cell.map(|cell| cell * cell / 12.0), cell, measured: [true; COORDINATES] }
}

fn batch(criterion: &mut Criterion, group: &str, own_errors: bool, lattices: &[Lattice]) {
    let mut group = criterion.benchmark_group(group);
    let chain = transition(0.9, 1.0);
    for &lattice in lattices {
        let scene = scene(lattice, own_errors);
        let mut bank = Bank::new(Kernel::new(MOTION, radar(), ALPHA, INFLATION));
        for track in &scene.tracks {
            bank.push(track);
        }
        let mut plots: Vec<Measurement> = scene.plots.into_iter().flatten().collect();
        plots.sort_by(|a, b| a.polar[1].total_cmp(&b.polar[1]));
        let gains = vec![1e8; plots.len()];
        let scan = Scan { plots: &plots, gains: &gains, time_ns: 0, dt_s: 1.0, transition: &chain };
        let tracks = bank.len();
        group.throughput(Throughput::Elements(tracks as u64));
        group.sample_size(if tracks > 10_000 { 20 } else { 100 });
        group.bench_function(BenchmarkId::from_parameter(format!("{tracks}x{PLOTS}")), |bencher| {
            bencher.iter(|| {
                let mut full = 0;
                bank.scan(
                    black_box(&scan),
                    |_, cells| Offer { threshold: (cells / 100.0).ln(), detection_probability: 0.9 },
                    |passed| full += passed.plots[..passed.lanes].iter().filter(|plots| plots.len() == PLOTS).count(),
                );
                assert_eq!(full, tracks); // a fast wrong answer is not a result
            });
        });
        assert!((0..tracks).all(|track| bank.track(track).is_sound()));
    }
    group.finish();
}

fn tracker_cycle(criterion: &mut Criterion) {
    batch(criterion, "tracker_cycle", false, &[[1, 1, 1], [20, 10, 5], [100, 20, 5], [200, 100, 5]]);
    batch(criterion, "tracker_cycle_own_errors", true, &[[20, 10, 5]]);
}

/// The same one track at a time, each offered its own plots: no index, and the rule of the configuration.
fn tracker_cycle_plain(criterion: &mut Criterion) {
    let scene = scene([20, 10, 5], false);
    let rules = Rules::new(&TrackerConfig::default());
    let radar = radar();
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
    let mut tracks = scene.tracks;
    let mut group = criterion.benchmark_group("tracker_cycle_plain");
    group.throughput(Throughput::Elements(tracks.len() as u64));
    group.bench_function(BenchmarkId::from_parameter(format!("{}x{PLOTS}", tracks.len())), |bencher| {
        bencher.iter(|| {
            let mut associated = 0;
            for (track, plots) in tracks.iter_mut().zip(&scene.plots) {
                let prediction = black_box(&*track).predict(&chain, &MOTION, 1.0);
                let outcome = update(&prediction, 0, plots, &surroundings, &rules, &mut workspace);
                associated += outcome.plots_in_gate;
                *track = outcome.posterior;
            }
            assert_eq!(associated, tracks.len() * PLOTS);
        });
    });
    group.finish();
    assert!(tracks.iter().all(Imm::is_sound));
}

/// Sorting plots and asking for as many windows as there are plots, each expected to hold as many plots whatever their number:
/// at most n log n in the plots.
fn plot_index(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("plot_index");
    for count in [1000_u32, 10_000, 100_000] {
        let mut rng = generator(2, Purpose::Test, count, 0);
        let mut somewhere = || Polar {
            range_m: rng.random_range(2e3..50e3),
            azimuth_rad: rng.random_range(0.0..TAU),
            elevation_rad: 0.1,
        };
        let plots: Vec<Measurement> = (0..count).map(|_| measurement(somewhere(), 0.0, 5.0, 1.0)).collect();
        // Expected to hold four plots.
        let side = 2.0 / f64::from(count).sqrt();
        let window = |plot: &Measurement| Window {
            azimuth_rad: plot.polar[1],
            half_azimuth_rad: 0.5 * side * TAU,
            range_m: [plot.polar[0] - 0.5 * side * 48e3, plot.polar[0] + 0.5 * side * 48e3],
            elevation_rad: Window::ANY_ELEVATION,
        };
        let (mut index, mut near) = (PlotIndex::default(), Vec::new());
        group.throughput(Throughput::Elements(count.into()));
        group.sample_size(20);
        group.bench_function(BenchmarkId::from_parameter(count), |bencher| {
            bencher.iter(|| {
                index.build(black_box(&plots).iter());
                let mut found = 0;
                for plot in &plots {
                    index.find(&window(plot), &mut near);
                    found += near.len();
                }
                // Each finds itself, and the azimuth bins that a window touches are three times as wide as it at most.
                assert!(found >= plots.len() && found <= 16 * plots.len(), "{found}");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, tracker_cycle, tracker_cycle_plain, plot_index);
criterion_main!(benches);
