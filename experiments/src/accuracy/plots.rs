//! Drawn plots: one in every scan, of the target alone.

use super::compare::{self, Verdict};
use super::page::{self, from_reference};
use super::{Score, figures, rows};
use crate::follow::{Follower, ScanRecord};
use crate::parallel::runs_with;
use crate::settings::Settings;
use crate::trajectory::{self, Trajectory};
use crate::world::{Conditions, sights};
use crate::{Case, Options, Progress, Results, Row};

const REFERENCE: &str = "independent run of the source's form, 1000 runs";
/// The settings that are compared.
pub(super) const SETTINGS: [Settings; 2] = [Settings::Source, Settings::Default];

/// The same in a comparison.
pub(super) const PAIR: &str = "default : source";

/// The records of all runs of one case.
pub(super) struct Runs {
    pub(super) trajectory: Trajectory,
    pub(super) settings: Settings,
    pub(super) records: Vec<Vec<ScanRecord>>,
}

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

impl Runs {
    fn scores(&self) -> Vec<Vec<Score>> {
        let score = |record: &ScanRecord| {
            let errors = [record.predicted_error_m, record.position_error_m, record.velocity_error_mps];
            Score::new(record.k, errors, record.nees_position, record.correct)
        };
        self.records.iter().map(|run| run.iter().map(score).collect()).collect()
    }

    fn rows(&self, seed: u64) -> Vec<Row> {
        let scores = self.scores();
        let mut all = Vec::new();
        for (place, segment) in (0..).zip(self.trajectory.segments()) {
            let case = Case::new()
                .with("trajectory", self.trajectory.name())
                .with("settings", self.settings.name())
                .with("segment", segment.name);
            let is_published = self.trajectory == Trajectory::B && self.settings == Settings::Source;
            all.extend(rows(&case, &scores, &segment, [seed, place]).into_iter().map(|row| {
                match published(segment.name, row.metric) {
                    Some(value) if is_published => row.against(value, REFERENCE),
                    _ => row,
                }
            }));
        }
        all
    }
}

/// Published figures of B with the source's settings.
fn published(segment: &str, metric: &str) -> Option<f64> {
    Some(match (metric, segment) {
        ("pred_position_rms_m", "all") => 15.64,
        ("est_position_rms_m", "all") => 10.99,
        ("est_velocity_rms_mps", "all") => 5.03,
        ("nees_position", "all") => 2.80,
        ("p_correct", "cv1" | "hover") => 0.99,
        ("p_correct", "turn") => 0.79,
        ("p_correct", "cv2") => 0.84,
        ("p_correct", "brake") => 0.77,
        ("p_correct", "accelerate") => 0.82,
        ("p_correct", "cv3") => 0.94,
        _ => return None,
    })
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
