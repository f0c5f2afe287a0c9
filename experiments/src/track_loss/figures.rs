//! Losses and times against SNR.

use common::config::{Association, Swerling};
use evaluation::proportion::wilson;

use super::{Case, LONGEST};
use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::follow::Fate;
use crate::rows::LEVEL;
use crate::settings::Settings;
use crate::trajectory::Trajectory;

/// What a curve shows of a case: value and interval.
type Measure = fn(&[Fate]) -> [f64; 3];

pub(super) fn of(cases: &[Case]) -> Vec<Figure> {
    let mut figures: Vec<Figure> = [Trajectory::Cv, Trajectory::B].map(|trajectory| source(cases, trajectory)).into();
    figures.push(settings(cases));
    figures.push(robustness(cases));
    figures
}

/// The methods of the source on one trajectory.
fn source(cases: &[Case], trajectory: Trajectory) -> Figure {
    let methods = [
        (Association::PdaStatistics, "PDA with statistics"),
        (Association::Strongest, "strongest neighbour"),
        (Association::Nearest, "nearest neighbour"),
        (Association::Pda, "PDA without statistics"),
    ];
    let panels = |measure: Measure, axis: &Axis| {
        each_pfa(cases, axis, move |cases, pfa| {
            let mut series = Vec::new();
            for (colour, (association, label)) in methods.into_iter().enumerate() {
                let is = |case: &&Case| {
                    let setting = &case.setting;
                    let usual = setting.settings == Settings::Source && setting.swerling == Swerling::One;
                    usual
                        && setting.is_usual()
                        && setting.trajectory == trajectory
                        && setting.association == association
                        && is_pfa(case, pfa)
                };
                series.extend(curve(cases.iter().filter(is), label, colour, measure));
            }
            series
        })
    };
    let name = trajectory.name();
    Figure {
        name: format!("track-loss-{}", name.to_lowercase()),
        title: format!("Trajectory {name}, Swerling I, settings of the source: lost tracks and time of tracking"),
        columns: 3,
        panels: [panels(lost, &share("probability of loss")), panels(time, &scans())].concat(),
    }
}

/// Both settings and the hypotheses by a criterion without gates.
fn settings(cases: &[Case]) -> Figure {
    let methods = [
        (Settings::Source, Association::PdaStatistics, "PDA, settings of the source"),
        (Settings::Default, Association::PdaStatistics, "PDA, default settings"),
        (Settings::Default, Association::Mht, "hypotheses, default settings"),
    ];
    let panels = each_pfa(cases, &share("position wrong by > 150 m"), |cases, pfa| {
        let mut series = Vec::new();
        for (colour, (settings, association, label)) in methods.into_iter().enumerate() {
            let is = |case: &&Case| {
                let setting = &case.setting;
                let usual = setting.trajectory == Trajectory::B && setting.swerling == Swerling::One;
                usual
                    && setting.is_usual()
                    && setting.settings == settings
                    && setting.association == association
                    && is_pfa(case, pfa)
            };
            series.extend(curve(cases.iter().filter(is), label, colour, strayed));
        }
        series
    });
    Figure {
        name: "track-loss-settings".into(),
        title: "Trajectory B, Swerling I: runs with a position error above 150 m in three scans running".into(),
        columns: 3,
        panels,
    }
}

/// Default settings on all trajectories and kinds of targets, at the highest F.
fn robustness(cases: &[Case]) -> Figure {
    let kinds = [
        (Swerling::Zero, Association::PdaStatistics, "Swerling 0"),
        (Swerling::One, Association::PdaStatistics, "Swerling I"),
        (Swerling::Three, Association::PdaStatistics, "Swerling III"),
        (Swerling::One, Association::Mht, "Swerling I, hypotheses"),
    ];
    let is_default = |case: &&Case| case.setting.settings == Settings::Default && case.setting.is_usual();
    let pfa = super::cases::PFA[0];
    let mut panels: Vec<Panel> = Vec::new();
    for trajectory in crate::trajectory::ALL {
        let mut series = Vec::new();
        for (colour, (swerling, association, label)) in kinds.into_iter().enumerate() {
            let is = |case: &&Case| {
                let setting = &case.setting;
                setting.trajectory == trajectory && setting.swerling == swerling && setting.association == association
            };
            let shown = cases.iter().filter(is_default).filter(is).filter(|case| is_pfa(case, pfa));
            series.extend(curve(shown, label, colour, strayed));
        }
        let title = format!("trajectory {}, F = {pfa}", trajectory.name());
        panels.push(Panel { title, x: snr(), y: share("position wrong by > 150 m"), series });
    }
    panels.retain(|panel| !panel.series.is_empty());
    Figure {
        name: "track-loss-targets".into(),
        title: "Default settings: runs with a position error above 150 m in three scans running".into(),
        columns: 2,
        panels,
    }
}

fn each_pfa(cases: &[Case], y: &Axis, series: impl Fn(&[Case], f64) -> Vec<Series>) -> Vec<Panel> {
    let all = super::cases::PFA.into_iter().filter(|&pfa| cases.iter().any(|case| is_pfa(case, pfa)));
    all.map(|pfa| Panel { title: format!("F = {pfa}"), x: snr(), y: y.clone(), series: series(cases, pfa) }).collect()
}

/// A line with its measured points; nothing without cases.
fn curve<'a>(cases: impl Iterator<Item = &'a Case>, label: &str, colour: usize, measure: Measure) -> Vec<Series> {
    let points: Vec<[f64; 4]> = cases
        .map(|case| {
            let [value, lo, hi] = measure(&case.fates);
            [case.setting.snr_db, value, lo, hi]
        })
        .collect();
    if points.is_empty() {
        return Vec::new();
    }
    let line = points.iter().map(|&[x, y, ..]| [x, y]).collect();
    vec![Series::new("", colour, Shape::Line(line)), Series::new(label, colour, Shape::Measured(points))]
}

fn lost(fates: &[Fate]) -> [f64; 3] {
    proportion(fates, |fate| fate.lost_at.is_some())
}

fn strayed(fates: &[Fate]) -> [f64; 3] {
    proportion(fates, |fate| fate.strayed)
}

fn proportion(fates: &[Fate], of: fn(&Fate) -> bool) -> [f64; 3] {
    let count = fates.iter().filter(|fate| of(fate)).count() as u64;
    let estimate = wilson(count, fates.len() as u64, LEVEL);
    [estimate.value, estimate.lo, estimate.hi]
}

fn time(fates: &[Fate]) -> [f64; 3] {
    let estimate = evaluation::mean::mean(fates.iter().map(|fate| f64::from(fate.scans())), LEVEL);
    [estimate.value, estimate.lo, estimate.hi]
}

fn is_pfa(case: &Case, pfa: f64) -> bool {
    (case.setting.pfa - pfa).abs() < 1e-9
}

fn snr() -> Axis {
    Axis::linear("signal-to-noise ratio / dB").between(7.5, 16.5)
}

fn share(label: &str) -> Axis {
    Axis::linear(label).between(0.0, 1.0)
}

fn scans() -> Axis {
    Axis::linear("mean time of tracking / scans").between(0.0, LONGEST)
}
