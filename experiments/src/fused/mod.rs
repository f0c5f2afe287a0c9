//! `fusion`: tracks of several radars against the truth: what fusion is worth, and what breaks it.
//!
//! - `rules`: rules that make one estimate of several (F6), by radars and manoeuvres, where it is known whose tracks they are.
//! - `association`: number of system tracks and wrong attachments with and without registration (F5), (F7), with wrong
//!   coordinates of the radars (F1), and in formations (F9).
//! - `classes`: the class of a target from several declarations (F10).

mod association;
mod classes;
mod page;
mod rules;

use fusion::Fusion;
use fusion::simulation::{Outcome, Score, World};

use crate::{Options, Progress, Results};

/// Runs all parts: 20 runs of each case.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(20, 2);
    progress.expect(u64::from(runs) * (rules::cases(options) + association::cases(options)) as u64);
    let mut results = Results { runs, ..Results::default() };
    rules::measure(options, runs, progress, &mut results);
    association::measure(options, runs, progress, &mut results);
    classes::measure(options, &mut results);
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// Lets a world go on for so many cycles; calls `after` at the end of each.
fn follow(world: &mut World, fusion: &mut Fusion, cycles: u32, mut after: impl FnMut(u32, &World, &Fusion)) {
    for cycle in 0..cycles {
        world.advance(|site, report| fusion.take(site, &report, report.time_ns));
        fusion.cycle(world.time_ns());
        after(cycle, world, fusion);
    }
}

/// Scores of the cycles from `settled` on, and what the last of them has come to.
fn scored(world: &mut World, fusion: &mut Fusion, settled: u32, cycles: u32) -> (Score, Outcome) {
    let (mut score, mut outcome) = (Score::default(), Outcome::default());
    follow(world, fusion, cycles, |cycle, world, fusion| {
        if cycle >= settled {
            outcome = score.take(world, fusion.system_tracks());
        }
    });
    (score, outcome)
}
