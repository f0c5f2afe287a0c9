//! What an experiment brought, and its form as JSON.

use serde::Serialize;

use crate::figures::Figure;
use crate::page::Block;
use crate::{Options, Row};

/// The outcome of one experiment.
#[derive(Debug, Clone, Default)]
pub struct Results {
    /// Runs of each case.
    pub runs: u32,
    /// The measured figures.
    pub rows: Vec<Row>,
    /// Pictures of them.
    pub figures: Vec<Figure>,
    /// Pieces of a page in `docs/results`.
    pub blocks: Vec<Block>,
    /// What a reader must know beside the figures, a sentence each: references that are not met, and why.
    pub remarks: Vec<String>,
}

/// The JSON object of one call: keys, case keys and metrics stay once published.
#[derive(Debug, Serialize)]
struct Document<'a> {
    experiment: &'a str,
    version: &'a str,
    git: &'a str,
    seed: u64,
    runs: u32,
    rows: Vec<Row>,
}

/// `{experiment, version, git, seed, runs, rows}` of the experiments that one call has run. With several (`all`),
/// each case begins with its `experiment`, and `runs` is the largest number of them.
///
/// # Errors
/// Never in practice: all keys are text.
pub fn to_json(name: &str, options: &Options, all: &[(&str, Results)]) -> serde_json::Result<String> {
    let together = all.len() > 1;
    let rows = all.iter().flat_map(|(experiment, results)| {
        results.rows.iter().map(move |row| {
            let case = if together { row.case.clone().within("experiment", *experiment) } else { row.case.clone() };
            Row { case, ..row.clone() }
        })
    });
    let document = Document {
        experiment: name,
        version: env!("CARGO_PKG_VERSION"),
        git: option_env!("RADAR_CHAIN_GIT").unwrap_or("unknown"),
        seed: options.seed,
        runs: all.iter().map(|(_, results)| results.runs).max().unwrap_or_default(),
        rows: rows.collect(),
    };
    serde_json::to_string_pretty(&document).map(|text| text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;

    #[test]
    fn one_object_for_one_experiment_and_for_all() {
        let results = |runs| Results {
            runs,
            rows: vec![Row::proportion(&Case::new().with("pfa", 0.1), "pd", 1, 2)],
            ..Results::default()
        };
        let parse = |text: String| serde_json::from_str::<serde_json::Value>(&text).expect("JSON");
        let one = parse(to_json("cfar", &Options::default(), &[("cfar", results(5))]).expect("JSON"));
        assert_eq!(one["experiment"], "cfar");
        assert_eq!(one["rows"][0]["case"], serde_json::json!({"pfa": 0.1}));
        let all = [("cfar", results(5)), ("initiation", results(9))];
        let all = parse(to_json("all", &Options::default(), &all).expect("JSON"));
        assert_eq!((&all["experiment"], &all["runs"]), (&"all".into(), &9.into()));
        assert_eq!(all["rows"][1]["case"]["experiment"], "initiation");
    }
}
