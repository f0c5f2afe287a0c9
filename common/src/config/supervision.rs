//! `[supervision]`, `[watchdog]`: what happens when a stage dies, hangs, starves or falls behind.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require, seconds, seconds_or_none};

/// Restarting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SupervisionConfig {
    /// Restarts of one stage before the chain gives up.
    pub max_restarts: u32,
    /// Pause before a restart, s; doubled, up to 1 s, when a stage dies again within two seconds.
    pub backoff_s: f64,
    /// How long a stage may take to drain and end after the source has, s.
    pub drain_s: f64,
    /// A stage without a health report for this time is killed, s; 0 for never. In lossless mode only while all
    /// stages downstream of it report.
    pub hang_s: f64,
    /// The same for the recorder, which may wait for a disk, s; 0 for never.
    pub recorder_hang_s: f64,
}

impl Default for SupervisionConfig {
    fn default() -> Self {
        Self { max_restarts: 1000, backoff_s: 0.05, drain_s: 30.0, hang_s: 5.0, recorder_hang_s: 60.0 }
    }
}

impl SupervisionConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        seconds_or_none("supervision.backoff_s", self.backoff_s)?;
        seconds_or_none("supervision.drain_s", self.drain_s)?;
        // Processes speak once a second.
        let limits = [("supervision.hang_s", self.hang_s), ("supervision.recorder_hang_s", self.recorder_hang_s)];
        limits.into_iter().try_for_each(|(key, limit_s)| {
            require(key, limit_s, limit_s == 0.0 || (2.0..1e6).contains(&limit_s), "0 for never, or at least 2")
        })
    }
}

/// When a stage says that something is wrong with its input or with itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WatchdogConfig {
    /// Upstream is silent when nothing has come for so long, s.
    pub silence_s: f64,
    /// The stage is slow when it works for so long without catching up with its input, s.
    pub slow_s: f64,
}

impl Default for WatchdogConfig {
    fn default() -> Self {
        Self { silence_s: 3.0, slow_s: 1.0 }
    }
}

impl WatchdogConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        seconds("watchdog.silence_s", self.silence_s)?;
        seconds("watchdog.slow_s", self.slow_s)
    }
}
