//! `[replay]`: a recording in place of a radar.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};
use super::run::Source;
use crate::topic::Topic;

/// What is replayed. Which scans, `[run]` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ReplayConfig {
    /// The recording; the later parts of its run in the same folder follow it.
    pub file: String,
    /// `dwells`, `plots`, `tracks`, `truth`: what goes out again. The stages after them run.
    #[schemars(with = "Vec<String>")]
    pub topics: Vec<Topic>,
    /// Source of the recorded run.
    pub of: Source,
}

impl Default for ReplayConfig {
    fn default() -> Self {
        Self { file: String::new(), topics: vec![Topic::Plots, Topic::Truth], of: Source::RadarSim }
    }
}

impl ReplayConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let drives = |topic: &Topic| matches!(topic, Topic::Dwells | Topic::Plots | Topic::Tracks);
        let valid = self.topics.iter().any(drives) && self.topics.iter().all(|topic| topic.is_data());
        let topics: Vec<&str> = self.topics.iter().map(|topic| topic.name()).collect();
        require("replay.topics", topics.join(","), valid, "dwells, plots or tracks, and truth if wanted")?;
        require("replay.of", "replay", self.of != Source::Replay, "radar-sim, plot-source or external")
    }
}
