//! The kernel: prediction, gates, update of many tracks, and nothing around them; the drone filter's three modes of nine states.
//!
//! Ids are `tracks x plots of each`; times are per whole scan, on one core, in f64. `kernel` works on groups of eight, `kernel_single` on one
//! track after the other by the same code with vectors of one. `tracker_take` is the whole tracker.
//!
//! Each track is offered its own five plots, the same from scan to scan, so that it settles and what is timed is the steady state. The gains
//! a = ℓ/ρ are given: they belong to the plots and cost the same whatever the filter. States lie track by track and are loaded into lanes and
//! stored, as in the tracker.
//!
//! **Limits.** Arithmetic: 5040 multiplications and additions a track and 159 a plot, 5835 here: 182 cycles of two eight-lane fused
//! operations, 0.065 µs at 2.8 GHz (squares about a running mean are 27 more a plot, three of them divisions, and 75 fewer a track).
//! Memory: a track's state is 752 bytes, read and written in each scan; its five plots are 560 bytes.
//!
//! `plot_index` is the index alone: sorting, and one window of four expected plots about each plot.

use std::f64::consts::TAU;
use std::hint::black_box;

use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::random::{Purpose, generator};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use tracker::association::gate::own_probability;
use tracker::filter::uav::Uav;
use tracker::filter::{Evidence, Filter, Group, LANES, Machine, Mixture, Prior, Row, TwoPlots, Update, expect};
use tracker::plots::index::{PlotIndex, Window};
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

/// Plots in each gate.
const PLOTS: usize = 5;
const SIGMA: [f32; COORDINATES] = [20.0, 0.001_745, 0.001_745, 10.0];
/// The default settings.
const FILTER: Uav =
    Uav { noise: [0.9, 0.8, 7.5], jerk_share: 1.0, axes: 3, stay: 0.9, start_probability: [0.33, 0.34, 0.33] };
const ALPHA: f64 = 3.5;
const INFLATION: f64 = 0.45;

/// Azimuths, ranges and elevations of the lattice.
type Lattice = [u32; 3];

/// Tracks of two plots each, and the plots of their next scans.
struct Scene {
    /// States, one after the other.
    tracks: Vec<f64>,
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
                let (first, words) = (scene.tracks.len(), FILTER.layout().words());
                scene.tracks.resize(first + words, 0.0);
                FILTER.start(&TwoPlots { previous: &previous, last: &last, step_s: 1.0 }, &mut scene.tracks[first..]);
                scene.plots.push(std::array::from_fn(|_| near(0.8, 3.0, 4.5)));
            }
        }
    }
    scene
}

fn radar() -> Radar {
    let cell = SIGMA.map(|sigma| f64::from(sigma) * 12.0_f64.sqrt());
    Radar {
        variance: cell.map(|cell| cell * cell / 12.0),
        cell,
        measured: [true; COORDINATES],
        range_rate_interval_mps: 0.0,
    }
}

fn kernel(criterion: &mut Criterion, group: &str, lanes: usize, own_errors: bool, lattices: &[Lattice]) {
    let mut group = criterion.benchmark_group(group);
    let (machine, radar, layout) = (Machine::default(), radar(), FILTER.layout());
    for &lattice in lattices {
        let Scene { mut tracks, plots } = scene(lattice, own_errors);
        let (mut prediction, mut expected) = (Group::new(layout), Vec::new());
        let (mut evidence, mut update) = (Evidence::default(), Update::new(layout));
        let miss = 1.0 - 0.9 * own_probability(ALPHA, COORDINATES);
        group.throughput(Throughput::Elements(plots.len() as u64));
        group.sample_size(if plots.len() > 10_000 { 20 } else { 100 });
        group.bench_function(BenchmarkId::from_parameter(format!("{}x{PLOTS}", plots.len())), |bencher| {
            bencher.iter(|| {
                let mut taken = 0;
                for (states, plots) in tracks.chunks_mut(lanes * layout.words()).zip(plots.chunks(lanes)) {
                    for (lane, state) in states.chunks(layout.words()).enumerate() {
                        update.posterior.load(lane, state);
                    }
                    FILTER.predict(
                        machine,
                        plots.len(),
                        &update.posterior,
                        black_box(&Row::splat(1.0)),
                        &mut prediction,
                    );
                    expect(machine, plots.len(), &radar, ALPHA, &prediction, &mut expected);
                    evidence.clear(layout.len());
                    for (lane, plots) in plots.iter().enumerate() {
                        evidence.set_none(lane, &[miss; 3]);
                        for plot in plots {
                            evidence.add(lane, plot, 0.0, 1e8);
                        }
                    }
                    let prior = Prior { prediction: &prediction, expected: &expected, inflation: INFLATION };
                    FILTER.update(machine, plots.len(), prior, &evidence, &mut update);
                    for (lane, state) in states.chunks_mut(layout.words()).enumerate() {
                        taken += usize::from(update.weights.of_none(lane, &update.posterior) < 0.5);
                        update.posterior.store(lane, state);
                    }
                }
                assert!(taken * 10 > plots.len() * 9, "{taken}"); // a fast wrong answer is not a result
            });
        });
        assert!(tracks.chunks(layout.words()).all(|state| Mixture::new(layout, state).is_sound()));
    }
    group.finish();
}

fn tracker_cycle(criterion: &mut Criterion) {
    kernel(criterion, "kernel", LANES, false, &[[1, 1, 1], [20, 10, 5], [100, 20, 5], [200, 100, 5]]);
    kernel(criterion, "kernel_own_errors", LANES, true, &[[20, 10, 5]]);
    kernel(criterion, "kernel_single", 1, false, &[[20, 10, 5]]);
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

criterion_group!(benches, tracker_cycle, plot_index);
criterion_main!(benches);
