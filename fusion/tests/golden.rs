//! Every case of `tests/golden` (or of the folder `GOLDEN_DIR`), to the tolerance that it states.
//!
//! The files come from an independent reference program; see `golden/README.md`.

use std::collections::BTreeSet;
use std::path::PathBuf;

use common::geodesy::{DatumShift, Ellipsoid, FrameChange, Position, enu_axes};
use common::geometry::Polar;
use fusion::association::partition;
use fusion::class;
use fusion::comparison::{chi_squared, gate};
use fusion::gaussian::{Gaussian, Matrix, Vector};
use fusion::grouping::FormationGate;
use fusion::outliers::{Channels, Classic, Limits};
use fusion::registration::{BIASES, Bias, BiasJacobian, Observation, Registration, jacobian};
use fusion::rules;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use serde_json::Value;

#[test]
fn every_case_agrees() {
    let own = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let parent = std::env::var_os("GOLDEN_DIR").map_or(own, PathBuf::from);
    let folder = if parent.join("tertiary").is_dir() { parent.join("tertiary") } else { parent };
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("readable").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    assert!(!files.is_empty(), "no golden case found in {}", folder.display());
    let mut refused = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("readable");
        let cases: Vec<Value> = serde_json::from_str(&text).expect("a list of cases");
        for case in cases {
            let of = Case { name: format!("{}: {}", file.display(), case["id"]), value: &case };
            if !of.check(&file.file_stem().expect("a name").to_string_lossy()) {
                refused.push(of.name);
            }
        }
    }
    assert!(refused.is_empty(), "cases of an unknown kind:\n{}", refused.join("\n"));
}

struct Case<'a> {
    name: String,
    value: &'a Value,
}

impl Case<'_> {
    /// Checks a case; whether its kind is known.
    fn check(&self, kind: &str) -> bool {
        let (input, expected) = (&self.value["input"], &self.value["expected"]);
        match kind {
            "coords" => self.coordinates(input, expected),
            "chi2" => self.chi_squared(input, expected),
            "fusion" => self.fusion(input, expected),
            "association" => self.association(input, expected),
            "registration" => self.registration(input, expected),
            "outliers" => self.outliers(input, expected),
            "grouping" if input.get("K").is_some() => self.classes(input, expected),
            "grouping" => self.formation(input, expected),
            _ => return false,
        }
        true
    }

    fn near(&self, what: &str, found: &[f64], expected: &Value) {
        let expected = numbers(expected);
        assert_eq!(found.len(), expected.len(), "{} {what}", self.name);
        let tolerance = &self.value["tolerance"];
        let absolute = [&tolerance["abs_m"], &tolerance["abs"]].iter().find_map(|it| it.as_f64());
        // A matrix or vector agrees relative to its largest element.
        let size = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let allowed = absolute.unwrap_or_else(|| tolerance["rel"].as_f64().expect("a tolerance") * size);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= allowed, "{} {what}: found {found}, expected {expected}", self.name);
        }
    }

    fn coordinates(&self, input: &Value, expected: &Value) {
        if input.get("site_deg").is_some() {
            let at = |key: &str| {
                let degrees = numbers(&input[format!("{key}_deg")]);
                place(degrees[0], degrees[1], input[if key == "site" { "site_h" } else { "target_h" }].as_f64())
            };
            let (site, target) = (at("site"), at("target"));
            let enu = Vector3::from(FrameChange::new(&target, &site).position_m([0.0; 3]));
            self.near("enu", enu.as_slice(), &expected["enu"]);
            let polar = Polar::from_enu(&enu);
            self.near("polar", &[polar.range_m, polar.azimuth_rad, polar.elevation_rad], &expected["polar"]);
            // Columns of the reference: north, east, up.
            let axes = enu_axes(&site);
            let rows: Vec<f64> = (0..3).flat_map(|axis| [1, 0, 2].map(|row| axes[(row, axis)])).collect();
            self.near("axes", &rows, &expected["M_corrected"]);
            return;
        }
        let from = place(number(&input["B_deg"]), number(&input["L_deg"]), input["h"].as_f64());
        if let Some(helmert) = input.get("helmert").map(numbers) {
            let ecef = Ellipsoid::KRASOVSKY.ecef_m(&from);
            self.near("Krasovsky", ecef.as_slice(), &expected["ecef_krasovsky"]);
            let shift = DatumShift {
                shift_m: [helmert[0], helmert[1], helmert[2]],
                rotation_arcsec: [helmert[3], helmert[4], helmert[5]],
                scale_ppm: helmert[6],
            };
            self.near("WGS-84", shift.apply(&ecef).as_slice(), &expected["ecef_wgs84"]);
            return;
        }
        let ellipsoid = Ellipsoid { semi_major_m: number(&input["a"]), flattening: 1.0 / number(&input["inv_f"]) };
        let ecef = ellipsoid.ecef_m(&from);
        self.near("earth-centred", ecef.as_slice(), &expected["ecef"]);
        let back = ellipsoid.ecef_m(&ellipsoid.position(&ecef));
        self.near("and back", back.as_slice(), &expected["ecef"]);
    }

    fn chi_squared(&self, input: &Value, expected: &Value) {
        let found = if numbers(&input["x1"]).len() == 3 { distance::<3>(input) } else { distance::<6>(input) };
        self.near("χ²", &[found], &expected["chi2"]);
        if let Some(probability) = input["prob"].as_f64() {
            let limit = gate(numbers(&input["x1"]).len(), probability);
            self.near("gate", &[limit], &expected["gate"]);
            assert_eq!(Some(found <= limit), expected["associated"].as_bool(), "{}", self.name);
        }
    }

    fn fusion(&self, input: &Value, expected: &Value) {
        if input.get("x_g").is_some() {
            let [system, before, after] =
                ["g", "p", "u"].map(|of| gaussian(&input[format!("x_{of}")], &input[format!("P_{of}")]));
            let gained = rules::tracklet(&after, &before).expect("covariances");
            let mut sum = system.information().expect("a covariance");
            sum.matrix += gained.matrix;
            sum.vector += gained.vector;
            let found = sum.moments().expect("positive definite");
            self.near("tracklet", found.mean.as_slice(), &expected["x"]);
            self.near("tracklet P", found.covariance.as_slice(), &expected["P"]);
            return;
        }
        let estimates = gaussians(input);
        for (rule, of) in expected.as_object().expect("rules") {
            let found = match rule.as_str() {
                "mean" => Gaussian { mean: rules::mean(&estimates), covariance: Matrix::zeros() },
                "scalar_weights" => Gaussian { mean: rules::by_trace(&estimates), covariance: Matrix::zeros() },
                "information" => rules::information(&estimates).expect("covariances"),
                "ci_fast" => rules::intersection(&estimates).expect("covariances"),
                other => {
                    let share = other.strip_prefix("blue_rho_").and_then(|share| share.parse().ok());
                    let share = share.unwrap_or_else(|| panic!("{}: unknown rule {other}", self.name));
                    rules::known_common(&estimates, share).expect("covariances")
                }
            };
            self.near(rule, found.mean.as_slice(), &of["x"]);
            if of.get("P").is_some() {
                self.near(rule, found.covariance.as_slice(), &of["P"]);
            }
        }
    }

    fn association(&self, input: &Value, expected: &Value) {
        let radars: Vec<Vec<Gaussian>> = input["tracks"].as_array().expect("radars").iter().map(gaussians).collect();
        let sets = |groups: &[Vec<(usize, usize)>]| -> BTreeSet<Vec<(usize, usize)>> {
            groups
                .iter()
                .map(|group| {
                    let mut group = group.clone();
                    group.sort_unstable();
                    group
                })
                .collect()
        };
        let right = partition_of(&expected["optimal"]);
        assert_eq!(sets(&partition(&radars, number(&input["gate_optimal"]))), sets(&right), "{}", self.name);
        for (group, fused) in right.iter().zip(expected["fused_blue_rho_0_2"].as_array().expect("fused")) {
            let members: Vec<Gaussian> = group.iter().map(|&(radar, index)| radars[radar][index]).collect();
            let found = rules::known_common(&members, 0.2).expect("covariances");
            self.near("fused", found.mean.as_slice(), fused);
        }
    }

    fn registration(&self, input: &Value, expected: &Value) {
        let radians = |value: &Value| {
            let [b, l, h] = numbers(value)[..] else { panic!("a place") };
            place(b.to_degrees(), l.to_degrees(), Some(h))
        };
        let centre = radians(&input["centre"]);
        let sites: Vec<Position> = input["sites"].as_array().expect("sites").iter().map(radians).collect();
        let prior = numbers(&input["prior"]);
        let prior = Bias::new(prior[0], prior[1], prior[2], 0.0);
        let mut registration = Registration::new(&vec![prior; sites.len()]);
        for system in partition_of(&input["systems"]) {
            let observations: Vec<Observation> = system
                .iter()
                .map(|&(site, index)| {
                    let track = &input["tracks"][site];
                    let position_m = Vector3::from_vec(numbers(&track["x"][index]));
                    let covariance = Matrix3::from_vec(numbers(&track["P"][index]));
                    let here = FrameChange::new(&centre, &sites[site]).position_m(position_m.into());
                    let turn = enu_axes(&centre) * enu_axes(&sites[site]).transpose();
                    let jacobian: BiasJacobian = turn * jacobian(&here.into(), &Vector3::zeros());
                    Observation { site, position_m, weight: covariance.try_inverse().expect("a covariance"), jacobian }
                })
                .collect();
            registration.observe(&observations, 1.0);
        }
        registration.solve();
        for site in 0..sites.len() {
            let sigma: Vec<f64> = (0..3).map(|i| registration.covariance(site, site)[(i, i)].sqrt()).collect();
            for axis in 0..3 {
                self.near("bias", &[registration.bias(site)[axis]], &expected["estimate"][site][axis]);
                self.near("sigma", &sigma[axis..=axis], &expected["sigma"][site][axis]);
            }
            assert!(registration.bias(site)[BIASES - 1].abs() < 1e-12);
        }
    }

    fn outliers(&self, input: &Value, expected: &Value) {
        let sigma = numbers(&input["sigma"]);
        let limits = Limits {
            speed_mps: number(&input["vmax"]),
            sigma: [sigma[0], sigma[1], sigma[2]],
            forget_s: number(&input["T_por"]),
        };
        let (mut classic, mut channels) = (Classic::new(limits), Channels::new(limits));
        let [time, range, azimuth, elevation] = ["T", "D", "A", "E"].map(|key| numbers(&input[key]));
        for (index, &time_s) in time.iter().enumerate() {
            let measured = [range[index], azimuth[index], elevation[index]];
            let kept = classic.keeps(time_s, measured);
            assert_eq!(Some(kept), expected["classic"][index].as_bool(), "{} classic {index}", self.name);
            for (axis, kept) in channels.keeps(time_s, measured).into_iter().enumerate() {
                let right = expected["cluster_seed_W1_window8"][index][axis].as_bool();
                assert_eq!(Some(kept), right, "{} channel {axis} of {index}", self.name);
            }
        }
    }

    fn classes(&self, input: &Value, expected: &Value) {
        assert_eq!(input["K"], 3, "{}", self.name);
        for (sources, expected) in
            input["sources"].as_array().expect("sources").iter().zip(expected["P"].as_array().expect("P"))
        {
            let right = numbers(sources);
            // Over everything that the sources can declare of a target of class 0.
            let mut probability = 0.0;
            for declared in 0..3_usize.pow(right.len() as u32) {
                let class_of = |source: usize| declared / 3_usize.pow(source as u32) % 3;
                let says: Vec<[f64; 3]> =
                    right.iter().enumerate().map(|(source, &p)| class::declared(class_of(source), p)).collect();
                let chance: f64 = says.iter().map(|of| of[0]).product();
                let posterior = class::posterior(says);
                let most = posterior.iter().copied().fold(0.0, f64::max);
                let equals = posterior.iter().filter(|&&p| (p - most).abs() < 1e-12).count() as f64;
                probability += if (posterior[0] - most).abs() < 1e-12 { chance / equals } else { 0.0 };
            }
            self.near("P", &[probability], expected);
        }
    }

    fn formation(&self, input: &Value, expected: &Value) {
        let gate = FormationGate {
            ground_m: number(&input["gate_xy"]),
            height_m: number(&input["gate_h"]),
            velocity_mps: number(&input["dv"]),
            hysteresis: 1.0,
        };
        let vectors = |key: &str| -> Vec<Vector3<f64>> {
            let of = |value: &Value| Vector3::from_iterator(numbers(value).into_iter().chain([0.0; 3]).take(3));
            input[key].as_array().expect("vectors").iter().map(of).collect()
        };
        let (position, velocity) = (vectors("pos"), vectors("vel"));
        let leader = input["leader"].as_u64().expect("an index") as usize;
        for (index, right) in expected["member"].as_array().expect("flags").iter().enumerate() {
            let member =
                gate.holds(&(position[index] - position[leader]), &(velocity[index] - velocity[leader]), false);
            assert_eq!(Some(member), right.as_bool(), "{} {index}", self.name);
        }
    }
}

fn distance<const N: usize>(input: &Value) -> f64
where
    nalgebra::Const<N>: nalgebra::DimMin<nalgebra::Const<N>, Output = nalgebra::Const<N>>,
{
    let vector = |key: &str| SVector::<f64, N>::from_vec(numbers(&input[key]));
    let matrix = |key: &str| SMatrix::<f64, N, N>::from_row_slice(&numbers(&input[key]));
    let mut spread = matrix("P1") + matrix("P2");
    if input.get("P12").is_some() {
        spread -= matrix("P12") + matrix("P12").transpose();
    }
    chi_squared(&(vector("x1") - vector("x2")), spread)
}

fn place(latitude_deg: f64, longitude_deg: f64, height_m: Option<f64>) -> Position {
    Position { latitude_deg, longitude_deg, height_m: height_m.unwrap_or(0.0) }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// All numbers of a value, of nested lists in order.
fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or_else(|| vec![number(value)], |values| values.iter().flat_map(numbers).collect())
}

fn gaussian(mean: &Value, covariance: &Value) -> Gaussian {
    Gaussian { mean: Vector::from_vec(numbers(mean)), covariance: Matrix::from_row_slice(&numbers(covariance)) }
}

/// `x` and `P`, lists of means and covariances.
fn gaussians(value: &Value) -> Vec<Gaussian> {
    let means = value["x"].as_array().expect("means");
    means.iter().enumerate().map(|(index, mean)| gaussian(mean, &value["P"][index])).collect()
}

fn partition_of(value: &Value) -> Vec<Vec<(usize, usize)>> {
    let pair = |value: &Value| {
        let of = |i: usize| value[i].as_u64().expect("an index") as usize;
        (of(0), of(1))
    };
    let groups = value.as_array().expect("groups");
    groups.iter().map(|group| group.as_array().expect("a group").iter().map(pair).collect()).collect()
}
