//! The association rule (T20) one track at a time, as it is written.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{SMatrix, SVector};
use tracker::association::gate::Gate;
use tracker::filter::gaussian::at;
use tracker::filter::uav::MODES;
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

use super::expected::{Expected, Likelihood};
use super::imm::Imm;
use super::motion::DIMENSIONS;

/// A plot that the track may have caused.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice {
    pub plot: Measurement,
    /// Its time minus the prediction's, s.
    pub offset_s: f64,
    /// a = ℓ/ρ, m³·m/s.
    pub gain: f64,
}

/// What the scan did.
#[derive(Debug, Clone)]
pub(crate) struct Posterior {
    pub imm: Imm,
    pub likelihood: [f64; MODES],
    pub none: [f64; MODES],
    /// By candidate, then mode.
    pub plots: Vec<[f64; MODES]>,
    /// By candidate, then mode: how many times the error of one rounding e_m may be in error, relatively, whoever computes it.
    pub growth: Vec<[f64; MODES]>,
}

/// What each mode expects.
pub(crate) fn expect(prediction: &Imm) -> [Expected; MODES] {
    std::array::from_fn(|j| Expected::new(j, &prediction.modes[j]))
}

/// One gate per mode.
pub(crate) fn gates(expected: &[Expected; MODES], radar: &Radar, alpha: f64) -> [Gate; MODES] {
    expected.map(|expected| {
        let mut half: [f64; COORDINATES] =
            std::array::from_fn(|i| alpha * (expected.polar_variance[i] + radar.variance[i]).sqrt());
        half[1] = half[1].min(FRAC_PI_2);
        half[2] = half[2].min(FRAC_PI_2);
        Gate {
            centre: expected.polar(),
            predicted: expected.polar_variance,
            drift: expected.drift(),
            half,
            cos_elevation: expected.frame.cos_elevation,
            alpha,
        }
    })
}

/// Weights and moments, with every plot's own posterior written out (T8), (T14).
pub(crate) fn update(prediction: &Imm, choices: &[Choice], miss: [f64; MODES], inflation: f64) -> Posterior {
    let mut posterior = Posterior {
        imm: *prediction,
        likelihood: miss,
        none: [1.0; MODES],
        plots: vec![[0.0; MODES]; choices.len()],
        growth: vec![[1.0; MODES]; choices.len()],
    };
    for (j, &n) in DIMENSIONS.iter().enumerate() {
        let prior = &prediction.modes[j];
        let expected = Expected::new(j, prior);
        let terms: Vec<(f64, Term)> = choices
            .iter()
            .map(|choice| match expected.likelihood(&choice.plot, inflation) {
                Some(likelihood) => Term::new(&expected, &likelihood, choice, n),
                None => (0.0, Term::none()),
            })
            .collect();
        for (growth, choice) in posterior.growth.iter_mut().zip(choices) {
            if let Some(likelihood) = expected.likelihood(&choice.plot, inflation) {
                growth[j] = growth_of(&likelihood, &expected.innovation(&choice.plot, choice.offset_s), &choice.plot);
            }
        }
        let total = miss[j] + terms.iter().map(|(e, _)| e).sum::<f64>();
        if !(total > 0.0 && total < f64::MAX) {
            continue;
        }
        posterior.likelihood[j] = total;
        posterior.none[j] = miss[j] / total;
        for (weights, (e, _)) in posterior.plots.iter_mut().zip(&terms) {
            weights[j] = e / total;
        }
        // û, then every term's covariance and spread about it.
        let mut step = SVector::<f64, 9>::zeros();
        for (e, term) in &terms {
            step += term.step * (e / total);
        }
        let mut covariance = step * step.transpose() * posterior.none[j];
        for (e, term) in &terms {
            let from = term.step - step;
            covariance += (from * from.transpose() - term.gained) * (e / total);
        }
        let state = &mut posterior.imm.modes[j];
        for b in 0..n {
            state.mean[b] += step[b];
            for a in 0..=b {
                state.covariance[at(a, b)] += covariance[(a, b)];
            }
        }
    }
    // W_j ∝ W*_j L_j.
    let largest = posterior.likelihood.into_iter().fold(0.0, f64::max);
    let weights: [f64; MODES] =
        std::array::from_fn(|j| prediction.probability[j] * (posterior.likelihood[j] / largest));
    let total: f64 = weights.iter().sum();
    if largest > 0.0 && largest < f64::MAX && total > 0.0 && total < f64::MAX {
        posterior.imm.probability = weights.map(|w| w / total);
    }
    if !posterior.imm.is_sound() {
        posterior.imm = *prediction;
    }
    posterior
}

/// e = a N(d; 0, D) depends on the exponent ½ dᵀ D⁻¹ d, which nobody knows better than to κ roundings of its size, κ being the
/// condition number of D with unit variances (others are rounding errors of the scale, which Cholesky's method does not see), and on |D|,
/// whose relative error is at most the dimension times κ roundings. And d = y − h is a difference of large numbers: a rounding of y
/// moves the exponent by |D⁻¹ d| |y|.
fn growth_of(likelihood: &Likelihood, d: &[f64; COORDINATES], plot: &Measurement) -> f64 {
    let known: Vec<usize> = (0..COORDINATES).filter(|&i| likelihood.inverse[at(i, i)] > 0.0).collect();
    let scaled = nalgebra::DMatrix::from_fn(known.len(), known.len(), |i, j| {
        let (i, j) = (known[i], known[j]);
        likelihood.inverse[at(i, j)] / (likelihood.inverse[at(i, i)] * likelihood.inverse[at(j, j)]).sqrt()
    });
    let eigenvalues = scaled.symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min().max(f64::EPSILON);
    let slope = likelihood.solve(*d);
    let exponent: f64 = 0.5 * d.iter().zip(slope).map(|(d, y)| d * y).sum::<f64>();
    let [x, y, z] = plot.position;
    let measured = [x, y, z, plot.polar[3]];
    let shift: f64 = slope.iter().zip(measured).map(|(slope, y)| (slope * y).abs()).sum();
    (known.len() as f64 + exponent) * condition + shift
}

/// What one plot alone would do to the state.
struct Term {
    /// K d = û_m − u*.
    step: SVector<f64, 9>,
    /// K H P* = P* − P̃.
    gained: SMatrix<f64, 9, 9>,
}

impl Term {
    fn none() -> Self {
        Self { step: SVector::zeros(), gained: SMatrix::zeros() }
    }

    /// With e_m.
    fn new(expected: &Expected, likelihood: &Likelihood, choice: &Choice, n: usize) -> (f64, Self) {
        let d = expected.innovation(&choice.plot, choice.offset_s);
        let y = likelihood.solve(d);
        let product =
            |a: &[f64; COORDINATES], b: &[f64; COORDINATES]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let e = choice.gain * (likelihood.ln_peak - 0.5 * product(&d, &y)).exp();
        let b = &expected.cross;
        let mut term = Self::none();
        for i in 0..n {
            term.step[i] = product(&b[i], &y);
            for k in 0..n {
                term.gained[(i, k)] = product(&b[i], &likelihood.solve(b[k]));
            }
        }
        (e, term)
    }
}
