//! Two targets that pass each other keep their tracks, whatever cells, errors and turn time make of how far each may have been led astray.

#[expect(dead_code, reason = "disturbances and distances are of other tests")]
mod world;

use std::collections::{BTreeMap, BTreeSet};

use common::config::TrackerConfig;
use common::random::{Purpose, generator};
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use world::{Radar, Target, follow, observe};

const PAIRS: u64 = 40;
const SCANS: u32 = 80;
/// Turn in which they meet, and turns about it that are not looked at.
const MEETING: u32 = 45;
const ABOUT: u32 = 12;

/// A radar, and two targets of one azimuth cell: one stands, the other flies past it along the line of sight, at a distance of less than a
/// standard error.
fn draw(seed: u64) -> (Radar, [Target; 2]) {
    let mut rng = generator(seed, Purpose::Test, 0, 7);
    let rng: &mut dyn Rng = &mut rng;
    let log_uniform = |rng: &mut dyn Rng, low: f64, high: f64| rng.random_range(low.ln()..high.ln()).exp();
    // From errors that are a fraction of a cell to cells that are fractions of an error.
    let error_cells = log_uniform(rng, 0.2, 4.0);
    let sigma = [log_uniform(rng, 3.0, 20.0), rng.random_range(0.03_f64..0.3).to_radians()];
    let (range_m, period_s) = (rng.random_range(8e3..40e3), log_uniform(rng, 1.0, 8.0));
    let radar = Radar {
        period_s,
        sectors: 16,
        cell: [sigma[0] / error_cells, sigma[1] / error_cells, 0.0, 0.0],
        range_m: 60e3,
        pfa: if seed.is_multiple_of(2) { 0.0 } else { 1e-6 },
        error_cells,
        interval_mps: 0.0,
    };
    let speed_mps = (sigma[0] * rng.random_range(2.0..4.0) / period_s).min(20.0);
    let before_m = speed_mps * period_s * f64::from(MEETING);
    let beside_m = range_m * sigma[1] * rng.random_range(0.3..0.9);
    let target = |from_m, speed_mps| Target {
        from_m,
        velocity_mps: Vector3::new(0.0, speed_mps, 0.0),
        snr: 200.0,
        fluctuates: false,
    };
    let stands = target(Vector3::new(300.0, range_m, 0.0), 0.0);
    let passes = target(Vector3::new(300.0 + beside_m, range_m - before_m, 0.0), speed_mps);
    (radar, [stands, passes])
}

#[test]
fn targets_that_pass_keep_their_tracks() {
    let (mut kept, mut others) = (0, Vec::new());
    for seed in 0..PAIRS {
        let (radar, targets) = draw(seed);
        let observed = observe(&radar, &targets, &|_, _, _| Vec::new(), SCANS, seed);
        let mut confirmed = BTreeMap::<u32, BTreeSet<u64>>::new();
        for (scan, track) in follow(&TrackerConfig::default(), &observed.messages) {
            if track.is_confirmed() {
                confirmed.entry(scan).or_default().insert(track.id);
            }
        }
        let (before, after) = (&confirmed[&(MEETING - ABOUT)], &confirmed[&(SCANS - 2)]);
        kept += usize::from(before.len() == 2 && before == after);
        if after.len() > 2 {
            others.push(seed);
        }
    }
    assert!(
        kept >= 38 && others.is_empty(),
        "{kept} of {PAIRS} pairs kept their tracks; more than two: seeds {others:?}"
    );
}
