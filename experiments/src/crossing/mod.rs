//! Two drones that come near each other: do their tracks keep to them?
//!
//! They converge, fly side by side for ten scans at a separation of 0.1 to 2 cells of range, and part again: each goes on to the other's side
//! (`cross`) or turns back to its own (`part`). Plots are drawn as in [`crate::world`] and each drone has one, also where a radar
//! could not resolve them (`resolved`), or where all four coordinates lie within a cell the two give a single plot of both powers
//! between them (`merged`). The same plots are processed with independent PDA and with joint events.
//!
//! ```text
//! tracker    the whole tracker, which begins, confirms, merges and ends tracks by itself (`trackers.rs`)
//! filters    two filters that have begun on their drones: the association alone (`filters.rs`)
//! ```
//!
//! Of filters, a run counts as a *change* if each track follows the other's drone at the end, as *lost* if one of the drones is
//! followed by none, within 50 m.

mod course;
mod filters;
mod outcome;
mod page;
mod trackers;

use common::random::{Purpose, generator};
use evaluation::bootstrap::ratio_of_shares;
use evaluation::contrast;
use rand::Rng;

use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::parallel::runs_with;
use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results, Row};
use course::{CLOSING_MPS, CONDITIONS, Course, TOGETHER};
use filters::Filters;
use outcome::Outcome;

/// Separations, cells of range.
const SEPARATIONS: [f64; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];
/// Kinds of association, in the order of the outcomes.
const ASSOCIATIONS: [&str; 2] = ["independent", "joint"];
/// Whether near drones give one plot.
const PLOTS: [(bool, &str); 2] = [(false, "resolved"), (true, "merged")];
const RESAMPLES: usize = 1000;

/// What follows the drones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    Tracker,
    Filters,
}

impl Level {
    const ALL: [Self; 2] = [Self::Tracker, Self::Filters];

    /// As in the JSON.
    fn name(self) -> &'static str {
        match self {
            Self::Tracker => "tracker",
            Self::Filters => "filters",
        }
    }
}

/// Where the drones fly and who follows them.
#[derive(Debug, Clone, Copy)]
struct Setting {
    level: Level,
    course: Course,
    merged: bool,
    separation: f64,
}

impl Setting {
    fn case(&self, course: &'static str, association: &'static str) -> Case {
        Case::new()
            .with("tracks", self.level.name())
            .with("course", course)
            .with("plots", PLOTS[usize::from(self.merged)].1)
            .with("separation_cells", self.separation)
            .with("association", association)
    }
}

/// Runs the experiment.
///
/// # Errors
/// If the tracker refuses its configuration.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(1000, 20);
    let separations = options.some_of(&SEPARATIONS);
    progress.expect(u64::from(runs) * separations.len() as u64 * 8);
    let mut results = Results { runs, ..Results::default() };
    for level in Level::ALL {
        let mut panels = Vec::new();
        for course in Course::ALL {
            for (merged, plots) in PLOTS {
                let mut wrong = [Vec::new(), Vec::new()];
                for &separation in &separations {
                    let setting = Setting { level, course, merged, separation };
                    progress.say(format!("{}, {}, {plots} plots, {separation} cells", level.name(), course.name()));
                    let outcomes = fly(&setting, runs, options, progress)?;
                    for (points, row) in
                        wrong.iter_mut().zip(rows(&setting, &outcomes, options.seed, &mut results.rows))
                    {
                        points.push([separation, row.value, row.lo, row.hi]);
                    }
                }
                panels.push(panel(format!("{}, {plots} plots", course.name()), wrong));
            }
        }
        for (merged, _) in PLOTS {
            for &separation in &separations {
                sums(&Setting { level, course: Course::Cross, merged, separation }, &mut results.rows);
            }
        }
        results.figures.push(figure(level, panels));
    }
    results.remarks.push(format!(
        "Two targets at {:.0} dB, Swerling I, F = {}; {TOGETHER} scans side by side, closing and parting at 2 × {CLOSING_MPS} m/s.",
        CONDITIONS.snr_db, CONDITIONS.pfa
    ));
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// The outcomes of both kinds of association on the same plots, by run. The two courses have draws of their own, so that
/// what adds up over them is independent.
fn fly(setting: &Setting, runs: u32, options: &Options, progress: &Progress) -> anyhow::Result<Vec<[Outcome; 2]>> {
    let Setting { level, course, merged, separation } = *setting;
    let seed = generator(options.seed, Purpose::Trajectory, course as u32, 0).next_u64();
    let all = runs_with(options.threads, runs, progress, Filters::new, |filters, run| match level {
        Level::Filters => Ok(filters.fly(course, separation, merged, seed, run)),
        Level::Tracker => trackers::fly(course, separation, merged, seed, run),
    });
    all.into_iter().collect()
}

/// The rows of a setting; returns those of either fault, independent and joint.
fn rows(setting: &Setting, outcomes: &[[Outcome; 2]], seed: u64, rows: &mut Vec<Row>) -> [Row; 2] {
    let n = outcomes.len() as u64;
    let either = [0, 1].map(|index: usize| {
        let case = setting.case(setting.course.name(), ASSOCIATIONS[index]);
        let of = || outcomes.iter().map(|both| &both[index]);
        let share = |metric, what: fn(&Outcome) -> bool| {
            Row::proportion(&case, metric, of().filter(|outcome| what(outcome)).count() as u64, n)
        };
        rows.push(share("p_identity_change", |outcome| outcome.changed));
        rows.push(share("p_lost", |outcome| outcome.lost));
        let either = share("p_change_or_lost", Outcome::wrong);
        rows.push(either.clone());
        rows.extend(Row::gospa(&case, &of().map(|outcome| &outcome.gospa).collect::<Vec<_>>()));
        rows.push(Row::mean(&case, "ospa_m", of().map(|outcome| outcome.ospa.mean())));
        match setting.level {
            Level::Tracker => rows.push(share("p_redundant", |outcome| outcome.redundant)),
            Level::Filters => rows.push(Row::mean(&case, "coalesced_share", of().map(|outcome| outcome.coalesced))),
        }
        either
    });
    let pairs: Vec<[bool; 2]> =
        outcomes.iter().map(|[independent, joint]| [joint.wrong(), independent.wrong()]).collect();
    let mut rng = generator(seed, Purpose::Resampling, rows.len() as u32, 0);
    let case = setting.case(setting.course.name(), "joint/independent");
    rows.push(Row::new(&case, "ratio_change_or_lost", ratio_of_shares(&pairs, RESAMPLES, LEVEL, &mut rng)));
    let differences =
        outcomes.iter().map(|[independent, joint]| joint.gospa.distance.mean() - independent.gospa.distance.mean());
    rows.push(Row::mean(&setting.case(setting.course.name(), "joint-independent"), "gospa_difference_m", differences));
    either
}

/// The shares of wrong runs of both courses together.
fn sums(setting: &Setting, rows: &mut Vec<Row>) {
    for association in ASSOCIATIONS {
        let of = |course: Course| {
            let case = setting.case(course.name(), association);
            rows.iter().find(|row| row.case == case && row.metric == "p_change_or_lost").map(Row::estimate)
        };
        if let (Some(cross), Some(part)) = (of(Course::Cross), of(Course::Part)) {
            let sum = contrast::sum(&cross, &part);
            rows.push(Row::new(&setting.case("cross+part", association), "sum_change_or_lost", sum));
        }
    }
}

fn panel(title: String, [independent, joint]: [Vec<[f64; 4]>; 2]) -> Panel {
    Panel {
        title,
        x: Axis::log("separation, cells of range"),
        y: Axis::linear("share of runs with a change or a loss").between(0.0, 1.0),
        series: vec![
            Series::new("independent PDA", 0, Shape::Measured(independent)),
            Series::new("joint events", 1, Shape::Measured(joint)),
        ],
    }
}

fn figure(level: Level, panels: Vec<Panel>) -> Figure {
    let (name, of) = match level {
        Level::Tracker => ("crossing-tracker", "the whole tracker"),
        Level::Filters => ("crossing", "the association alone"),
    };
    Figure {
        name: name.into(),
        title: format!("Two drones near each other, {of}: tracks that change or lose their drone"),
        columns: 2,
        panels,
    }
}
