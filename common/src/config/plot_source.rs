//! `[plot_source]`: recordings of real radars.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, within};

/// Where real plots come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlotSourceConfig {
    /// Recording of the radar.
    pub file: String,
    /// Recording of a cooperative sensor, for scoring; empty for none.
    pub truth: String,
    /// Sectors in a scan.
    pub sectors_per_scan: u32,
}

impl Default for PlotSourceConfig {
    fn default() -> Self {
        Self { file: String::new(), truth: String::new(), sectors_per_scan: 32 }
    }
}

impl PlotSourceConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        within("plot_source.sectors_per_scan", self.sectors_per_scan.into(), 1..=1024)
    }
}
