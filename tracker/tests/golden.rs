//! Every case of `tests/golden/imm_pda` (or of the folder `GOLDEN_DIR`), to |a − b| ≤ 1e-9 (1 + |b|).
//!
//! The files come from an independent reference program (see `golden/README.md`). Their frame has x north
//! and y east; here x is east. Their power statistic is normalised to known noise.

#[expect(dead_code, reason = "lists of cases and notes are of the other families")]
mod golden_files;

use std::cell::Cell;

use common::amplitude::{Detector, FalsePower, TargetStatistics};
use common::config::{Association, Clutter, GateRule, Swerling};
use common::geometry::Polar;
use common::tracks;
use golden_files::{Check, array, golden_files, number, numbers, read};
use nalgebra::{SMatrix, SVector};
use serde_json::Value;
use tracker::association::gate::{Gate, own_probability};
use tracker::association::one_track::OneTrack;
use tracker::association::scan::Member;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::gaussian::{Gaussian, at};
use tracker::filter::uav::{CONSTANT_VELOCITY, MANOEUVRE, MODES, Uav};
use tracker::filter::{Expectation, Filter, Group, Machine, Mixture, TwoPlots, expect};
use tracker::plots::measurement::{COORDINATES, LineOfSight, Measurement, position_covariance};
use tracker::plots::radar::Radar;

/// Of |ours − golden| over 1 + |golden|.
const LIMIT: f64 = 1e-9;
const STATE: usize = 9;
/// Our axis (east, north, up) of each axis of the files.
const AXIS: [usize; 3] = [1, 0, 2];

#[test]
fn every_case_agrees() {
    let files = golden_files("imm_pda");
    assert!(!files.is_empty(), "no golden case found");
    let mut refused = Vec::new();
    for file in files {
        let case = read(&file);
        let check = Check { case: file.display().to_string() };
        if let Some(reason) = refusal(&case) {
            refused.push(format!("{}: {reason}", file.display()));
            continue;
        }
        match case["op"].as_str() {
            Some("meas_cov") => check.measurement_covariance(&case),
            Some("h_H_gate") => check.measurement_function(&case),
            Some("init") => check.start(&case),
            Some("amp") => check.amplitude(&case),
            Some("scan") => check.scan(&case),
            other => refused.push(format!("{}: unknown op {other:?}", file.display())),
        }
    }
    assert!(refused.is_empty(), "all other cases agree; refused:\n{}", refused.join("\n"));
}

/// What a case asks for that the filter does not do, on purpose: the source's printed formulas that are wrong (✎ in
/// `docs/theory/imm-pda.md`), and measures of the gate other than that of (x, y, z, ṙ).
fn refusal(case: &Value) -> Option<String> {
    let (cfg, op) = (&case["cfg"], case["op"].as_str());
    let uses_r = matches!(op, Some("meas_cov" | "init" | "scan"));
    let volume = &cfg["volume"];
    if op == Some("scan") && cfg["use_Fi"] == true {
        Some("use_Fi: F of the source mode; (T3) takes that of the destination mode".into())
    } else if uses_r && cfg["r_text"] == true {
        Some("r_text: the printed elements of R are not positive definite; (T6)".into())
    } else if op == Some("scan") && !(volume.is_null() || volume == "4d") {
        Some(format!("volume {volume}: V is that of the four gated coordinates, \"4d\"; (T11)"))
    } else {
        None
    }
}

impl Check {
    fn same_gaussian(&self, what: &str, ours: &Gaussian, mean: &Value, covariance: &Value) {
        let (our_mean, our_covariance) = ours.to_message();
        for (i, golden) in numbers(mean).into_iter().enumerate() {
            self.close(&format!("{what} mean {i}"), our_mean[place(i)], golden, LIMIT);
        }
        for (i, row) in array(covariance).iter().enumerate() {
            for (j, golden) in numbers(row).into_iter().enumerate() {
                let value = our_covariance[tracks::pack(place(i), place(j))];
                self.close(&format!("{what} covariance {i},{j}"), value, golden, LIMIT);
            }
        }
    }

    fn same_state(&self, what: &str, filter: &Uav, ours: Mixture<'_>, golden: &Value) {
        for j in 0..MODES {
            let mut mode = ours.gaussian(j);
            filter.complete(ours, Some(j), &mut mode);
            self.same_gaussian(&format!("{what} mode {j}"), &mode, &golden["u"][j], &golden["P"][j]);
        }
        self.all_close(&format!("{what} W"), ours.weights(), &golden["W"], LIMIT);
        let mut all = ours.moments();
        filter.complete(ours, None, &mut all);
        self.same_gaussian(&format!("{what} mixture"), &all, &golden["mean"], &golden["cov"]);
    }

    fn measurement_covariance(&self, case: &Value) {
        let sigma = numbers(&case["cfg"]["sig"]);
        for (k, place) in array(&case["in"]["r_beta_eps"]).iter().enumerate() {
            let place = numbers(place);
            let place = Polar { range_m: place[0], azimuth_rad: place[1], elevation_rad: place[2] };
            let frame = LineOfSight::at(place.to_enu().into());
            let ours = position_covariance(&frame, [sigma[0].powi(2), sigma[1].powi(2), sigma[2].powi(2)]);
            for i in 0..COORDINATES {
                let mut row = [0.0; COORDINATES];
                for (j, value) in row.iter_mut().enumerate() {
                    *value = match (i, j) {
                        (3, 3) => sigma[3].powi(2),
                        (3, _) | (_, 3) => 0.0,
                        _ => ours[at(AXIS[i], AXIS[j])],
                    };
                }
                self.all_close(&format!("R {k} row {i}"), &row, &case["out"]["R"][k][i], LIMIT);
            }
        }
    }

    fn measurement_function(&self, case: &Value) {
        let radar = radar(&case["cfg"]);
        for k in 0..array(&case["in"]["u"]).len() {
            let gaussian = gaussian(&case["in"]["u"][k], &case["in"]["P"][k]);
            let (filter, mut modes) = (filter(None), vec![Gaussian::ZERO; MODES]);
            modes[MANOEUVRE] = gaussian;
            let mut group = Group::new(filter.layout());
            group.load(0, &state(&filter, &modes, &[0.0, 0.0, 1.0]));
            let mut expected = Vec::new();
            expect(Machine::default(), 1, &radar, 1.0, &group, &mut expected);
            let expected: &Expectation = &expected[MANOEUVRE];
            let p = gaussian.position();
            self.all_close("h", &[p[1], p[0], p[2], expected.centre[3].0[0]], &case["out"]["h"][k], LIMIT);
            let mut rows = [[0.0; STATE]; COORDINATES];
            for axis in 0..3 {
                rows[axis][3 * axis] = 1.0;
                rows[3][3 * axis] = expected.gradient[AXIS[axis]].0[0];
                rows[3][3 * axis + 1] = expected.radial[AXIS[axis]].0[0];
            }
            for (i, row) in rows.iter().enumerate() {
                self.all_close(&format!("H row {i}"), row, &case["out"]["H"][k][i], LIMIT);
            }
            let gate = Gate::new(expected, 0, 1.0);
            self.gate_centre(&gate, &case["out"]["centre"][k]);
            self.all_close("innovation sd", &gate.half, &case["out"]["innov_sd"][k], LIMIT);
        }
    }

    fn gate_centre(&self, gate: &Gate, golden: &Value) {
        let golden_azimuth = number(&golden[1]);
        let mut centre = gate.centre;
        centre[1] = golden_azimuth + common::angle::difference(centre[1], golden_azimuth);
        self.all_close("gate centre", &centre, golden, LIMIT);
    }

    fn start(&self, case: &Value) {
        let cfg = &case["cfg"];
        let previous = measurement(&case["in"]["plot_prev"], cfg);
        let last = measurement(&case["in"]["plot_last"], cfg);
        let mut filter = filter(Some(cfg));
        filter.start_probability = numbers(&cfg["W0"]).try_into().expect("three modes");
        let mut state = vec![0.0; filter.layout().words()];
        filter.start(&TwoPlots { previous: &previous, last: &last, step_s: number(&cfg["T"]) }, &mut state);
        self.same_state("start", &filter, Mixture::new(filter.layout(), &state), &case["out"]);
    }

    fn amplitude(&self, case: &Value) {
        for (k, row) in array(&case["out"]["rows"]).iter().enumerate() {
            let cells = row.get("N").or(row.get("reference_cells")).and_then(Value::as_u64).unwrap_or(0);
            let detector = Detector::new(number(&row["F"]), u32::try_from(cells).expect("small"));
            let snr = common::units::from_db(number(&row["snr_db"]));
            let target = detector.target(swerling(&row["swerling"]), snr);
            self.close(&format!("row {k}: D"), target.detection_probability, number(&row["D"]), LIMIT);
            let ours: Vec<f64> = numbers(&row["w"]).into_iter().map(|q| target.likelihood_ratio(q)).collect();
            self.all_close(&format!("row {k}: λ"), &ours, &row["lr"], LIMIT);
        }
    }

    fn scan(&self, case: &Value) {
        let (cfg, input, output) = (&case["cfg"], &case["in"], &case["out"]);
        let filter = filter(Some(cfg));
        for (i, row) in array(&cfg["Pi"]).iter().enumerate() {
            let stays = |j: usize| if i == j { filter.stay } else { 0.5 * (1.0 - filter.stay) };
            self.all_close("Π", &[stays(0), stays(1), stays(2)], row, LIMIT);
        }
        let modes: Vec<Gaussian> = (0..MODES).map(|j| gaussian(&input["u"][j], &input["P"][j])).collect();
        let mut track = OneTrack::new(Box::new(filter));
        track.set(&state(&filter, &modes, &numbers(&input["W"])));
        track.predict(number(&cfg["T"]));
        self.same_state("predicted", &filter, track.state(), &output["predicted"]);

        let radar = radar(cfg);
        let rules = rules(cfg, &input["method"]);
        if rules.gate_probability.is_none() && !rules.gate_probability_by_mode {
            self.close("P_G", own_probability(rules.alpha, 4), number(&cfg["P_G"]), LIMIT);
        }
        let plots: Vec<Measurement> = array(&input["plots"]).iter().map(|plot| measurement(plot, cfg)).collect();
        let pfa = number(&input["F"]);
        let target = Detector::new(pfa, 0).target(swerling(&cfg["swerling"]), number(&input["snr"]));
        // The files take one density for the whole gate, that at its centre: of a first update only the gate counts.
        let cells: f64 = radar.cell.iter().product();
        let density = Cell::new(1.0);
        let surroundings = Surroundings {
            radar: &radar,
            detection_probability: target.detection_probability,
            target: Some(&target),
            shares: &[],
            clutter: |_: &Measurement| FalsePlots { density: density.get(), power: FalsePower::default() },
        };
        let prediction = track.words().to_vec();
        let member = || Member { time_ns: 0, plots: &plots, surroundings };
        let centre = track.update(member(), &radar, &rules).selection.gate.centre;
        density.set(pfa / cells / (centre[0] * centre[0] * centre[2].cos()));
        track.set(&prediction);
        let outcome = track.update(member(), &radar, &rules);
        let (weights, choice) = (&track.scan.update.weights, &track.scan.choices[0]);

        let golden = &output["assoc"];
        let selection = &outcome.selection;
        if let Some(mode) = golden["gate_model"].as_u64() {
            assert_eq!(selection.component as u64, mode, "{}: gate model", self.case);
        }
        if golden["gate_centre"].is_array() {
            self.gate_centre(&selection.gate, &golden["gate_centre"]);
            self.all_close("gate half widths", &selection.gate.half, &golden["gate_half"], LIMIT);
        }
        if golden["gate_volume_cart"].is_number() {
            self.close("V", selection.volume, number(&golden["gate_volume_cart"]), LIMIT);
            let in_cells: f64 = (0..COORDINATES).map(|i| 2.0 * selection.gate.half[i] / radar.cell[i]).product();
            self.close("U", in_cells, number(&golden["gate_cells_U"]), LIMIT);
        }
        self.close("D", target.detection_probability, number(&golden["D"]), LIMIT);
        assert_eq!(outcome.plots_in_gate, array(&golden["in_gate"]).len(), "{}: plots in gate", self.case);
        if golden["amp_lr_in_gate"].is_array() {
            let ours: Vec<f64> = numbers(&golden["in_gate"])
                .into_iter()
                .map(|index| target.likelihood_ratio(plots[index as usize].power))
                .collect();
            self.all_close("λ", &ours, &golden["amp_lr_in_gate"], LIMIT);
        }
        if golden["weights"].is_array() {
            let chosen: Vec<f64> = choice.candidates.iter().map(|candidate| candidate.plot as f64).collect();
            self.all_close("in gate", &chosen, &golden["in_gate"], LIMIT);
            for j in 0..MODES {
                let mut ours = vec![weights.none[j].0[0]];
                ours.extend((0..choice.candidates.len()).map(|m| weights.plots[m * MODES + j].0[0]));
                self.all_close(&format!("weights of mode {j}"), &ours, &golden["weights"][j], LIMIT);
            }
        }
        if let Some(chosen) = golden["chosen"].as_u64() {
            assert_eq!(choice.best().map(|(plot, _)| plot as u64), Some(chosen), "{}: chosen", self.case);
        }
        if golden["L"].is_array() {
            let density = if rules.clutter == Clutter::Parametric {
                density.get()
            } else {
                outcome.plots_in_gate as f64 / selection.volume
            };
            self.all_close(
                "L",
                &likelihoods(&track, &rules, outcome.plots_in_gate, density, &target),
                &golden["L"],
                LIMIT,
            );
        }
        self.same_state("updated", &filter, track.state(), &output["updated"]);
    }
}

/// L_j in the files' terms: over D/ρ_c where there are plots, and the density of the one plot of a hard decision.
fn likelihoods(
    track: &OneTrack,
    rules: &Rules,
    plots_in_gate: usize,
    density: f64,
    target: &TargetStatistics,
) -> Vec<f64> {
    let update = &track.scan.update;
    let of = |j: usize| {
        let ours = update.weights.likelihood[j].0[0];
        if plots_in_gate == 0 {
            ours
        } else if rules.association.decides() {
            update.densities.ln(0, j, 0).exp()
        } else {
            ours * density / target.detection_probability
        }
    };
    (0..MODES).map(of).collect()
}

/// The state of these modes; what the near-constant-velocity mode says of acceleration is the memory.
fn state(filter: &Uav, modes: &[Gaussian], weights: &[f64]) -> Vec<f64> {
    let layout = filter.layout();
    let mut words = vec![0.0; layout.words()];
    words[..MODES].copy_from_slice(weights);
    for (j, mode) in modes.iter().enumerate() {
        let n = layout.known(j);
        let (mean, covariance) = words[layout.start(j)..].split_at_mut(n);
        mean.copy_from_slice(&mode.mean[..n]);
        covariance[..n * (n + 1) / 2].copy_from_slice(&mode.covariance[..n * (n + 1) / 2]);
    }
    words[layout.memory_start()] = modes[CONSTANT_VELOCITY].covariance[at(6, 6)];
    words
}

/// Where element `i` of the files' state stands in the order of messages.
fn place(i: usize) -> usize {
    3 * AXIS[i / 3] + i % 3
}

fn gaussian(mean: &Value, covariance: &Value) -> Gaussian {
    let (golden_mean, mut m) = (numbers(mean), SVector::<f64, STATE>::zeros());
    let mut p = SMatrix::<f64, STATE, STATE>::zeros();
    for i in 0..STATE {
        m[place(i)] = golden_mean[i];
        for (j, value) in numbers(&covariance[i]).into_iter().enumerate() {
            p[(place(i), place(j))] = value;
        }
    }
    Gaussian::from_message_order(&m, &p)
}

fn measurement(plot: &Value, cfg: &Value) -> Measurement {
    let (plot, sigma) = (numbers(plot), numbers(&cfg["sig"]));
    let place = Polar { range_m: plot[0], azimuth_rad: plot[1], elevation_rad: plot[2] };
    Measurement {
        time_ns: 0,
        position: place.to_enu().into(),
        polar: [plot[0], plot[1], plot[2], plot[3]],
        cos_elevation: plot[2].cos(),
        variance: std::array::from_fn(|i| sigma[i] * sigma[i]),
        power: plot.get(4).copied().unwrap_or(0.0),
        measured: [true; COORDINATES],
        has_power: true,
        is_common: false,
        crowd: 0.0,
    }
}

fn radar(cfg: &Value) -> Radar {
    let sigma = numbers(&cfg["sig"]);
    Radar {
        range_rate_interval_mps: 0.0,
        variance: std::array::from_fn(|i| sigma[i] * sigma[i]),
        cell: std::array::from_fn(|i| sigma[i] * 2.0 * 3.0_f64.sqrt()),
        measured: [true; COORDINATES],
    }
}

fn filter(cfg: Option<&Value>) -> Uav {
    let noise = cfg.map_or([1.0; MODES], |cfg| numbers(&cfg["a"]).try_into().expect("three modes"));
    let stay = cfg.and_then(|cfg| cfg["Pi"][0][0].as_f64()).unwrap_or(0.9);
    Uav { noise, jerk_share: 1.0, axes: 3, stay, start_probability: [0.33, 0.34, 0.33] }
}

fn rules(cfg: &Value, method: &Value) -> Rules {
    let gate_rule = match cfg.get("gate_rule").and_then(Value::as_str) {
        None | Some("most-probable" | "max") => GateRule::MostProbable,
        Some("manoeuvre") => GateRule::Widest,
        Some("union") => GateRule::Union,
        Some(other) => panic!("unknown gate rule {other}"),
    };
    Rules {
        gate_rule,
        alpha: number(&cfg["alpha"]),
        union_probability: 0.0,
        gate_false_plots: 0.0,
        gate_probability_by_mode: cfg["pg_model"] == true,
        gate_probability: cfg["pg_const"].as_f64(),
        association: match method.as_str() {
            Some("pda_amp") => Association::PdaStatistics,
            Some("pda" | "pda_noamp" | "pda_no_amp" | "pda_plain") => Association::Pda,
            Some("nn") => Association::Nearest,
            Some("sn") => Association::Strongest,
            other => panic!("unknown method {other:?}"),
        },
        clutter: match cfg["clutter"].as_str() {
            Some("nonpar") => Clutter::NonParametric,
            Some("par") => Clutter::Parametric,
            other => panic!("unknown clutter model {other:?}"),
        },
        inflation: number(&cfg["gamma"]),
    }
}

fn swerling(value: &Value) -> Swerling {
    match value.as_u64() {
        Some(0) => Swerling::Zero,
        Some(1) => Swerling::One,
        Some(3) => Swerling::Three,
        other => panic!("unknown Swerling case {other:?}"),
    }
}
