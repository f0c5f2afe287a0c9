//! Rows as a plain aligned table for a terminal.

use std::fmt::Write;

use serde_json::Value;

use crate::Row;
use crate::results::Results;

/// Mark of a row whose reference lies outside its interval.
const OUTSIDE: &str = " *";
/// Columns after the parameters.
const FIGURES: usize = 7;

/// The rows as text: one table for each set of parameters, numbers to the right; what all rows of a table have in common stands above it. A
/// star marks a reference that lies outside the interval, as one in twenty does by chance.
pub fn text(rows: &[Row]) -> String {
    let mut out = String::new();
    for table in rows.chunk_by(|a, b| a.case.iter().map(|(key, _)| key).eq(b.case.iter().map(|(key, _)| key))) {
        if !out.is_empty() {
            out.push('\n');
        }
        write_table(&mut out, table);
    }
    if let Some(agreement) = agreement(rows) {
        let _ = writeln!(out, "\n{agreement} (*)");
    }
    out
}

/// A line for each of several experiments: how much it has found, and how much of that agrees with references.
pub fn verdicts(all: &[(&str, Results)], seed: u64) -> String {
    let mut out = format!("{:<20}{:>7}{:>9}  references in the interval\n", format!("seed {seed}"), "runs", "figures");
    let agrees = |results: &Results| results.rows.iter().filter_map(Row::agrees).collect::<Vec<_>>();
    let told = |agrees: &[bool]| match agrees.len() {
        0 => "none".to_string(),
        n => format!("{} of {n}", agrees.iter().filter(|agrees| **agrees).count()),
    };
    for (name, results) in all {
        let _ = writeln!(out, "{name:<20}{:>7}{:>9}  {}", results.runs, results.rows.len(), told(&agrees(results)));
    }
    let together: Vec<bool> = all.iter().flat_map(|(_, results)| agrees(results)).collect();
    let figures: usize = all.iter().map(|(_, results)| results.rows.len()).sum();
    let _ = writeln!(
        out,
        "{:<20}{:>7}{figures:>9}  {}; one in twenty lies outside by chance",
        "together",
        "",
        told(&together)
    );
    out
}

/// How many of the references lie outside the intervals; `None` without references.
fn agreement(rows: &[Row]) -> Option<String> {
    let agrees: Vec<bool> = rows.iter().filter_map(Row::agrees).collect();
    let outside = agrees.iter().filter(|agrees| !**agrees).count();
    let compared = agrees.len();
    (compared > 0).then(|| format!("{outside} of {compared} references lie outside the 95 % interval of the figure"))
}

fn write_table(out: &mut String, rows: &[Row]) {
    let keys = rows.iter().take(1).flat_map(|row| row.case.iter().map(|(key, _)| key.to_string()));
    let heads: Vec<String> =
        keys.chain(["metric", "value", "lo", "hi", "n", "reference", "source"].map(String::from)).collect();
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    let is_common = |column: usize| rows.len() > 1 && cells.iter().all(|line| line[column] == cells[0][column]);
    let metric = heads.len() - FIGURES;
    let is_word = |column: usize| column == metric || column == heads.len() - 1;
    let common: Vec<String> = (0..heads.len())
        .filter(|&column| is_common(column) && !cells[0][column].is_empty())
        .map(|column| format!("{} {}", heads[column], cells[0][column]))
        .collect();
    if !common.is_empty() {
        let _ = writeln!(out, "{}", common.join(", "));
    }
    let columns: Vec<usize> = (0..heads.len()).filter(|&column| !is_common(column)).collect();
    for line in std::iter::once(&heads).chain(&cells) {
        let mut text = String::new();
        for &column in &columns {
            let all = std::iter::once(&heads).chain(&cells);
            let width = all.map(|line| line[column].chars().count()).max().unwrap_or_default();
            // Words to the left, numbers to the right.
            let _ = if is_word(column) {
                write!(text, "{:<width$}  ", line[column])
            } else {
                write!(text, "{:>width$}  ", line[column])
            };
        }
        let _ = writeln!(out, "{}", text.trim_end());
    }
}

fn cells(row: &Row) -> Vec<String> {
    let parameters = row.case.iter().map(|(_, value)| match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), parameter),
        other => other.to_string(),
    });
    let mark = if row.agrees() == Some(false) { OUTSIDE } else { "" };
    let reference = row.reference.map(|reference| number(reference) + mark).unwrap_or_default();
    let figures = [row.metric.to_string(), number(row.value), number(row.lo), number(row.hi), row.n.to_string()];
    let rest = [reference, row.source.clone().unwrap_or_default()];
    parameters.chain(figures).chain(rest).collect()
}

/// A parameter as it was given: 16, 0.99 or 1e-6.
fn parameter(x: f64) -> String {
    if x != 0.0 && x.abs() < 1e-3 { format!("{x:e}") } else { x.to_string() }
}

/// Four significant digits.
fn number(x: f64) -> String {
    if !x.is_finite() {
        return "–".into();
    }
    let magnitude = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    if (-3..6).contains(&magnitude) {
        let decimals = (3 - magnitude).max(0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;

    #[test]
    fn columns_are_aligned_and_outsiders_marked() {
        let case = |pfa: f64, kind: &str| Case::new().with("pfa", pfa).with("swerling", kind);
        let rows = [
            Row::proportion(&case(1e-6, "I"), "pfa", 10, 10_000_000).against(5e-6, "set"),
            Row::proportion(&case(0.01, "III"), "pd", 50, 100).against(0.5, "(C4)"),
        ];
        let text = text(&rows);
        let expected = "\
 pfa  swerling  metric      value         lo         hi         n    reference  source
1e-6         I  pfa      1.000e-6   5.432e-7   1.841e-6  10000000  5.000e-6 *  set
0.01       III  pd         0.5000     0.4038     0.5962       100      0.5000  (C4)

1 of 2 references lie outside the 95 % interval of the figure (*)
";
        let squeeze = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(squeeze(&text), squeeze(expected), "{text}");
        let ends: Vec<_> = text.lines().take(3).map(|line| line.find("pd").or(line.find("pfa  "))).collect();
        assert!(ends.iter().all(Option::is_some), "{text}");
    }

    #[test]
    fn each_experiment_has_a_line_and_all_of_them_one() {
        let row = |hits| Row::proportion(&Case::new(), "pd", hits, 100).against(0.5, "(C4)");
        let results = |rows: Vec<Row>| Results { runs: 100, rows, ..Results::default() };
        let text = verdicts(&[("cfar", results(vec![row(50), row(90)])), ("crossing", results(vec![]))], 7);
        let lines: Vec<_> = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(lines[1..3], ["cfar 100 2 1 of 2", "crossing 100 0 none"], "{text}");
        assert!(lines[3].starts_with("together 2 1 of 2;"), "{text}");
        assert!(text.lines().all(|line| line.len() <= 100), "{text}");
    }

    #[test]
    fn what_all_rows_have_in_common_stands_above_them() {
        let case = |pfa: f64| Case::new().with("pfa", pfa).with("swerling", "I").with("association", "joint-events");
        let row = |pfa| Row::proportion(&case(pfa), "lost", 10, 100);
        let text = text(&[row(0.1), row(0.01)]);
        let lines: Vec<_> = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(
            lines[0],
            "swerling I, association joint-events, metric lost, value 0.1000, lo 0.05523, hi 0.1744, n 100"
        );
        assert_eq!(lines[1..], ["pfa", "0.1", "0.01"]);
        assert!(!text.contains("reference"), "no column for what no row has: {text}");
    }

    #[test]
    fn numbers_have_four_digits() {
        for (x, text) in
            [(0.0, "0.000"), (12.3456, "12.35"), (123_456.7, "123457"), (1.2e7, "1.200e7"), (f64::NAN, "–")]
        {
            assert_eq!(number(x), text);
        }
    }
}
