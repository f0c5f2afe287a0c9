//! Trajectory B at 16 dB through simulated cells, the plot extractor and the whole tracker, step by step to drawn plots and the filter alone.
//!
//! Scored are the scans k = 10 … 50 in which *every* arm ([`arms::Arm`]) has a confirmed track within 150 m of the target: the same scans of the
//! same runs, each arm's own share of them is `p_followed`. Comparisons of neighbouring arms
//! (`compare.rs`) say what each step does. Two arms are *equivalent* if the whole 95 % interval lies within ± 5 % of no difference.

mod arms;
mod page;
mod radar;

use common::amplitude::Detector;
use common::config::{ChainConfig, Swerling};
use common::random::{Purpose, generator};
use evaluation::{Estimate, bootstrap};
use radar_sim::motion::Segments;

use super::{RESAMPLES, Score, compare, rows};
use crate::follow::Follower;
use crate::parallel::runs_with;
use crate::rows::LEVEL;
use crate::settings::Settings;
use crate::trajectory::{Segment, Trajectory};
use crate::world::{Conditions, place, sights};
use crate::{Case, Options, Progress, Results, Row, fluctuation};
use arms::{ARMS, Arm, Scores};

/// F per cell.
const PFA: [f64; 2] = [1e-4, 1e-3];
/// Kinds of targets.
const SWERLING: [Swerling; 2] = [Swerling::Zero, Swerling::One];
/// Peak SNR of the target, at the centre of a cell.
const SNR_DB: f64 = 16.0;
/// Arms that are compared.
const PAIRS: [(Arm, Arm, &str); 6] = [
    (Arm::Cells, Arm::Stated, "cells : stated"),
    (Arm::Stated, Arm::Nominal, "stated : nominal"),
    (Arm::Nominal, Arm::Unmapped, "nominal : unmapped"),
    (Arm::Unmapped, Arm::Alone, "unmapped : alone"),
    (Arm::Alone, Arm::Plots, "alone : plots"),
    (Arm::Cells, Arm::Plots, "cells : plots"),
];

/// One run by arm.
struct Run {
    /// Scores of all scans.
    scores: [Scores; ARMS],
    /// Detections from cells and drawn.
    detected: [u64; 2],
    /// Squared errors of the target's plots from cells over stated variances, the same weighted with these as a filter weighs them, and
    /// over nominal variances; [Σ, Σ weights] over plots and axes.
    plot_nees: [[f64; 2]; 3],
    /// Power above the threshold of the other plots near the target's range, over the mean that noise has by the header; [Σ, n].
    false_excess: [f64; 2],
}

pub(super) fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(400, 2);
    let mut results = Results { runs, ..Results::default() };
    let pfas = if options.quick { &PFA[..1] } else { &PFA };
    progress.expect(u64::from(runs) * (SWERLING.len() * pfas.len()) as u64);
    for swerling in SWERLING {
        for &pfa in pfas {
            progress.say(format!("Swerling {}, F = {pfa:e}", fluctuation::name(swerling)));
            let reference_cells = 2 * ChainConfig::default().extractor.reference_cells;
            let conditions = Conditions { pfa, reference_cells, snr_db: SNR_DB, swerling };
            let follower = || Follower::new(&Settings::Default.config(&conditions), &conditions);
            let all = runs_with(options.threads, runs, progress, follower, |follower, run| {
                one_run(follower, &conditions, options.seed, run)
            });
            let all = all.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
            results.rows.extend(rows_of(&conditions, &all, options.seed));
        }
    }
    results.remarks = page::verdict(&results.rows);
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

fn one_run(follower: &mut Follower, conditions: &Conditions, seed: u64, run: u32) -> anyhow::Result<Run> {
    let motion = Trajectory::B.motion(seed, run);
    let flight = radar::Flight::simulate(&motion, seed, run, conditions.swerling, conditions.pfa)?;
    let sights = sights(Trajectory::B, conditions, seed, run);
    let through = |arm| arms::through_tracker(arm, &flight, &motion, seed, run);
    let scores = [
        through(Arm::Cells)?,
        through(Arm::Stated)?,
        through(Arm::Nominal)?,
        through(Arm::Unmapped)?,
        arms::by_filter(follower, &arms::sights_of(&flight, &motion, seed, run), seed, run),
        arms::by_filter(follower, &sights, seed, run),
    ];
    let (plot_nees, false_excess) = plot_sums(&flight, &motion, &conditions.detector());
    let looks = flight.looks.iter().enumerate().filter(|&(index, look)| counted(index) && look.own.is_some());
    let drawn = sights.iter().enumerate().filter(|&(index, sight)| counted(index) && sight.detected);
    Ok(Run { scores, detected: [looks.count() as u64, drawn.count() as u64], plot_nees, false_excess })
}

/// Whether the scan of a turn is scored: turn 0 is k = −1.
fn counted(turn: usize) -> bool {
    Segment::SETTLED.holds((turn as u32).saturating_sub(1))
}

/// [`Run::plot_nees`] and [`Run::false_excess`] of the scored scans.
fn plot_sums(flight: &radar::Flight, motion: &Segments, detector: &Detector) -> ([[f64; 2]; 3], [f64; 2]) {
    let (mut nees, mut excess) = ([[0.0; 2]; 3], [0.0; 2]);
    let add = |sums: &mut [f64; 2], added: [f64; 2]| *sums = [sums[0] + added[0], sums[1] + added[1]];
    for (_, look) in flight.looks.iter().enumerate().filter(|&(turn, _)| counted(turn)) {
        let truth = place(&motion.at(look.time_s));
        for plot in flight.false_plots(look, &truth) {
            let above = f64::from(plot.statistic).powi(2) - detector.threshold;
            add(&mut excess, [above / detector.noise_mean_excess(), 1.0]);
        }
        let Some(plot) = look.own.map(|own| &look.plots[own]) else { continue };
        let errors = radar::errors(plot, &truth);
        let (stated, nominal) = (radar::stated_sigma(plot), flight.nominal_sigma());
        for i in 0..errors.len() {
            let square = |sigma: f64| (errors[i] / sigma).powi(2);
            let weight = (nominal[i] / stated[i]).powi(2);
            add(&mut nees[0], [square(stated[i]), 1.0]);
            add(&mut nees[1], [weight * square(stated[i]), weight]);
            add(&mut nees[2], [square(nominal[i]), 1.0]);
        }
    }
    (nees, excess)
}

fn rows_of(conditions: &Conditions, runs: &[Run], seed: u64) -> Vec<Row> {
    let case = |segment: &'static str, source: &'static str| {
        Case::new()
            .with("trajectory", "B")
            .with("settings", "default")
            .with("segment", segment)
            .with("source", source)
            .with("swerling", fluctuation::parameter(conditions.swerling))
            .with("pfa", conditions.pfa)
    };
    let settled = Segment::SETTLED;
    let trials = u64::from(settled.last - settled.first + 1);
    let mut all = Vec::new();
    for arm in Arm::ALL {
        let case = case(settled.name, arm.name());
        let detected: Vec<[u64; 2]> =
            runs.iter().map(|run| [run.detected[usize::from(arm == Arm::Plots)], trials]).collect();
        all.push(Row::clustered(&case, "pd", &detected));
        let followed =
            |run: &Run| run.scores[arm as usize].iter().flatten().filter(|score| settled.holds(score.k)).count();
        let followed: Vec<[u64; 2]> = runs.iter().map(|run| [followed(run) as u64, trials]).collect();
        all.push(Row::clustered(&case, "p_followed", &followed));
    }
    let n = runs.iter().map(|run| run.plot_nees[0][1]).sum::<f64>() as u64;
    for (metric, which) in [("plot_nees_stated", 0), ("plot_nees_weighted", 1), ("plot_nees_nominal", 2)] {
        let sums: Vec<[f64; 2]> = runs.iter().map(|run| run.plot_nees[which]).collect();
        let mut rng = generator(seed, Purpose::Resampling, which as u32, 2);
        let found = Estimate { n, ..bootstrap::ratio(&sums, RESAMPLES, LEVEL, &mut rng) };
        all.push(
            Row::new(&case(settled.name, Arm::Cells.name()), metric, found)
                .against(1.0, "errors as they are said to be"),
        );
    }
    let excess: Vec<[f64; 2]> = runs.iter().map(|run| run.false_excess).collect();
    let excess = bootstrap::ratio(&excess, RESAMPLES, LEVEL, &mut generator(seed, Purpose::Resampling, 3, 2));
    all.push(Row::new(&case(settled.name, Arm::Cells.name()), "false_excess", excess).against(1.0, "noise"));
    let common: Vec<[Vec<Score>; ARMS]> = runs.iter().map(common_scans).collect();
    let of = |arm: Arm| -> Vec<Vec<Score>> { common.iter().map(|run| run[arm as usize].clone()).collect() };
    let by_arm = Arm::ALL.map(of);
    let named = Trajectory::B.segments().into_iter().filter(|segment| segment.first >= settled.first);
    for (place, segment) in (0..).zip(std::iter::once(settled).chain(named)) {
        for arm in Arm::ALL {
            all.extend(rows(&case(segment.name, arm.name()), &by_arm[arm as usize], &segment, [seed, place]));
        }
        for (first, second, name) in PAIRS {
            let pair = [first, second].map(|arm| by_arm[arm as usize].as_slice());
            all.extend(compare::rows(&case(segment.name, name), pair, &segment, [seed, place]));
        }
    }
    all
}

/// The scores of each arm in the scans in which all have one.
fn common_scans(run: &Run) -> [Vec<Score>; ARMS] {
    let mut common: [Vec<Score>; ARMS] = Default::default();
    for index in 0..run.scores[0].len() {
        let of = |arm: Arm| run.scores[arm as usize].get(index).copied().flatten();
        if Arm::ALL.iter().all(|&arm| of(arm).is_some()) {
            for (scores, arm) in common.iter_mut().zip(Arm::ALL) {
                scores.extend(of(arm));
            }
        }
    }
    common
}
