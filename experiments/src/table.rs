//! Rows as a plain aligned table for a terminal.

use std::fmt::Write;

use serde_json::Value;

use crate::Row;

/// Mark of a row whose reference lies outside its interval.
const OUTSIDE: &str = " *";

/// The rows as text: one table for each set of parameters, numbers to the right. A star marks a reference that lies outside the
/// interval, as one in twenty does by chance.
pub fn text(rows: &[Row]) -> String {
    let mut out = String::new();
    for table in rows.chunk_by(|a, b| a.case.iter().map(|(key, _)| key).eq(b.case.iter().map(|(key, _)| key))) {
        if !out.is_empty() {
            out.push('\n');
        }
        write_table(&mut out, table);
    }
    let outside = rows.iter().filter(|row| row.agrees() == Some(false)).count();
    let compared = rows.iter().filter(|row| row.agrees().is_some()).count();
    if compared > 0 {
        let _ = writeln!(out, "\n{outside} of {compared} references lie outside the 95 % interval of the figure (*)");
    }
    out
}

fn write_table(out: &mut String, rows: &[Row]) {
    let keys = rows.iter().take(1).flat_map(|row| row.case.iter().map(|(key, _)| key.to_string()));
    let heads = keys.chain(["metric", "value", "lo", "hi", "n", "reference", "source"].map(String::from));
    let mut lines: Vec<Vec<String>> = vec![heads.collect()];
    lines.extend(rows.iter().map(cells));
    let widths: Vec<usize> = (0..lines[0].len())
        .map(|column| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or_default())
        .collect();
    let metric = widths.len() - 7;
    for line in &lines {
        let mut text = String::new();
        for (column, (cell, &width)) in line.iter().zip(&widths).enumerate() {
            // Words to the left, numbers to the right.
            let _ = if column == metric || column == widths.len() - 1 {
                write!(text, "{cell:<width$}  ")
            } else {
                write!(text, "{cell:>width$}  ")
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
    fn numbers_have_four_digits() {
        for (x, text) in
            [(0.0, "0.000"), (12.3456, "12.35"), (123_456.7, "123457"), (1.2e7, "1.200e7"), (f64::NAN, "–")]
        {
            assert_eq!(number(x), text);
        }
    }
}
