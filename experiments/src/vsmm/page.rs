//! The tables of `docs/results/vsmm.md`.

use serde_json::Value;

use super::cost::Cost;
use super::{POSITION, POSITION_RATIO, VELOCITY, VELOCITY_RATIO};
use crate::Row;
use crate::page::{Block, figure, find};

pub(super) fn blocks(rows: &[Row], costs: &[Cost]) -> Vec<Block> {
    let is_swept = |row: &Row| row.case.get("filter").is_some_and(|filter| filter == "AGMM" || filter == "SGMM");
    vec![
        table("vsmm-filters", rows, |row| row.reference.is_some() || !is_swept(row)),
        table("vsmm-sweep", rows, is_swept),
        cost(costs),
    ]
}

/// One line for each case of which a position is among `which`.
fn table(name: &'static str, rows: &[Row], which: impl Fn(&Row) -> bool) -> Block {
    let head = ["example", "filter", "position, m", "velocity, m/s", "position over IMM5", "velocity over IMM5"];
    let mut cases: Vec<&Row> = rows.iter().filter(|row| row.metric == POSITION && which(row)).collect();
    cases.sort_by_key(|row| row.case.get("example").and_then(Value::as_u64));
    let lines: Vec<Vec<String>> = cases
        .into_iter()
        .map(|row| {
            let same: Vec<(&str, Value)> = row.case.iter().map(|(key, value)| (key, value.clone())).collect();
            let of = |metric: &str, decimals: usize| figure(find(rows, metric, &same), decimals);
            let parameter = |key: &str, name: &str| {
                row.case
                    .get(key)
                    .filter(|value| !value.is_null())
                    .map_or(String::new(), |value| format!(", {name} {value}"))
            };
            let text = |key: &str| row.case.get(key).map_or(String::new(), ToString::to_string).replace('"', "");
            vec![
                text("example"),
                text("filter")
                    + &parameter("t", "t =")
                    + &parameter("t1", "t₁ =")
                    + &parameter("r_deg_per_s", "r °/s ="),
                of(POSITION, 2),
                of(VELOCITY, 3),
                of(POSITION_RATIO, 3),
                of(VELOCITY_RATIO, 3),
            ]
        })
        .collect();
    Block::table(name, &head, &lines)
}

fn cost(costs: &[Cost]) -> Block {
    let lines: Vec<Vec<String>> = costs
        .iter()
        .map(|(name, times)| {
            let mut line = vec![(*name).to_string()];
            for (lanes, time) in times.iter().enumerate() {
                line.extend([format!("{time:.0} ns"), format!("{:.2}", time / costs[0].1[lanes])]);
            }
            line
        })
        .collect();
    let head = ["filter", "a track of eight", "over IMM5", "a track alone", "over IMM5"];
    Block::table("vsmm-cost", &head, &lines)
}
