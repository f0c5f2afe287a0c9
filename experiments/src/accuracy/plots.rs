//! Drawn plots: one in every scan, of the target alone.

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
    results.remarks = verdict(&results.rows);
    results.figures = figures::of(&all, options.seed);
    results
}

impl Runs {
    fn rows(&self, seed: u64) -> Vec<Row> {
        let score = |record: &ScanRecord| {
            let errors = [record.predicted_error_m, record.position_error_m, record.velocity_error_mps];
            Score::new(record.k, errors, record.nees_position, record.correct)
        };
        let scores: Vec<Vec<Score>> = self.records.iter().map(|run| run.iter().map(score).collect()).collect();
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
        format!("{segment} {}: {:.3} [{:.3}, {:.3}]", row.metric, row.value, row.lo, row.hi)
    };
    let compared: Vec<(&Row, f64)> = rows.iter().filter_map(|row| Some((row, row.reference?))).collect();
    // The reference has an error of its own, as large as that of the figure, and is rounded.
    let differs = |row: &Row, reference: f64| {
        let half = if reference > row.value { row.hi - row.value } else { row.value - row.lo };
        (reference - row.value).abs() > std::f64::consts::SQRT_2 * half + 0.005
    };
    let outside: Vec<String> = compared
        .iter()
        .filter(|(row, _)| row.agrees() == Some(false))
        .map(|&(row, reference)| {
            let far = if differs(row, reference) { "differs" } else { "no difference of two samples" };
            format!("\n  {} against {reference} ({far})", name(row))
        })
        .collect();
    let agreement = format!(
        "{} of {} references on B lie in the interval of their figure.{}",
        compared.len() - outside.len(),
        compared.len(),
        outside.concat()
    );
    let of = |settings: &'static str| {
        rows.iter().filter(move |row| {
            row.case.get("trajectory") == Some(&"B".into()) && row.case.get("settings") == Some(&settings.into())
        })
    };
    let worse: Vec<String> = of("source")
        .zip(of("default"))
        .filter(|(source, default)| match source.metric {
            "p_correct" => default.hi < source.lo,
            "nees_position" => false,
            _ => default.lo > source.hi,
        })
        .map(|(source, default)| format!("\n  {} against {:.3} of the source", name(default), source.value))
        .collect();
    let place = if worse.is_empty() { " nowhere." } else { ":" };
    vec![
        agreement,
        format!(
            "On B the default settings are worse than the source's, interval apart from interval,{place}{}",
            worse.concat()
        ),
    ]
}
