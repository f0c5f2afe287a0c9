//! `real-recordings`: every filter on what real radars recorded, with the presets as they are.
//!
//! The ferry's recording is part of the project; those of the airport are given by `--recordings DIR` and left out without it
//! (`--quick` takes half a minute of them). Nothing here is chosen by a score: presets are read from `config/`, and the lag of the
//! ferry's time stamps, as the registration of the airport, is no property of a tracker.

mod airport;
mod ferry;
mod page;

use std::path::Path;

use common::config::{self, ChainConfig, Estimator, TrackerConfig};
use common::random::{Purpose, generator};
use evaluation::Estimate;
use evaluation::bootstrap;

use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results};

/// Resamples behind each interval.
const RESAMPLES: usize = 2000;
/// Names of the recordings.
const FERRY: &str = "ferry";
const AIRPORT: &str = "airport";
/// The tracker with none of a preset's keys.
const DEFAULTS: &str = "no preset";

/// Runs the experiment: every filter on every recording, and the tracker without a preset.
///
/// # Errors
/// A recording cannot be read.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let mut results = Results { runs: 1, ..Results::default() };
    ferry::run(options, progress, &mut results)?;
    airport::run(options, progress, &mut results)?;
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// A preset of the project.
fn preset(name: &str, text: &str) -> anyhow::Result<ChainConfig> {
    Ok(config::parse(Path::new(name), text, &[])?)
}

/// The trackers that are compared: all filters with the keys of a preset, and the tracker without any.
fn trackers(preset: &TrackerConfig, options: &Options) -> Vec<(String, TrackerConfig)> {
    let of = |estimator| (name(estimator), TrackerConfig { estimator, ..preset.clone() });
    let mut all: Vec<_> = options.some_of(&Estimator::ALL).into_iter().map(of).collect();
    all.push((DEFAULTS.into(), TrackerConfig::default()));
    all
}

/// As the configuration spells it.
fn name(estimator: Estimator) -> String {
    serde_json::to_value(estimator).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}

fn case(recording: &str, tracker: &str) -> Case {
    Case::new().with("recording", recording).with("tracker", tracker)
}

/// A figure of pieces of a recording, with its interval by the bootstrap over the pieces.
fn figure<T>(pieces: &[T], seed: u64, statistic: impl Fn(&[&T]) -> f64) -> Estimate {
    let mut rng = generator(seed, Purpose::Resampling, 0, 0);
    bootstrap::interval(pieces, RESAMPLES, LEVEL, &mut rng, statistic)
}
