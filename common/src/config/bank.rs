//! `[tracker.bank]` and `[tracker.bandwidth]`: filters of correlated acceleration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, positive, within};

/// How the hypotheses make one output (M3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OutputRule {
    /// All, by all scans.
    Bayes,
    /// The likeliest, by all scans.
    Standard,
    /// All, by the last scans.
    SlidingBayes,
    /// The likeliest, by the last scans.
    Sliding,
}

/// Several hypotheses on the mean acceleration of each coordinate: `multi-alternative` (M1)-(M3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BankConfig {
    /// q: hypotheses on each coordinate, 1 to 9 (M2).
    pub hypotheses: u32,
    /// a_max: the greatest acceleration along a coordinate, m/s².
    pub greatest_acceleration_mps2: f64,
    /// τ: correlation time of acceleration about its mean, s.
    pub correlation_time_s: f64,
    /// n: scans by which the sliding rules judge, 1 to 32.
    pub window_scans: u32,
    /// `bayes`, `standard` (by all scans), `sliding-bayes` or `sliding` (by the last ones) (M3).
    pub rule: OutputRule,
}

impl Default for BankConfig {
    fn default() -> Self {
        Self {
            hypotheses: 5,
            greatest_acceleration_mps2: 49.0,
            correlation_time_s: 3.0,
            window_scans: 4,
            rule: OutputRule::SlidingBayes,
        }
    }
}

impl BankConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        within("tracker.bank.hypotheses", self.hypotheses.into(), 1..=9)?;
        acceleration("tracker.bank.greatest_acceleration_mps2", self.greatest_acceleration_mps2)?;
        correlation("tracker.bank.correlation_time_s", self.correlation_time_s)?;
        within("tracker.bank.window_scans", self.window_scans.into(), 1..=32)
    }
}

/// Correlated acceleration of a bandwidth that adapts: `adaptive-bandwidth` (M4).
///
/// The defaults are the tuned form; the naive one has 3 s, 1 and 49 m/s², 2.8, 4 scans and no hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BandwidthConfig {
    /// τ: correlation time of acceleration, s.
    pub correlation_time_s: f64,
    /// The greatest acceleration along a coordinate, m/s².
    pub greatest_acceleration_mps2: f64,
    /// Standard deviation of acceleration in straight flight, m/s².
    pub narrow_mps2: f64,
    /// Standard deviation of acceleration in a manoeuvre, m/s².
    pub wide_mps2: f64,
    /// Mean of the last four squared normalised innovations from which a manoeuvre has begun.
    pub threshold: f64,
    /// Scans with an acceleration of less than its standard deviation after which a manoeuvre has ended.
    pub calm_scans: u32,
    /// Scans that a manoeuvre lasts before those count.
    pub hold_scans: u32,
}

impl Default for BandwidthConfig {
    fn default() -> Self {
        Self {
            correlation_time_s: 10.0,
            greatest_acceleration_mps2: 49.0,
            narrow_mps2: 3.0,
            wide_mps2: 24.5,
            threshold: 2.0,
            calm_scans: 10,
            hold_scans: 20,
        }
    }
}

impl BandwidthConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        correlation("tracker.bandwidth.correlation_time_s", self.correlation_time_s)?;
        acceleration("tracker.bandwidth.greatest_acceleration_mps2", self.greatest_acceleration_mps2)?;
        acceleration("tracker.bandwidth.narrow_mps2", self.narrow_mps2)?;
        acceleration("tracker.bandwidth.wide_mps2", self.wide_mps2)?;
        positive("tracker.bandwidth.threshold", self.threshold)?;
        within("tracker.bandwidth.calm_scans", self.calm_scans.into(), 1..=1000)?;
        within("tracker.bandwidth.hold_scans", self.hold_scans.into(), 0..=1000)
    }
}

/// Up to a thousand g.
fn acceleration(key: &str, value: f64) -> Result<(), ConfigError> {
    super::load::require(key, value, value > 0.0 && value <= 1e4, "a number above 0, at most 1e4")
}

fn correlation(key: &str, value: f64) -> Result<(), ConfigError> {
    super::load::require(key, value, (0.01..=1e4).contains(&value), "a number from 0.01 to 1e4")
}
