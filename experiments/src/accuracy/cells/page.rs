//! The tables of `docs/results/accuracy.md` on cells, and what they say.

use super::arms::Arm;
use super::{PAIRS, PFA, SWERLING};
use crate::page::{Block, figure, find, power_of_ten};
use crate::trajectory::Segment;
use crate::{Row, fluctuation};

/// Ratios and relative differences within this of nothing are equivalent.
const MARGIN: f64 = 0.05;
/// NEES of a consistent position.
const CONSISTENT: f64 = 3.0;

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![by_arm(rows), comparisons(rows)]
}

fn of<'a>(rows: &'a [Row], metric: &str, source: &str, swerling: &str, pfa: f64) -> Option<&'a Row> {
    let case = [
        ("segment", Segment::SETTLED.name.into()),
        ("source", source.into()),
        ("swerling", swerling.into()),
        ("pfa", pfa.into()),
    ];
    find(rows, metric, &case)
}

/// Kind of target and F of every case.
fn cases() -> impl Iterator<Item = (&'static str, f64)> {
    SWERLING.into_iter().flat_map(|swerling| PFA.map(|pfa| (fluctuation::name(swerling), pfa)))
}

fn by_arm(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for (swerling, pfa) in cases() {
        for arm in Arm::ALL {
            let cell = |metric, decimals| figure(of(rows, metric, arm.name(), swerling, pfa), decimals);
            lines.push(vec![
                format!("Swerling {swerling}, {}", power_of_ten(pfa)),
                arm.name().into(),
                cell("est_position_rms_m", 2),
                cell("pred_position_rms_m", 2),
                cell("est_velocity_rms_mps", 2),
                cell("nees_position", 2),
                cell("p_correct", 3),
                cell("pd", 3),
                cell("p_followed", 3),
                cell("plot_nees_stated", 2),
                cell("plot_nees_weighted", 2),
                cell("plot_nees_nominal", 2),
                cell("false_excess", 2),
            ]);
        }
    }
    let head = [
        "target, F",
        "source",
        "estimated position, m",
        "predicted, m",
        "velocity, m/s",
        "position NEES",
        "correct mode",
        "detected",
        "followed",
        "plots: (error/stated)²",
        "weighted",
        "(error/(C1))²",
        "false plots: excess over noise",
    ];
    Block::table("cells-arms", &head, &lines)
}

/// Metrics of a comparison: name, no difference, unit of the margin.
const COMPARED: [(&str, f64, f64); 4] = [
    ("est_position_rms_ratio", 1.0, 1.0),
    ("pred_position_rms_ratio", 1.0, 1.0),
    ("est_velocity_rms_ratio", 1.0, 1.0),
    ("nees_position_difference", 0.0, CONSISTENT),
];

/// What an interval says of equivalence.
fn says(row: &Row, none: f64, unit: f64) -> &'static str {
    let margin = MARGIN * unit;
    let differs = row.lo > none || row.hi < none;
    match (row.lo >= none - margin && row.hi <= none + margin, differs) {
        (true, _) => "equivalent",
        (false, true) => "differs",
        (false, false) => "undecided",
    }
}

fn comparisons(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for (swerling, pfa) in cases() {
        for (_, _, pair) in PAIRS {
            let mut line = vec![format!("Swerling {swerling}, {}", power_of_ten(pfa)), pair.into()];
            for (metric, none, unit) in COMPARED {
                let row = of(rows, metric, pair, swerling, pfa);
                line.push(format!("{} {}", figure(row, 3), row.map_or("", |row| says(row, none, unit))));
            }
            lines.push(line);
        }
    }
    let head = [
        "target, F",
        "first : second",
        "estimated position, ratio of rms",
        "predicted position",
        "velocity",
        "NEES, difference",
    ];
    Block::table("cells-comparisons", &head, &lines)
}

/// How many comparisons are equivalent, by pair.
pub(super) fn verdict(rows: &[Row]) -> Vec<String> {
    let of_pair = |(_, _, pair): (Arm, Arm, &str)| {
        let compared = COMPARED.iter().flat_map(|&(metric, none, unit)| {
            cases()
                .filter_map(move |(swerling, pfa)| of(rows, metric, pair, swerling, pfa))
                .map(move |row| says(row, none, unit))
        });
        let all: Vec<&str> = compared.collect();
        let count = |word: &str| all.iter().filter(|&&said| said == word).count();
        format!(
            "{pair}: of {} comparisons {} are equivalent within 5 %, {} differ, {} are undecided.",
            all.len(),
            count("equivalent"),
            count("differs"),
            count("undecided")
        )
    };
    PAIRS.into_iter().map(of_pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;
    use evaluation::Estimate;

    #[test]
    fn an_interval_within_the_margin_is_equivalent() {
        let row = |lo, hi| Row::new(&Case::new(), "ratio", Estimate { value: 0.5 * (lo + hi), lo, hi, n: 9 });
        assert_eq!(says(&row(0.97, 1.02), 1.0, 1.0), "equivalent");
        assert_eq!(says(&row(1.01, 1.04), 1.0, 1.0), "equivalent");
        assert_eq!(says(&row(0.9, 1.02), 1.0, 1.0), "undecided");
        assert_eq!(says(&row(0.4, 0.6), 1.0, 1.0), "differs");
        assert_eq!(says(&row(-0.14, 0.1), 0.0, CONSISTENT), "equivalent");
    }
}
