//! `report.json`, schema 1: the contract with scripts.
//!
//! A value that a run has no means to measure (no truth, no cells) is `null`.

mod chain;
mod text;

pub use chain::{ChainReport, SCHEMA_OF_SITES, SitesReport};

use std::collections::BTreeMap;

use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

use crate::config::ChainConfig;
use crate::health::FalseAlarms;
use crate::recording::Gap;

/// Version of the layout; keys are only added within a version.
pub const SCHEMA: u32 = 1;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// Commit of the program; `unknown` outside a repository.
    pub git: String,
    /// The effective configuration.
    pub config: Option<ChainConfig>,
    /// Seed of every random draw.
    pub seed: u64,
    /// Scans that went through the whole chain.
    pub scans: u64,
    /// Wall-clock time from the first to the last message, s.
    pub wall_s: f64,
    /// Measurement time over wall-clock time.
    pub realtime_factor: f64,
    /// Whether results can be compared byte by byte with another run: lossless, nothing lost.
    pub comparable: bool,
    /// Messages lost, by topic and consumer.
    pub loss: BTreeMap<String, BTreeMap<String, u64>>,
    /// Messages that full queues of observers have discarded, by topic and observer. They cost the chain nothing.
    #[serde(default)]
    pub observers: BTreeMap<String, BTreeMap<String, u64>>,
    /// Messages, by topic.
    pub messages: BTreeMap<String, u64>,
    /// Percentiles of latencies, µs.
    pub latency_us: BTreeMap<String, Percentiles>,
    /// Latency limits.
    pub budget: BTreeMap<String, BudgetResult>,
    /// Plots against truth.
    pub detection: Detection,
    /// Tracks against truth.
    pub tracking: Tracking,
    /// Resources, by process.
    pub processes: BTreeMap<String, ProcessUse>,
    /// What was sent, received and lost, by topic and consumer.
    #[serde(default)]
    pub books: Vec<Book>,
    /// Scans with a latency above its limit, the first [`MISSES_LISTED`] of each latency.
    #[serde(default)]
    pub misses: Vec<Miss>,
    /// What a soak adds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub soak: Option<Soak>,
    /// The recording, if one was made: the last part of it.
    pub recording: Option<String>,
    /// Parts of the recording.
    #[serde(default)]
    pub parts: u32,
    /// Recordings removed to keep their total size within its limit.
    #[serde(default)]
    pub removed_recordings: u32,
    /// What is missing from the recording, the first thousand places.
    #[serde(default)]
    pub gaps: Vec<Gap>,
}

/// Percentiles of one latency, µs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Number of values.
    pub n: u64,
    /// Median.
    pub p50: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p999: f64,
    /// Largest value.
    pub max: f64,
}

/// One latency against its limit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BudgetResult {
    /// Limit, µs.
    pub limit_us: f64,
    /// Percentile that must not lie above it.
    pub percentile: f64,
    /// Scans with a value above the limit.
    pub misses: u64,
    /// Whether every percentile lies within its limit, as far as limits apply; `true` without values.
    pub ok: bool,
    /// Every percentile that has a limit.
    #[serde(default)]
    pub limits: Vec<LimitResult>,
}

/// One percentile against its limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct LimitResult {
    /// Percentile, 0 to 100.
    pub percentile: f64,
    /// Limit, µs.
    pub limit_us: f64,
    /// Its value, µs.
    pub value_us: f64,
    /// Whether the value lies within the limit.
    pub ok: bool,
    /// Whether the limit applies: at full speed queues are full by design, so only limits given for it do.
    #[serde(default = "applies")]
    pub applied: bool,
}

/// Limits of reports that do not say.
fn applies() -> bool {
    true
}

/// One topic as one consumer got it. Books balance when `received + lost = sent`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Book {
    /// Name of the topic.
    pub topic: String,
    /// Name of the consumer.
    pub consumer: String,
    /// Messages that publishers have counted. Of dwells, which nobody counts, positions of the schedule that have passed:
    /// those that a killed source never sent are among them.
    pub sent: u64,
    /// Messages received, as the consumer counts them.
    pub received: u64,
    /// Messages lost, from gap to gap.
    pub lost: u64,
}

impl Book {
    /// Whether everything sent was received or is known to be lost.
    pub fn balances(&self) -> bool {
        self.received + self.lost == self.sent
    }
}

/// Misses of one latency that are listed.
pub const MISSES_LISTED: usize = 200;

/// A scan with a latency above its limit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Miss {
    /// The scan.
    pub scan: u32,
    /// Name of the latency.
    pub latency: String,
    /// Its largest value in this scan, µs.
    pub us: f64,
    /// Its limit, µs.
    pub limit_us: f64,
}

/// What a soak adds to the report of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Soak {
    /// Whether budgets, loss and memory stayed within their limits.
    pub ok: bool,
    /// What did not, in words.
    pub findings: Vec<String>,
    /// Latencies over the run in equally long blocks, by name.
    pub blocks: BTreeMap<String, Blocks>,
    /// Private resident memory gained after warm-up, by process, MiB; not of processes that were restarted.
    pub growth_mib: BTreeMap<String, f64>,
    /// What could not be judged, and why, in words.
    #[serde(default)]
    pub not_judged: Vec<String>,
    /// The bare hop measured beside the run, by the latency it is compared with, µs.
    pub reference: BTreeMap<String, Percentiles>,
    /// Median of a hop over the median of the bare one, by latency.
    pub ratio_to_reference: BTreeMap<String, f64>,
}

/// One latency over the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    /// Middle of the block since the beginning, s.
    pub t_s: Vec<f64>,
    /// Median in the block, µs.
    pub p50: Vec<f64>,
    /// 99th percentile in the block, µs.
    pub p99: Vec<f64>,
    /// Largest value in the block, µs.
    pub max: Vec<f64>,
}

/// Plots against truth.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// Cells tested outside clutter and away from targets.
    pub cells: u64,
    /// Cells of those over threshold.
    pub false_alarm_cells: u64,
    /// Set probability of false alarm.
    pub pfa_set: Option<f64>,
    /// `false_alarm_cells / cells`.
    pub pfa_measured: Option<f64>,
    /// 95 % interval of `pfa_measured`, that of the Poisson distribution.
    pub pfa_interval: Option<[f64; 2]>,
    /// Mean probability of detection of the visible targets, from their signal-to-noise ratios.
    pub pd_expected: Option<f64>,
    /// Share of visible targets with a plot.
    pub pd_measured: Option<f64>,
    /// Plots.
    pub plots: u64,
    /// Plots found and left out, because their message was full.
    #[serde(default)]
    pub left_out: u64,
    /// Sights of visible targets that were too close to another to count in the shares and errors.
    pub unresolved: Option<u64>,
    /// Plots near no target (clutter included).
    pub false_plots: Option<u64>,
    /// Mean squared error over variance of plots of targets, by axis; 1 is right.
    pub normalised_error_squared: BTreeMap<String, f64>,
}

/// Tracks against truth.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Tracking {
    /// Targets that were confirmed or visible long enough for it.
    pub targets: Option<u64>,
    /// Those that were confirmed.
    pub confirmed: Option<u64>,
    /// Confirmed tracks that were never near a target.
    pub false_tracks: Option<u64>,
    /// Confirmed tracks that were, in some scan, near targets which all had other tracks: duplicates. They are not among the
    /// false ones.
    pub redundant_tracks: Option<u64>,
    /// How often a visible target's track was lost.
    pub lost: Option<u64>,
    /// Root mean square error of position of confirmed tracks, m.
    pub position_rmse_m: Option<f64>,
    /// Root mean square error of velocity of confirmed tracks, m/s.
    pub velocity_rmse_mps: Option<f64>,
    /// Normalised estimation error squared of position and velocity, over its dimensions; 1 is right.
    pub nees: Option<f64>,
    /// The same of position.
    pub nees_position: Option<f64>,
    /// Mean GOSPA distance per scan, m.
    pub gospa_m: Option<f64>,
    /// Mean part of the distances of targets and their tracks in GOSPA, m. Its square and those of the two below add up to that of the
    /// distance (for p = 2) in each scan, not in the mean.
    pub gospa_localisation_m: Option<f64>,
    /// Mean part of the targets without a track in GOSPA, m.
    pub gospa_missed_m: Option<f64>,
    /// Mean part of the tracks without a target in GOSPA, duplicates among them, m.
    pub gospa_false_m: Option<f64>,
    /// Cut-off distance c and order p of GOSPA.
    pub gospa_parameters: Option<[f64; 2]>,
    /// Mean probability that the tracks give to the true mode of motion, by mode.
    pub mode_probability: BTreeMap<String, f64>,
    /// Scans from the first sight of each target to its confirmation, by target.
    pub confirmation_scans: BTreeMap<String, u64>,
    /// Share of truth with a confirmed track within the gate (cooperative truth: moving ones near the radar).
    pub truth_share: Option<f64>,
    /// The same of aircraft on the ground.
    pub truth_share_ground: Option<f64>,
    /// Truth reports that counted.
    pub truth_points: Option<u64>,
    /// Median distance of track and truth, m.
    pub distance_p50_m: Option<f64>,
    /// 95th percentile of the distance of track and truth, m.
    pub distance_p95_m: Option<f64>,
    /// Changes of track number along a target.
    pub id_changes: Option<u64>,
    /// Confirmed tracks that were never near a target, per hour of truth.
    pub false_tracks_per_hour: Option<f64>,
    /// 95 % interval of `false_tracks_per_hour`, that of the Poisson distribution.
    pub false_tracks_per_hour_interval: Option<[f64; 2]>,
    /// Duplicates per hour of truth; not in `false_tracks_per_hour`.
    pub redundant_tracks_per_hour: Option<f64>,
    /// Hours of truth.
    pub truth_hours: Option<f64>,
    /// Dimensions of the state in `nees` and `nees_position`: 6 and 3, or 4 and 2 of a radar without elevation.
    #[serde(default)]
    pub nees_dimensions: Option<[u32; 2]>,
    /// The confirmed tracks themselves, with truth or without.
    #[serde(default)]
    pub tracks: Option<TrackSummary>,
}

/// Tracks that are listed.
pub const TRACKS_LISTED: usize = 200;

/// The confirmed tracks of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackSummary {
    /// Confirmed tracks.
    pub count: u64,
    /// Those alive at the end.
    pub alive: u64,
    /// Median time from confirmation to the last report, s.
    pub life_p50_s: f64,
    /// 95th percentile of that time, s.
    pub life_p95_s: f64,
    /// Share of looks at confirmed tracks with a plot.
    pub hit_share: f64,
    /// Those alive at the end, then those that have ended, the longest lives first: at most [`TRACKS_LISTED`].
    pub list: Vec<TrackLine>,
}

/// One confirmed track at its last report.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackLine {
    /// Number of the track.
    pub id: u64,
    /// Whether it was alive at the end.
    pub alive: bool,
    /// From confirmation to the last report, s.
    pub life_s: f64,
    /// Looks at it since its confirmation.
    pub looks: u64,
    /// Looks with a plot.
    pub hits: u64,
    /// East, north, up; m.
    pub position_m: [f64; 3],
    /// Distance from the antenna, m.
    pub range_m: f64,
    /// Clockwise from north, degrees.
    pub azimuth_deg: f64,
    /// Over ground, m/s.
    pub speed_mps: f64,
    /// Direction of motion, clockwise from north, degrees.
    pub course_deg: f64,
}

/// Resources of one process.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ProcessUse {
    /// Process identifier, of the last start.
    pub pid: u32,
    /// Processor time, s, of all starts.
    pub cpu_s: f64,
    /// Resident memory at the first report, MiB.
    pub rss_mib_start: f64,
    /// Resident memory at the last report, MiB.
    pub rss_mib_end: f64,
    /// Largest resident memory, MiB.
    pub rss_mib_max: f64,
    /// Starts after the first.
    pub restarts: u64,
    /// Input that was not used, by reason.
    pub rejected: BTreeMap<String, u64>,
    /// Open file descriptors at the last report.
    #[serde(default)]
    pub files: u32,
    /// Times that nothing came from upstream for longer than allowed.
    #[serde(default)]
    pub silences: u64,
    /// Steps that took longer than allowed.
    #[serde(default)]
    pub slow_steps: u64,
    /// Real-time wishes that the system has refused.
    #[serde(default)]
    pub refused: Vec<String>,
    /// False alarms per cell, where the process has measured them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub false_alarms: Option<FalseAlarms>,
}

impl Report {
    /// The report as `report.json`.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a report has only text keys");
        text.push('\n');
        text
    }

    /// Messages lost in all.
    pub fn lost(&self) -> u64 {
        self.loss.values().flat_map(BTreeMap::values).sum()
    }
}

impl Percentiles {
    /// Those of a histogram in ns.
    pub fn of(histogram: &Histogram<u64>) -> Self {
        if histogram.is_empty() {
            return Self::default();
        }
        let us = |quantile| histogram.value_at_quantile(quantile) as f64 / 1000.0;
        let max = histogram.max() as f64 / 1000.0;
        Self { n: histogram.len(), p50: us(0.5), p90: us(0.9), p99: us(0.99), p999: us(0.999), max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_keys_are_there() {
        let json: serde_json::Value = serde_json::from_str(&Report::default().to_json()).expect("JSON");
        let keys = |value: &serde_json::Value, wanted: &str| {
            for key in wanted.split(' ') {
                assert!(value.get(key).is_some(), "{key} is missing in {value}");
            }
        };
        keys(
            &json,
            "schema version git config seed scans wall_s realtime_factor loss latency_us budget detection tracking processes",
        );
        keys(
            &json["detection"],
            "cells false_alarm_cells pfa_set pfa_measured pd_expected pd_measured plots false_plots",
        );
        keys(
            &json["tracking"],
            "targets confirmed false_tracks lost position_rmse_m velocity_rmse_mps nees gospa_m mode_probability \
             truth_share distance_p50_m distance_p95_m id_changes",
        );
        keys(&serde_json::to_value(Percentiles::default()).expect("JSON"), "n p50 p90 p99 p999 max");
        keys(&serde_json::to_value(BudgetResult::default()).expect("JSON"), "limit_us percentile misses ok");
        keys(
            &serde_json::to_value(ProcessUse::default()).expect("JSON"),
            "pid cpu_s rss_mib_start rss_mib_end rss_mib_max restarts rejected",
        );
    }

    #[test]
    fn a_report_reads_back_and_has_a_text() {
        let mut report = Report { scans: 60, config: Some(ChainConfig::default()), ..Report::default() };
        report.latency_us.insert("end_to_end".into(), Percentiles { n: 5, p50: 300.0, ..Percentiles::default() });
        report.budget.insert(
            "end_to_end".into(),
            BudgetResult {
                limit_us: 5000.0,
                percentile: 99.0,
                misses: 0,
                ok: true,
                limits: vec![LimitResult {
                    percentile: 99.0,
                    limit_us: 5000.0,
                    value_us: 400.0,
                    ok: true,
                    applied: true,
                }],
            },
        );
        report.tracking.truth_share = Some(0.737);
        assert_eq!(serde_json::from_str::<Report>(&report.to_json()).expect("JSON"), report);
        let text = report.to_text();
        assert!(text.contains("60 scans") && text.contains("p99 ≤ 5000") && text.contains("73.70 %"), "{text}");
    }
}
