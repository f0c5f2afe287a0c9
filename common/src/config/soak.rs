//! `[soak]`: series and limits of a soak. `[metrics]`: address of the metrics.

use std::net::SocketAddr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative, require, seconds};

/// Limits of `radar-chain soak` beside the budgets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SoakConfig {
    /// Latency histograms and resources are written down this often, s.
    pub interval_s: f64,
    /// The first share of a run is warm-up: memory growth is measured from its end.
    pub warm_up: f64,
    /// Private resident memory that a process may gain after warm-up, MiB.
    pub growth_mib: f64,
    /// Where latency histograms by interval are written, in the log format of HdrHistogram; empty for nowhere.
    pub log: String,
    /// Messages that may be lost, all topics and consumers together.
    pub loss: u64,
}

impl Default for SoakConfig {
    fn default() -> Self {
        Self { interval_s: 5.0, warm_up: 0.1, growth_mib: 1.0, log: String::new(), loss: 0 }
    }
}

impl SoakConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        seconds("soak.interval_s", self.interval_s)?;
        let share = self.warm_up;
        require("soak.warm_up", share, (0.0..=0.5).contains(&share), "a share of the run from 0 to 0.5")?;
        not_negative("soak.growth_mib", self.growth_mib)
    }
}

/// Metrics in the text form that Prometheus reads.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MetricsConfig {
    /// Address and port, for example `127.0.0.1:9464`; empty for none. Port 0 takes a free one.
    pub listen: String,
}

impl MetricsConfig {
    /// Where to listen, if anywhere.
    pub fn address(&self) -> Option<SocketAddr> {
        self.listen.parse().ok()
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = self.listen.is_empty() || self.address().is_some();
        require("metrics.listen", &self.listen, valid, "an address and a port, for example 127.0.0.1:9464")
    }
}
