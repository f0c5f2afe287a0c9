//! The whole tracker, message by message: one turn of the beam over many tracks.
//!
//! Ids are `tracks x plots in each gate`, in the second group `tracks + plots elsewhere`, in the third with the family of filters; times are per turn of 32 messages, on one core. What is
//! timed is [`Tracker::process_plots`] with everything that it does: plots into the store, agenda, index, gates, rivals, association, update, existence,
//! clutter map, starts, prediction of the next passage and the message of each track.
//!
//! Targets hover on a lattice so wide that they are nobody's rivals. Each has one strong plot and four at the threshold, drawn anew from turn
//! to turn, so that every gate holds five and no plot at the threshold is believed to start a track. Up to eight turns are drawn and used in turn.
//!
//! **Limits.** Arithmetic of the kernel, as in `tracker_cycle`: 5040 multiplications and additions a track and 159 a plot, 5835 here, 0.065 µs
//! at 2.8 GHz with eight lanes; what the tracker adds to it is decision statistics (five exponentials a plot), the search for a start from each
//! of the four plots that no track explains, and waiting for memory. Of a track 3.0 kB are kept, 0.75 kB of them each read (what was
//! expected of the scan) or written (posterior, what is expected of the next); its message is 1.7 kB more, its plots 0.9 kB in the store, which
//! are read twice. Figures are in `docs/measured.md`.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::{Duration, Instant};

use common::config::{Estimator, TrackerConfig};
use common::message::END_OF_SCAN;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::random::{Purpose, generator};
use common::tracks::Track;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::{Rng, RngExt};
use tracker::Tracker;

/// Plots in each gate.
const PLOTS: usize = 5;
const SECTORS: u32 = 32;
/// Turns that are drawn.
const TURNS: usize = 8;
/// Turns before the first that is timed: tracks start on one plot each, then settle among five.
const STARTING: u32 = 6;
const SETTLING: u32 = 12;
const PERIOD_NS: u64 = 1_000_000_000;
const PFA: f64 = 1e-3;
const SIGMA: [f32; 4] = [20.0, 0.001_745, 0.001_745, 10.0];

/// Azimuths, ranges and elevations of the lattice.
type Lattice = [u32; 3];

/// Plots of some turns by sector, at their times from the start of the turn.
struct Sky {
    turns: Vec<Vec<Vec<Plot>>>,
}

impl Sky {
    /// `around`: plots of each target; `elsewhere`: others, between the elevations of the lattice.
    fn draw([azimuths, ranges, elevations]: Lattice, around: usize, elsewhere: usize, turns: usize) -> Self {
        let mut rng = generator(1, Purpose::Test, around as u32, elsewhere as u32);
        let threshold = -PFA.ln();
        // So that no azimuth has more than another.
        let between = |range, elevation| f64::from(range * elevations + elevation) / f64::from(ranges * elevations);
        let turn = |rng: &mut dyn Rng| {
            let mut sectors = vec![Vec::new(); SECTORS as usize];
            let mut add = |plot: Plot| {
                let sector = (plot.azimuth_rad / TAU * f64::from(SECTORS)) as usize;
                sectors[sector.min(SECTORS as usize - 1)].push(plot);
            };
            for azimuth in 0..azimuths {
                for range in 0..ranges {
                    for elevation in 0..elevations {
                        let place = [
                            14_000.0 + 46_000.0 * f64::from(range) / f64::from(ranges),
                            TAU * (f64::from(azimuth) + between(range, elevation)) / f64::from(azimuths),
                            0.02 + 0.4 * f64::from(elevation) / f64::from(elevations),
                            0.0,
                        ];
                        for k in 0..around {
                            let power = if k == 0 { 300.0 } else { threshold + 0.1 };
                            add(plot(place, if k == 0 { 0.5 } else { 1.0 }, power, rng));
                        }
                    }
                }
            }
            for _ in 0..elsewhere {
                let place = [
                    rng.random_range(14_000.0..60_000.0),
                    rng.random_range(0.0..TAU),
                    0.06 + 0.08 * f64::from(rng.random_range(0..5_u32)),
                    rng.random_range(-50.0..50.0),
                ];
                add(plot(place, 1.0, threshold + 0.1, rng));
            }
            for sector in &mut sectors {
                sector.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
            }
            sectors
        };
        Self { turns: (0..turns).map(|_| turn(&mut rng)).collect() }
    }
}

/// Within `spread` standard deviations of a place in each coordinate.
fn plot(place: [f64; 4], spread: f64, power: f64, rng: &mut dyn Rng) -> Plot {
    let mut near = |i: usize| place[i] + spread * f64::from(SIGMA[i]) * rng.random_range(-1.0..1.0);
    let azimuth_rad = near(1).rem_euclid(TAU);
    Plot {
        time_ns: (azimuth_rad / TAU * PERIOD_NS as f64) as u64,
        range_m: near(0),
        azimuth_rad,
        elevation_rad: near(2),
        range_rate_mps: near(3),
        sigma_range_m: SIGMA[0],
        sigma_azimuth_rad: SIGMA[1],
        sigma_elevation_rad: SIGMA[2],
        sigma_range_rate_mps: SIGMA[3],
        statistic: power.sqrt() as f32,
        cell_count: 1,
        flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
        ..Plot::default()
    }
}

/// A tracker and how far its beam has come.
struct Running {
    tracker: Tracker,
    scan: u32,
    plots: Vec<Plot>,
    tracks: Vec<Track>,
}

/// What a turn brought out.
#[derive(Debug, Default)]
struct Counts {
    tracks: usize,
    confirmed: usize,
    alive: u32,
    full_gates: usize,
}

impl Running {
    fn new(estimator: Estimator) -> Self {
        let config =
            TrackerConfig { estimator, start_density: 1e-12, clutter_map_scans: 0, ..TrackerConfig::default() };
        let tracker = Tracker::new(&config, 1).expect("valid");
        Self { tracker, scan: 0, plots: Vec::new(), tracks: Vec::new() }
    }

    /// One turn; the time is that within the tracker.
    fn turn(&mut self, sectors: &[Vec<Plot>]) -> (Counts, Duration) {
        let cell = SIGMA.map(|sigma| f64::from(sigma) * 12.0_f64.sqrt());
        let (mut counts, mut spent) = (Counts::default(), Duration::ZERO);
        let start_ns = u64::from(self.scan) * PERIOD_NS;
        for (sector, plots) in (0..SECTORS).zip(sectors) {
            let at = |sectors: u32| TAU * f64::from(sectors) / f64::from(SECTORS);
            let header = PlotsHeader {
                seq: u64::from(self.scan * SECTORS + sector),
                session: 1,
                time_ns: start_ns + u64::from(sector + 1) * PERIOD_NS / u64::from(SECTORS),
                covered_from_rad: at(sector),
                covered_to_rad: at(sector + 1),
                scan_period_s: 1.0,
                pfa: PFA,
                cell_range_m: cell[0],
                cell_azimuth_rad: cell[1],
                cell_elevation_rad: cell[2],
                cell_range_rate_mps: cell[3],
                scan: self.scan,
                sector,
                sectors_per_scan: SECTORS,
                flags: if sector + 1 == SECTORS { END_OF_SCAN } else { 0 },
                ..PlotsHeader::default()
            };
            self.plots.clear();
            self.plots.extend(plots.iter().map(|plot| Plot { time_ns: plot.time_ns + start_ns, ..*plot }));
            let begin = Instant::now();
            let taken = self.tracker.process_plots(black_box(&header), black_box(&self.plots), &mut self.tracks);
            spent += begin.elapsed();
            counts.tracks += self.tracks.len();
            counts.confirmed += self.tracks.iter().filter(|track| track.is_confirmed()).count();
            counts.full_gates += self.tracks.iter().filter(|track| track.plots_in_gate as usize == PLOTS).count();
            counts.alive = taken.alive;
        }
        self.scan += 1;
        (counts, spent)
    }
}

/// A tracker whose tracks have started and settled among the plots of a sky.
fn settle(estimator: Estimator, lattice: Lattice, elsewhere: usize) -> (Running, Sky) {
    let targets = lattice.iter().product::<u32>() as usize;
    let mut running = Running::new(estimator);
    let alone = Sky::draw(lattice, 1, 0, 2);
    for turn in 0..STARTING {
        running.turn(&alone.turns[turn as usize % 2]);
    }
    let sky = Sky::draw(lattice, PLOTS, elsewhere, TURNS.min(1 + 2_000_000 / (targets * PLOTS + elsewhere)));
    for turn in 0..SETTLING {
        running.turn(&sky.turns[turn as usize % sky.turns.len()]);
    }
    (running, sky)
}

fn whole_tracker(criterion: &mut Criterion, group: &str, cases: &[(Estimator, Lattice, usize)]) {
    let mut group = criterion.benchmark_group(group);
    for &(estimator, lattice, elsewhere) in cases {
        let targets = lattice.iter().product::<u32>() as usize;
        let plots = targets * PLOTS + elsewhere;
        group.throughput(Throughput::Elements(if elsewhere > 0 { plots } else { targets } as u64));
        group.sample_size(10);
        let name = if elsewhere > 0 { format!("{targets}+{elsewhere}") } else { format!("{targets}x{PLOTS}") };
        let own = serde_json::to_value(estimator).expect("a name");
        let family = own.as_str().filter(|_| estimator != Estimator::ImmUav).map(|own| format!("-{own}"));
        let name = name + &family.unwrap_or_default();
        // Made when first asked for, so that a filter of the command line does not wait for what it leaves out.
        let mut settled = None;
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            let (running, sky) = settled.get_or_insert_with(|| settle(estimator, lattice, elsewhere));
            bencher.iter_custom(|iterations| {
                let mut spent = Duration::ZERO;
                for _ in 0..iterations {
                    let (counts, time) = running.turn(&sky.turns[running.scan as usize % sky.turns.len()]);
                    // Every target has its track, hardly anything else has; its gate holds its plots.
                    let every = targets..=targets + targets / 1000;
                    let all = [counts.tracks, counts.confirmed, counts.alive as usize];
                    assert!(all.iter().all(|tracks| every.contains(tracks)), "{counts:?}");
                    assert!(counts.full_gates * 100 > targets * 90, "{counts:?}");
                    spent += time;
                }
                spent
            });
        });
    }
    group.finish();
}

fn tracker_take(criterion: &mut Criterion) {
    let usual = |lattice, elsewhere| (Estimator::ImmUav, lattice, elsewhere);
    let sizes = [[10, 5, 2], [50, 10, 2], [100, 25, 4], [250, 80, 5]];
    whole_tracker(criterion, "tracker_take", &sizes.map(|lattice| usual(lattice, 0)));
    let crowded = [10_000, 100_000].map(|elsewhere| usual([50, 10, 2], elsewhere));
    whole_tracker(criterion, "tracker_take_plots", &crowded);
    let families = Estimator::ALL.map(|estimator| (estimator, [50, 10, 2], 0));
    whole_tracker(criterion, "tracker_take_families", &families);
}

criterion_group!(benches, tracker_take);
criterion_main!(benches);
