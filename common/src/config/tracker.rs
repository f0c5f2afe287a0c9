//! `[tracker]`: filters, association, life cycle.

use serde::{Deserialize, Serialize};

use super::load::ConfigError;

/// Tracking.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrackerConfig {}

impl TrackerConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }
}
