//! One flight: estimates of one run, and systematic and rms errors of all runs against time.

use tracker::filter::bank::Rule;

use super::filters::{Form, Setting, follow};
use super::flights::{Flight, STEP_S, plots};
use super::{Errors, mean_error};
use crate::figures::{Axis, Figure, Panel, Series, Shape};

/// The run that is shown.
const RUN: u32 = 0;
/// Every which scan is drawn.
const EVERY: usize = 2;
/// What is shown.
const SHOWN: [Setting; 5] = [
    Setting::bank(Rule::Bayes, 5, 4),
    Setting::bank(Rule::Sliding, 5, 4),
    Setting::bank(Rule::SlidingBayes, 5, 4),
    Setting::Single(Form::Hold),
    Setting::Single(Form::Tuned),
];

pub(super) fn of(flight: Flight, all: &[(Setting, Vec<Errors>)], seed: u64) -> Figure {
    let (truth, first) = (flight.truth(), flight.counted().start);
    let plots = plots(&truth, seed, RUN);
    let panel = |title: &str, y: &str| Panel {
        title: title.into(),
        x: Axis::linear("t / s"),
        y: Axis::linear(y),
        series: Vec::new(),
    };
    let mut acceleration = panel("one run, second coordinate", "acceleration / (m/s²)");
    let mut bias = panel("systematic position error, all runs", "length of the mean error / m");
    let mut rms = panel("position error, all runs", "rms / m");
    let shown = SHOWN.iter().filter_map(|shown| all.iter().find(|(setting, _)| setting == shown));
    for (colour, (setting, runs)) in shown.enumerate() {
        let label = setting.name();
        let mut line = Vec::new();
        follow(setting, &plots, |scan, estimate| {
            if scan % EVERY == 0 && flight.counted().contains(&scan) {
                line.push([scan as f64 * STEP_S, estimate[2][1]]);
            }
        });
        acceleration.series.push(Series::new(label, colour, Shape::Line(line)));
        let runs: Vec<&Errors> = runs.iter().collect();
        let scans = || (0..runs[0].len()).step_by(EVERY);
        let time = |scan: usize| (first + scan) as f64 * STEP_S;
        let of_scans = |of: &dyn Fn(usize) -> f64| Shape::Line(scans().map(|scan| [time(scan), of(scan)]).collect());
        bias.series.push(Series::new(
            label,
            colour,
            of_scans(&|scan| {
                let [x, y] = mean_error(&runs, scan, 0);
                x.hypot(y)
            }),
        ));
        let square =
            |scan: usize| runs.iter().map(|run| run[scan][0][0].powi(2) + run[scan][0][1].powi(2)).sum::<f64>();
        rms.series.push(Series::new(label, colour, of_scans(&|scan| (square(scan) / runs.len() as f64).sqrt())));
    }
    let true_line = flight.counted().step_by(EVERY).map(|scan| [scan as f64 * STEP_S, truth[scan][2][1]]);
    acceleration.series.push(Series::new("truth", 6, Shape::Dashed(true_line.collect())));
    Figure {
        name: format!("multi-alternative-{}", flight.name().replace(' ', "-")),
        title: format!("{}: five hypotheses, window of 4 scans", flight.name()),
        columns: 3,
        panels: vec![acceleration, bias, rms],
    }
}
