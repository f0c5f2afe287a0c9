//! The tables of `docs/results/crossing.md`.

use super::course::Course;
use super::{ASSOCIATIONS, Level, PLOTS, SEPARATIONS};
use crate::Row;
use crate::page::{Block, figure, find};

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![
        faults(rows, Level::Tracker, "crossing-tracker"),
        distances(rows),
        faults(rows, Level::Filters, "crossing-filters"),
        sums(rows),
    ]
}

fn of(
    rows: &[Row],
    metric: &str,
    level: Level,
    place: (&str, &str, f64),
    association: &str,
    decimals: usize,
) -> String {
    let (course, plots, separation) = place;
    let case = [
        ("tracks", level.name().into()),
        ("course", course.into()),
        ("plots", plots.into()),
        ("separation_cells", separation.into()),
        ("association", association.into()),
    ];
    figure(find(rows, metric, &case), decimals)
}

/// Every course, kind of plots and separation.
fn places() -> impl Iterator<Item = (&'static str, &'static str, f64)> {
    Course::ALL.into_iter().flat_map(|course| {
        PLOTS.into_iter().flat_map(move |(_, plots)| {
            SEPARATIONS.into_iter().map(move |separation| (course.name(), plots, separation))
        })
    })
}

fn begin((course, plots, separation): (&str, &str, f64)) -> Vec<String> {
    vec![course.into(), plots.into(), separation.to_string()]
}

/// Losses and changes of both kinds of association, and their ratio.
fn faults(rows: &[Row], level: Level, name: &'static str) -> Block {
    let lines: Vec<Vec<String>> = places()
        .map(|place| {
            let mut line = begin(place);
            for association in ASSOCIATIONS {
                for metric in ["p_lost", "p_identity_change", "p_change_or_lost"] {
                    line.push(of(rows, metric, level, place, association, 3));
                }
            }
            line.push(of(rows, "ratio_change_or_lost", level, place, "joint/independent", 2));
            line
        })
        .collect();
    let head = [
        "course",
        "plots",
        "cells",
        "independent: lost",
        "change",
        "either",
        "joint: lost",
        "change",
        "either",
        "ratio of either",
    ];
    Block::table(name, &head, &lines)
}

/// GOSPA of the whole tracker, with its parts, and duplicates.
fn distances(rows: &[Row]) -> Block {
    let lines: Vec<Vec<String>> = places()
        .map(|place| {
            let tracker = |metric: &str, association: &str, decimals| {
                of(rows, metric, Level::Tracker, place, association, decimals)
            };
            let mut line = begin(place);
            line.push(tracker("gospa_m", ASSOCIATIONS[0], 1));
            for metric in ["gospa_m", "gospa_localisation_m", "gospa_missed_m", "gospa_false_m", "ospa_m"] {
                line.push(tracker(metric, ASSOCIATIONS[1], 1));
            }
            line.push(tracker("gospa_difference_m", "joint-independent", 1));
            line.push(tracker("p_redundant", ASSOCIATIONS[0], 3));
            line.push(tracker("p_redundant", ASSOCIATIONS[1], 3));
            line
        })
        .collect();
    let head = [
        "course",
        "plots",
        "cells",
        "independent: GOSPA, m",
        "joint: GOSPA, m",
        "of distance",
        "of missed",
        "of false",
        "OSPA, m",
        "joint − independent, m",
        "a redundant track: independent",
        "joint",
    ];
    Block::table("crossing-gospa", &head, &lines)
}

/// Wrong runs of both courses together.
fn sums(rows: &[Row]) -> Block {
    let lines: Vec<Vec<String>> = SEPARATIONS
        .into_iter()
        .map(|separation| {
            let mut line = vec![separation.to_string()];
            for level in Level::ALL {
                for (_, plots) in PLOTS {
                    for association in ASSOCIATIONS {
                        let place = ("cross+part", plots, separation);
                        line.push(of(rows, "sum_change_or_lost", level, place, association, 3));
                    }
                }
            }
            line
        })
        .collect();
    let head = [
        "cells",
        "tracker, resolved: independent",
        "joint",
        "merged: independent",
        "joint",
        "filters, resolved: independent",
        "joint",
        "merged: independent",
        "joint",
    ];
    Block::table("crossing-sums", &head, &lines)
}
