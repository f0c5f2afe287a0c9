//! The tables of `docs/results/accuracy.md` on drawn plots.

use evaluation::{Estimate, contrast};

use super::compare::Verdict;
use super::runs::{PAIR, SETTINGS};
use crate::page::{Block, figure, find};
use crate::trajectory::{self, Trajectory};
use crate::{Row, trajectory::Segment};

/// Rows of the published table: what, metric, segment, decimals.
const PUBLISHED: [(&str, &str, &str, usize); 11] = [
    ("estimated position rms, m", "est_position_rms_m", "all", 2),
    ("predicted position rms, m", "pred_position_rms_m", "all", 2),
    ("velocity rms, m/s", "est_velocity_rms_mps", "all", 2),
    ("position NEES (3 if consistent)", "nees_position", "all", 2),
    ("correct mode, straight", "p_correct", "cv1", 3),
    ("correct mode, turn", "p_correct", "turn", 3),
    ("correct mode, straight again", "p_correct", "cv2", 3),
    ("correct mode, brake", "p_correct", "brake", 3),
    ("correct mode, hover", "p_correct", "hover", 3),
    ("correct mode, acceleration", "p_correct", "accelerate", 3),
    ("correct mode, straight at the end", "p_correct", "cv3", 3),
];

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![published(rows), segments(rows), trajectories(rows)]
}

fn of<'a>(rows: &'a [Row], metric: &str, trajectory: Trajectory, settings: &str, segment: &str) -> Option<&'a Row> {
    let case = [("trajectory", trajectory.name().into()), ("settings", settings.into()), ("segment", segment.into())];
    find(rows, metric, &case)
}

/// The metric of a comparison, and what "better" is judged by.
fn compared(metric: &str) -> &'static str {
    match metric {
        "est_position_rms_m" => "est_position_rms_ratio",
        "pred_position_rms_m" => "pred_position_rms_ratio",
        "est_velocity_rms_mps" => "est_velocity_rms_ratio",
        "p_correct" => "p_correct_difference",
        _ => "nees_position_excess",
    }
}

/// Figure minus reference, which is a sample too: of as many runs, so as uncertain, and rounded to a digit of `unit`.
pub(super) fn from_reference(row: &Row, reference: f64, unit: f64) -> Estimate {
    let sample = row.estimate();
    let shift = reference - sample.value;
    let rounding = 0.5 * unit;
    let other =
        Estimate { value: reference, lo: sample.lo + shift - rounding, hi: sample.hi + shift + rounding, ..sample };
    contrast::difference(&sample, &other)
}

/// B against the reference, and the default settings against the source's.
fn published(rows: &[Row]) -> Block {
    let lines: Vec<Vec<String>> = PUBLISHED
        .into_iter()
        .map(|(name, metric, segment, decimals)| {
            let source = of(rows, metric, Trajectory::B, SETTINGS[0].name(), segment);
            let reference = source.and_then(|row| row.reference);
            let difference = source
                .zip(reference)
                .map(|(row, reference)| Row::new(&row.case, "difference", from_reference(row, reference, 0.01)));
            let plain = source.map(|row| Row { reference: None, ..row.clone() });
            let pair = of(rows, compared(metric), Trajectory::B, PAIR, segment);
            vec![
                name.into(),
                reference.map_or("–".into(), |reference| format!("{reference:.2}")),
                figure(plain.as_ref(), decimals),
                figure(difference.as_ref(), decimals),
                figure(of(rows, metric, Trajectory::B, SETTINGS[1].name(), segment), decimals),
                figure(pair, 4),
                pair.map_or("–", |row| Verdict::of(row).name()).into(),
            ]
        })
        .collect();
    let head = [
        "B",
        "reference",
        "source settings",
        "minus reference",
        "default settings",
        "default against source",
        "default is",
    ];
    Block::table("accuracy-published", &head, &lines)
}

/// Every comparison on every segment of B.
fn segments(rows: &[Row]) -> Block {
    let metrics = [
        "est_position_rms_ratio",
        "pred_position_rms_ratio",
        "est_velocity_rms_ratio",
        "nees_position_excess",
        "p_correct_difference",
    ];
    let line = |segment: &Segment| {
        let cell = |metric: &str| {
            let row = of(rows, metric, Trajectory::B, PAIR, segment.name);
            format!("{} {}", figure(row, 3), row.map_or("", |row| Verdict::of(row).name()))
        };
        std::iter::once(segment.name.to_string()).chain(metrics.map(cell)).collect()
    };
    let lines: Vec<Vec<String>> = Trajectory::B.segments().iter().map(line).collect();
    let head = [
        "B, segment",
        "estimated position, ratio of rms",
        "predicted position",
        "velocity",
        "distance of NEES from 3, difference",
        "correct mode, difference",
    ];
    Block::table("accuracy-segments", &head, &lines)
}

/// All trajectories.
fn trajectories(rows: &[Row]) -> Block {
    let lines: Vec<Vec<String>> = trajectory::ALL
        .into_iter()
        .map(|trajectory| {
            let mut line = vec![trajectory.name().to_string()];
            for settings in SETTINGS {
                for metric in ["est_position_rms_m", "nees_position"] {
                    let row = of(rows, metric, trajectory, settings.name(), "all");
                    let plain = row.map(|row| Row { reference: None, ..row.clone() });
                    line.push(figure(plain.as_ref(), 2));
                }
            }
            line.push(figure(of(rows, "est_position_rms_ratio", trajectory, PAIR, "all"), 3));
            line.push(figure(of(rows, "nees_position_excess", trajectory, PAIR, "all"), 3));
            line
        })
        .collect();
    let head = [
        "trajectory",
        "source, rms, m",
        "NEES",
        "default, rms, m",
        "NEES",
        "rms, default over source",
        "distance of NEES from 3, default minus source",
    ];
    Block::table("accuracy-trajectories", &head, &lines)
}
