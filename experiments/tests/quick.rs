//! Every experiment, with few runs: the form of its results, and that they do not depend on the number of threads.

use std::collections::BTreeSet;

use experiments::catalogue::{ALL, EXPERIMENTS, Experiment, named};
use experiments::{Options, Progress, page, results, table};
use serde_json::Value;

fn json(name: &str, threads: usize, cells: bool) -> String {
    let options = Options { quick: true, threads, cells, ..Options::default() };
    let all: Vec<_> = named(name)
        .into_iter()
        .map(|experiment| (experiment.name, (experiment.run)(&options, &Progress::hidden()).expect("results")))
        .collect();
    let page = pages_of_results();
    for (_, results) in &all {
        assert!(!table::text(&results.rows).is_empty());
        page::renew(&page, &results.blocks).expect("a place for each table");
        for figure in &results.figures {
            let svg = figure.to_svg().expect("a figure");
            assert!(svg.starts_with("<svg") && !svg.contains("NaN"), "{}", figure.name);
        }
    }
    results::to_json(name, &options, &all).expect("JSON")
}

/// All pages of results, one after the other.
fn pages_of_results() -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/results");
    let pages = std::fs::read_dir(folder).expect("the pages of results").flatten();
    pages.map(|page| std::fs::read_to_string(page.path()).expect("a page")).collect()
}

/// Keys of the cases, where all rows have the same.
fn keys_of(experiment: &str, cells: bool) -> Option<&'static str> {
    match (experiment, cells) {
        ("accuracy", false) => Some("trajectory settings segment"),
        ("accuracy", true) => Some("trajectory settings segment source swerling pfa"),
        ("track-loss", _) => Some("trajectory pfa snr_db swerling association gate_rule settings"),
        _ => None,
    }
}

/// Two tests, which run at the same time.
#[test]
fn results_have_the_published_form_and_do_not_depend_on_threads() {
    have_the_published_form(EXPERIMENTS.iter().step_by(2).map(|experiment| (*experiment, false)));
}

#[test]
fn so_have_the_others_and_through_cells() {
    let others = EXPERIMENTS.iter().skip(1).step_by(2).map(|experiment| (*experiment, false));
    have_the_published_form(others.chain(named("accuracy").into_iter().map(|experiment| (experiment, true))));
}

fn have_the_published_form(experiments: impl Iterator<Item = (Experiment, bool)>) {
    for (experiment, cells) in experiments {
        let text = json(experiment.name, 1, cells);
        assert_eq!(text, json(experiment.name, 2, cells), "{} on two threads", experiment.name);
        let value: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(value["experiment"], experiment.name);
        for key in ["version", "git", "seed", "runs"] {
            assert!(!value[key].is_null(), "{key}");
        }
        let rows = value["rows"].as_array().expect("rows");
        assert!(!rows.is_empty(), "{}", experiment.name);
        if let Some(published) = keys_of(experiment.name, cells) {
            let keys: BTreeSet<&str> = published.split(' ').collect();
            for row in rows {
                let case = row["case"].as_object().expect("a case");
                assert_eq!(case.keys().map(String::as_str).collect::<BTreeSet<_>>(), keys, "{}", experiment.name);
            }
        }
        for row in rows {
            let row = row.as_object().expect("a row");
            let mut keys: Vec<&str> = row.keys().map(String::as_str).collect();
            keys.sort_unstable();
            assert_eq!(keys, ["case", "hi", "lo", "metric", "n", "reference", "source", "value"]);
            assert!(row["case"].as_object().is_some_and(|case| !case.is_empty()));
            assert_eq!(row["reference"].is_null(), row["source"].is_null(), "{row:?}");
            if let (Some(lo), Some(value), Some(hi)) = (row["lo"].as_f64(), row["value"].as_f64(), row["hi"].as_f64()) {
                assert!(lo <= value && value <= hi, "{row:?}");
            }
        }
    }
}

#[test]
fn names_are_the_published_ones() {
    for name in [
        "cfar",
        "plot-accuracy",
        "accuracy",
        "track-loss",
        "initiation",
        "vsmm",
        "multi-alternative",
        "estimators",
        "outliers",
        "fusion",
        "real-recordings",
    ] {
        assert_eq!(named(name).len(), 1, "{name}");
    }
    assert_eq!(named(ALL).len(), EXPERIMENTS.len());
    assert!(named("nothing").is_empty());
}
