//! A target that appears: whether and when it is confirmed, and by how many tracks.

use common::geometry::Polar;
use common::random::{Purpose, generator};
use evaluation::gospa::MeanGospa;
use evaluation::initiation::delay_scans;
use nalgebra::Vector3;
use radar_sim::motion::Segments;
use rand::{Rng, RngExt};
use tracker::Tracker;

use super::rule::Rule;
use crate::judge::Judge;
use crate::turning::{CELL, PERIOD_S, Turning, Volume, passage_s};
use crate::world::Conditions;

/// Plots of half the errors of a single cell (C1), as interpolation has them at 15 dB.
pub(super) const RADAR: Turning = Turning { pfa: 0.0, sigma: [10.0, 0.000_87, 0.000_87, 5.0] };
/// Where there are false plots: 4.85 km × 45° × 2.8° × 208 m/s from 200 m on; it turns with the target.
pub(super) const VOLUME: Volume =
    Volume { middle: [200.0 + 35.0 * CELL[0], 0.0, 4.0 * CELL[2], 0.0], cells: [70, 130, 8, 6] };
/// First turn of the target: its predecessors make the false plots and their tracks usual.
const FIRST_SCAN: u32 = 8;
/// Turns in which it has to be confirmed.
pub(super) const WINDOW: u32 = 10;
/// Turns of a run.
const SCANS: u32 = 24;
/// Turns with a target.
pub(super) const WITH_TARGET: u32 = SCANS - FIRST_SCAN;
/// A track is the target's within this distance, m.
const NEAR_M: f64 = 200.0;

/// What one run with one rule has brought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    /// Scans until the target was followed by a confirmed track.
    pub(super) delay: Option<u64>,
    /// Duplicates of its track.
    pub(super) redundant: u64,
    /// Of target and tracks, from the first turn of the target.
    pub(super) gospa: MeanGospa,
}

/// All rules on the same plots.
pub(super) fn one_run(seed: u64, run: u32, conditions: &Conditions, rules: &[Rule]) -> anyhow::Result<Vec<Outcome>> {
    let radar = Turning { pfa: conditions.pfa, ..RADAR };
    let target = somewhere(&mut generator(seed, Purpose::Trajectory, run, 0));
    let turns: Vec<_> = (0..SCANS)
        .map(|scan| {
            let mut rng = generator(seed, Purpose::Measurement, run, scan);
            let seen = (scan >= FIRST_SCAN).then(|| radar.target(scan, &target, conditions, &mut rng));
            let mut plots: Vec<_> = seen.flatten().into_iter().collect();
            let mut volume = VOLUME;
            volume.middle[1] = Polar::from_enu(&target.at(passage_s(scan, &target)).position_m).azimuth_rad;
            radar.false_plots(scan, &volume, &mut rng, &mut plots);
            radar.messages(scan, scan + 1 == SCANS, &plots)
        })
        .collect();
    let outcome = |rule: &Rule| {
        let mut tracker = Tracker::new(&rule.config(), 1)?;
        let mut judge = Judge::new(NEAR_M);
        let (mut tracks, mut seen) = (Vec::new(), Vec::new());
        let mut followed = Vec::new();
        let mut gospa = MeanGospa::default();
        for (scan, turn) in (0..).zip(&turns) {
            seen.clear();
            for (header, plots) in turn {
                tracker.process_plots(header, plots, &mut tracks);
                seen.extend(tracks.iter().copied());
            }
            let there = if scan >= FIRST_SCAN { std::slice::from_ref(&target) } else { &[] };
            let verdict = judge.turn(&seen, there);
            if scan >= FIRST_SCAN {
                gospa.add(&verdict.gospa);
            }
            followed.push((scan >= FIRST_SCAN, verdict.tracks.first().is_some_and(Option::is_some)));
        }
        let delay = delay_scans(followed.into_iter().take((FIRST_SCAN + WINDOW) as usize));
        Ok(Outcome { delay, redundant: judge.redundant(), gospa })
    };
    rules.iter().map(outcome).collect()
}

/// A target at a random place in the volume, away from north and the edges, at 10…40 m/s in a random direction.
fn somewhere(rng: &mut impl Rng) -> Segments {
    let place = Polar {
        range_m: rng.random_range(1000.0..4000.0),
        azimuth_rad: rng.random_range(1.0..5.2),
        elevation_rad: VOLUME.middle[2],
    };
    let (speed, course) = (rng.random_range(10.0..40.0), rng.random_range(0.0..std::f64::consts::TAU));
    let velocity_mps = Vector3::new(speed * course.sin(), speed * course.cos(), 0.0);
    // At this place in its first turn.
    Segments::straight(place.to_enu() - velocity_mps * (f64::from(FIRST_SCAN) * PERIOD_S), velocity_mps)
}
