//! What has gone wrong with radars and targets of users, each as a small input: far ranges, plots that are no targets, a target that goes, a long
//! pause.

#[expect(dead_code, reason = "disturbances are of another test")]
mod world;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use common::config::TrackerConfig;
use common::tracks::Track;
use common::units::from_db;
use nalgebra::Vector3;
use rand::Rng;
use world::{Radar, Target, follow, observe};

/// A radar of thin range cells, as on an airport or a ship.
const MARINE: Radar = Radar {
    period_s: 2.0,
    sectors: 8,
    cell: [7.5, 0.0087, 0.0, 0.0],
    range_m: 3000.0,
    pfa: 0.0,
    error_cells: 0.2,
    interval_mps: 0.0,
};

fn quiet(_: &Radar, _: u32, _: &mut dyn Rng) -> Vec<(common::geometry::Polar, f64, f64)> {
    Vec::new()
}

fn straight(from_m: [f64; 2], velocity_mps: [f64; 2]) -> Target {
    Target {
        from_m: Vector3::new(from_m[0], from_m[1], 0.0),
        velocity_mps: Vector3::new(velocity_mps[0], velocity_mps[1], 0.0),
        snr: from_db(25.0),
        fluctuates: false,
    }
}

/// Ids of the confirmed tracks of a scan.
fn confirmed(tracks: &[(u32, Track)], scan: u32) -> BTreeSet<u64> {
    tracks.iter().filter(|(at, track)| *at == scan && track.is_confirmed()).map(|(_, track)| track.id).collect()
}

/// Ten aircraft at up to 1600 range cells.
#[test]
fn aircraft_beyond_the_first_cells_are_confirmed() {
    let radar = Radar { period_s: 4.0, sectors: 32, cell: [75.0, 0.0244, 0.0, 0.0], range_m: 120e3, ..MARINE };
    let targets: Vec<Target> = (0..10)
        .map(|k| {
            let (range_m, azimuth) = (50e3 + 7e3 * f64::from(k), TAU * (f64::from(k) + 0.3) / 10.0);
            straight(
                [range_m * azimuth.sin(), range_m * azimuth.cos()],
                [200.0 * azimuth.cos(), -200.0 * azimuth.sin()],
            )
        })
        .collect();
    let config = TrackerConfig { start_speed_mps: 350.0, ..TrackerConfig::default() };
    let tracks = follow(&config, &observe(&radar, &targets, &quiet, 30, 1).messages);
    for scan in 8..30 {
        assert_eq!(confirmed(&tracks, scan).len(), 10, "scan {scan}");
    }
    assert_eq!(confirmed(&tracks, 8), confirmed(&tracks, 29));
}

/// Seventy plots a turn and no target, with and without power, over one minute: nothing lasts, and no gate is larger than the radar's area.
#[test]
fn plots_at_random_places_make_no_track() {
    for pfa in [0.0, 1e-6] {
        let radar = Radar { pfa, ..MARINE };
        let random = |radar: &Radar, _: u32, rng: &mut dyn Rng| {
            (0..70)
                .map(|_| {
                    let (place, rate) = radar.anywhere(rng);
                    (place, rate, 1000.0)
                })
                .collect()
        };
        for seed in 1..4 {
            let tracks = follow(&TrackerConfig::default(), &observe(&radar, &[], &random, 30, seed).messages);
            assert!(confirmed(&tracks, 29).len() <= 1, "F {pfa}, seed {seed}");
            let mut lived = BTreeMap::<u64, u32>::new();
            for (_, track) in tracks.iter().filter(|(_, track)| track.is_confirmed()) {
                *lived.entry(track.id).or_default() += 1;
                assert!(track.gate_volume < 0.5 * TAU * radar.range_m * radar.range_m, "{}", track.gate_volume);
            }
            assert!(lived.values().filter(|scans| **scans > 10).count() <= 1, "F {pfa}, seed {seed}: {lived:?}");
        }
    }
}

/// Of two targets 60 m apart one goes: its track ends and does not ride on the other.
#[test]
fn the_track_of_a_target_that_goes_ends() {
    let radar = Radar { period_s: 1.0, cell: [6.0, 0.007, 0.0, 0.0], error_cells: 0.3, ..MARINE };
    for seed in 1..6 {
        let both = [straight([-1200.0, 1500.0], [15.0, 0.0]), straight([-1200.0, 1440.0], [15.0, 0.0])];
        let mut messages = observe(&radar, &both, &quiet, 120, seed).messages;
        for (header, plots) in &mut messages {
            plots.retain(|plot| header.scan < 60 || plot.range_m * plot.azimuth_rad.cos() > 1470.0);
        }
        let tracks = follow(&TrackerConfig::default(), &messages);
        assert_eq!(confirmed(&tracks, 50).len(), 2, "seed {seed}");
        for scan in 81..120 {
            assert!(confirmed(&tracks, scan).len() <= 1, "seed {seed}, scan {scan}");
        }
        assert_eq!(confirmed(&tracks, 119).len(), 1, "seed {seed}");
    }
}

/// Targets beyond the unambiguous interval of range rates, and one that passes its end, are tracked like others.
#[test]
fn range_rates_fold() {
    for (interval_mps, cell_mps) in [(208.0, 34.6), (60.0, 5.0), (25.0, 2.0)] {
        let radar = Radar {
            period_s: 1.0,
            sectors: 32,
            cell: [60.0, 0.006, 0.0, cell_mps],
            range_m: 10e3,
            pfa: 1e-6,
            error_cells: 0.25,
            interval_mps,
        };
        let targets = [
            straight([100.0, 2000.0], [3.0, 110.0]),
            straight([7000.0, 300.0], [-130.0, 0.0]),
            straight([-4000.0, -2500.0], [140.0, 0.0]),
            straight([-1000.0, 1900.0], [-60.0, 53.0]),
            straight([2000.0, -2000.0], [2.0, 1.0]),
        ];
        let config = TrackerConfig { start_speed_mps: 250.0, ..TrackerConfig::default() };
        let tracks = follow(&config, &observe(&radar, &targets, &quiet, 45, 1).messages);
        for scan in 8..44 {
            assert_eq!(confirmed(&tracks, scan), confirmed(&tracks, 8), "interval {interval_mps}, scan {scan}");
        }
        assert_eq!(confirmed(&tracks, 8).len(), targets.len(), "interval {interval_mps}");
    }
}

/// Half an hour without plots: every track has ended, none has coasted away, and the targets get new ones.
#[test]
fn a_long_pause_ends_tracks() {
    let targets = [straight([1000.0, 500.0], [3.0, 0.0]), straight([-800.0, 900.0], [0.0, -4.0])];
    let seen = observe(&MARINE, &targets, &quiet, 60, 1).messages;
    let mut messages = seen.clone();
    let pause_ns = 1800 * 1_000_000_000;
    for (header, plots) in messages.iter_mut().filter(|(header, _)| header.scan >= 30) {
        header.time_ns += pause_ns;
        for plot in plots {
            plot.time_ns += pause_ns;
        }
    }
    let tracks = follow(&TrackerConfig::default(), &messages);
    assert_eq!(confirmed(&tracks, 28).len(), 2);
    assert_eq!(confirmed(&tracks, 59).len(), 2);
    assert!(confirmed(&tracks, 28).is_disjoint(&confirmed(&tracks, 59)));
    for (scan, track) in &tracks {
        let [east_m, north_m, _] = track.position_m();
        assert!(east_m.hypot(north_m) < 3000.0, "scan {scan}: {east_m} {north_m}");
    }
}
