//! `vsmm`: turn filters with fixed, adaptive and switching grids on two published examples (V1)-(V4).
//!
//! The tracker's own filters follow one ship by certain plots, R at the plot as in the source. `position_m` and `velocity_mps` are the rms over
//! runs of the whole error in the plane, its mean over the scans from 30 s on; their ratios to IMM5 are of the same runs. A clairvoyant filter
//! is told the true turn rate before each scan and where R holds: with no noise it is a bound for all filters, with the noise of the others it is
//! what they could reach if they knew the rate.

mod cost;
mod examples;
mod figures;
mod filters;
mod page;

use common::random::{Purpose, generator};
use evaluation::bootstrap;

use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Options, Progress, Results, Row};
pub(crate) use examples::{EXAMPLES, Example, STEP_S};
use filters::{Kind, Setting, follow};

/// Resamples behind each interval.
const RESAMPLES: usize = 400;
const SOURCE: &str = "an independent program";
/// Metrics.
const POSITION: &str = "position_m";
const VELOCITY: &str = "velocity_mps";
const POSITION_RATIO: &str = "position_over_imm5";
const VELOCITY_RATIO: &str = "velocity_over_imm5";

/// Squared errors of position and velocity of one run, by scan from [`Example::first_scan`] on.
type Errors = Vec<[f64; 2]>;

/// Runs the experiment: 500 runs of each filter.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(500, 3);
    let settings = EXAMPLES.map(|example| Setting::all(example, options));
    progress.expect(settings.iter().map(|of_one| of_one.len() as u64).sum::<u64>() * u64::from(runs_of_each));
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    let mut shown = Vec::new();
    for of_example in settings {
        let mut imm5 = Vec::new();
        for setting in of_example {
            progress.say(format!("example {}, {}", setting.example.number, setting.name()));
            let truth = setting.example.truth();
            let errors: Vec<Errors> = runs(options.threads, runs_of_each, progress, |run| {
                errors(&setting, &truth, &setting.example.plots(&truth, options.seed, run))
            });
            if setting.kind == Kind::Imm5 {
                imm5.clone_from(&errors);
            }
            results.rows.extend(rows(&setting, &errors, &imm5, options.seed));
            if setting.is_published() {
                shown.push((setting, errors));
            }
        }
    }
    let costs = cost::of_all(options);
    results.remarks.push(cost::remark(&costs));
    results.figures = figures::of(&shown, options.seed);
    results.blocks = page::blocks(&results.rows, &costs);
    Ok(results)
}

fn errors(setting: &Setting, truth: &[examples::Truth], plots: &[tracker::plots::measurement::Measurement]) -> Errors {
    let square = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    let mut errors = Vec::new();
    follow(setting, truth, plots, |scan, estimate| {
        if scan >= Example::first_scan() {
            let ship = &truth[scan];
            errors
                .push([square(estimate.position_m, ship.position_m), square(estimate.velocity_mps, ship.velocity_mps)]);
        }
    });
    errors
}

/// Mean over scans of the rms over runs, of position or velocity.
fn mean_rms<'a>(runs: impl ExactSizeIterator<Item = &'a Errors>, which: usize) -> f64 {
    let (n, mut sums) = (runs.len() as f64, Vec::new());
    for run in runs {
        sums.resize(run.len(), 0.0);
        for (sum, square) in sums.iter_mut().zip(run) {
            *sum += square[which];
        }
    }
    sums.iter().map(|sum| (sum / n).sqrt()).sum::<f64>() / sums.len() as f64
}

fn rows(setting: &Setting, errors: &[Errors], imm5: &[Errors], seed: u64) -> Vec<Row> {
    let case = setting.case();
    let pairs: Vec<[&Errors; 2]> = errors.iter().zip(imm5).map(|(own, other)| [own, other]).collect();
    let mut rows = Vec::new();
    for (which, metric, ratio) in [(0, POSITION, POSITION_RATIO), (1, VELOCITY, VELOCITY_RATIO)] {
        let mut rng = generator(seed, Purpose::Resampling, setting.example.number, which as u32);
        let estimate =
            bootstrap::interval(errors, RESAMPLES, LEVEL, &mut rng, |drawn| mean_rms(drawn.iter().copied(), which));
        let row = Row::new(&case, metric, estimate);
        rows.push(match setting.reference()[which] {
            Some(reference) => row.against(reference, SOURCE),
            None => row,
        });
        if setting.kind != Kind::Imm5 {
            let estimate = bootstrap::interval(&pairs, RESAMPLES, LEVEL, &mut rng, |drawn| {
                let of = |side: usize| mean_rms(drawn.iter().map(|pair| pair[side]), which);
                of(0) / of(1)
            });
            rows.push(Row::new(&case, ratio, estimate));
        }
    }
    rows
}
