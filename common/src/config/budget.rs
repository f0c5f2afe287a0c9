//! `[budget]`: latency limits. A budget is broken when its percentile lies above its limit.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, positive, require};
use crate::latency::{LATENCIES, LATENCY_NAMES};

/// Limits of one latency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Limit, µs: a scan with a value above it is a miss.
    pub limit_us: f64,
    /// Percentile that must not lie above it, 0 to 100.
    pub percentile: f64,
    /// Further limits, of the median, µs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p50_us: Option<f64>,
    /// Of the 90th percentile, µs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p90_us: Option<f64>,
    /// Of the 99th percentile, µs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p99_us: Option<f64>,
    /// Of the 99.9th percentile, µs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p999_us: Option<f64>,
}

impl Budget {
    /// All percentiles with their limits, µs.
    pub fn limits(&self) -> impl Iterator<Item = (f64, f64)> {
        let further = [(50.0, self.p50_us), (90.0, self.p90_us), (99.0, self.p99_us), (99.9, self.p999_us)];
        let further = further.into_iter().filter_map(|(percentile, limit)| Some((percentile, limit?)));
        std::iter::once((self.percentile, self.limit_us)).chain(further)
    }
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
        let p99 =
            |limit_us| Budget { limit_us, percentile: 99.0, p50_us: None, p90_us: None, p99_us: None, p999_us: None };
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
            for (percentile, limit) in budget.limits().skip(1) {
                let key = format!("budget.{name}.p{}_us", percentile.to_string().replace('.', ""));
                positive(&key, limit)?;
            }
        }
        Ok(())
    }
}
