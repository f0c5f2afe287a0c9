//! Any radar follows what moves before it: from 0.2 to 500 km, 0.25 to 15 s a turn, in two and three dimensions, with and without Doppler and
//! power, at the settings of its class of targets.
//!
//! `SWEEP_SEED=5000 cargo test --test any_radar` draws other radars; a radar on which something goes wrong is printed with its seed.

mod world;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::fmt;

use common::config::TrackerConfig;
use common::random::{Purpose, generator};
use common::tracks::{Track, pack};
use common::units::from_db;
use nalgebra::{DMatrix, DVector, Vector3};
use rand::{Rng, RngExt};
use world::{Observed, Radar, Target, follow, observe};

const SCANS: u32 = 60;
const RADARS: u64 = 200;
/// Detections after which a target is to be confirmed.
const LOOKS: usize = 6;
/// Scans after which a track has settled.
const SETTLED: u32 = 20;

/// A radar and targets drawn from a seed.
struct Scenario {
    seed: u64,
    radar: Radar,
    targets: Vec<Target>,
    config: TrackerConfig,
}

impl Scenario {
    fn draw(seed: u64) -> Self {
        let mut rng = generator(seed, Purpose::Test, 0, 1);
        let rng: &mut dyn Rng = &mut rng;
        let log_uniform = |rng: &mut dyn Rng, low: f64, high: f64| rng.random_range(low.ln()..high.ln()).exp();
        let range_m = log_uniform(rng, 200.0, 500e3);
        // Drones near, aircraft far; none crosses more than a two-hundredth of the range in a turn.
        let (fastest_mps, config) = if range_m < 15e3 {
            (30.0, TrackerConfig::default())
        } else {
            (250.0, TrackerConfig { start_speed_mps: 350.0, ..TrackerConfig::default() })
        };
        let period_s = log_uniform(rng, 0.25, (range_m / (4.0 * fastest_mps)).clamp(0.5, 15.0));
        let fastest_mps = fastest_mps.min(range_m / (200.0 * period_s));
        let cells = log_uniform(rng, 40.0, 1e5_f64.min(range_m / 1.5));
        let (has_elevation, has_doppler) = [(false, false), (false, true), (true, true)][rng.random_range(0..3)];
        let mut degrees = |low: f64, high: f64| rng.random_range(low..high).to_radians();
        let (beam_rad, tier_rad) = (degrees(0.3, 4.0), degrees(0.5, 4.0));
        let cell = [
            range_m / cells,
            beam_rad,
            if has_elevation { tier_rad } else { 0.0 },
            if has_doppler { rng.random_range(0.1..0.6) * fastest_mps.max(2.0) } else { 0.0 },
        ];
        let radar = Radar {
            period_s,
            sectors: [8, 16, 32][rng.random_range(0..3)],
            cell,
            range_m,
            pfa: if rng.random_range(0..4) == 0 { 0.0 } else { 1e-6 },
            error_cells: 0.25,
            interval_mps: 0.0,
        };
        let count = rng.random_range(1..=5);
        let first_rad = rng.random_range(0.0..TAU);
        let targets = (0..count)
            .map(|k| {
                let range = range_m * rng.random_range(0.3..0.8);
                let azimuth = first_rad + TAU * (f64::from(k) + rng.random_range(-0.2..0.2)) / f64::from(count);
                let height = if has_elevation { range * rng.random_range(0.05..0.3) } else { 0.0 };
                let (speed, course) = (fastest_mps * rng.random_range(0.2..1.0), rng.random_range(0.0..TAU));
                let fluctuates = rng.random_range(0..2) == 0;
                Target {
                    from_m: Vector3::new(range * azimuth.sin(), range * azimuth.cos(), height),
                    velocity_mps: Vector3::new(speed * course.sin(), speed * course.cos(), 0.0),
                    // Detected in four of five turns or more.
                    snr: from_db(rng.random_range(if fluctuates { 18.0 } else { 15.0 }..30.0)),
                    fluctuates,
                }
            })
            .collect();
        Self { seed, radar, targets, config }
    }
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Radar { period_s, cell, range_m, pfa, .. } = self.radar;
        let [range, azimuth, elevation, doppler] = cell;
        let (azimuth, elevation) = (azimuth.to_degrees(), elevation.to_degrees());
        write!(
            f,
            "seed {}: {:.1} km, {period_s:.2} s a turn, cells of {range:.1} m, {azimuth:.2}°, {elevation:.2}°, {doppler:.1} m/s, \
             F {pfa:.0e}, {} targets",
            self.seed,
            range_m / 1e3,
            self.targets.len()
        )
    }
}

/// What became of a scenario.
#[derive(Debug, Default)]
struct Outcome {
    /// Targets that were confirmed late or not at all, not held, or held by more than one track.
    late: usize,
    lost: usize,
    renumbered: usize,
    false_tracks: usize,
    /// Mean squared normalised error of position over its dimensions, of settled tracks.
    nees: f64,
}

fn score(scenario: &Scenario, looks: &[Vec<u32>], tracks: &[(u32, Track)]) -> Outcome {
    let Scenario { radar, targets, .. } = scenario;
    let axes = if radar.cell[2] > 0.0 { 3 } else { 2 };
    let mut held: Vec<BTreeMap<u32, u64>> = vec![BTreeMap::new(); targets.len()];
    let mut messages: BTreeMap<u64, [u32; 2]> = BTreeMap::new();
    let (mut nees, mut settled) = (0.0, 0.0);
    for (_, track) in tracks.iter().filter(|(_, track)| track.is_confirmed()) {
        let time_s = world::time_s(track.time_ns);
        let errors = targets.iter().map(|target| radar.error(track, target, time_s).norm());
        let nearest = errors.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (nearest, error_m) = nearest.expect("a target");
        let is_near = error_m < radar.near_m(&targets[nearest], time_s);
        messages.entry(track.id).or_default()[usize::from(is_near)] += 1;
        if is_near {
            held[nearest].insert((time_s / radar.period_s) as u32, track.id);
        }
        if is_near && track.age_scans > SETTLED {
            let error = radar.error(track, &targets[nearest], time_s);
            let error = DVector::from_fn(axes, |i, _| error[i]);
            let covariance = DMatrix::from_fn(axes, axes, |i, j| track.covariance[pack(3 * i, 3 * j)]);
            let inverse = covariance.try_inverse().expect("positive definite");
            nees += (error.transpose() * inverse * error)[0] / axes as f64;
            settled += 1.0;
        }
    }
    let mut outcome = Outcome { nees: nees / settled, ..Outcome::default() };
    outcome.false_tracks = messages.values().filter(|[far, near]| far > near).count();
    for (held, looks) in held.iter().zip(looks) {
        let first = held.keys().next().copied().unwrap_or(SCANS);
        outcome.late += usize::from(looks.iter().filter(|look| **look < first).count() > LOOKS);
        outcome.lost += usize::from((held.len() as f64) < 0.9 * f64::from(SCANS - first) - 1.0);
        outcome.renumbered += usize::from(held.values().collect::<BTreeSet<_>>().len() > 1);
    }
    outcome
}

#[test]
fn all_targets_are_followed_and_nothing_else() {
    let first = std::env::var("SWEEP_SEED").map_or(1, |seed| seed.parse().expect("SWEEP_SEED is a whole number"));
    let (mut failed, mut false_tracks, mut nees) = (0, 0, Vec::new());
    for scenario in (first..first + RADARS).map(Scenario::draw) {
        let noise = |radar: &Radar, _: u32, rng: &mut dyn Rng| radar.false_alarms(200.0, rng);
        let Observed { messages, looks } = observe(&scenario.radar, &scenario.targets, &noise, SCANS, scenario.seed);
        let outcome = score(&scenario, &looks, &follow(&scenario.config, &messages));
        let Outcome { late, lost, renumbered, .. } = outcome;
        if late + lost + renumbered + outcome.false_tracks > 0 {
            failed += 1;
            println!("{scenario}: {outcome:?}");
        }
        false_tracks += outcome.false_tracks;
        nees.push(outcome.nees);
    }
    nees.sort_by(f64::total_cmp);
    let quantile = |q: f64| nees[(q * (nees.len() - 1) as f64) as usize];
    let [low, median, high] = [0.05, 0.5, 0.95].map(quantile);
    println!("{failed} of {RADARS} failed; {false_tracks} false tracks; NEES {low:.2} {median:.2} {high:.2}");
    // Less than one in thirty, and one false track in a thousand scans.
    assert!(failed <= 6, "{failed} of {RADARS}");
    assert!(false_tracks as f64 <= 1e-3 * RADARS as f64 * f64::from(SCANS), "{false_tracks} false tracks");
    assert!(median > 0.7 && median < 1.1 && high < 2.0, "NEES {low:.2} {median:.2} {high:.2}");
}
