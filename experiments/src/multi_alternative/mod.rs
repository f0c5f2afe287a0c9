//! `multi-alternative`: several hypotheses on mean acceleration against one whose bandwidth adapts, on published manoeuvres (M1)-(M4).
//!
//! The tracker's own filters follow one aircraft by certain plots. Over the scans from the beginning of the manoeuvre to 4 s after its end:
//! ```text
//! position_m, …              mean over scans of the rms over runs of the whole error in the plane
//! systematic_position_m, …   mean over scans of the length of the mean error over runs
//! position_gain_over_hold, … rms of a baseline over that of the filter, in the same runs
//! ```

mod figures;
mod filters;
mod flights;
mod page;

use common::random::{Purpose, generator};
use evaluation::bootstrap;
use tracker::filter::bank::Rule;

use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results, Row};
use filters::{Form, Setting, follow};
pub(crate) use flights::{FLIGHTS, Flight, STEP_S, plots};

/// Resamples behind each interval.
const RESAMPLES: usize = 200;
/// Position, velocity, acceleration.
const RMS: [&str; 3] = ["position_m", "velocity_mps", "acceleration_mps2"];
const SYSTEMATIC: [&str; 3] = ["systematic_position_m", "systematic_velocity_mps", "systematic_acceleration_mps2"];
const OVER_HOLD: [&str; 3] = ["position_gain_over_hold", "velocity_gain_over_hold", "acceleration_gain_over_hold"];
const OVER_TUNED: [&str; 3] = ["position_gain_over_tuned", "velocity_gain_over_tuned", "acceleration_gain_over_tuned"];
/// Systematic errors of the standard and the sliding rule over those of Bayes.
const OVER_RULE: [&str; 3] =
    ["systematic_position_ratio", "systematic_velocity_ratio", "systematic_acceleration_ratio"];

/// Errors of one run by counted scan: position, velocity, acceleration.
type Errors = Vec<[[f64; 2]; 3]>;

/// Runs the experiment: 400 runs of each filter on each flight.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(400, 3);
    let settings = Setting::all(options);
    let flights = options.some_of(&FLIGHTS);
    progress.expect(settings.len() as u64 * flights.len() as u64 * u64::from(runs_of_each));
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    for flight in flights {
        let truth = flight.truth();
        let mut all: Vec<(Setting, Vec<Errors>)> = Vec::new();
        for setting in &settings {
            progress.say(format!("{}, {}", flight.name(), setting.name()));
            let errors = runs(options.threads, runs_of_each, progress, |run| {
                let mut errors = Errors::new();
                follow(setting, &plots(&truth, options.seed, run), |scan, estimate| {
                    if flight.counted().contains(&scan) {
                        let of = |k: usize| [0, 1].map(|axis| estimate[k][axis] - truth[scan][k][axis]);
                        errors.push([of(0), of(1), of(2)]);
                    }
                });
                errors
            });
            let of = |other: Setting| all.iter().find(|(setting, _)| *setting == other).map(|(_, errors)| &errors[..]);
            results.rows.extend(rows(flight, setting, &errors, of, options.seed));
            all.push((*setting, errors));
        }
        results.figures.push(figures::of(flight, &all, options.seed));
    }
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// Mean over scans of the rms over runs.
fn mean_rms(runs: &[&Errors], which: usize) -> f64 {
    mean_over_scans(runs, |scan| {
        let squares = runs.iter().map(|run| run[scan][which][0].powi(2) + run[scan][which][1].powi(2));
        (squares.sum::<f64>() / runs.len() as f64).sqrt()
    })
}

/// The error of each run along the mean error of all, mean over scans: their mean is the mean length of the mean error.
fn systematic_of_runs(errors: &[Errors], which: usize) -> Vec<f64> {
    let all: Vec<&Errors> = errors.iter().collect();
    let scans = errors.first().map_or(0, Vec::len);
    let directions: Vec<[f64; 2]> = (0..scans)
        .map(|scan| {
            let mean = mean_error(&all, scan, which);
            let length = mean[0].hypot(mean[1]);
            mean.map(|axis| if length > 0.0 { axis / length } else { 0.0 })
        })
        .collect();
    let along = |run: &Errors| {
        let each = run.iter().zip(&directions).map(|(error, u)| error[which][0] * u[0] + error[which][1] * u[1]);
        each.sum::<f64>() / scans as f64
    };
    errors.iter().map(along).collect()
}

fn mean_over_scans(runs: &[&Errors], of: impl Fn(usize) -> f64) -> f64 {
    let scans = runs.first().map_or(0, |run| run.len());
    (0..scans).map(of).sum::<f64>() / scans as f64
}

/// Mean over runs at one scan.
fn mean_error(runs: &[&Errors], scan: usize, which: usize) -> [f64; 2] {
    [0, 1].map(|axis| runs.iter().map(|run| run[scan][which][axis]).sum::<f64>() / runs.len() as f64)
}

fn rows<'a>(
    flight: Flight,
    setting: &Setting,
    errors: &[Errors],
    of: impl Fn(Setting) -> Option<&'a [Errors]>,
    seed: u64,
) -> Vec<Row> {
    let case = setting.describe(Case::new().with("flight", flight.name()));
    let mut rng = generator(seed, Purpose::Resampling, 0, 0);
    let mut rows = Vec::new();
    for which in 0..3 {
        let rms = bootstrap::interval(errors, RESAMPLES, LEVEL, &mut rng, |drawn| mean_rms(drawn, which));
        rows.push(Row::new(&case, RMS[which], rms));
        let systematic = systematic_of_runs(errors, which);
        rows.push(Row::mean(&case, SYSTEMATIC[which], systematic.iter().copied()));
        for (form, metric) in [(Form::Hold, OVER_HOLD[which]), (Form::Tuned, OVER_TUNED[which])] {
            let Some(others) = of(Setting::Single(form)) else { continue };
            let pairs: Vec<[&Errors; 2]> = others.iter().zip(errors).map(|(other, own)| [other, own]).collect();
            let gain = bootstrap::interval(&pairs, RESAMPLES, LEVEL, &mut rng, |drawn| {
                let side = |side: usize| mean_rms(&drawn.iter().map(|pair| pair[side]).collect::<Vec<_>>(), which);
                side(0) / side(1)
            });
            rows.push(Row::new(&case, metric, gain));
        }
        if let Setting::Bank { rule: Rule::Standard | Rule::Sliding, hypotheses, window, .. } = *setting
            && let Some(bayes) = of(Setting::bank(Rule::Bayes, hypotheses, window))
        {
            let pairs: Vec<[f64; 2]> =
                systematic.iter().zip(systematic_of_runs(bayes, which)).map(|(own, bayes)| [*own, bayes]).collect();
            rows.push(Row::new(&case, OVER_RULE[which], bootstrap::ratio(&pairs, RESAMPLES, LEVEL, &mut rng)));
        }
    }
    rows
}
