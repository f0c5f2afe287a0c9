//! A radar that turns, for tests: true targets in, `plots` messages out, no cells.

use std::f64::consts::TAU;

use common::angle;
use common::geometry::{Polar, range_rate_mps};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::random::{Purpose, generator};
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, StandardNormal};

/// Sectors in a scan.
pub(crate) const SECTORS: u32 = 32;
/// Cells of \[L22\]: range, azimuth, elevation, range rate.
pub(crate) const CELL: [f64; 4] = [69.3, 0.006_04, 0.006_04, 34.6];
/// Start of measurement time, ns.
pub(crate) const EPOCH_NS: u64 = 1_700_000_000_000_000_000;
/// Probability of false alarm unless another is said.
const PFA: f64 = 1e-6;

/// A target: position and velocity at a time.
pub(crate) type Target = fn(f64) -> (Vector3<f64>, Vector3<f64>);

/// Forty targets in one direction, so that many tracks are due at once: pairs in 20 ranges, of which one target crosses the
/// other's path within some cells.
pub(crate) const FLEET: [Target; 40] = [
    flier::<0>,
    flier::<1>,
    flier::<2>,
    flier::<3>,
    flier::<4>,
    flier::<5>,
    flier::<6>,
    flier::<7>,
    flier::<8>,
    flier::<9>,
    flier::<10>,
    flier::<11>,
    flier::<12>,
    flier::<13>,
    flier::<14>,
    flier::<15>,
    flier::<16>,
    flier::<17>,
    flier::<18>,
    flier::<19>,
    flier::<20>,
    flier::<21>,
    flier::<22>,
    flier::<23>,
    flier::<24>,
    flier::<25>,
    flier::<26>,
    flier::<27>,
    flier::<28>,
    flier::<29>,
    flier::<30>,
    flier::<31>,
    flier::<32>,
    flier::<33>,
    flier::<34>,
    flier::<35>,
    flier::<36>,
    flier::<37>,
    flier::<38>,
    flier::<39>,
];

fn flier<const K: u32>(time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (pair, second) = (f64::from(K / 2), f64::from(K % 2));
    let from = Vector3::new(900.0 + 150.0 * pair + 60.0 * second, 1000.0 + 150.0 * pair - 20.0 * second, 150.0);
    let velocity = Vector3::new(4.0 - 3.0 * second, -2.0 + 0.2 * pair, 0.0);
    (from + velocity * time_s, velocity)
}

/// What the radar does.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turning {
    /// Seed of all draws.
    pub seed: u64,
    /// Mean power over noise.
    pub snr: f64,
    /// Swerling I if true, else steady power.
    pub fluctuates: bool,
    /// Probability of false alarm.
    pub pfa: f64,
    /// False plots a scan: 25 at 10⁻⁶ are those of the cells around the targets.
    pub false_plots: u32,
    /// Whether elevation, range rate and statistics are measured.
    pub full: bool,
    /// Whether two targets within a cell in every coordinate give one plot, between them, of both their powers.
    pub merges: bool,
}

impl Default for Turning {
    fn default() -> Self {
        Self { seed: 1, snr: 100.0, fluctuates: false, pfa: PFA, false_plots: 25, full: true, merges: false }
    }
}

/// The messages of `scans` scans.
pub(crate) fn messages(radar: Turning, targets: &[Target], scans: u32) -> Vec<(PlotsHeader, Vec<Plot>)> {
    let mut all: Vec<(PlotsHeader, Vec<Plot>)> =
        (0..scans).flat_map(|scan| (0..SECTORS).map(move |sector| (header(radar, scan, sector), Vec::new()))).collect();
    let threshold = -radar.pfa.ln();
    for scan in 0..scans {
        let mut rng = generator(radar.seed, Purpose::Test, scan, 0);
        let mut echoes: Vec<Echo> = targets.iter().filter_map(|target| Echo::of(*target, scan)).collect();
        if radar.merges {
            merge(radar, &mut echoes, &mut rng);
        }
        for echo in echoes {
            let power = echo.power.unwrap_or_else(|| radar.power(&mut rng));
            let q = power + exponential(&mut rng);
            if q > threshold {
                let plot = measured(radar, echo.time_s, &echo.position, &echo.velocity, q, &mut rng);
                place(&mut all, plot, echo.time_s);
            }
        }
        for _ in 0..radar.false_plots {
            let azimuth = rng.random::<f64>();
            let time_s = f64::from(scan) + azimuth;
            let place_at = Polar {
                range_m: rng.random_range(200.0..5000.0),
                azimuth_rad: TAU * azimuth,
                elevation_rad: if radar.full { rng.random_range(0.0..0.35) } else { 0.0 },
            };
            let velocity = Vector3::new(rng.random_range(-60.0..60.0), rng.random_range(-60.0..60.0), 0.0);
            let q = threshold + exponential(&mut rng);
            let plot = measured(radar, time_s, &place_at.to_enu(), &velocity, q, &mut rng);
            place(&mut all, plot, time_s);
        }
    }
    if let Some((header, _)) = all.last_mut() {
        header.flags |= END_OF_STREAM;
    }
    all
}

impl Turning {
    fn power(&self, rng: &mut impl Rng) -> f64 {
        if self.fluctuates { self.snr * exponential(rng) } else { self.snr }
    }
}

/// What the beam meets, of one target or of two.
struct Echo {
    time_s: f64,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    /// If it has been drawn.
    power: Option<f64>,
}

impl Echo {
    fn of(target: Target, scan: u32) -> Option<Self> {
        let time_s = f64::from(scan) + passage(target, scan)?;
        let (position, velocity) = target(time_s);
        Some(Self { time_s, position, velocity, power: None })
    }

    fn is_one_with(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|echo| {
            let place = Polar::from_enu(&echo.position);
            [place.range_m, place.azimuth_rad, place.elevation_rad, range_rate_mps(&echo.position, &echo.velocity)]
        });
        (0..4).all(|i| (if i == 1 { angle::difference(a[i], b[i]) } else { a[i] - b[i] }).abs() < CELL[i])
    }
}

/// Draws all powers, and makes one of two that the radar cannot tell apart.
fn merge(radar: Turning, echoes: &mut Vec<Echo>, rng: &mut impl Rng) {
    for echo in echoes.iter_mut() {
        echo.power = Some(radar.power(rng));
    }
    let mut second = 1;
    while second < echoes.len() {
        let Some(first) = (0..second).find(|&first| echoes[first].is_one_with(&echoes[second])) else {
            second += 1;
            continue;
        };
        let other = echoes.remove(second);
        let echo = &mut echoes[first];
        let powers = [echo.power, other.power].map(|power| power.unwrap_or(0.0));
        let share = powers[1] / (powers[0] + powers[1]);
        echo.time_s += share * (other.time_s - echo.time_s);
        echo.position += (other.position - echo.position) * share;
        echo.velocity += (other.velocity - echo.velocity) * share;
        echo.power = Some(powers[0] + powers[1]);
    }
}

/// Into the sector of its azimuth, near the time it was measured.
fn place(all: &mut [(PlotsHeader, Vec<Plot>)], plot: Plot, time_s: f64) {
    let turned = plot.azimuth_rad / TAU;
    let scan = (time_s - turned).round().max(0.0);
    let index = (scan * f64::from(SECTORS)) as usize + (turned * f64::from(SECTORS)) as usize;
    if let Some((_, plots)) = all.get_mut(index) {
        plots.push(plot);
    }
}

/// Share of the turn after which the beam meets the target, if it does.
fn passage(target: Target, scan: u32) -> Option<f64> {
    // The beam gains on the target: find where it overtakes, by bisection on a fine grid.
    let ahead = |turned: f64| {
        let (position, _) = target(f64::from(scan) + turned);
        angle::difference(position.x.atan2(position.y), TAU * turned)
    };
    let steps = 4096;
    for step in 0..steps {
        let (a, b) = (f64::from(step) / f64::from(steps), f64::from(step + 1) / f64::from(steps));
        let (before, after) = (ahead(a), ahead(b));
        if before >= 0.0 && after < 0.0 && before < 1.0 {
            return Some(a + (b - a) * before / (before - after));
        }
    }
    None
}

fn header(radar: Turning, scan: u32, sector: u32) -> PlotsHeader {
    let at = |sectors: u32| TAU * f64::from(sectors) / f64::from(SECTORS);
    let full = |cell: f64| if radar.full { cell } else { 0.0 };
    PlotsHeader {
        seq: u64::from(scan * SECTORS + sector),
        session: 1,
        time_ns: EPOCH_NS
            + u64::from(scan) * 1_000_000_000
            + u64::from(sector + 1) * 1_000_000_000 / u64::from(SECTORS),
        covered_from_rad: at(sector),
        covered_to_rad: at(sector + 1),
        scan_period_s: 1.0,
        pfa: full(radar.pfa),
        cell_range_m: CELL[0],
        cell_azimuth_rad: CELL[1],
        cell_elevation_rad: full(CELL[2]),
        cell_range_rate_mps: full(CELL[3]),
        scan,
        sector,
        sectors_per_scan: SECTORS,
        flags: if sector + 1 == SECTORS { END_OF_SCAN } else { 0 },
        ..PlotsHeader::default()
    }
}

fn measured(
    radar: Turning,
    time_s: f64,
    position: &Vector3<f64>,
    velocity: &Vector3<f64>,
    q: f64,
    rng: &mut impl Rng,
) -> Plot {
    let place = Polar::from_enu(position);
    let sigma = [5.0, 0.000_5, 0.000_5, 3.0];
    let mut error = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
    let full = |value: f64| if radar.full { value } else { 0.0 };
    Plot {
        time_ns: EPOCH_NS + (time_s * 1e9) as u64,
        range_m: (place.range_m + error(sigma[0])).max(1.0),
        azimuth_rad: angle::wrap(place.azimuth_rad + error(sigma[1])),
        elevation_rad: full(place.elevation_rad + error(sigma[2])),
        range_rate_mps: full(range_rate_mps(position, velocity) + error(sigma[3])),
        sigma_range_m: sigma[0] as f32,
        sigma_azimuth_rad: sigma[1] as f32,
        sigma_elevation_rad: full(sigma[2]) as f32,
        sigma_range_rate_mps: full(sigma[3]) as f32,
        statistic: full(q.sqrt()) as f32,
        cell_count: 1,
        flags: if radar.full { HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC } else { 0 },
        ..Plot::default()
    }
}

fn exponential(rng: &mut impl Rng) -> f64 {
    Exp1.sample(rng)
}
