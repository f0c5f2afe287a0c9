//! `[budget]`: latency limits. A budget is broken when its percentile lies above its limit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, positive, require};
use crate::latency::{LATENCIES, LATENCY_NAMES};

/// Limits of one latency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Budget {
    /// Limit, µs: a scan with a value above it is over budget.
    pub limit_us: f64,
    /// Percentile that must not lie above it, 0 to 100.
    pub percentile: f64,
    /// Further limits, of the median, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p50_us: Option<f64>,
    /// Of the 90th percentile, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p90_us: Option<f64>,
    /// Of the 99th percentile, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p99_us: Option<f64>,
    /// Of the 99.9th percentile, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p999_us: Option<f64>,
}

/// A budget as written: what is not named keeps its default.
#[derive(Debug, Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct Written {
    limit_us: Option<f64>,
    percentile: Option<f64>,
    p50_us: Option<f64>,
    p90_us: Option<f64>,
    p99_us: Option<f64>,
    p999_us: Option<f64>,
}

impl Written {
    fn over(self, default: Budget) -> Budget {
        Budget {
            limit_us: self.limit_us.unwrap_or(default.limit_us),
            percentile: self.percentile.unwrap_or(default.percentile),
            p50_us: self.p50_us.or(default.p50_us),
            p90_us: self.p90_us.or(default.p90_us),
            p99_us: self.p99_us.or(default.p99_us),
            p999_us: self.p999_us.or(default.p999_us),
        }
    }
}

impl Budget {
    /// All percentiles with their limits, µs. A further limit of the same percentile takes the place of the first.
    pub fn limits(&self) -> impl Iterator<Item = (f64, f64)> {
        let percentile = self.percentile;
        let same = move |&(other, _): &(f64, f64)| (other - percentile).abs() < 1e-9;
        let first = self.further().find(same).unwrap_or((percentile, self.limit_us));
        std::iter::once(first).chain(self.further().filter(move |further| !same(further)))
    }

    /// The further limits, µs.
    pub fn further(&self) -> impl Iterator<Item = (f64, f64)> {
        let further = [(50.0, self.p50_us), (90.0, self.p90_us), (99.0, self.p99_us), (99.9, self.p999_us)];
        further.into_iter().filter_map(|(percentile, limit)| Some((percentile, limit?)))
    }
}

/// Limits of all latencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "WrittenBudgets")]
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

/// `[budget]` as written.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct WrittenBudgets {
    hop_dwells: Written,
    extract: Written,
    hop_plots: Written,
    track: Written,
    end_to_end: Written,
    scan: Written,
    record: Written,
}

impl From<WrittenBudgets> for BudgetConfig {
    fn from(written: WrittenBudgets) -> Self {
        let default = Self::default();
        Self {
            hop_dwells: written.hop_dwells.over(default.hop_dwells),
            extract: written.extract.over(default.extract),
            hop_plots: written.hop_plots.over(default.hop_plots),
            track: written.track.over(default.track),
            end_to_end: written.end_to_end.over(default.end_to_end),
            scan: written.scan.over(default.scan),
            record: written.record.over(default.record),
        }
    }
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
            for (percentile, limit) in budget.further() {
                let key = format!("budget.{name}.p{}_us", percentile.to_string().replace('.', ""));
                positive(&key, limit)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_written_keeps_its_default() {
        let config = |text: &str| toml::from_str::<BudgetConfig>(text).expect("valid");
        let budget = config("[track]\np999_us = 7000.0\n[scan]\nlimit_us = 1.0").all();
        let limits: Vec<_> = budget[3].limits().collect();
        assert_eq!(limits, [(99.0, 2000.0), (99.9, 7000.0)]);
        assert_eq!((budget[5].limit_us, budget[5].percentile), (1.0, 99.0));
        let replaced = config("[track]\np99_us = 7.0").all();
        assert_eq!(replaced[3].limits().collect::<Vec<_>>(), [(99.0, 7.0)]);
        assert!(toml::from_str::<BudgetConfig>("[track]\np98_us = 1.0").is_err());
    }
}
