//! The runs on drawn plots: their settings, their records, the rows that follow from them.

use super::{Score, rows};
use crate::follow::ScanRecord;
use crate::settings::Settings;
use crate::trajectory::Trajectory;
use crate::{Case, Row};

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

impl Runs {
    pub(super) fn scores(&self) -> Vec<Vec<Score>> {
        let score = |record: &ScanRecord| {
            let errors = [record.predicted_error_m, record.position_error_m, record.velocity_error_mps];
            Score::new(record.k, errors, record.nees_position, record.correct)
        };
        self.records.iter().map(|run| run.iter().map(score).collect()).collect()
    }

    pub(super) fn rows(&self, seed: u64) -> Vec<Row> {
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
