//! `[run]`: what runs, how long and how fast.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::pace::Speed;

use super::load::{ConfigError, require, within};

/// Where plots come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// Simulated cells through the plot extractor.
    RadarSim,
    /// A real radar's recorded plots.
    PlotSource,
    /// A real radar's recorded video through the plot extractor.
    VideoSource,
    /// A recording of this program.
    Replay,
    /// The tracks of all other sites.
    Fusion,
    /// The same site on another host.
    Link,
    /// A program of the user's that publishes plots.
    External,
}

/// What a full queue does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// It blocks the publisher: results do not depend on the speed of the machine.
    Lossless,
    /// It drops the oldest message, counted: nothing ever blocks the source.
    RealTime,
}

impl Mode {
    /// As in the configuration and in the attribute of the services.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Lossless => "lossless",
            Mode::RealTime => "real-time",
        }
    }
}

/// What runs, how long and how fast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RunConfig {
    /// `radar-sim`, `plot-source`, `video-source`, `replay`, `fusion`: the tracks of all other sites, `link`: the same site on another
    /// host, or `external`: a program of the user's.
    pub source: Source,
    /// `lossless` or `real-time`.
    pub mode: Mode,
    /// Number of the last scan plus one; 0 runs until stopped or to the end of the recording.
    pub scans: u32,
    /// First scan; a source that was restarted goes on here.
    pub first_scan: u32,
    /// Number of the first track; a tracker that was restarted counts on from above all earlier ones.
    pub first_track: u64,
    /// Name of the run, in the names of recordings; empty for the time of its start.
    pub id: String,
    /// Times real time, or `"max"`.
    #[schemars(with = "f64")]
    pub speed: Speed,
    /// Seed of every random draw.
    pub seed: u64,
    /// Measurement time of the first scan, s since 1970 (UTC).
    pub epoch_s: u64,
    /// Whether another site fuses the tracks of this one.
    #[serde(skip)]
    pub fused: bool,
}

impl Default for RunConfig {
    fn default() -> Self {
        Self {
            source: Source::RadarSim,
            mode: Mode::Lossless,
            scans: 60,
            first_scan: 0,
            first_track: 1,
            id: String::new(),
            speed: Speed::Times(1.0),
            seed: 1,
            epoch_s: 1_767_225_600,
            fused: false,
        }
    }
}

impl RunConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        if let Speed::Times(factor) = self.speed {
            let valid = (1e-6..=1e6).contains(&factor);
            require("run.speed", factor, valid, "`max` or a number from 1e-6 to 1e6")?;
        }
        within("run.epoch_s", self.epoch_s, 0..=10_000_000_000)
    }
}
