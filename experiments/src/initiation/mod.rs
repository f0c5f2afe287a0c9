//! `initiation`: new targets confirmed in time against false tracks, for both logics of the tracker.
//!
//! The whole tracker is fed with the drawn plots of a turning radar ([`crate::turning`]).
//!
//! ```text
//! target     one target, which appears after 8 turns in a place drawn anew in every run, among false plots
//! clutter    false plots alone, all around, for hours
//! ```
//!
//! A target is *confirmed* if a confirmed track follows it, within 200 m, in one of its first 10 turns. A *redundant track* is one that is
//! within that distance while another one follows the target. A *false track* is one that is confirmed where there is no target at all. Three
//! things are swept, each value a point of a receiver curve: the threshold of existence that confirms, M of N, and, at the usual
//! threshold, the density of new targets that a pair of plots is weighed with before a track starts at all.
//!
//! All cases see the same targets and draws: they differ from each other by less than their intervals say, and may miss
//! their references together.
//!
//! The reference of M-of-N counts all sequences of hits and misses of the window that confirm, weighted by (C4): what
//! there would be without false plots and without errors of association.

mod clutter;
mod figure;
mod page;
mod reference;
mod rule;
mod target;

use common::amplitude::Detector;
use common::config::Swerling;
use common::units::from_db;
use evaluation::Estimate;
use serde_json::Value;

use crate::parallel::runs;
use crate::turning::PERIOD_S;
use crate::world::Conditions;
use crate::{Case, Options, Progress, Results, Row, fluctuation};
use rule::Rule;
use target::Outcome;

/// Mean signal-to-noise ratios, dB.
const SNR_DB: [f64; 3] = [10.0, 13.0, 16.0];
/// F per cell.
const PFA: [f64; 3] = [1e-5, 1e-4, 1e-3];
/// Kinds of targets.
const SWERLING: [Swerling; 2] = [Swerling::Zero, Swerling::One];
/// Runs with a target in each case.
const RUNS: u32 = 80;

/// Runs the experiment: 80 runs with a target in each case, and hours without.
///
/// # Errors
/// If the tracker refuses a threshold.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(RUNS, 2);
    let rules = rule::all(options);
    let (pfas, snrs) = (options.some_of(&PFA), options.some_of(&SNR_DB));
    let effort = clutter::Effort::new(options, f64::from(runs_of_each) / f64::from(RUNS));
    let cases = (SWERLING.len() * pfas.len() * snrs.len()) as u64;
    progress.expect(u64::from(runs_of_each) * cases + u64::from(effort.most_runs()) * pfas.len() as u64);
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    let mut rates = Vec::new();
    for &pfa in &pfas {
        progress.say(format!("without a target, F = {pfa:e}"));
        let of_rules = clutter::rates(options, progress, &effort, pfa, &rules)?;
        for (rule, rate) in rules.iter().zip(&of_rules) {
            results.rows.push(Row::new(&case(None, pfa, *rule), "false_tracks_per_hour", *rate));
        }
        rates.push(of_rules);
    }
    for swerling in SWERLING {
        for (&pfa, rates) in pfas.iter().zip(&rates) {
            for &snr_db in &snrs {
                let conditions = Conditions { pfa, reference_cells: 0, snr_db, swerling };
                progress.say(format!("Swerling {}, F = {pfa:e}, {snr_db} dB", fluctuation::name(swerling)));
                let of_run = |run| target::one_run(options.seed, run, &conditions, &rules);
                let outcomes = runs(options.threads, runs_of_each, progress, of_run);
                let outcomes = outcomes.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
                let points = points(&conditions, &rules, &outcomes, rates, &effort, &mut results.rows);
                let name = figure::new(&conditions, snrs.len());
                if results.figures.last().is_none_or(|last| last.name != name.name) {
                    results.figures.push(name);
                }
                let figure = results.figures.last_mut().expect("the figure of its kind of target");
                figure.panels.push(figure::panel(&conditions, &points));
            }
        }
    }
    let hours = |rule: Rule| effort.hours(rule);
    results.remarks.push(format!(
        "False tracks are those of 436,800 cells (45° × 2.8° × 4.85 km × 208 m/s) a scan of {PERIOD_S} s, without a target; seen for \
         {:.1} hours in each case with thresholds of existence from 0.5 on, for {:.1} hours with the other rules.",
        hours(Rule::USUAL[0]),
        hours(Rule::USUAL[1])
    ));
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// Rows of one case and what its figure shows.
fn points(
    conditions: &Conditions,
    rules: &[Rule],
    outcomes: &[Vec<Outcome>],
    rates: &[Estimate],
    effort: &clutter::Effort,
    rows: &mut Vec<Row>,
) -> Vec<figure::Point> {
    let mut points = Vec::new();
    for (place, (&rule, &rate)) in rules.iter().zip(rates).enumerate() {
        let of_rule: Vec<Outcome> = outcomes.iter().map(|run| run[place]).collect();
        let of_case = rows_of(conditions, rule, &of_rule);
        points.push((rule, of_case[0].estimate(), rate, effort.hours(rule).recip()));
        rows.extend(of_case);
    }
    points
}

fn case(conditions: Option<&Conditions>, pfa: f64, rule: Rule) -> Case {
    Case::new()
        .with("snr_db", conditions.map_or(Value::Null, |conditions| conditions.snr_db.into()))
        .with("pfa", pfa)
        .with("swerling", conditions.map_or(Value::Null, |conditions| fluctuation::parameter(conditions.swerling)))
        .with("logic", rule.logic())
        .with("confirm", rule.parameter())
}

fn rows_of(conditions: &Conditions, rule: Rule, outcomes: &[Outcome]) -> Vec<Row> {
    let n = outcomes.len() as u64;
    let case = case(Some(conditions), conditions.pfa, rule);
    let delays = || outcomes.iter().filter_map(|outcome| outcome.delay);
    let mut p_confirmed = Row::proportion(&case, "p_confirmed", delays().count() as u64, n);
    if let Rule::MOfN(m_of_n) = rule {
        let detector = Detector::new(conditions.pfa, 0);
        let pd = detector.target(conditions.swerling, from_db(conditions.snr_db)).detection_probability;
        let misses = rule.config().tentative_misses;
        let reference = reference::perfect_m_of_n(pd, m_of_n, misses);
        p_confirmed = p_confirmed.against(reference, "all sequences, perfect association");
    }
    let redundant = outcomes.iter().map(|outcome| outcome.redundant).sum();
    let seconds = n as f64 * f64::from(target::WITH_TARGET) * PERIOD_S;
    let mut rows = vec![
        p_confirmed,
        Row::mean(&case, "delay_scans", delays().map(|delay| delay as f64)),
        Row::per_hour(&case, "redundant_tracks_per_hour", redundant, seconds),
    ];
    rows.extend(Row::gospa(&case, &outcomes.iter().map(|outcome| &outcome.gospa).collect::<Vec<_>>()));
    rows
}
