//! The tables of `docs/results/multi-alternative.md`.

use serde_json::Value;

use super::filters::PUBLISHED;
use super::flights::FLIGHTS;
use super::{OVER_HOLD, OVER_RULE, OVER_TUNED, RMS, SYSTEMATIC};
use crate::Row;
use crate::page::{Block, figure, find};

/// τ of the source, s.
const TAU_S: f64 = 3.0;

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![gains(rows), rules(rows), errors(rows), sweeps(rows)]
}

fn case(flight: &str, filter: &str, q: usize, n: usize) -> Vec<(&'static str, Value)> {
    vec![
        ("flight", flight.into()),
        ("filter", filter.into()),
        ("q", q.into()),
        ("n", n.into()),
        ("tau_s", TAU_S.into()),
    ]
}

/// Sliding Bayes against both baselines.
fn gains(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for (q, n) in PUBLISHED {
        for flight in FLIGHTS {
            let case = case(flight.name(), "sliding Bayes", q, n);
            let cell = |metric: &&str| figure(find(rows, metric, &case), 2);
            let mut line = vec![format!("q = {q}, n = {n}"), flight.name().into()];
            line.extend(OVER_HOLD.iter().chain(&OVER_TUNED).map(cell));
            lines.push(line);
        }
    }
    let head = [
        "bank",
        "flight",
        "over hold: position",
        "velocity",
        "acceleration",
        "over tuned: position",
        "velocity",
        "acceleration",
    ];
    Block::table("multi-alternative-gains", &head, &lines)
}

/// Systematic errors of the rules.
fn rules(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for (q, n) in PUBLISHED {
        for flight in FLIGHTS {
            let mut line = vec![format!("q = {q}, n = {n}"), flight.name().into()];
            for rule in ["standard", "sliding"] {
                let case = case(flight.name(), rule, q, n);
                line.extend(OVER_RULE.iter().map(|metric| figure(find(rows, metric, &case), 3)));
            }
            lines.push(line);
        }
    }
    let head = [
        "bank",
        "flight",
        "standard over Bayes: position",
        "velocity",
        "acceleration",
        "sliding over Bayes: position",
        "velocity",
        "acceleration",
    ];
    Block::table("multi-alternative-rules", &head, &lines)
}

/// Errors of all filters with the source's parameters.
fn errors(rows: &[Row]) -> Block {
    let is_listed = |row: &&Row| {
        let of = |key: &str| row.case.get(key).and_then(Value::as_u64).map(|value| value as usize);
        let is_single = row.case.get("q").is_some_and(Value::is_null);
        let has_tau = row.case.get("tau_s").and_then(Value::as_f64).is_some_and(|tau| (tau - TAU_S).abs() < 1e-9);
        row.metric == RMS[0]
            && (is_single || has_tau && PUBLISHED.iter().any(|(q, n)| of("q") == Some(*q) && of("n") == Some(*n)))
    };
    Block::table(
        "multi-alternative-errors",
        &heads(&["flight", "filter"]),
        &lines(rows, is_listed, &["flight", "filter"]),
    )
}

/// Sliding Bayes with other parameters, on the flights that turn hardest.
fn sweeps(rows: &[Row]) -> Block {
    let is_listed = |row: &&Row| {
        let is = |key: &str, text: &str| row.case.get(key).is_some_and(|value| value == text);
        row.metric == RMS[0]
            && is("filter", "sliding Bayes")
            && (is("flight", "turn 5 g") || is("flight", "reversal 4 g"))
    };
    Block::table("multi-alternative-sweeps", &heads(&["flight"]), &lines(rows, is_listed, &["flight"]))
}

fn heads<'a>(first: &[&'a str]) -> Vec<&'a str> {
    let figures =
        ["q", "n", "τ, s", "position, m", "velocity, m/s", "acceleration, m/s²", "systematic: m", "m/s", "m/s²"];
    first.iter().copied().chain(figures).collect()
}

fn lines<'a>(rows: &'a [Row], is_listed: impl Fn(&&'a Row) -> bool, first: &[&str]) -> Vec<Vec<String>> {
    let text = |row: &Row, key: &str| match row.case.get(key) {
        Some(Value::Null) | None => "–".into(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    };
    let line = |row: &Row| {
        let same: Vec<(&str, Value)> = row.case.iter().map(|(key, value)| (key, value.clone())).collect();
        let keys = first.iter().copied().chain(["q", "n", "tau_s"]).map(|key| text(row, key));
        let figures = RMS.iter().chain(&SYSTEMATIC).map(|metric| figure(find(rows, metric, &same), 2));
        keys.chain(figures).collect()
    };
    rows.iter().filter(|row| is_listed(row)).map(line).collect()
}
