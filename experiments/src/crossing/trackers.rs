//! What users run: the whole tracker, which begins, confirms, shares out, merges and ends tracks by itself.
//!
//! The same flights, seen by a radar that turns. A drone is *lost* if no confirmed track follows it in three scans running once one
//! has, or at the end; it *changes* its track if another one follows it after the meeting than before: one exchanged with the
//! other drone, or a new one. Holders count only while the drones are so far apart that there is no doubt whose track is whose.

use common::config::TrackerConfig;
use common::random::{Purpose, generator};
use evaluation::identity::changes;
use evaluation::track_loss::first;
use radar_sim::motion::Segments;
use tracker::Tracker;

use super::course::{CONDITIONS, Course, FOLLOWS_M, SCANS, apart_m, paths, plots};
use super::outcome::Outcome;
use crate::follow::LOST_SCANS;
use crate::judge::Judge;
use crate::turning::{Turn, Turning, Volume, passage_s};
use crate::world::{SIGMA, offset, place};

/// The radar of \[L22\].
const RADAR: Turning = Turning { pfa: CONDITIONS.pfa, sigma: SIGMA };
/// Cells with false plots about the two: 1.7 km, 14°, 2.8° and 277 m/s.
const CELLS: [u32; 4] = [24, 40, 8, 8];
/// Scans until both are followed; distances count from here on.
const SETTLED: u32 = 10;

/// One run: first with independent tracks, then with joint events.
///
/// # Errors
/// If the tracker refuses its configuration.
pub(super) fn fly(course: Course, separation: f64, merged: bool, seed: u64, run: u32) -> anyhow::Result<[Outcome; 2]> {
    let drones = paths(course, separation);
    let turns: Vec<Turn> = (0..SCANS)
        .map(|scan| {
            let mut rng = generator(seed, Purpose::Measurement, run, scan);
            let times_s = [0, 1].map(|i: usize| passage_s(scan, &drones[i]));
            let mut seen = plots(&drones, times_s, merged, &mut rng);
            seen.retain(|seen| seen.power > CONDITIONS.detector().threshold);
            let mut all: Vec<_> = seen.iter().map(|seen| RADAR.plot(seen.time_s, &seen.polar, seen.power)).collect();
            let [a, b] = [0, 1].map(|i: usize| place(&drones[i].at(times_s[i])));
            let middle = std::array::from_fn(|i| b[i] + 0.5 * offset(a[i], b[i], i));
            RADAR.false_plots(scan, &Volume { middle, cells: CELLS }, &mut rng, &mut all);
            RADAR.messages(scan, scan + 1 == SCANS, &all)
        })
        .collect();
    let [independent, joint] = [false, true].map(|joint| {
        let config = TrackerConfig { joint_association: joint, ..TrackerConfig::default() };
        follow(&drones, &turns, &config)
    });
    Ok([independent?, joint?])
}

fn follow(drones: &[Segments; 2], turns: &[Turn], config: &TrackerConfig) -> anyhow::Result<Outcome> {
    let mut tracker = Tracker::new(config, 1)?;
    let mut judge = Judge::new(FOLLOWS_M);
    let mut outcome = Outcome::default();
    let (mut tracks, mut seen) = (Vec::new(), Vec::new());
    let mut errors_m = [Vec::new(), Vec::new()];
    let mut holders = [Vec::new(), Vec::new()];
    for (scan, turn) in (0..).zip(turns) {
        seen.clear();
        for (header, plots) in turn {
            tracker.process_plots(header, plots, &mut tracks);
            seen.extend(tracks.iter().copied());
        }
        let verdict = judge.turn(&seen, drones);
        if scan >= SETTLED {
            outcome.add(&verdict.ospa, &verdict.gospa);
        }
        let truth = [0, 1].map(|i: usize| drones[i].at(passage_s(scan, &drones[i])));
        let certain = apart_m(&truth) >= 2.0 * FOLLOWS_M;
        for (drone, track) in verdict.tracks.iter().enumerate() {
            if track.is_some() || !errors_m[drone].is_empty() {
                errors_m[drone].push(track.map_or(f64::NAN, |(_, distance_m)| distance_m));
            }
            holders[drone].push(track.map(|(id, _)| id).filter(|_| certain));
        }
    }
    let ends = |errors_m: &Vec<f64>| errors_m.last().is_none_or(|error_m| error_m.is_nan());
    outcome.lost = errors_m
        .iter()
        .any(|errors_m| ends(errors_m) || first(errors_m.iter().copied(), FOLLOWS_M, LOST_SCANS).is_some());
    outcome.changed = holders.into_iter().any(|holders| changes(holders) > 0);
    outcome.redundant = judge.redundant() > 0;
    Ok(outcome)
}
