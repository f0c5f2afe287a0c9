//! The surface movement radar of an airport, with multilateration as truth: the scores of the recorder.
//!
//! Intervals are those of the bootstrap over pieces of five minutes, each scored alone; the figures are those of the whole.

use std::path::{Path, PathBuf};

use anyhow::Context;
use common::config::{ChainConfig, TrackerConfig};
use common::report::Tracking;
use common::units::NS_PER_S;
use evaluation::{Estimate, poisson};
use plot_source::Source;
use recorder::scoring::cooperative::Cooperative;
use tracker::Tracker;

use super::{AIRPORT, case, figure, preset, trackers};
use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Options, Progress, Results, Row};

const PRESET: &str = include_str!("../../../config/smr.toml");
/// Half a minute: whether it works.
const SHORT_RADAR: &[u8] = include_bytes!("../../../plot-source/tests/data/lebl-smr-30s.ast");
const SHORT_TRUTH: &[u8] = include_bytes!("../../../plot-source/tests/data/lebl-mlat-30s.ast");
/// The whole recordings, in the folder that is given.
const RADAR: &str = "lebl-smr-cat010.ast";
const TRUTH: &str = "lebl-mlat-cat010.ast";
/// Length of a piece, s.
const PIECE_S: f64 = 300.0;

pub(super) fn run(options: &Options, progress: &Progress, results: &mut Results) -> anyhow::Result<()> {
    let read = |folder: &PathBuf, name: &str| {
        let path = folder.join(name);
        std::fs::read(&path).with_context(|| format!("reading {}", path.display()))
    };
    let (radar, truth) = match &options.recordings {
        Some(folder) => (read(folder, RADAR)?, read(folder, TRUTH)?),
        None if options.quick => (SHORT_RADAR.to_vec(), SHORT_TRUTH.to_vec()),
        None => {
            let text = format!("The airport is left out: --recordings DIR names the folder of {RADAR} and {TRUTH}.");
            results.remarks.push(text);
            return Ok(());
        }
    };
    let chain = preset("config/smr.toml", PRESET)?;
    let trackers = trackers(&chain.tracker, options);
    progress.expect(trackers.len() as u64);
    progress.say(AIRPORT.into());
    let score = |run: u32| score(&chain, &trackers[run as usize].1, &radar, &truth);
    let scored: Vec<anyhow::Result<Vec<Tracking>>> = runs(options.threads, trackers.len() as u32, progress, score);
    for ((name, _), scored) in trackers.iter().zip(scored) {
        rows(name, options.seed, &scored?, &mut results.rows);
    }
    Ok(())
}

/// The scores of a tracker: of the whole, then of each piece.
fn score(chain: &ChainConfig, config: &TrackerConfig, radar: &[u8], truth: &[u8]) -> anyhow::Result<Vec<Tracking>> {
    let source = Source::decode(chain, (Path::new(RADAR), radar), Some((Path::new(TRUTH), truth)))?;
    let mut tracker = Tracker::new(config, 1)?;
    let new = || Cooperative::new(&chain.recorder.scoring);
    let (mut whole, mut pieces) = (new(), Vec::new());
    let (mut begin_ns, mut tracks) = (None, Vec::new());
    for scan in source {
        let begin_ns = *begin_ns.get_or_insert(scan.begin_ns);
        let piece = ((scan.begin_ns - begin_ns) as f64 / (PIECE_S * NS_PER_S)) as usize;
        pieces.resize_with(pieces.len().max(piece + 1), new);
        for (header, plots) in &scan.plots {
            let processed = tracker.process_plots(header, plots, &mut tracks);
            let tracks_header = tracker::process::header_of(header, &processed, 0, 0);
            for fold in [&mut whole, &mut pieces[piece]] {
                fold.see(header);
                fold.tracks(&tracks_header, &tracks);
            }
        }
        if let Some((header, targets)) = &scan.truth {
            whole.truth(header, targets);
            pieces[piece].truth(header, targets);
        }
    }
    Ok(std::iter::once(whole).chain(pieces).map(|mut fold| fold.finish()).collect())
}

fn rows(name: &str, seed: u64, scored: &[Tracking], rows: &mut Vec<Row>) {
    let (whole, pieces) = (&scored[0], &scored[1..]);
    let case = case(AIRPORT, name);
    let points = |piece: &Tracking| piece.truth_points.unwrap_or(0) as f64;
    let share = |of: fn(&Tracking) -> Option<f64>| {
        figure(pieces, seed, move |pieces| {
            let known = pieces.iter().filter(|piece| of(piece).is_some());
            let sums = known.fold([0.0; 2], |sums, piece| {
                [sums[0] + points(piece) * of(piece).unwrap_or(0.0), sums[1] + points(piece)]
            });
            sums[0] / sums[1]
        })
    };
    let total =
        |of: fn(&Tracking) -> f64| figure(pieces, seed, move |pieces| pieces.iter().map(|piece| of(piece)).sum());
    let about = |value: Option<f64>, interval: Estimate| {
        let value = value.unwrap_or(f64::NAN);
        Estimate { value, lo: interval.lo.min(value), hi: interval.hi.max(value), n: interval.n }
    };
    let hours = whole.truth_hours.unwrap_or(0.0);
    let never_near = poisson::per_hour(whole.false_tracks.unwrap_or(0), hours * 3600.0, LEVEL);
    for (metric, estimate) in [
        ("followed", about(whole.truth_share, share(|piece| piece.truth_share))),
        ("followed_on_ground", about(whole.truth_share_ground, share(|piece| piece.truth_share_ground))),
        ("distance_p50_m", about(whole.distance_p50_m, share(|piece| piece.distance_p50_m))),
        ("distance_p95_m", about(whole.distance_p95_m, share(|piece| piece.distance_p95_m))),
        (
            "changes",
            about(whole.id_changes.map(|changes| changes as f64), total(|piece| piece.id_changes.unwrap_or(0) as f64)),
        ),
        ("never_near_per_hour", never_near),
    ] {
        rows.push(Row::new(&case, metric, estimate));
    }
}
