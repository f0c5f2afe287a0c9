//! `[budget]`: latency limits. A budget is broken when its percentile lies above its limit.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, positive, require};
use crate::latency::{LATENCIES, LATENCY_NAMES};

/// Limit of one latency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Limit, µs.
    pub limit_us: f64,
    /// Percentile that must not lie above it, 0 to 100.
    pub percentile: f64,
}

/// Limits of all latencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BudgetConfig {
    /// Dwell published → extractor received it.
    pub hop_dwells: Budget,
    /// Last dwell of a sector received → its plots published.
    pub extract: Budget,
    /// Plots published → tracker received them.
    pub hop_plots: Budget,
    /// Plots received → tracks of that sector published.
    pub track: Budget,
    /// Last dwell of a sector published → its tracks published.
    pub end_to_end: Budget,
    /// Last dwell of a scan published → last tracks of that scan published.
    pub scan: Budget,
    /// Tracks published → tracks in the recording buffer.
    pub record: Budget,
}

impl Default for BudgetConfig {
    fn default() -> Self {
        let p99 = |limit_us| Budget { limit_us, percentile: 99.0 };
        Self {
            hop_dwells: p99(1000.0),
            extract: p99(1000.0),
            hop_plots: p99(1000.0),
            track: p99(2000.0),
            end_to_end: p99(5000.0),
            scan: p99(5000.0),
            record: p99(20_000.0),
        }
    }
}

impl BudgetConfig {
    /// All budgets, in the order of [`crate::latency::Latency`].
    pub fn all(&self) -> [Budget; LATENCIES] {
        [self.hop_dwells, self.extract, self.hop_plots, self.track, self.end_to_end, self.scan, self.record]
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        for (name, budget) in LATENCY_NAMES.iter().zip(self.all()) {
            positive(&format!("budget.{name}.limit_us"), budget.limit_us)?;
            let valid = budget.percentile > 0.0 && budget.percentile <= 100.0;
            let key = format!("budget.{name}.percentile");
            require(&key, budget.percentile, valid, "a percentile above 0, at most 100")?;
        }
        Ok(())
    }
}
