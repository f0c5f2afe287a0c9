//! Receiver curves: confirmed targets against false tracks, by kind of target, F and SNR.

use evaluation::Estimate;

use super::rule::Rule;
use super::target::WINDOW;
use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::fluctuation;
use crate::world::Conditions;

/// Where no false track was seen, the point is drawn at this many of them.
const NONE: f64 = 0.5;
/// Ends of the axis, false tracks an hour.
const LIMITS: [f64; 2] = [0.005, 3e4];

/// One point: the rule, confirmed targets, false tracks an hour and the rate that one of them is.
pub(super) type Point = (Rule, Estimate, Estimate, f64);

/// A figure without its panels.
pub(super) fn new(conditions: &Conditions, columns: usize) -> Figure {
    let name = fluctuation::name(conditions.swerling);
    Figure {
        name: format!("initiation-swerling-{name}"),
        title: format!(
            "Swerling {name}: targets confirmed within {WINDOW} scans against false tracks (436,800 cells a scan)"
        ),
        columns,
        panels: Vec::new(),
    }
}

/// The curves of one F and SNR.
pub(super) fn panel(conditions: &Conditions, points: &[Point]) -> Panel {
    let mut series = Vec::new();
    for (colour, (logic, label)) in
        [("existence", "existence swept"), ("start-density", "density of new targets swept"), ("m-of-n", "m of n")]
            .into_iter()
            .enumerate()
    {
        let (mut measured, mut line) = (Vec::new(), Vec::new());
        for (_, p, rate, one) in points.iter().filter(|(rule, ..)| rule.logic() == logic) {
            let x = if rate.n == 0 { NONE * one } else { rate.value };
            measured.push([x, p.value, p.lo, p.hi]);
            line.push([x, p.value]);
            let ends = [[rate.lo.max(LIMITS[0]), p.value], [rate.hi.min(LIMITS[1]), p.value]];
            series.push(Series::new("", colour, Shape::Line(ends.into())));
        }
        series.push(Series::new("", colour, Shape::Dashed(line)));
        series.push(Series::new(label, colour, Shape::Measured(measured)));
    }
    Panel {
        title: format!("{} dB, F = {:e}", conditions.snr_db, conditions.pfa),
        x: Axis::log("false tracks per hour (none: half of one)").between(LIMITS[0], LIMITS[1]),
        y: Axis::linear("probability of confirmation").between(0.0, 1.0),
        series,
    }
}
