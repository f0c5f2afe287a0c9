//! `accuracy`: errors of one track, whether they are as the filter says, and whether it finds the mode of motion.
//!
//! Without clutter and misses (`plots.rs`): what the filter itself can do, by kind of motion, with the settings of the source and the
//! chain's. With `--cells` (`cells/`): trajectory B through simulated cells, the plot extractor and the whole tracker.
//!
//! | metric                    | of all scans of a segment                                  | unit |
//! |---------------------------|------------------------------------------------------------|------|
//! | `pred_position_rms_m`     | predicted position, total 3-D error                        | m    |
//! | `est_position_rms_m`      | estimated position                                         | m    |
//! | `est_velocity_rms_mps`    | estimated velocity                                         | m/s  |
//! | `p_correct`               | share in which the most probable mode is the true one      |      |
//! | `nees_position`           | νᵀ P⁻¹ ν, 3 if the filter is consistent                    |      |
//!
//! Scans of one run are not independent: intervals come from resampling whole runs. Where two ways see the same runs, they are compared run
//! by run (`compare.rs`).

mod cells;
mod compare;
mod figures;
mod page;
mod plots;
mod runs;

use common::random::{Purpose, generator};
use evaluation::{Estimate, bootstrap};
use nalgebra::Vector3;

use crate::rows::LEVEL;
use crate::trajectory::Segment;
use crate::{Case, Options, Progress, Results, Row};

/// Resamples of an interval.
const RESAMPLES: usize = 500;

/// Runs the experiment: 1000 runs of each trajectory, or 400 through cells.
///
/// # Errors
/// If the simulator or the tracker refuses its configuration.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    if options.cells { cells::run(options, progress) } else { Ok(plots::run(options, progress)) }
}

/// Errors of one scan.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Score {
    /// k.
    k: u32,
    /// Squared error of the prediction, m².
    predicted_m2: f64,
    /// Squared error of the estimate, m².
    position_m2: f64,
    /// Squared error of the estimate, m²/s².
    velocity_m2ps2: f64,
    /// Of the position.
    nees: f64,
    /// Whether the most probable mode is the true one.
    correct: bool,
}

impl Score {
    fn new(k: u32, errors: [Vector3<f64>; 3], nees: f64, correct: bool) -> Self {
        let [predicted_m2, position_m2, velocity_m2ps2] = errors.map(|error| error.norm_squared());
        Self { k, predicted_m2, position_m2, velocity_m2ps2, nees, correct }
    }
}

/// [Σ, n] of a value over the scans of a segment, by run.
fn sums(runs: &[Vec<Score>], segment: &Segment, of: impl Fn(&Score) -> f64) -> Vec<[f64; 2]> {
    let of_run = |run: &Vec<Score>| {
        let values = run.iter().filter(|score| segment.holds(score.k)).map(&of);
        values.fold([0.0, 0.0], |[sum, n], value| [sum + value, n + 1.0])
    };
    runs.iter().map(of_run).collect()
}

/// The five metrics of one segment; `runs` holds the scores of each run, `place` tells the draws of rows apart.
fn rows(case: &Case, runs: &[Vec<Score>], segment: &Segment, [seed, place]: [u64; 2]) -> [Row; 5] {
    let mean = |of: fn(&Score) -> f64| -> Estimate {
        let sums = sums(runs, segment, of);
        let scans = sums.iter().map(|[_, n]| n).sum::<f64>() as u64;
        let mut rng = generator(seed, Purpose::Resampling, place as u32, 0);
        Estimate { n: scans, ..bootstrap::ratio(&sums, RESAMPLES, LEVEL, &mut rng) }
    };
    let correct = sums(runs, segment, |score| f64::from(u8::from(score.correct)));
    let hits: Vec<[u64; 2]> = correct.into_iter().map(|run| run.map(|count| count as u64)).collect();
    [
        Row::new(case, "pred_position_rms_m", mean(|score| score.predicted_m2).square_root()),
        Row::new(case, "est_position_rms_m", mean(|score| score.position_m2).square_root()),
        Row::new(case, "est_velocity_rms_mps", mean(|score| score.velocity_m2ps2).square_root()),
        Row::clustered(case, "p_correct", &hits),
        Row::new(case, "nees_position", mean(|score| score.nees)),
    ]
}
