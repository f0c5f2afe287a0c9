//! The tables of `docs/results/estimators.md`.

use serde_json::Value;

use super::{NEES, POSITION, VELOCITY, name};
use crate::Row;
use crate::page::{Block, figure, find};
use common::config::Estimator;

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    [("estimators-position", POSITION, 1), ("estimators-velocity", VELOCITY, 1), ("estimators-nees", NEES, 2)]
        .map(|(block, metric, decimals)| table(rows, block, metric, decimals))
        .into()
}

/// A line for each scenario, a column for each filter.
fn table(rows: &[Row], block: &'static str, metric: &str, decimals: usize) -> Block {
    let names = Estimator::ALL.map(name);
    let head: Vec<&str> = std::iter::once("scenario").chain(names.iter().map(String::as_str)).collect();
    let is_first = |row: &&Row| row.metric == metric && row.case.get("estimator") == Some(&names[0].as_str().into());
    let line = |row: &Row| {
        let scenario = row.case.get("scenario").cloned().unwrap_or_default();
        let cell = |name: &String| {
            let case = [("scenario", scenario.clone()), ("estimator", Value::from(name.as_str()))];
            figure(find(rows, metric, &case), decimals)
        };
        std::iter::once(scenario.as_str().unwrap_or_default().to_string()).chain(names.iter().map(cell)).collect()
    };
    Block::table(block, &head, &rows.iter().filter(is_first).map(line).collect::<Vec<_>>())
}
