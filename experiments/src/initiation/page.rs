//! The tables of `docs/results/initiation.md`.

use serde_json::Value;

use super::rule::Rule;
use super::{PFA, SNR_DB, SWERLING};
use crate::page::{Block, figure, find, power_of_ten};
use crate::{Row, fluctuation};

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![targets(rows), clutter(rows)]
}

fn rule(rule: Rule) -> [(&'static str, Value); 2] {
    [("logic", rule.logic().into()), ("confirm", rule.parameter())]
}

/// The usual rule and three of five, by kind of target, F and SNR.
fn targets(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for swerling in SWERLING {
        for pfa in PFA {
            for snr_db in SNR_DB {
                let of = |metric: &str, by: Rule, decimals: usize| {
                    let mut case = rule(by).to_vec();
                    case.extend([("pfa", pfa.into()), ("snr_db", snr_db.into())]);
                    case.push(("swerling", fluctuation::parameter(swerling)));
                    figure(find(rows, metric, &case), decimals)
                };
                let [usual, counting] = Rule::USUAL;
                lines.push(vec![
                    format!("Swerling {}", fluctuation::name(swerling)),
                    power_of_ten(pfa),
                    format!("{snr_db} dB"),
                    of("p_confirmed", usual, 2),
                    of("delay_scans", usual, 1),
                    of("redundant_tracks_per_hour", usual, 1),
                    of("gospa_m", usual, 1),
                    of("gospa_localisation_m", usual, 1),
                    of("gospa_missed_m", usual, 1),
                    of("gospa_false_m", usual, 1),
                    of("p_confirmed", counting, 2),
                ]);
            }
        }
    }
    let head = [
        "target",
        "F",
        "SNR",
        "confirmed",
        "delay, scans",
        "redundant tracks an hour",
        "GOSPA, m",
        "of distance",
        "of missed",
        "of false",
        "3 of 5: confirmed (reference)",
    ];
    Block::table("initiation-targets", &head, &lines)
}

/// False tracks an hour of every rule, by F.
fn clutter(rows: &[Row]) -> Block {
    let mut lines: Vec<Vec<String>> = Vec::new();
    let rates = || rows.iter().filter(|row| row.metric == "false_tracks_per_hour");
    for first in rates().filter(|row| row.case.get("pfa") == Some(&PFA[0].into())) {
        let parameter = |key| first.case.get(key).cloned().unwrap_or_default();
        let same = [("logic", parameter("logic")), ("confirm", parameter("confirm"))];
        let of = |pfa: f64| {
            let mut case = same.to_vec();
            case.push(("pfa", pfa.into()));
            let row = find(rows, "false_tracks_per_hour", &case);
            format!("{} ({})", figure(row, 2), row.map_or(0, |row| row.n))
        };
        let mut line = same.iter().map(|(_, value)| value.to_string().replace('"', "")).collect::<Vec<_>>();
        line.extend(PFA.map(of));
        lines.push(line);
    }
    Block::table("initiation-clutter", &["logic", "threshold", "F = 10⁻⁵", "10⁻⁴", "10⁻³"], &lines)
}
