//! `estimators`: every filter on drones, ships and aircraft, on the same certain plots: errors and consistency.
//!
//! Settings are those of the kind of target, the same for all of its scenarios (`scenarios.rs`). `position_m` and `velocity_mps` are the rms
//! over runs and scans of the whole error, `nees` the mean of the normalised squared error of position over its dimensions (1 if
//! consistent). Ratios are to the best filter of the scenario.

mod page;
mod scenarios;

use common::config::{Estimator, TrackerConfig};
use common::random::{Purpose, generator};
use evaluation::bootstrap;
use nalgebra::{DMatrix, DVector};
use tracker::association::one_track::OneTrack;
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::{TwoPlots, family};

use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results, Row};
use scenarios::Scenario;

/// Resamples behind each interval.
const RESAMPLES: usize = 400;
const POSITION: &str = "position_m";
const VELOCITY: &str = "velocity_mps";
const NEES: &str = "nees";

/// Squared errors of position and velocity and NEES over its dimensions: means of one run.
type Means = [f64; 3];

/// Runs the experiment: 100 runs of each filter on each scenario.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(100, 2);
    let scenarios = options.some_of(&scenarios::all());
    progress.expect((scenarios.len() * Estimator::ALL.len()) as u64 * u64::from(runs_of_each));
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    for scenario in scenarios {
        for estimator in Estimator::ALL {
            progress.say(format!("{}, {}", scenario.name(), name(estimator)));
            let config = TrackerConfig { estimator, ..scenario.config() };
            let means =
                runs(options.threads, runs_of_each, progress, |run| follow(&scenario, &config, options.seed, run));
            let case = Case::new().with("scenario", scenario.name()).with("estimator", name(estimator));
            let mut rng = generator(options.seed, Purpose::Resampling, 0, 0);
            for (which, metric) in [(0, POSITION), (1, VELOCITY), (2, NEES)] {
                let estimate = bootstrap::interval(&means, RESAMPLES, LEVEL, &mut rng, |drawn| {
                    let mean = drawn.iter().map(|run| run[which]).sum::<f64>() / drawn.len() as f64;
                    if metric == NEES { mean } else { mean.sqrt() }
                });
                results.rows.push(Row::new(&case, metric, estimate));
            }
        }
    }
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// As the configuration spells it.
fn name(estimator: Estimator) -> String {
    serde_json::to_value(estimator).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}

fn follow(scenario: &Scenario, config: &TrackerConfig, seed: u64, run: u32) -> Means {
    let axes = scenario.axes();
    let scenarios::Run { step_s, truth, plots } = scenario.run(seed, run);
    let mut track = OneTrack::new(family(config, &scenario.radar(), step_s));
    track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s });
    let (mut sums, mut counted) = ([0.0; 3], 0.0);
    for scan in 2..plots.len() {
        track.predict(step_s);
        track.take(&plots[scan]);
        if scan >= scenario.first_scan() {
            let all = track.state().moments();
            let square = |first: usize, truth: &[f64; 3]| -> f64 {
                (0..axes).map(|axis| (all.mean[first + axis] - truth[axis]).powi(2)).sum()
            };
            sums[0] += square(0, &truth[scan][0]);
            sums[1] += square(3, &truth[scan][1]);
            sums[2] += normalised(&all, &truth[scan][0], axes);
            counted += 1.0;
        }
    }
    sums.map(|sum| sum / counted)
}

/// eᵀ P⁻¹ e of the position over its dimensions.
fn normalised(all: &Gaussian, truth: &[f64; 3], axes: usize) -> f64 {
    let error = DVector::from_fn(axes, |i, _| all.mean[i] - truth[i]);
    let covariance = DMatrix::from_fn(axes, axes, |i, j| all.covariance[at(i, j)]);
    covariance.cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(&error)) / axes as f64)
}
