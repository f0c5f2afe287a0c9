//! `track-loss`: how often, and after how long, a track loses its target among false plots.
//!
//! One track, begun on two plots of its target, for 50 scans ([`crate::follow`]). `p_loss` is the source's measure: the target's
//! measured place, detected or not, outside the gate in use in three scans running, or more than 2000 false plots expected in the
//! gate; there the source gives the track up, and from then on only predicts. `mean_time_scans` are the scans until then, 50 if that
//! never comes. `p_error150` does not depend on gates: a position error of more than 150 m in three scans running.
//!
//! ```text
//! source settings     known noise, SNR and fluctuation: PDA with and without statistics, strongest, nearest
//! default settings    told neither SNR nor fluctuation; PDA (T20) and hypotheses (T21)
//! ```
//!
//! All cases see the same draws of each run: they differ from each other by less than their intervals say.

mod cases;
mod claims;
mod figures;

use std::collections::BTreeMap;

use evaluation::proportion::wilson;
use evaluation::simultaneous::sidak;

use crate::follow::{Fate, Follower};
use crate::parallel::runs_with;
use crate::rows::LEVEL;
use crate::trajectory::SCANS;
use crate::world::sights;
use crate::{Options, Progress, Results, Row};

pub use cases::Setting;

/// Metrics, as published.
const P_LOSS: &str = "p_loss";
const P_ERROR150: &str = "p_error150";
const MEAN_TIME: &str = "mean_time_scans";

/// Runs behind the references of the source's form.
const REFERENCE_RUNS: f64 = 1000.0;

/// One case and what became of its tracks, by run.
struct Case {
    setting: Setting,
    fates: Vec<Fate>,
}

/// Runs the experiment: 1000 runs in each case, 300 with hypotheses.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let usual = options.runs_or(1000, 2);
    let runs_of = |setting: &Setting| options.runs_or(if setting.is_mht() { 300 } else { 1000 }, 2);
    let settings = cases::all(options);
    progress.expect(settings.iter().map(|setting| u64::from(runs_of(setting))).sum());
    let mut results = Results { runs: usual, ..Results::default() };
    let mut cases = Vec::new();
    for setting in settings {
        progress.say(setting.to_string());
        let conditions = setting.conditions();
        let follower = || Follower::new(&setting.config(), &conditions);
        let fates = runs_with(options.threads, runs_of(&setting), progress, follower, |follower, run| {
            follower.fate(&sights(setting.trajectory, &conditions, options.seed, run), options.seed, run)
        });
        let case = Case { setting, fates };
        results.rows.extend(rows(&case));
        cases.push(case);
    }
    results.remarks.extend(agreement(&results.rows, P_LOSS));
    results.remarks.extend(agreement(&results.rows, P_ERROR150));
    let claims = claims::of(&cases, options.seed);
    results.remarks.extend(claims.remarks);
    results.rows.extend(claims.rows);
    results.remarks.push(cost(options));
    results.figures = figures::of(&cases);
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

/// Whether all referenced figures of a metric agree at once, by groups of settings. Two readings: the reference within the
/// joint interval of the figure, as if it were exact; and the difference of the two, both of so many runs.
fn agreement(rows: &[Row], metric: &str) -> Vec<String> {
    let mut groups: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.metric == metric && row.reference.is_some()) {
        let text = |key| row.case.get(key).and_then(serde_json::Value::as_str).unwrap_or_default();
        let filter = if text("association") == "mht" { "mht" } else { text("settings") };
        groups.entry(filter.to_string()).or_default().push(row);
    }
    groups.into_iter().map(|(group, rows)| compare(&group, metric, &rows)).collect()
}

fn compare(group: &str, metric: &str, rows: &[&Row]) -> String {
    let level = sidak(LEVEL, rows.len());
    let z = evaluation::quantile::two_sided(level);
    let mut outside = Vec::new();
    let mut different = 0;
    for row in rows {
        let reference = row.reference.unwrap_or(f64::NAN);
        let n = row.n as f64;
        let joint = wilson((row.value * n).round() as u64, row.n, level);
        if joint.contains(reference) {
            continue;
        }
        let pooled = (row.value * n + reference * REFERENCE_RUNS) / (n + REFERENCE_RUNS);
        let deviation = (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / REFERENCE_RUNS)).sqrt();
        let differs = (row.value - reference).abs() > z * deviation;
        different += u32::from(differs);
        let values: Vec<String> = row.case.iter().map(|(_, value)| value.to_string().replace('"', "")).collect();
        outside.push(format!(
            "{}: {:.3} [{:.3}, {:.3}] against {reference:.3}{}",
            values.join(" "),
            row.value,
            joint.lo,
            joint.hi,
            if differs { "" } else { " (no difference of two samples)" }
        ));
    }
    let mut text = format!(
        "{metric}, {group}: {} of {} references lie in the joint 95 % interval ({:.2} % each); of the others {different} \
         differ if the reference, too, is taken as a share of {REFERENCE_RUNS} runs.",
        rows.len() - outside.len(),
        rows.len(),
        100.0 * level
    );
    for line in outside {
        text += "\n  ";
        text += &line;
    }
    text
}

/// Median time of a scan of one track with each association. It depends on the computer, so it is no row.
fn cost(options: &Options) -> String {
    let costs: Vec<String> = cases::timed()
        .iter()
        .map(|setting| {
            let conditions = setting.conditions();
            let mut follower = Follower::new(&setting.config(), &conditions);
            let runs = options.runs_or(20, 1).min(20);
            let mut all: Vec<f64> = (0..runs)
                .flat_map(|run| {
                    follower.time_us(&sights(setting.trajectory, &conditions, options.seed, run), options.seed, run)
                })
                .collect();
            all.sort_unstable_by(f64::total_cmp);
            format!("\n  {setting}: {:.1} µs", all.get(all.len() / 2).copied().unwrap_or(f64::NAN))
        })
        .collect();
    format!("Prediction and update of one track, median of the scans, on this computer:{}", costs.concat())
}

/// Mean time to loss cannot exceed this.
const LONGEST: f64 = SCANS as f64;
