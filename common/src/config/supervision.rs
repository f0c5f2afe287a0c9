//! `[supervision]`: what happens when a stage dies.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative};

/// Restarting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SupervisionConfig {
    /// Restarts of one stage before the chain gives up.
    pub max_restarts: u32,
    /// Pause before a restart, s; doubled when a stage dies again within ten seconds.
    pub backoff_s: f64,
    /// How long a stage may take to drain and end after the source has, s.
    pub drain_s: f64,
}

impl Default for SupervisionConfig {
    fn default() -> Self {
        Self { max_restarts: 1000, backoff_s: 0.05, drain_s: 30.0 }
    }
}

impl SupervisionConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        not_negative("supervision.backoff_s", self.backoff_s)?;
        not_negative("supervision.drain_s", self.drain_s)
    }
}
