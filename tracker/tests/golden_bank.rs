//! Every case of `tests/golden/multi_alternative` (or of the folder `GOLDEN_DIR`): steps to 1e-10 (1 + |value|), chains to 1e-8 (1 + |value|).
//!
//! The files come from an independent reference program (see `golden/README.md`). They know one coordinate, here the first; state [w v m].

mod golden_files;

use common::config::BandwidthConfig;
use golden_files::{Check, array, for_each_case, number, numbers, said, three};
use serde_json::Value;
use tracker::association::one_track::OneTrack;
use tracker::filter::bank::{AdaptiveBandwidth, MultiAlternative, Rule};
use tracker::filter::{Filter, Mixture, TwoPlots};
use tracker::plots::measurement::Measurement;

/// Limits of steps and of chains.
const STEP: f64 = 1e-10;
const CHAIN: f64 = 1e-8;
/// The four rules and what the files call their outputs.
const RULES: [(Rule, &str); 4] = [
    (Rule::Bayes, "bayes"),
    (Rule::Standard, "standard"),
    (Rule::Sliding, "sliding"),
    (Rule::SlidingBayes, "sliding_bayes"),
];
/// Place of element (row, column) of P in a block.
const PACKED: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
#[test]
fn every_case_agrees() {
    for_each_case("multi_alternative", |check, case, content| {
        if case["F"].is_array() {
            check.transition(case);
        } else if case["q"].is_number() {
            check.hypotheses(case);
        } else if case["input"]["n_pp"].is_number() {
            check.window(case);
        } else if case["input"]["P"].is_array() {
            check.step(case);
        } else if case["means"].is_array() {
            check.chain(case, content);
        } else if case["parameters"].is_object() {
            check.baseline(case, content);
        } else {
            panic!("{}: a case of no known kind", check.case);
        }
    });
}

impl Check {
    /// F column by column, the response to ±1 m/s², and Q from a certain state.
    fn transition(&self, case: &Value) {
        let (step_s, tau_s, sigma) = (number(&case["T"]), number(&case["tau"]), number(&case["sigma_w"]));
        let predict = |filter: MultiAlternative, states: &[[f64; 3]]| {
            let words = words(&filter, &[0.0; 6], states);
            let mut track = OneTrack::new(Box::new(filter));
            track.set(&words);
            track.predict(step_s);
            track.words().to_vec()
        };
        let one = MultiAlternative::new(1, 3.0 * sigma, tau_s, 1, Rule::Bayes, 2);
        let block = one.block(0);
        for column in 0..3 {
            let mut state = [0.0; 3];
            state[column] = 1.0;
            let after = predict(one.clone(), &[state]);
            for row in 0..3 {
                self.close("F", after[block.hypothesis(0) + row], number(&case["F"][row][column]), STEP);
                let (q, golden) = (after[block.covariance(PACKED[row][column])], number(&case["Q"][row][column]));
                assert!((q - golden).abs() <= STEP * golden.abs(), "{}: Q {row} {column}: {q:e} {golden:e}", self.case);
            }
        }
        let two = MultiAlternative::new(2, 2.0, tau_s, 1, Rule::Bayes, 2);
        let after = predict(two.clone(), &[[0.0; 3]; 2]);
        self.all_close("g", &after[two.block(0).hypothesis(1)..][..3], &case["g"], STEP);
    }

    fn hypotheses(&self, case: &Value) {
        let q = case["q"].as_u64().expect("a number") as usize;
        let filter = MultiAlternative::new(q, number(&case["a_max"]), 3.0, 1, Rule::Bayes, 2);
        self.all_close("means", filter.means(), &case["means"], STEP);
        self.close("sigma_w", filter.sigma_mps2(), number(&case["sigma_w"]), STEP);
    }

    /// A bank of these hypotheses.
    fn bank(&self, of: &Value, n: usize, rule: Rule) -> MultiAlternative {
        let (sigma, q) = (number(&of["sigma_w"]), array(&of["means"]).len());
        let filter = MultiAlternative::new(q, 3.0 * sigma * q as f64, number(&of["tau"]), n, rule, 2);
        self.all_close("means", filter.means(), &of["means"], STEP);
        filter
    }

    fn step(&self, case: &Value) {
        let (input, output) = (&case["input"], &case["output"]);
        let filter = self.bank(input, 1, Rule::Bayes);
        let (block, q) = (filter.block(0), filter.means().len());
        let mut p = [0.0; 6];
        for (i, row) in array(&input["P"]).iter().enumerate() {
            for (j, value) in numbers(row).into_iter().enumerate() {
                p[PACKED[i][j]] = value;
            }
        }
        let states: Vec<[f64; 3]> = array(&input["x"]).iter().map(three).collect();
        let mut track = OneTrack::new(Box::new(filter.clone()));
        track.set(&words(&filter, &p, &states));
        track.predict(number(&input["T"]));
        track.take(&plot(number(&input["z"]), number(&input["sigma_z"])));
        let after = track.words();
        for i in 0..q {
            self.all_close("x", &after[block.hypothesis(i)..][..3], &output["x"][i], STEP);
        }
        for i in 0..3 {
            self.all_close("P", &PACKED[i].map(|k| after[block.covariance(k)]), &output["P"][i], STEP);
        }
        self.scores(&filter, after, &output["log_likelihood"], STEP);
        self.all_close("weights", &filter.shares_of(after, 0)[..q], &output["weights_one_scan"], STEP);
        self.all_close("output", &reported(track.state()), &output["bayes_one_scan"], STEP);
    }

    /// The last log-densities, which the filter keeps relative to the largest.
    fn scores(&self, filter: &MultiAlternative, words: &[f64], golden: &Value, limit: f64) {
        let golden = numbers(golden);
        let largest = golden.iter().copied().fold(f64::MIN, f64::max);
        for (i, golden) in golden.into_iter().enumerate() {
            self.close("log-likelihood", words[filter.block(0).recent(i, 0)], golden - largest, limit);
        }
    }

    fn window(&self, case: &Value) {
        let (input, output) = (&case["input"], &case["output"]);
        let n = input["n_pp"].as_u64().expect("a number") as usize;
        let scans: Vec<Vec<f64>> = array(&input["log_likelihoods"]).iter().map(numbers).collect();
        let q = scans[0].len();
        for (rule, name) in RULES {
            let filter = MultiAlternative::new(q, 30.0, 3.0, n, rule, 2);
            let block = filter.block(0);
            let mut states: Vec<[f64; 3]> = array(&input["conditional_total"]).iter().map(three).collect();
            for (state, mean) in states.iter_mut().zip(filter.means()) {
                state[0] -= mean;
            }
            let mut words = words(&filter, &[0.0; 6], &states);
            for i in 0..q {
                words[block.total(i)] = scans.iter().map(|scan| scan[i]).sum();
                for (back, scan) in scans.iter().rev().take(n).enumerate() {
                    words[block.recent(i, back)] = scan[i];
                }
            }
            let shares = filter.shares_of(&words, 0);
            let likeliest = (0..q).fold(0, |best, i| if shares[i] > shares[best] { i } else { best });
            match rule {
                Rule::Bayes => self.all_close("weights", &shares[..q], &output["weights_full"], STEP),
                Rule::SlidingBayes => self.all_close("weights", &shares[..q], &output["weights_window"], STEP),
                Rule::Standard => assert_eq!(output["index_standard"], likeliest, "{}", self.case),
                Rule::Sliding => assert_eq!(output["index_sliding"], likeliest, "{}", self.case),
            }
            let mut track = OneTrack::new(Box::new(filter));
            track.set(&words);
            track.predict(0.0);
            self.all_close(name, &reported(track.state()), &output[name], STEP);
        }
    }

    fn chain(&self, case: &Value, content: &Value) {
        let n = case["n_pp"].as_u64().expect("a number") as usize;
        for (rule, name) in RULES {
            let filter = self.bank(case, n, rule);
            let (block, q) = (filter.block(0), filter.means().len());
            let mut track = OneTrack::new(Box::new(filter.clone()));
            let plots = self.begin(&mut track, content, said(content, "T"), said(content, "sigma_z"));
            self.all_close("start", &track.words()[block.hypothesis(0)..][..3], &case["start_x"], CHAIN);
            for (scan, plot) in array(&case["scans"]).iter().zip(&plots[2..]) {
                track.predict(said(content, "T"));
                track.take(plot);
                let what = format!("scan {} {name}", scan["k"]);
                self.all_close(&what, &reported(track.state()), &scan[name], CHAIN);
                self.scores(&filter, track.words(), &scan["log_likelihood"], CHAIN);
                let variances = [0, 2, 5].map(|k| track.words()[block.covariance(k)]);
                self.all_close(&format!("{what} P"), &variances, &scan["P_diag"], CHAIN);
                let shares = &filter.shares_of(track.words(), 0)[..q];
                match rule {
                    Rule::Bayes => self.all_close(&what, shares, &scan["weights_full"], CHAIN),
                    Rule::SlidingBayes => self.all_close(&what, shares, &scan["weights_window"], CHAIN),
                    Rule::Standard => assert!(shares[whole(&scan["index_standard"])] > 0.5, "{what}"),
                    Rule::Sliding => assert!(shares[whole(&scan["index_sliding"])] > 0.5, "{what}"),
                }
            }
        }
    }

    /// Starts a track on the first two plots of a chain. Returns all of them.
    fn begin(&self, track: &mut OneTrack, content: &Value, step_s: f64, sigma_m: f64) -> Vec<Measurement> {
        let plots: Vec<Measurement> = numbers(&content["z"]).into_iter().map(|z| plot(z, sigma_m)).collect();
        assert!(plots.len() > 2, "{}: {} plots", self.case, plots.len());
        track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s });
        plots
    }

    fn baseline(&self, case: &Value, content: &Value) {
        let of = |name: &str| number(&case["parameters"][name]);
        let config = BandwidthConfig {
            // 5 g, as for chains.
            greatest_acceleration_mps2: 49.033_25,
            threshold: of("thr_on"),
            calm_scans: of("nr") as u32,
            hold_scans: of("hold") as u32,
            ..BandwidthConfig::default()
        };
        let mut filter = AdaptiveBandwidth::configured(&config, 2).with_recent(of("nd") as usize);
        filter.tau_s = [of("tau_n"), of("tau_w")];
        filter.sigma_mps2 = [of("sn"), of("swide")];
        filter.calm = of("c_off");
        let mut track = OneTrack::new(Box::new(filter));
        let plots = self.begin(&mut track, content, 0.1, 10.0);
        for (scan, plot) in array(&case["scans"]).iter().zip(&plots[2..]) {
            track.predict(0.1);
            track.take(plot);
            let what = format!("scan {}", scan["k"]);
            self.all_close(&what, &reported(track.state()), &scan["x"], CHAIN);
            let covariance = track.state().gaussian(0).covariance;
            let variances = [6, 3, 0].map(|i| covariance[tracker::filter::gaussian::at(i, i)]);
            self.all_close(&format!("{what} P"), &variances, &scan["P_diag"], CHAIN);
            assert_eq!(scan["wide_after_scan"], filter.is_wide(track.state(), 0), "{}: {what}: wide", self.case);
        }
    }
}

fn whole(value: &Value) -> usize {
    value.as_u64().expect("a whole number") as usize
}

/// [a v m] of the first coordinate.
fn reported(state: Mixture<'_>) -> [f64; 3] {
    [6, 3, 0].map(|i| state.mean(0)[i])
}

/// A plot on the first coordinate, of equal errors in all directions.
fn plot(z_m: f64, sigma_m: f64) -> Measurement {
    Measurement { polar: [1.0, 0.0, 0.0, 0.0], ..Measurement::in_plane([z_m, 0.0], [sigma_m, sigma_m]) }
}

/// A state of these hypotheses on the first coordinate, nothing on the others.
fn words(filter: &MultiAlternative, p: &[f64; 6], states: &[[f64; 3]]) -> Vec<f64> {
    let mut words = vec![0.0; filter.layout().words()];
    words[0] = 1.0;
    let block = filter.block(0);
    words[block.covariance(0)..][..6].copy_from_slice(p);
    for (i, state) in states.iter().enumerate() {
        words[block.hypothesis(i)..][..3].copy_from_slice(state);
    }
    words
}
