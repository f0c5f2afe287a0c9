//! Drawn plots: one in every scan, of the target alone.

use super::compare::{self, Verdict};
use super::figures;
use super::page::{self, from_reference};
use super::runs::{PAIR, Runs, SETTINGS};
use crate::follow::Follower;
use crate::parallel::runs_with;
use crate::trajectory;
use crate::world::{Conditions, sights};
use crate::{Case, Options, Progress, Results, Row};

pub(super) fn run(options: &Options, progress: &Progress) -> Results {
    let runs = options.runs_or(1000, 6);
    let trajectories = options.some_of(&trajectory::ALL);
    progress.expect(u64::from(runs) * (trajectories.len() * SETTINGS.len()) as u64);
    let mut results = Results { runs, ..Results::default() };
    let mut all = Vec::new();
    for trajectory in trajectories {
        for settings in SETTINGS {
            progress.say(format!("{}, {}", trajectory.name(), settings.name()));
            let conditions = Conditions::WITHOUT_CLUTTER;
            let follower = || Follower::new(&settings.config(&conditions), &conditions);
            let records = runs_with(options.threads, runs, progress, follower, |follower, run| {
                let mut records = Vec::new();
                let sights = sights(trajectory, &conditions, options.seed, run);
                follower.watch(&sights, options.seed, run, |record, _| records.push(record));
                records
            });
            let case = Runs { trajectory, settings, records };
            results.rows.extend(case.rows(options.seed));
            all.push(case);
        }
    }
    for pair in all.chunks_exact(SETTINGS.len()) {
        results.rows.extend(compared([&pair[1], &pair[0]], options.seed));
    }
    results.remarks = verdict(&results.rows);
    results.blocks = page::blocks(&results.rows);
    results.figures = figures::of(&all, options.seed);
    results
}

/// The first of two cases against the second, by segment.
fn compared(pair: [&Runs; 2], seed: u64) -> Vec<Row> {
    let [first, second] = pair.map(Runs::scores);
    let trajectory = pair[0].trajectory;
    let of_segment = |(place, segment): (u64, crate::trajectory::Segment)| {
        let case =
            Case::new().with("trajectory", trajectory.name()).with("settings", PAIR).with("segment", segment.name);
        compare::rows(&case, [&first, &second], &segment, [seed, place])
    };
    (0..).zip(trajectory.segments()).flat_map(of_segment).collect()
}

/// Which references are met, and whether the default settings are as good.
fn verdict(rows: &[Row]) -> Vec<String> {
    let name = |row: &Row| {
        let segment = row.case.get("segment").and_then(serde_json::Value::as_str).unwrap_or_default();
        format!("{segment} {}: {:.4} [{:.4}, {:.4}]", row.metric, row.value, row.lo, row.hi)
    };
    let compared: Vec<(&Row, f64)> = rows.iter().filter_map(|row| Some((row, row.reference?))).collect();
    let outside: Vec<String> = compared
        .iter()
        .filter(|&&(row, reference)| !from_reference(row, reference, 0.01).contains(0.0))
        .map(|(row, reference)| format!("\n  {} against {reference}", name(row)))
        .collect();
    let on_b = rows.iter().filter(|row| {
        row.case.get("trajectory") == Some(&"B".into()) && row.case.get("settings") == Some(&PAIR.into())
    });
    let judged: Vec<(&Row, Verdict)> =
        on_b.filter(|row| row.metric != "nees_position_difference").map(|row| (row, Verdict::of(row))).collect();
    let count = |verdict| judged.iter().filter(|(_, of)| *of == verdict).count();
    let worse: Vec<String> =
        judged.iter().filter(|(_, of)| *of == Verdict::Worse).map(|(row, _)| format!("\n  {}", name(row))).collect();
    vec![
        format!(
            "{} of {} references on B do not differ from their figure, both taken as samples of so many runs.{}",
            compared.len() - outside.len(),
            compared.len(),
            outside.concat()
        ),
        format!(
            "On B, run by run, the default settings are better than the source's in {} of {} rows, equal in {}, worse in {}.{}",
            count(Verdict::Better),
            judged.len(),
            count(Verdict::Equal),
            count(Verdict::Worse),
            worse.concat()
        ),
    ]
}
