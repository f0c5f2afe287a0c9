//! What is no target makes no lasting track, and a drone or an aircraft of 15 dB among it is followed: plots at random places with and without
//! power, interference, strobes, rings, sea clutter, rain.
//!
//! `DISTURBED_SEED=7 cargo test --test disturbed -- --nocapture` draws others and prints all.

#[expect(dead_code, reason = "when targets were seen is of another test")]
mod world;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use common::config::TrackerConfig;
use common::geometry::Polar;
use common::units::from_db;
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Gamma, Poisson};
use world::{Disturbance, Radar, Target, exponential, follow, observe, time_s};

const SCANS: u32 = 100;
/// Scans after which a confirmed false track has lasted.
const LASTING: u32 = 10;
/// Share of the turns, those before its confirmation included, in which the target is to have its track.
const FOLLOWED: f64 = 0.75;

/// Draws the plots of a turn.
type Draw = dyn Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo>;

/// Radars of several kinds.
fn radars() -> [(&'static str, Radar); 4] {
    [
        (
            "drone",
            Radar {
                period_s: 1.0,
                sectors: 32,
                cell: [69.3, 0.006_04, 0.006_04, 34.6],
                range_m: 5000.0,
                pfa: 1e-6,
                error_cells: 0.25,
                interval_mps: 0.0,
            },
        ),
        (
            "marine",
            Radar {
                period_s: 2.0,
                sectors: 8,
                cell: [7.5, 0.0175, 0.0, 0.0],
                range_m: 3000.0,
                pfa: 1e-6,
                error_cells: 0.2,
                interval_mps: 0.0,
            },
        ),
        (
            "marine without power",
            Radar {
                period_s: 2.0,
                sectors: 8,
                cell: [7.5, 0.0175, 0.0, 0.0],
                range_m: 3000.0,
                pfa: 0.0,
                error_cells: 0.2,
                interval_mps: 0.0,
            },
        ),
        (
            "approach",
            Radar {
                period_s: 4.0,
                sectors: 32,
                cell: [75.0, 0.0244, 0.0, 0.0],
                range_m: 110e3,
                pfa: 1e-6,
                error_cells: 0.25,
                interval_mps: 0.0,
            },
        ),
    ]
}

/// A plot that is no target's: place, range rate (m/s), power over noise.
type Echo = (Polar, f64, f64);

/// As many plots a turn as a Poisson number of this mean, each drawn by `one`.
fn many(mean: f64, one: impl Fn(&Radar, u32, &mut dyn Rng) -> Echo) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    move |radar, scan, rng| {
        let count = Poisson::new(mean).expect("positive").sample(rng) as usize;
        (0..count).map(|_| one(radar, scan, rng)).collect()
    }
}

/// Plots at random places, of random strength up to 50 dB.
fn random(mean: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    many(mean, move |radar, _, rng| {
        let (place, rate) = radar.anywhere(rng);
        (place, rate, radar.threshold() * from_db(rng.random_range(0.0..35.0)))
    })
}

/// Plots of noise's strength over the surface.
fn weak(mean: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    many(mean, move |radar, _, rng| {
        let (place, rate) = radar.anywhere(rng);
        // Alike over the surface, so fewer near.
        let place = Polar { range_m: radar.range_m * rng.random::<f64>().sqrt().max(0.01), ..place };
        (place, rate, radar.threshold() + exponential(rng))
    })
}

/// A strobe along one azimuth, which stands still or turns.
fn strobe(mean: f64, turns_rad: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    many(mean, move |radar, scan, rng| {
        let (place, rate) = radar.anywhere(rng);
        let azimuth = 1.0 + turns_rad * f64::from(scan) + radar.cell[1] * rng.random_range(-1.0..1.0);
        let q = radar.threshold() * from_db(rng.random_range(0.0..30.0));
        (Polar { azimuth_rad: azimuth.rem_euclid(TAU), ..place }, rate, q)
    })
}

/// A ring of one range.
fn ring(mean: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    many(mean, move |radar, _, rng| {
        let (place, rate) = radar.anywhere(rng);
        let range_m = 0.4 * radar.range_m + 2.0 * radar.cell[0] * rng.random_range(-1.0..1.0);
        (Polar { range_m, ..place }, rate, radar.threshold() * from_db(rng.random_range(0.0..30.0)))
    })
}

/// K-distributed sea clutter out to a third of the range: spikes of shape ν, many a turn.
fn sea(nu: f64, mean: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    let texture = Gamma::new(nu, 1.0 / nu).expect("positive");
    many(mean, move |radar, _, rng| {
        let (place, rate) = radar.anywhere(rng);
        let range_m = 0.33 * radar.range_m * rng.random::<f64>().sqrt().max(0.02);
        // The tail above the threshold of clutter 5 dB over the noise.
        let tail = loop {
            let q = 6.0 * texture.sample(rng) * exponential(rng);
            if q > radar.threshold() {
                break q;
            }
        };
        let place = Polar { range_m, elevation_rad: 0.3 * radar.cell[2], ..place };
        (place, 0.05 * rate, tail)
    })
}

/// Rain: a volume that drifts.
fn rain(mean: f64) -> impl Fn(&Radar, u32, &mut dyn Rng) -> Vec<Echo> {
    many(mean, move |radar, scan, rng| {
        let (place, _) = radar.anywhere(rng);
        let centre = 0.5 * radar.range_m + 10.0 * radar.period_s * f64::from(scan);
        let range_m = centre + 0.1 * radar.range_m * rng.random_range(-1.0..1.0);
        let azimuth_rad = 2.0 + 0.3 * rng.random_range(-1.0..1.0);
        let q = radar.threshold() + 4.0 * exponential(rng);
        (Polar { range_m, azimuth_rad, ..place }, 10.0 + 0.1 * radar.cell[3] * rng.random_range(-1.0..1.0), q)
    })
}

/// What a disturbance and a target in it have come to.
#[derive(Debug)]
struct Outcome {
    /// False tracks that were confirmed for more than ten scans.
    lasting: usize,
    /// Share of the turns in which the target had a confirmed track.
    followed: f64,
}

fn run(radar: &Radar, disturbance: Disturbance<'_>, target: Option<Target>, seed: u64) -> Outcome {
    let config = if radar.range_m < 15e3 {
        TrackerConfig::default()
    } else {
        TrackerConfig { start_speed_mps: 350.0, ..TrackerConfig::default() }
    };
    let all = |radar: &Radar, scan: u32, rng: &mut dyn Rng| {
        let mut plots = disturbance(radar, scan, rng);
        plots.extend(radar.false_alarms(20.0, rng));
        plots
    };
    let seen = observe(radar, target.as_slice(), &all, SCANS, seed);
    let (mut confirmed, mut held) = (BTreeMap::<u64, u32>::new(), BTreeSet::new());
    for (scan, track) in follow(&config, &seen.messages) {
        let time_s = time_s(track.time_ns);
        let is_near = |target: &Target| radar.error(&track, target, time_s).norm() < radar.near_m(target, time_s);
        if !track.is_confirmed() {
        } else if target.as_ref().is_some_and(is_near) {
            held.insert(scan);
        } else {
            *confirmed.entry(track.id).or_default() += 1;
        }
    }
    let lasting = confirmed.values().filter(|scans| **scans > LASTING).count();
    Outcome { lasting, followed: held.len() as f64 / f64::from(SCANS) }
}

/// A target of 15 dB at a third of the range.
fn target(radar: &Radar) -> Target {
    let (range_m, speed_mps) = (0.3 * radar.range_m, if radar.range_m < 15e3 { 8.0 } else { 120.0 });
    let height_m = if radar.cell[2] > 0.0 { 0.1 * range_m } else { 0.0 };
    Target {
        from_m: Vector3::new(0.8 * range_m, 0.6 * range_m, height_m),
        velocity_mps: Vector3::new(-0.3 * speed_mps, 0.95 * speed_mps, 0.0),
        snr: from_db(15.0),
        fluctuates: false,
    }
}

#[test]
fn nothing_lasts_and_a_target_is_followed_by_radars_that_tell_power() {
    follow_by(radars().into_iter().filter(|(_, radar)| radar.pfa > 0.0 && radar.range_m < 15e3));
}

#[test]
fn nothing_lasts_and_a_target_is_followed_far_off_and_without_power() {
    follow_by(radars().into_iter().filter(|(_, radar)| radar.pfa == 0.0 || radar.range_m > 15e3));
}

fn follow_by(radars: impl Iterator<Item = (&'static str, Radar)>) {
    let seed =
        std::env::var("DISTURBED_SEED").map_or(1, |seed| seed.parse().expect("DISTURBED_SEED is a whole number"));
    let disturbances: [(&str, Box<Draw>); 18] = [
        ("noise alone", Box::new(random(0.001))),
        ("1 plot of any strength", Box::new(random(1.0))),
        ("10 plots of any strength", Box::new(random(10.0))),
        ("70 plots of any strength", Box::new(random(70.0))),
        ("300 plots of any strength", Box::new(random(300.0))),
        ("1000 plots of any strength", Box::new(random(1000.0))),
        ("10 weak plots", Box::new(weak(10.0))),
        ("100 weak plots", Box::new(weak(100.0))),
        ("1000 weak plots", Box::new(weak(1000.0))),
        ("a strobe of 30 plots", Box::new(strobe(30.0, 0.0))),
        ("a strobe of 200 plots", Box::new(strobe(200.0, 0.0))),
        ("a strobe that turns", Box::new(strobe(60.0, 0.05))),
        ("a ring of 30 plots", Box::new(ring(30.0))),
        ("a ring of 200 plots", Box::new(ring(200.0))),
        ("sea, shape 0.5", Box::new(sea(0.5, 200.0))),
        ("sea, shape 2", Box::new(sea(2.0, 200.0))),
        ("sea, shape 10", Box::new(sea(10.0, 500.0))),
        ("rain", Box::new(rain(150.0))),
    ];
    let mut failed = Vec::new();
    for (name, radar) in radars {
        for (what, disturbance) in &disturbances {
            let alone = run(&radar, disturbance.as_ref(), None, seed);
            let with = run(&radar, disturbance.as_ref(), Some(target(&radar)), seed);
            let line = format!("{name}, {what}: {} lasting, target followed in {:.2}", alone.lasting, with.followed);
            eprintln!("{line}");
            if alone.lasting > 1 || with.followed < FOLLOWED {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "seed {seed}: {failed:#?}");
}
