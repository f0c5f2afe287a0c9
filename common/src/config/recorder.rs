//! `[recorder]`: what is recorded, and where; how tracks are scored.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative, positive, require, within};

/// Recording and scoring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RecorderConfig {
    /// Whether a recording is written. The report is written in any case.
    pub record: bool,
    /// Folder of the recordings.
    pub directory: String,
    /// Where the report is written.
    pub report: String,
    /// Whether dwells are recorded too (10⁸ bytes per second on disk).
    pub dwells: bool,
    /// A chunk is closed at this size, KiB.
    pub chunk_kib: u32,
    /// A new part begins when one has reached this size, MiB, or half of `total_mib`; 0 = never.
    pub rotate_mib: u32,
    /// A new part begins when one is this old, s; 0 = never.
    pub rotate_s: u32,
    /// All recordings of the site in the folder together, MiB: the oldest are removed; 0 = no limit.
    pub total_mib: u32,
    /// `[recorder.scoring]`: how tracks are compared with truth.
    pub scoring: ScoringConfig,
}

impl Default for RecorderConfig {
    fn default() -> Self {
        Self {
            record: true,
            directory: "recordings".into(),
            report: "report.json".into(),
            dwells: false,
            chunk_kib: 768,
            rotate_mib: 256,
            rotate_s: 1800, // an index of one chunk a second stays below 1 MiB of memory
            total_mib: 0,
            scoring: ScoringConfig::default(),
        }
    }
}

/// When a track counts as following a target. The first group is for truth from cooperative
/// sensors, the second for simulated truth. Distances and times that are left out follow from the radar: a track may be three
/// resolution cells from its target, and half of the way that the target makes in a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ScoringConfig {
    /// Cooperative truth counts where it moves faster than this, m/s.
    pub speed_min_mps: f64,
    /// Cooperative truth counts within this range of the radar, m; left out: where it is visible to the radar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_max_m: Option<f64>,
    /// A confirmed track follows a cooperative target within this distance, m; left out: from the radar's cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gate_m: Option<f64>,
    /// A track is interpolated over gaps up to this, s; left out: 5 scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap_max_s: Option<f64>,
    /// A track is predicted past its last report up to this, s; left out: 2 scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold_max_s: Option<f64>,
    /// A confirmed track follows a simulated target within this distance, m; left out: from the radar's cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_gate_m: Option<f64>,
    /// Scans in which a simulated target has to be confirmed.
    pub confirm_scans: u32,
    /// Cut-off distance c of GOSPA, m; left out: half the distance at which tracks follow the first targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gospa_cutoff_m: Option<f64>,
    /// Order p of GOSPA.
    pub gospa_order: f64,
}

impl Default for ScoringConfig {
    fn default() -> Self {
        Self {
            speed_min_mps: 3.0,
            range_max_m: None,
            gate_m: None,
            gap_max_s: None,
            hold_max_s: None,
            target_gate_m: None,
            confirm_scans: 5,
            gospa_cutoff_m: None,
            gospa_order: 2.0,
        }
    }
}

impl RecorderConfig {
    /// Size at which a new part begins, MiB; 0 = never. Only whole parts can be removed, so none may take more than half
    /// of `total_mib`.
    pub fn part_mib(&self) -> u32 {
        let most = (self.total_mib / 2).max(u32::from(self.total_mib > 0));
        match (most, self.rotate_mib) {
            (0, rotate) => rotate,
            (most, 0) => most,
            (most, rotate) => rotate.min(most),
        }
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        within("recorder.chunk_kib", self.chunk_kib.into(), 16..=65_536)?;
        self.scoring.check()
    }
}

impl ScoringConfig {
    fn check(&self) -> Result<(), ConfigError> {
        not_negative("recorder.scoring.speed_min_mps", self.speed_min_mps)?;
        for (key, value) in [
            ("recorder.scoring.range_max_m", self.range_max_m),
            ("recorder.scoring.gate_m", self.gate_m),
            ("recorder.scoring.target_gate_m", self.target_gate_m),
            ("recorder.scoring.gospa_cutoff_m", self.gospa_cutoff_m),
        ] {
            value.map_or(Ok(()), |value| positive(key, value))?;
        }
        for (key, value) in
            [("recorder.scoring.gap_max_s", self.gap_max_s), ("recorder.scoring.hold_max_s", self.hold_max_s)]
        {
            value.map_or(Ok(()), |value| not_negative(key, value))?;
        }
        within("recorder.scoring.confirm_scans", self.confirm_scans.into(), 1..=1000)?;
        let valid = (1.0..=100.0).contains(&self.gospa_order);
        require("recorder.scoring.gospa_order", self.gospa_order, valid, "a number from 1 to 100")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_takes_at_most_half_of_the_total() {
        let part_mib =
            |rotate_mib, total_mib| RecorderConfig { rotate_mib, total_mib, ..RecorderConfig::default() }.part_mib();
        assert_eq!((part_mib(256, 0), part_mib(0, 0)), (256, 0));
        assert_eq!((part_mib(256, 100), part_mib(0, 100), part_mib(20, 100)), (50, 50, 20));
        assert_eq!((part_mib(256, 1), part_mib(256, 2), part_mib(0, 3)), (1, 1, 1));
    }
}
