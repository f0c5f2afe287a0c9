//! Stated and actual errors by axis and SNR.

use common::config::Swerling;

use super::{AXES, REQUIRED};
use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::{Row, fluctuation};

/// Mean (error/σ)² and rms error of every axis.
pub(super) fn new(rows: &[Row]) -> Figure {
    let points = |axis: &str, swerling: Swerling, metric: &str, factor: f64| -> Vec<[f64; 4]> {
        let is = |row: &&Row| {
            row.metric == metric
                && row.case.get("axis") == Some(&axis.into())
                && row.case.get("swerling") == Some(&fluctuation::parameter(swerling))
        };
        // Kinds of targets beside each other.
        let shift_db = match swerling {
            Swerling::Zero => -0.4,
            Swerling::One => 0.0,
            Swerling::Three => 0.4,
        };
        let snr_db = |row: &Row| row.case.get("snr_db").and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
        rows.iter()
            .filter(is)
            .map(|row| [snr_db(row) + shift_db, factor * row.value, factor * row.lo, factor * row.hi])
            .collect()
    };
    let panel = |metric: &str, axis: &str, factor: f64, y: Axis, background: Option<Series>| Panel {
        title: axis.replace('_', " "),
        x: Axis::linear("signal-to-noise ratio / dB").between(8.0, 42.0),
        y,
        series: background
            .into_iter()
            .chain(fluctuation::ALL.into_iter().enumerate().map(|(colour, swerling)| {
                let label = format!("Swerling {}", fluctuation::name(swerling));
                Series::new(label, colour, Shape::Measured(points(axis, swerling, metric, factor)))
            }))
            .collect(),
    };
    let required = || Shape::Band(vec![[8.0, REQUIRED[0], REQUIRED[1]], [42.0, REQUIRED[0], REQUIRED[1]]]);
    let nees = AXES.map(|(axis, _, _)| {
        let band = Series::new("required", 2, required());
        panel("nees", axis, 1.0, Axis::log("mean (error/σ)²").between(0.5, 10.0), Some(band))
    });
    let rms =
        AXES.map(|(axis, factor, unit)| panel("rms", axis, factor, Axis::log(format!("rms error / {unit}")), None));
    Figure {
        name: "plot-accuracy".into(),
        title: "Plots of single targets between cells: stated and actual errors".into(),
        columns: 4,
        panels: nees.into_iter().chain(rms).collect(),
    }
}
