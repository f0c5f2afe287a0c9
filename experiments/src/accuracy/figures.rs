//! The source's figures: errors and modes by scan, gates and measurements of one run, trajectories in plan.

use common::config::Swerling;
use common::tracks::{KIND_CONSTANT_VELOCITY, KIND_HOVER, KIND_MANOEUVRE};
use evaluation::rms::rms;
use tracker::plots::measurement::{COORDINATES, Measurement};

use super::runs::{Runs, SETTINGS};
use crate::figures::{Axis, Figure, GREY, Panel, Series, Shape};
use crate::follow::Follower;
use crate::settings::Settings;
use crate::trajectory::{SCANS, Trajectory};
use crate::world::{Conditions, sights};

/// The models that are drawn, in the order of their colours.
const MODELS: [(u16, &str); 3] =
    [(KIND_HOVER, "hover"), (KIND_CONSTANT_VELOCITY, "constant velocity"), (KIND_MANOEUVRE, "manoeuvre")];
/// The run that is shown where one is.
const SHOWN: u32 = 0;

pub(super) fn of(all: &[Runs], seed: u64) -> Vec<Figure> {
    let on_b: Vec<&Runs> = all.iter().filter(|runs| runs.trajectory == Trajectory::B).collect();
    vec![errors(&on_b), modes(&on_b, seed), gates(seed), plan(seed)]
}

fn scan_axis() -> Axis {
    Axis::linear("scan k").between(0.0, f64::from(SCANS))
}

/// Errors of the estimated position and what the filter says of them.
fn errors(all: &[&Runs]) -> Figure {
    let panel = |axis: usize, name: &str| {
        let mut series = Vec::new();
        for (colour, runs) in all.iter().enumerate() {
            let by_scan = |of: &dyn Fn(&crate::follow::ScanRecord) -> f64| -> Vec<[f64; 2]> {
                (0..SCANS as usize)
                    .map(|scan| [scan as f64 + 1.0, rms(runs.records.iter().map(|run| of(&run[scan])))])
                    .collect()
            };
            let settings = runs.settings.name();
            let actual = by_scan(&|record| record.position_error_m[axis]);
            let stated = by_scan(&|record| record.position_sd_m[axis]);
            series.push(Series::new(format!("{settings}: rms error"), colour, Shape::Line(actual)));
            series.push(Series::new(format!("{settings}: by the filter"), colour, Shape::Dashed(stated)));
        }
        Panel { title: name.into(), x: scan_axis(), y: Axis::linear("error, standard deviation / m"), series }
    };
    Figure {
        name: "accuracy-errors".into(),
        title: "Trajectory B without clutter: actual and stated errors of the estimated position".into(),
        columns: 3,
        panels: ["east", "north", "up"].into_iter().enumerate().map(|(axis, name)| panel(axis, name)).collect(),
    }
}

/// Mean mode probabilities over the true modes.
fn modes(all: &[&Runs], seed: u64) -> Figure {
    let truth = sights(Trajectory::B, &Conditions::WITHOUT_CLUTTER, seed, SHOWN);
    let panel = |runs: &&Runs| {
        let mut series = Vec::new();
        for (colour, (kind, name)) in MODELS.iter().enumerate() {
            // A band as high as the panel where the model is the true one.
            let is_true = |k: usize| truth[k + 1].kind == *kind;
            let mut k = 1;
            while k <= SCANS as usize {
                let first = k;
                while k <= SCANS as usize && is_true(k) {
                    k += 1;
                }
                if k > first {
                    let [from, to] = [first as f64 - 0.5, k as f64 - 0.5].map(|x| x.clamp(0.0, f64::from(SCANS)));
                    let band = Shape::Band(vec![[from, 0.0, 1.0], [to, 0.0, 1.0]]);
                    series.push(Series::new(format!("true: {name}"), colour, band));
                }
                k = k.max(first + 1);
            }
        }
        for (colour, (kind, name)) in MODELS.iter().enumerate() {
            let mean = |scan: usize| {
                runs.records.iter().map(|run| run[scan].probability_of(*kind)).sum::<f64>() / runs.records.len() as f64
            };
            let line = (0..SCANS as usize).map(|scan| [scan as f64 + 1.0, mean(scan)]).collect();
            series.push(Series::new(*name, colour, Shape::Line(line)));
        }
        Panel {
            title: format!("{} settings", runs.settings.name()),
            x: scan_axis(),
            y: Axis::linear("mean mode probability").between(0.0, 1.0),
            series,
        }
    };
    Figure {
        name: "accuracy-modes".into(),
        title: "Trajectory B without clutter: modes found and true modes".into(),
        columns: 2,
        panels: all.iter().map(panel).collect(),
    }
}

/// Gates in use (the largest of a union), the false plots in them and the target's plots in one run.
fn gates(seed: u64) -> Figure {
    let conditions = Conditions { pfa: 0.01, reference_cells: 0, snr_db: 16.0, swerling: Swerling::One };
    let axes: [(&str, f64); COORDINATES] = [
        ("range / m", 1.0),
        ("azimuth / °", 180.0 / std::f64::consts::PI),
        ("elevation / °", 180.0 / std::f64::consts::PI),
        ("range rate / m/s", 1.0),
    ];
    let sights = sights(Trajectory::B, &conditions, seed, SHOWN);
    let mut panels = Vec::new();
    for settings in SETTINGS {
        let mut bands: [Vec<[f64; 3]>; COORDINATES] = Default::default();
        let mut centres: [Vec<[f64; 2]>; COORDINATES] = Default::default();
        let mut own: [Vec<[f64; 2]>; COORDINATES] = Default::default();
        let mut others: [Vec<[f64; 2]>; COORDINATES] = Default::default();
        let mut follower = Follower::new(&settings.config(&conditions), &conditions);
        let mut scans = Vec::new();
        let fate = follower.watch(&sights, seed, SHOWN, |record, plots| scans.push((record, plots.to_vec())));
        // A lost track has nothing to show; its target flies on.
        scans.retain(|(record, _)| record.k <= fate.scans());
        for (record, plots) in &scans {
            let (k, gate) = (f64::from(record.k), &record.gate);
            let own = &sights[record.k as usize + 1].plot;
            let others_in_gate = || {
                let inside = |plot: &&Measurement| gate.holds(&gate.offset(plot, 0.0), plot);
                plots.iter().filter(inside).filter(|plot| *plot != own)
            };
            for (axis, (_, factor)) in axes.into_iter().enumerate() {
                let (centre, half) = (factor * gate.centre[axis], factor * gate.half[axis]);
                bands[axis].push([k, centre - half, centre + half]);
                centres[axis].push([k, centre]);
                others[axis].extend(others_in_gate().map(|plot| [k, factor * plot.polar[axis]]));
            }
        }
        for (k, sight) in (-1_i32..).zip(&sights).filter(|(_, sight)| sight.detected) {
            for (axis, (_, factor)) in axes.into_iter().enumerate() {
                own[axis].push([f64::from(k), factor * sight.plot.polar[axis]]);
            }
        }
        let until = fate.lost_at.map_or(String::new(), |k| format!(", lost at k = {k}"));
        for (axis, (label, _)) in axes.into_iter().enumerate() {
            // Wide gates are cut at the edge of the panel.
            let [lo, hi] = (own[axis].iter())
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], point| [lo.min(point[1]), hi.max(point[1])]);
            let margin = 0.3 * (hi - lo);
            let [lo, hi] = [lo - margin, hi + margin];
            let clipped =
                bands[axis].iter().map(|band| [band[0], band[1].clamp(lo, hi), band[2].clamp(lo, hi)]).collect();
            panels.push(Panel {
                title: format!("{} settings{until}", settings.name()),
                x: scan_axis(),
                y: Axis::linear(label).between(lo, hi),
                series: vec![
                    Series::new("gate in use", 0, Shape::Band(clipped)),
                    Series::new("false plots", GREY, Shape::Dots(std::mem::take(&mut others[axis]))),
                    Series::new("centre of the gate", 0, Shape::Line(std::mem::take(&mut centres[axis]))),
                    Series::new("target's plots", 1, Shape::Points(std::mem::take(&mut own[axis]))),
                ],
            });
        }
    }
    Figure {
        name: "accuracy-gates".into(),
        title: "Trajectory B, F = 0.01, 16 dB, Swerling I: gates and measurements of one run".into(),
        columns: COORDINATES,
        panels,
    }
}

/// Trajectories from above, with plots and estimates of one run.
fn plan(seed: u64) -> Figure {
    let conditions = Conditions::WITHOUT_CLUTTER;
    let panel = |trajectory: Trajectory| {
        let sights = sights(trajectory, &conditions, seed, SHOWN);
        let truth = sights.iter().map(|sight| [sight.truth.position_m.x, sight.truth.position_m.y]).collect();
        let plots = sights.iter().map(|sight| [sight.plot.position[0], sight.plot.position[1]]).collect();
        let mut estimates = Vec::new();
        Follower::new(&Settings::Default.config(&conditions), &conditions).watch(&sights, seed, SHOWN, |record, _| {
            let place = sights[record.k as usize + 1].truth.position_m + record.position_error_m;
            estimates.push([place.x, place.y]);
        });
        Panel {
            title: format!("trajectory {}", trajectory.name()),
            x: Axis::linear("east / m"),
            y: Axis::linear("north / m"),
            series: vec![
                Series::new("true", 6, Shape::Line(truth)),
                Series::new("plots", GREY, Shape::Points(plots)),
                Series::new("estimates of one run, default settings", 1, Shape::Line(estimates)),
            ],
        }
    };
    Figure {
        name: "accuracy-plan".into(),
        title: "Trajectories in plan view, without clutter".into(),
        columns: 2,
        panels: [Trajectory::A, Trajectory::B].map(panel).into(),
    }
}
