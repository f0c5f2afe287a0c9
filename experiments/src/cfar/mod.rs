//! `cfar`: false alarms and detections of the extractor's detectors in the simulator's noise, against theory.
//!
//! - [`false_alarms`]: share of noise cells over threshold against the set F, and how far they exceed it.
//! - [`variants`]: the same share for all detectors, and at the edge of clutter.
//! - [`detection`]: share of targets over threshold against (C4), for Swerling 0, I and III.
//!
//! Everything random is the simulator's (`radar_sim::noise`, `echo`, `fluctuation`), every threshold the extractor's
//! (`plot_extractor::cfar`), every reference `common::amplitude`, whose formulas `docs/theory/amplitude.md` derives.

pub mod detection;
pub mod false_alarms;
pub mod variants;

use crate::{Options, Progress, Results};

/// Guard cells on each side, as in the default configuration.
const GUARD: usize = 2;

/// Runs all parts: 1000 runs of 131,072 noise cells, with one detector and with all, and of 16 targets in each case.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(1000, 4);
    progress.expect(3 * u64::from(runs));
    let mut results = Results { runs, ..Results::default() };
    progress.say("noise".into());
    false_alarms::measure(options, runs, progress, &mut results);
    progress.say("other detectors".into());
    variants::measure(options, runs, progress, &mut results);
    progress.say("targets".into());
    detection::measure(options, runs, progress, &mut results);
    Ok(results)
}
