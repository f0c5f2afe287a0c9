//! Whether all referenced figures of a metric agree at once, by groups of settings.
//!
//! Figure and reference are shares of as many runs each, so the test is that of two samples: the interval of their difference
//! ([`evaluation::contrast`]) holds 0, at the level at which all hold together with 95 % (Šidák). That the reference lies
//! in the figure's own joint interval is stricter, as if it were exact: near 1, where 997 and 1000 runs of 1000 lose alike, it fails first.

use std::collections::BTreeMap;

use evaluation::contrast::difference;
use evaluation::proportion::wilson;
use evaluation::simultaneous::sidak;

use crate::Row;
use crate::rows::LEVEL;

/// Runs behind the references.
const REFERENCE_RUNS: u64 = 1000;

/// A sentence for each group.
pub(super) fn of(rows: &[Row], metric: &str) -> Vec<String> {
    let mut groups: BTreeMap<String, Vec<(&Row, f64)>> = BTreeMap::new();
    for (row, reference) in rows.iter().filter(|row| row.metric == metric).filter_map(|row| Some((row, row.reference?)))
    {
        let text = |key| row.case.get(key).and_then(serde_json::Value::as_str).unwrap_or_default();
        let filter = if text("association") == "mht" { "mht" } else { text("settings") };
        groups.entry(filter.to_string()).or_default().push((row, reference));
    }
    groups.into_iter().map(|(group, rows)| compare(&group, metric, &rows)).collect()
}

fn compare(group: &str, metric: &str, rows: &[(&Row, f64)]) -> String {
    let level = sidak(LEVEL, rows.len());
    let (mut alone, mut different) = (0, Vec::new());
    let mut largest: f64 = 0.0;
    for &(row, reference) in rows {
        let count = |share: f64, n: u64| (share * n as f64).round() as u64;
        let figure = wilson(count(row.value, row.n), row.n, level);
        let other = wilson(count(reference, REFERENCE_RUNS), REFERENCE_RUNS, level);
        alone += usize::from(figure.contains(reference));
        let difference = difference(&figure, &other);
        if difference.value.abs() > largest.abs() {
            largest = difference.value;
        }
        if !difference.contains(0.0) {
            let values: Vec<String> = row.case.iter().map(|(_, value)| value.to_string().replace('"', "")).collect();
            different.push(format!(
                "\n  {}: {:.3} against {reference:.3}, {:+.3} [{:+.3}, {:+.3}]",
                values.join(" "),
                row.value,
                difference.value,
                difference.lo,
                difference.hi
            ));
        }
    }
    format!(
        "{metric}, {group}: {} of {} figures do not differ from their references, both shares of {REFERENCE_RUNS} runs, in the joint 95 % \
         interval of the differences ({:.2} % each); {alone} references lie in the joint interval of the figure alone; the largest \
         difference is {largest:+.3}.{}",
        rows.len() - different.len(),
        rows.len(),
        100.0 * level,
        different.concat()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;

    #[test]
    fn two_samples_of_a_share_near_one_do_not_differ() {
        let case = Case::new().with("settings", "source").with("association", "nearest");
        let row = |lost, reference| Row::proportion(&case, "p_loss", lost, 1000).against(reference, "another sample");
        let sentence = |rows: &[Row]| of(rows, "p_loss").concat();
        let near = sentence(&[row(997, 1.0), row(500, 0.51)]);
        assert!(near.contains("2 of 2 figures") && near.contains("1 references"), "{near}");
        let far = sentence(&[row(950, 1.0), row(500, 0.51)]);
        assert!(far.contains("1 of 2 figures") && far.contains("0.950 against 1.000"), "{far}");
    }
}
