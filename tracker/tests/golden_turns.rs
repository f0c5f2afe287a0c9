//! Every case of `tests/golden/vsmm` (or of the folder `GOLDEN_DIR`): steps to 1e-10 (1 + |value|), chains to 1e-8 (1 + |value|).
//!
//! The files come from an independent reference program (see `golden/README.md`). State [x ẋ y ẏ]; R is evaluated at the plot.

mod golden_files;

use golden_files::{Check, array, for_each_case, number, numbers, said, three};
use nalgebra::{SMatrix, SVector};
use serde_json::Value;
use tracker::association::one_track::OneTrack;
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::turn::{AdaptiveGrid, Carry, Grid, SwitchingGrid, Turn};
use tracker::filter::{Filter, Mixture, TwoPlots};
use tracker::plots::measurement::Measurement;

/// Limits of steps and of chains.
const STEP: f64 = 1e-10;
const CHAIN: f64 = 1e-8;
/// Our state of each of the files'.
const PLACE: [usize; 4] = [0, 3, 1, 4];
#[test]
fn every_case_agrees() {
    for_each_case("vsmm", |check, case, content| {
        let input = &case["input"];
        if case["F"].is_array() {
            check.transition(case, &content["Q_sigma_a_0p1"]);
        } else if input["t1"].is_number() {
            check.adaptation(case);
        } else if input["n_grid"].is_number() {
            check.switching(case);
        } else if input["pi"].is_array() {
            check.step(case);
        } else if case["scans"].is_array() {
            check.chain(case, content);
        } else {
            panic!("{}: a case of no known kind", check.case);
        }
    });
}

impl Check {
    fn matrix_close(&self, what: &str, ours: &Gaussian, golden: &Value, limit: f64) {
        for (i, row) in array(golden).iter().enumerate() {
            let row_of_ours: Vec<f64> = PLACE.iter().map(|j| ours.covariance[at(PLACE[i], *j)]).collect();
            self.all_close(&format!("{what} row {i}"), &row_of_ours, row, limit);
        }
    }

    /// F column by column: certain states, predicted. Q: that of a state without covariance.
    fn transition(&self, case: &Value, noise: &Value) {
        let (rate, step_s) = (number(&case["turn_rate"]), number(&case["T"]));
        for (column, place) in PLACE.into_iter().enumerate() {
            let filter = turn(Grid::Known(vec![rate - 0.1, rate, rate + 0.1]), 0.1, 0.9, step_s);
            let mut state = Gaussian::ZERO;
            state.mean[place] = 1.0;
            let mut track = OneTrack::new(Box::new(filter.clone()));
            track.set(&words(&filter, &[state; 3], &[0.0, 1.0, 0.0], &[rate - 0.1, rate, rate + 0.1], false));
            track.predict(step_s);
            let predicted = track.state().gaussian(1);
            for (row, place) in PLACE.into_iter().enumerate() {
                self.close("F", predicted.mean[place], number(&case["F"][row][column]), STEP);
            }
            if noise.is_array() {
                self.matrix_close("Q", &predicted, noise, STEP);
            }
        }
    }

    fn adaptation(&self, case: &Value) {
        let input = &case["input"];
        let grid = adaptive(input, [0.0; 3]);
        self.all_close("grid", &grid.adapt(three(&input["grid"]), three(&input["mu"])), &case["output"]["grid"], STEP);
    }

    fn switching(&self, case: &Value) {
        let input = &case["input"];
        let whole = |value: &Value| value.as_u64().expect("a whole number");
        let grid = SwitchingGrid {
            rates: (0..whole(&input["n_grid"])).map(|place| place as f64).collect(),
            threshold: number(&input["t"]),
            carry: Carry::ByPlace,
            undecided_steps_right: whole(&input["literal_else"]) == 1,
        };
        let centre = number(&input["centre_index"]);
        let (window, _) = grid.switch([centre - 1.0, centre, centre + 1.0], three(&input["mu"]));
        self.close("centre", window[1], number(&case["output"]["centre_index"]), STEP);
    }

    fn step(&self, case: &Value) {
        let (input, output) = (&case["input"], &case["output"]);
        let (rates, mu, step_s) = (numbers(&input["turn_rates"]), numbers(&input["mu"]), number(&input["T"]));
        let noise_mps2 = number(&input["sigma_a"]);
        let moved = self.rates_moved(&input["pi"]);
        let (filter, before) = match moved {
            0 => (turn(Grid::Known(rates.clone()), noise_mps2, number(&input["pi"][0][0]), step_s), rates.clone()),
            _ => moved_grid(&rates, moved, noise_mps2, step_s),
        };
        let models: Vec<Gaussian> = (0..rates.len()).map(|j| gaussian(&input["x"][j], &input["P"][j])).collect();
        let mut track = OneTrack::new(Box::new(filter.clone()));
        track.set(&words(&filter, &models, &mu, &before, moved != 0));
        track.predict(step_s);
        self.all_close("rates", &track.state().memory()[..rates.len()], &input["turn_rates"], STEP);
        self.all_close("predicted mu", track.state().weights(), &output["predicted_mu"], STEP);
        for (j, rate) in rates.iter().enumerate() {
            let mixed = gaussian(&output["mixed_x"][j], &output["mixed_P"][j]);
            self.predicted_from(&mixed, *rate, step_s, noise_mps2, &track.state().gaussian(j));
        }
        let plot = plot(number(&input["rho"]), number(&input["alpha"]), input);
        track.take(&plot);
        self.all_close("mu", track.state().weights(), &output["mu"], STEP);
        for j in 0..rates.len() {
            let ours = track.state().gaussian(j);
            self.all_close("x", &PLACE.map(|place| ours.mean[place]), &output["x"][j], STEP);
            self.matrix_close("P", &ours, &output["P"][j], STEP);
            let density = track.scan.update.densities.ln(0, j, 0);
            self.close("log-likelihood", density, number(&output["log_likelihood"][j]), STEP);
        }
        let all = track.state().moments();
        self.all_close("x combined", &PLACE.map(|place| all.mean[place]), &output["x_combined"], STEP);
        self.matrix_close("P combined", &all, &output["P_combined"], STEP);
    }

    /// 0 where models keep their places; how far the rates have moved to the left where states follow their rates.
    fn rates_moved(&self, chain: &Value) -> i64 {
        let chain: Vec<Vec<f64>> = array(chain).iter().map(numbers).collect();
        let models = chain.len();
        let largest = chain.iter().flatten().copied().fold(0.0, f64::max);
        let stays = (0..models * models).find(|k| chain[k / models][k % models] >= largest).expect("a largest");
        let moved = (stays / models) as i64 - (stays % models) as i64;
        let other = chain[0][models - 1].min(chain[models - 1][0]);
        for (i, row) in chain.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let expected = if i as i64 - j as i64 == moved { largest } else { other };
                self.close("Π", *value, expected, STEP);
            }
        }
        moved
    }

    /// A prediction against its definition, from the mixed state.
    fn predicted_from(&self, mixed: &Gaussian, rate: f64, t: f64, noise_mps2: f64, ours: &Gaussian) {
        let (sine, cosine) = (rate * t).sin_cos();
        let (along, across) = if rate == 0.0 { (t, 0.0) } else { (sine / rate, (1.0 - cosine) / rate) };
        let f = SMatrix::<f64, 4, 4>::from_row_slice(
            &[
                [1.0, along, 0.0, -across],
                [0.0, cosine, 0.0, -sine],
                [0.0, across, 1.0, along],
                [0.0, sine, 0.0, cosine],
            ]
            .concat(),
        );
        let x = f * SVector::<f64, 4>::from_fn(|i, _| mixed.mean[PLACE[i]]);
        let g = [t * t / 2.0, t];
        let p = f * SMatrix::<f64, 4, 4>::from_fn(|i, j| mixed.covariance[at(PLACE[i], PLACE[j])]) * f.transpose()
            + SMatrix::from_fn(|i, j| if i / 2 == j / 2 { noise_mps2.powi(2) * g[i % 2] * g[j % 2] } else { 0.0 });
        for i in 0..4 {
            self.close("predicted x", ours.mean[PLACE[i]], x[i], STEP);
            for j in 0..4 {
                self.close("predicted P", ours.covariance[at(PLACE[i], PLACE[j])], p[(i, j)], STEP);
            }
        }
    }

    fn chain(&self, case: &Value, content: &Value) {
        let said = |name: &str| said(content, name);
        let errors = serde_json::json!({
            "sigma_rho": said("sigma_rho"), "sigma_alpha": said("sigma_alpha").to_radians()
        });
        let (step_s, stay) = (said("T ="), said("p_stay"));
        let first = numbers(&case["scans"][0]["turn_rates"]);
        let name = case["case"].as_str().expect("a name");
        let grid = if name.starts_with("IMM") {
            Grid::Known(first.clone())
        } else if name.starts_with("AGMM") {
            let degrees = |name: &str| said(name).to_radians();
            let settings = serde_json::json!({
                "t1": said("t1"), "t2": said("t2"), "t3": said("t3"), "r": degrees("r"), "omega_max": degrees("omega_max")
            });
            Grid::Adaptive(adaptive(&settings, three(&case["scans"][0]["turn_rates"])))
        } else {
            let note = content["note"].as_str().expect("a note");
            let known = note.split_once("over [").expect("known rates").1.split_once(']').expect("a list").0;
            Grid::Switching(SwitchingGrid {
                rates: known.split(',').map(|rate| rate.trim().parse::<f64>().expect("a rate").to_radians()).collect(),
                threshold: said("SGMM t"),
                carry: if name.contains("identity") { Carry::ByRate } else { Carry::ByPlace },
                undecided_steps_right: name.contains("literal"),
            })
        };
        let filter = turn(grid, said("sigma_a"), stay, step_s);
        let plots: Vec<Measurement> = array(&content["polar_measurements"])
            .iter()
            .map(|polar| plot(number(&polar[0]), number(&polar[1]), &errors))
            .collect();
        let mut track = OneTrack::new(Box::new(filter));
        track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s });
        for (scan, plot) in array(&case["scans"]).iter().zip(&plots[2..]) {
            track.predict(step_s);
            track.take(plot);
            let (what, models) = (format!("scan {}", scan["k"]), first.len());
            self.all_close(&format!("{what} rates"), &track.state().memory()[..models], &scan["turn_rates"], CHAIN);
            self.all_close(&format!("{what} mu"), track.state().weights(), &scan["mu"], CHAIN);
            let all = track.state().moments();
            self.all_close(&format!("{what} x"), &PLACE.map(|place| all.mean[place]), &scan["x_combined"], CHAIN);
            let variances = PLACE.map(|place| all.covariance[at(place, place)]);
            self.all_close(&format!("{what} P"), &variances, &scan["P_combined_diag"], CHAIN);
        }
    }
}

/// A switching grid whose next step leads to `rates`, and where it stood before.
fn moved_grid(rates: &[f64], moved: i64, noise_mps2: f64, step_s: f64) -> (Turn, Vec<f64>) {
    let spacing = rates[1] - rates[0];
    let (known, before) = if moved > 0 {
        let known = vec![rates[0] - spacing, rates[0], rates[1], rates[2]];
        (known.clone(), known[..3].to_vec())
    } else {
        let known = vec![rates[0], rates[1], rates[2], rates[2] + spacing];
        (known.clone(), known[1..].to_vec())
    };
    let grid = SwitchingGrid {
        rates: known,
        threshold: if moved > 0 { 1.0 } else { 0.0 },
        carry: Carry::ByRate,
        undecided_steps_right: moved > 0,
    };
    (turn(Grid::Switching(grid), noise_mps2, 0.9, step_s), before)
}

/// In the plane.
fn turn(grid: Grid, noise_mps2: f64, stay: f64, over_s: f64) -> Turn {
    Turn::new(grid, noise_mps2, 2, 60.0, stay, over_s)
}

fn adaptive(settings: &Value, first: [f64; 3]) -> AdaptiveGrid {
    AdaptiveGrid {
        first,
        greatest: number(&settings["omega_max"]),
        spacing: number(&settings["r"]),
        recentre: number(&settings["t1"]),
        narrow: number(&settings["t2"]),
        widen: number(&settings["t3"]),
    }
}

fn gaussian(mean: &Value, covariance: &Value) -> Gaussian {
    let mut gaussian = Gaussian::ZERO;
    for i in 0..4 {
        gaussian.mean[PLACE[i]] = number(&mean[i]);
        for j in 0..4 {
            gaussian.covariance[at(PLACE[i], PLACE[j])] = number(&covariance[i][j]);
        }
    }
    gaussian
}

/// Angles run from +x towards +y, ranges are signed.
fn plot(rho_m: f64, alpha_rad: f64, errors: &Value) -> Measurement {
    let (sine, cosine) = alpha_rad.sin_cos();
    Measurement::in_plane(
        [rho_m * cosine, rho_m * sine],
        [number(&errors["sigma_rho"]), number(&errors["sigma_alpha"])],
    )
}

/// A state of these models.
fn words(filter: &Turn, models: &[Gaussian], mu: &[f64], rates: &[f64], shown: bool) -> Vec<f64> {
    let layout = filter.layout();
    let mut words = vec![0.0; layout.words()];
    words[..mu.len()].copy_from_slice(mu);
    for (j, model) in models.iter().enumerate() {
        let (mean, rest) = words[layout.start(j)..].split_at_mut(6);
        mean.copy_from_slice(&model.mean[..6]);
        rest[..21].copy_from_slice(&model.covariance[..21]);
    }
    let memory = &mut words[layout.memory_start()..];
    memory[..rates.len()].copy_from_slice(rates);
    memory[rates.len()] = f64::from(u8::from(shown));
    debug_assert!(Mixture::new(layout, &words).is_sound(), "weights of {mu:?}");
    words
}
