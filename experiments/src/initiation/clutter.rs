//! False tracks: runs without a target, for as many hours as rates of a tenth in an hour need.
//!
//! False plots lie all around the antenna: eight sectors of the volume in which [`super::target`] looks, so that one turn of a second shows it
//! for eight. Rates are those of one such volume.

use std::collections::BTreeSet;

use common::random::{Purpose, generator};
use evaluation::{Estimate, poisson};
use tracker::Tracker;

use super::rule::Rule;
use super::target::{RADAR, VOLUME};
use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::turning::{PERIOD_S, Turning, Volume, seconds};
use crate::{Options, Progress};

/// Sectors of the volume around the antenna.
const SECTORS: u32 = 8;
/// Turns before tracks count: those that make false plots and clutter map usual.
const WARM_UP: u32 = 10;
/// Turns of a run after those.
const SCANS: u32 = 900;
const QUICK_SCANS: u32 = 30;
/// Runs for the usual number of targets: 2 hours of one volume each.
const STRICT_RUNS: u32 = 16;
const OTHER_RUNS: u32 = 1;

/// How much is seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    scans: u32,
    runs: [u32; 2],
}

impl Effort {
    /// `share` of the usual number of runs, at least one.
    pub(super) fn new(options: &Options, share: f64) -> Self {
        if options.quick {
            return Self { scans: QUICK_SCANS, runs: [1, 1] };
        }
        Self {
            scans: SCANS,
            runs: [STRICT_RUNS, OTHER_RUNS].map(|runs| (share * f64::from(runs)).ceil().max(1.0) as u32),
        }
    }

    /// Runs of a rule.
    fn runs(&self, rule: Rule) -> u32 {
        self.runs[usize::from(!rule.is_strict())]
    }

    /// Runs of any rule.
    pub(super) fn most_runs(&self) -> u32 {
        self.runs[0]
    }

    /// Hours of the volume that a rule sees.
    pub(super) fn hours(&self, rule: Rule) -> f64 {
        f64::from(self.runs(rule) * self.scans * SECTORS) * PERIOD_S / 3600.0
    }
}

/// False tracks an hour of each rule.
pub(super) fn rates(
    options: &Options,
    progress: &Progress,
    effort: &Effort,
    pfa: f64,
    rules: &[Rule],
) -> anyhow::Result<Vec<Estimate>> {
    let of_run = |run| one_run(options.seed, run, pfa, effort, rules);
    let counts = runs(options.threads, effort.most_runs(), progress, of_run);
    let mut all = vec![0; rules.len()];
    for run in counts {
        all.iter_mut().zip(run?).for_each(|(sum, count)| *sum += count);
    }
    let rate = |(rule, count): (&Rule, u64)| poisson::per_hour(count, effort.hours(*rule) * 3600.0, LEVEL);
    Ok(rules.iter().zip(all).map(rate).collect())
}

/// Tracks that each rule confirms, on the same plots; none of a rule whose runs are over.
fn one_run(seed: u64, run: u32, pfa: f64, effort: &Effort, rules: &[Rule]) -> anyhow::Result<Vec<u64>> {
    let radar = Turning { pfa, ..RADAR };
    let volume = Volume { cells: around(VOLUME.cells), ..VOLUME };
    let mut watched = Vec::new();
    for rule in rules {
        let tracker = (run < effort.runs(*rule)).then(|| Tracker::new(&rule.config(), 1)).transpose()?;
        watched.push((tracker, BTreeSet::new(), BTreeSet::new()));
    }
    let (mut plots, mut tracks) = (Vec::new(), Vec::new());
    let turns = WARM_UP + effort.scans;
    for scan in 0..turns {
        let mut rng = generator(seed, Purpose::Clutter, run, scan);
        plots.clear();
        radar.false_plots(scan, &volume, &mut rng, &mut plots);
        let messages = radar.messages(scan, scan + 1 == turns, &plots);
        for (tracker, before, confirmed) in &mut watched {
            let Some(tracker) = tracker else { continue };
            for (header, plots) in &messages {
                tracker.process_plots(header, plots, &mut tracks);
                for track in tracks.iter().filter(|track| track.is_confirmed()) {
                    let warm = seconds(track.time_ns) >= f64::from(WARM_UP) * PERIOD_S;
                    if !warm {
                        before.insert(track.id);
                    } else if !before.contains(&track.id) {
                        confirmed.insert(track.id);
                    }
                }
            }
        }
    }
    Ok(watched.into_iter().map(|(_, _, confirmed)| confirmed.len() as u64).collect())
}

/// The same volume in every direction.
fn around(cells: [u32; 4]) -> [u32; 4] {
    [cells[0], SECTORS * cells[1], cells[2], cells[3]]
}
