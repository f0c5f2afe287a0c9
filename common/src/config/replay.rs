//! `[replay]`: a recording in place of a radar.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};
use super::run::Source;
use crate::services::Topic;

/// What is replayed. Which scans, `[run]` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReplayConfig {
    /// The recording; the later parts of its run in the same folder follow it.
    pub file: String,
    /// `dwells`, `plots`, `tracks`, `truth`: what goes out again. The stages after them run.
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
    /// The topic that drives the chain: the last one in the order of processing, whose end the stages after it wait for.
    pub fn driving(&self) -> Topic {
        let stages = [Topic::Tracks, Topic::Plots, Topic::Dwells];
        stages.into_iter().find(|topic| self.topics.contains(topic)).unwrap_or(Topic::Plots)
    }

    /// The processes upstream of the recorder: the stages after the last replayed topic.
    pub(super) fn processes(&self) -> Vec<&'static str> {
        let mut processes = vec!["replay"];
        if !self.topics.contains(&Topic::Plots) && !self.topics.contains(&Topic::Tracks) {
            processes.push("plot-extractor");
        }
        if !self.topics.contains(&Topic::Tracks) {
            processes.push("tracker");
        }
        processes
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let drives = |topic: &Topic| matches!(topic, Topic::Dwells | Topic::Plots | Topic::Tracks);
        let valid = self.topics.iter().any(drives) && !self.topics.contains(&Topic::Health);
        let topics: Vec<&str> = self.topics.iter().map(|topic| topic.name()).collect();
        require("replay.topics", topics.join(","), valid, "dwells, plots or tracks, and truth if wanted")?;
        require("replay.of", "replay", self.of != Source::Replay, "radar-sim or plot-source")
    }
}
