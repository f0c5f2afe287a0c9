//! Where a target lies between cells, and how well that is known (C6).
//!
//! The response of pulse, Doppler filter and beam is Gaussian with known width, so the
//! logarithm of the echo's power falls as a known parabola about the target:
//!
//! ```text
//! ln S_k = A − κ (k − δ)²,   κ = 4 ln 2 (cell / width)²
//! y_k = ln S_k + κ k² = A' + 2 κ δ k
//! ```
//!
//! with S_k the signal-to-noise ratio in the cell k steps from the peak. δ is half the
//! slope over κ of a weighted straight line through k = −1, 0, 1. One measured power is 1 + S
//! on the average with variance 1 + 2S, so ln S has variance (1 + 2S)/S²; weights come
//! from the fitted S, not the measured one, which would favour cells that came out high.
//! The peak is the largest cell, so δ has the prior variance 1/12 of a uniform
//! distribution within a cell; with it no error exceeds cell/(2√3) (C1).
//!
//! Derivation: `docs/theory/cells-and-plots.md`.

/// Place along one axis relative to the centre of the peak cell, in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// δ, cells, in [−½, ½].
    pub cells: f64,
    /// Standard error of δ, cells.
    pub sigma: f64,
}

/// Variance of a place that is uniform within a cell, cells².
const UNIFORM_VARIANCE: f64 = 1.0 / 12.0;
/// Least standard error, cells: responses are never known better.
const SIGMA_FLOOR: f64 = 0.002;
/// Measured signal-to-noise ratios are not taken below this: the logarithm needs a positive number.
const LEAST_SNR: f64 = 0.3;

/// Offset of the target from the peak cell. `powers` are over the noise, before, in and
/// after the peak; NaN where there is no cell. `curvature` is κ of the axis.
pub fn interpolate(powers: [f64; 3], curvature: f64) -> Offset {
    let snr = powers.map(|power| (power - 1.0).max(LEAST_SNR));
    let mut delta = 0.0;
    let mut variance = f64::INFINITY;
    for _ in 0..3 {
        let (mut w, mut wk, mut wkk, mut wy, mut wky) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (index, k) in [-1.0_f64, 0.0, 1.0].into_iter().enumerate() {
            if powers[index].is_nan() {
                continue;
            }
            let fitted = snr[1] * (-curvature * ((k - delta).powi(2) - delta * delta)).exp();
            let weight = fitted * fitted / (1.0 + 2.0 * fitted);
            let y = snr[index].ln() + curvature * k * k;
            w += weight;
            wk += weight * k;
            wkk += weight * k * k;
            wy += weight * y;
            wky += weight * k * y;
        }
        let spread = wkk - wk * wk / w;
        if spread <= 0.0 || spread.is_nan() {
            break; // one cell alone
        }
        let slope = (wky - wk * wy / w) / spread;
        variance = 1.0 / spread / (4.0 * curvature * curvature);
        let trust = UNIFORM_VARIANCE / (UNIFORM_VARIANCE + variance);
        delta = (trust * slope / (2.0 * curvature)).clamp(-0.5, 0.5);
    }
    let variance = if variance.is_finite() {
        variance * UNIFORM_VARIANCE / (variance + UNIFORM_VARIANCE)
    } else {
        UNIFORM_VARIANCE
    };
    Offset { cells: delta, sigma: variance.sqrt().max(SIGMA_FLOOR) }
}

/// κ of an axis: cells of size `cell`, half-power response width `width`, same unit.
pub fn curvature(cell: f64, width: f64) -> f64 {
    4.0 * std::f64::consts::LN_2 * (cell / width).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};
    use rand::RngExt;

    /// Exact for a noiseless echo of high signal-to-noise ratio.
    #[test]
    fn a_clean_gaussian_is_found_exactly() {
        for step in -4..=4 {
            let (delta, kappa) = (f64::from(step) * 0.1, 1.3);
            let power = |k: f64| 1.0 + 1e6 * (-kappa * (k - delta).powi(2)).exp();
            let offset = interpolate([power(-1.0), power(0.0), power(1.0)], kappa);
            assert!((offset.cells - delta).abs() < 1e-3, "{delta}: {offset:?}");
        }
    }

    #[test]
    fn one_cell_alone_is_uniform() {
        let offset = interpolate([f64::NAN, 30.0, f64::NAN], 1.3);
        assert!(offset.cells.abs() < 1e-12 && (offset.sigma - UNIFORM_VARIANCE.sqrt()).abs() < 1e-12);
    }

    /// Normalised squared error of drawn echoes: mean in 0.8…1.25 at every signal-to-noise
    /// ratio (20,000 draws each, standard error 0.01).
    #[test]
    fn the_stated_error_is_the_error() {
        let mut rng = generator(2, Purpose::Test, 0, 0);
        for snr_db in [13.0, 16.0, 20.0, 30.0, 40.0] {
            for kappa in [1.33, 1.64] {
                let peak = 10.0_f64.powf(snr_db / 10.0);
                let (mut sum, mut runs) = (0.0, 0);
                while runs < 20_000 {
                    let delta: f64 = rng.random::<f64>() - 0.5;
                    let mut power = |k: f64| {
                        let signal = (peak * (-kappa * (k - delta).powi(2)).exp()).sqrt();
                        let (rho, phi) =
                            ((-rng.random::<f64>().ln()).sqrt(), rng.random::<f64>() * std::f64::consts::TAU);
                        (signal + rho * phi.cos()).powi(2) + (rho * phi.sin()).powi(2)
                    };
                    let powers = [power(-1.0), power(0.0), power(1.0)];
                    if powers[0] > powers[1] || powers[2] > powers[1] {
                        continue; // another cell would be the peak
                    }
                    let offset = interpolate(powers, kappa);
                    sum += ((offset.cells - delta) / offset.sigma).powi(2);
                    runs += 1;
                }
                let mean = sum / f64::from(runs);
                assert!((0.8..1.25).contains(&mean), "{snr_db} dB, κ {kappa}: {mean}");
            }
        }
    }
}
