//! `track-loss`: how often, and after how long, a track loses its target among false plots.
//!
//! One track, begun on two plots of its target, for 50 scans ([`crate::follow`]). `p_loss` is the source's measure: the target's
//! measured place, detected or not, outside the gate in use in three scans running, or more than 2000 false plots expected in the
//! gate; there the source gives the track up, and from then on only predicts. `mean_time_scans` are the scans until then, 50 if that
//! never comes. `p_error150` does not depend on gates: a position error of more than 150 m in three scans running.
//!
//! ```text
//! source settings     known noise, SNR and fluctuation: PDA with and without statistics, strongest, nearest
//! source, going on    the same, but a track whose target has left the gate goes on with whatever plots it meets
//! default settings    told neither SNR nor fluctuation; PDA (T20) and hypotheses (T21); every association with every gate rule
//! ```
//!
//! All cases see the same draws of each run: they differ from each other by less than their intervals say.

mod agreement;
mod cases;
mod claims;
mod figures;
mod page;

use crate::follow::{Fate, Follower};
use crate::parallel::runs_with;
use crate::trajectory::SCANS;
use crate::world::sights;
use crate::{Options, Progress, Results, Row};

pub use cases::Setting;

/// Metrics, as published.
const P_LOSS: &str = "p_loss";
const P_ERROR150: &str = "p_error150";
const MEAN_TIME: &str = "mean_time_scans";

/// One case and what became of its tracks, by run.
struct Case {
    setting: Setting,
    fates: Vec<Fate>,
}

/// Runs the experiment: 1000 runs in each case.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(1000, 2);
    let settings = cases::all(options);
    progress.expect(u64::from(runs) * settings.len() as u64);
    let mut results = Results { runs, ..Results::default() };
    let mut cases = Vec::new();
    for setting in settings {
        progress.say(setting.to_string());
        let conditions = setting.conditions();
        let follower = || Follower::new(&setting.config(), &conditions).going_on(setting.goes_on);
        let fates = runs_with(options.threads, runs, progress, follower, |follower, run| {
            follower.fate(&sights(setting.trajectory, &conditions, options.seed, run), options.seed, run)
        });
        let case = Case { setting, fates };
        results.rows.extend(rows(&case));
        cases.push(case);
    }
    results.remarks.extend(agreement::of(&results.rows, P_LOSS));
    results.remarks.extend(agreement::of(&results.rows, P_ERROR150));
    let verdict = results.remarks.clone();
    let claims = claims::of(&cases, options.seed);
    results.remarks.extend(claims.remarks);
    results.rows.extend(claims.rows);
    let costs = costs(options);
    let lines: Vec<String> = costs.iter().map(|(setting, us)| format!("\n  {setting}: {us:.1} µs")).collect();
    results
        .remarks
        .push(format!("Prediction and update of one track, median of the scans, on this computer:{}", lines.concat()));
    results.figures = figures::of(&cases);
    results.blocks = page::blocks(&results.rows, &costs, &verdict);
    Ok(results)
}

fn rows(case: &Case) -> [Row; 3] {
    let parameters = case.setting.case();
    let n = case.fates.len() as u64;
    let count = |of: fn(&Fate) -> bool| case.fates.iter().filter(|fate| of(fate)).count() as u64;
    let with = |row: Row, reference: Option<f64>| match reference {
        Some(reference) => row.against(reference, case.setting.reference_source()),
        None => row,
    };
    [
        with(
            Row::proportion(&parameters, P_LOSS, count(|fate| fate.lost_at.is_some()), n),
            case.setting.reference_loss(),
        ),
        with(Row::proportion(&parameters, P_ERROR150, count(|fate| fate.strayed), n), case.setting.reference_error()),
        Row::mean(&parameters, MEAN_TIME, case.fates.iter().map(|fate| f64::from(fate.scans()))),
    ]
}

/// Median time of a scan of one track, µs. It depends on the computer, so it is no row.
fn costs(options: &Options) -> Vec<(Setting, f64)> {
    let median = |setting: Setting| {
        let conditions = setting.conditions();
        let mut follower = Follower::new(&setting.config(), &conditions);
        let runs = options.runs_or(20, 1).min(20);
        let time =
            |run| follower.time_us(&sights(setting.trajectory, &conditions, options.seed, run), options.seed, run);
        let mut all: Vec<f64> = (0..runs).flat_map(time).collect();
        all.sort_unstable_by(f64::total_cmp);
        (setting, all.get(all.len() / 2).copied().unwrap_or(f64::NAN))
    };
    cases::timed(options).into_iter().map(median).collect()
}

/// Mean time to loss cannot exceed this.
const LONGEST: f64 = SCANS as f64;
