//! One run of each filter in plan view, its turn rates and probabilities; errors of all runs against time.

use super::examples::{EXAMPLES, Example, STEP_S};
use super::filters::{Estimate, Kind, Setting, follow};
use super::{Errors, mean_rms};
use crate::figures::{Axis, Figure, GREY, Panel, Series, Shape};

/// The run that is shown.
const RUN: u32 = 0;

pub(super) fn of(shown: &[(Setting, Vec<Errors>)], seed: u64) -> Vec<Figure> {
    EXAMPLES.iter().map(|example| of_example(*example, shown, seed)).collect()
}

fn of_example(example: Example, shown: &[(Setting, Vec<Errors>)], seed: u64) -> Figure {
    let truth = example.truth();
    let plots = example.plots(&truth, seed, RUN);
    let mut plan = Panel {
        title: "one run, plan view".into(),
        x: Axis::linear("x / m"),
        y: Axis::linear("y / m"),
        series: vec![Series::new(
            "plots",
            GREY,
            Shape::Dots(plots.iter().map(|plot| [plot.position[0], plot.position[1]]).collect()),
        )],
    };
    let mut rates = Panel {
        title: "one run, rate of the central model".into(),
        x: Axis::linear("t / s"),
        y: Axis::linear("turn rate / (°/s)"),
        series: Vec::new(),
    };
    let mut probabilities = Panel {
        title: "one run, probability of the central model".into(),
        x: Axis::linear("t / s"),
        y: Axis::linear("probability").between(0.0, 1.0),
        series: Vec::new(),
    };
    let mut errors = Panel {
        title: "position error, rms of all runs".into(),
        x: Axis::linear("t / s"),
        y: Axis::linear("rms / m"),
        series: Vec::new(),
    };
    let of_example = shown.iter().filter(|(setting, _)| setting.example.number == example.number);
    for (colour, (setting, runs)) in of_example.enumerate() {
        let label = label(setting);
        let mut estimates: Vec<(usize, Estimate)> = Vec::new();
        follow(setting, &truth, &plots, |scan, estimate| estimates.push((scan, estimate)));
        let centre = |estimate: &Estimate| estimate.rates_rad_per_s.len() / 2;
        let line = |of: &dyn Fn(&Estimate) -> f64| {
            Shape::Line(estimates.iter().map(|(scan, estimate)| [*scan as f64 * STEP_S, of(estimate)]).collect())
        };
        plan.series.push(Series::new(
            &label,
            colour,
            Shape::Line(estimates.iter().map(|(_, estimate)| estimate.position_m).collect()),
        ));
        // The centre of a known grid stays: its mean rate is shown.
        let rate = |estimate: &Estimate| {
            if setting.kind == Kind::Imm5 {
                let models = estimate.rates_rad_per_s.iter().zip(&estimate.probabilities);
                models.map(|(rate, probability)| rate * probability).sum::<f64>().to_degrees()
            } else {
                estimate.rates_rad_per_s[centre(estimate)].to_degrees()
            }
        };
        rates.series.push(Series::new(&label, colour, line(&rate)));
        probabilities.series.push(Series::new(
            &label,
            colour,
            line(&|estimate| estimate.probabilities[centre(estimate)]),
        ));
        let times = (Example::first_scan()..).map(|scan| scan as f64 * STEP_S);
        let rms = (0..runs[0].len()).map(|scan| {
            let of_scan: Vec<Errors> = runs.iter().map(|run| vec![run[scan]]).collect();
            mean_rms(of_scan.iter(), 0)
        });
        errors.series.push(Series::new(&label, colour, Shape::Line(times.zip(rms).map(|(t, rms)| [t, rms]).collect())));
    }
    let path = truth.iter().map(|ship| ship.position_m).collect();
    plan.series.push(Series::new("truth", 6, Shape::Dashed(path)));
    let turned =
        truth.iter().enumerate().skip(1).map(|(scan, ship)| [scan as f64 * STEP_S, ship.rate_rad_per_s.to_degrees()]);
    rates.series.push(Series::new("truth", 6, Shape::Dashed(turned.collect())));
    Figure {
        name: format!("vsmm-example-{}", example.number),
        title: format!("Example {}: fixed, adaptive and switching grids of turn rates", example.number),
        columns: 2,
        panels: vec![plan, rates, probabilities, errors],
    }
}

fn label(setting: &Setting) -> String {
    match setting.kind {
        Kind::Switching { threshold, .. } => format!("{} {threshold}", setting.name()),
        Kind::Imm5 => format!("{} (mean rate)", setting.name()),
        _ => setting.name().into(),
    }
}
