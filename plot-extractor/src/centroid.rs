//! Where a target lies between cells, and how well that is known (C6).
//!
//! The response of pulse, Doppler filter and beam is Gaussian with known width, so a target δ cells from the
//! peak has in the cell k steps from it the amplitude a h_k, and what is measured there is Rice distributed:
//!
//! ```text
//! h_k = exp(−½ κ (k − δ)²),   κ = 4 ln 2 (cell / width)²
//! ln p(x_k | a, δ) = −x_k² − a² h_k² + ln I₀(2 x_k a h_k) + ln 2 x_k,   x_k² = power over noise,  k = −1, 0, 1
//! ```
//!
//! The place is the mean of δ given the three powers, its error the standard deviation: both from the
//! density of δ at places around that of a fitted parabola, the amplitude integrated out by Laplace's
//! approximation. Before the measurement δ is uniform in −1 … 1, as noise may raise a cell beside the
//! right one to the peak, and weak amplitudes are more frequent than strong ones. What is conditioned on what was seen stays
//! true however the plot was selected: by a threshold, or as the largest cell.
//!
//! Derivation: `docs/theory/cells-and-plots.md`.

/// Place along one axis relative to the centre of the peak cell, in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// δ, cells, in [−1, 1].
    pub cells: f64,
    /// Standard error of δ, cells.
    pub sigma: f64,
}

/// Variance of a place that is uniform within a cell, cells².
const UNIFORM_VARIANCE: f64 = 1.0 / 12.0;
/// Least standard error, cells: the responses of an instrument are never known better, and a tracker that is told a tenth of a metre takes every
/// turn of a target for an error. From 45 dB up it is more than noise alone would give.
const SIGMA_FLOOR: f64 = 0.002;
/// Measured signal-to-noise ratios are not taken below this: the logarithm needs a positive number.
const LEAST_SNR: f64 = 0.3;
/// How far the target may lie from the centre of the peak cell, cells.
const FARTHEST: f64 = 1.0;
/// Places at which the density of δ is computed.
const PLACES: usize = 17;
/// How far they reach to each side of the fitted place, standard errors.
const REACH: f64 = 5.0;
/// The density of amplitudes falls with this power of them: with S ∝ r⁻⁴ and targets spread evenly over the volume,
/// p(S) ∝ S^(−7/4), p(a) ∝ a^(−5/2).
const FEWER: f64 = 2.5;

/// Offset of the target from the peak cell. `powers` are over the noise, before, in and
/// after the peak; NaN where there is no cell. `curvature` is κ of the axis. The noise is the mean of `noise_cells` ≥ 2
/// cells, by which the expectation of the true one is larger by N/(N − 1).
pub fn interpolate(powers: [f64; 3], curvature: f64, noise_cells: u32) -> Offset {
    let Some(fitted) = fit(powers, curvature) else {
        return Offset { cells: 0.0, sigma: UNIFORM_VARIANCE.sqrt() }; // one cell alone
    };
    // What is not there counts with x = h = 0: it says nothing.
    let amplitude = powers.map(|power| if power.is_nan() { 0.0 } else { power.max(0.0).sqrt() });
    let first = (fitted.cells - REACH * fitted.sigma).max(-FARTHEST);
    let last = (fitted.cells + REACH * fitted.sigma).min(FARTHEST);
    let step = (last - first) / (PLACES - 1) as f64;
    let place = |index: usize| first + step * index as f64;
    let mut density = [0.0; PLACES];
    let mut a = amplitude[1];
    for (index, ln_density) in density.iter_mut().enumerate() {
        let response = std::array::from_fn(|cell| {
            let k = cell as f64 - 1.0;
            if powers[cell].is_nan() { 0.0 } else { (-0.5 * curvature * (k - place(index)).powi(2)).exp() }
        });
        *ln_density = ln_density_of_place(&amplitude, &response, &mut a);
    }
    let largest = density.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
    for (index, ln_density) in density.into_iter().enumerate() {
        let weight = (ln_density - largest).exp();
        sum += weight;
        mean += weight * place(index);
        square += weight * place(index) * place(index);
    }
    let mean = mean / sum;
    let noise = f64::from(noise_cells) / (f64::from(noise_cells) - 1.0);
    Offset { cells: mean, sigma: (noise * (square / sum - mean * mean).max(0.0)).sqrt().max(SIGMA_FLOOR) }
}

/// ln p(δ | x) up to a constant, for h of that δ; `a`, an amplitude to start from, becomes the most probable one.
fn ln_density_of_place(amplitude: &[f64; 3], response: &[f64; 3], a: &mut f64) -> f64 {
    let products: [f64; 3] = std::array::from_fn(|k| amplitude[k] * response[k]);
    let energy: f64 = response.iter().map(|h| h * h).sum();
    for _ in 0..2 {
        let seen: f64 = products.iter().map(|b| b * bessel_ratio(2.0 * b * *a)).sum();
        *a = (seen / energy).max(1.0);
    }
    let rice: f64 = products.iter().map(|b| ln_bessel(2.0 * b * *a)).sum();
    rice - *a * *a * energy - 0.5 * energy.ln() - FEWER * a.ln()
}

/// I₁(z)/I₀(z) to 5 %, z ≥ 0: the lower bound of Amos (1974).
fn bessel_ratio(z: f64) -> f64 {
    z / (0.5 + (z * z + 1.5 * 1.5).sqrt())
}

/// ln I₀(z), z ≥ 0, to 2·10⁻⁷: Abramowitz & Stegun 9.8.1, 9.8.2.
fn ln_bessel(z: f64) -> f64 {
    let polynomial = |coefficients: &[f64], t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if z < 3.75 {
        let t = (z / 3.75).powi(2);
        polynomial(&[1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3], t).ln()
    } else {
        let coefficients = [
            0.398_942_28,
            0.013_285_92,
            0.002_253_19,
            -0.001_575_65,
            0.009_162_81,
            -0.020_577_06,
            0.026_355_37,
            -0.016_476_33,
            0.003_923_77,
        ];
        z + (polynomial(&coefficients, 3.75 / z) / z.sqrt()).ln()
    }
}

/// The parabola through the logarithms of the powers: a weighted straight line through
/// y_k = ln S_k + κ k² = A' + 2 κ δ k, weights 1/var(ln S) = S²/(1 + 2S) from the fitted S, not the measured one,
/// which would favour cells that came out high. `None` if there is only one cell.
fn fit(powers: [f64; 3], curvature: f64) -> Option<Offset> {
    let snr = powers.map(|power| (power - 1.0).max(LEAST_SNR));
    let mut offset = None;
    let mut delta = 0.0;
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
            break;
        }
        let slope = (wky - wk * wy / w) / spread;
        delta = (slope / (2.0 * curvature)).clamp(-0.5, 0.5);
        offset = Some(Offset { cells: delta, sigma: 0.5 / curvature / spread.sqrt() });
    }
    offset
}

/// κ of an axis: cells of size `cell`, half-power response width `width`, same unit.
pub fn curvature(cell: f64, width: f64) -> f64 {
    4.0 * std::f64::consts::LN_2 * (cell / width).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};
    use proptest::prelude::*;
    use rand::RngExt;

    /// Exact noise.
    const KNOWN: u32 = u32::MAX;

    /// Exact for a noiseless echo of high signal-to-noise ratio.
    #[test]
    fn a_clean_gaussian_is_found_exactly() {
        for step in -4..=4 {
            let (delta, kappa) = (f64::from(step) * 0.1, 1.3);
            let power = |k: f64| 1.0 + 1e6 * (-kappa * (k - delta).powi(2)).exp();
            let offset = interpolate([power(-1.0), power(0.0), power(1.0)], kappa, KNOWN);
            assert!((offset.cells - delta).abs() < 1e-3, "{delta}: {offset:?}");
        }
    }

    #[test]
    fn one_cell_alone_is_uniform() {
        let offset = interpolate([f64::NAN, 30.0, f64::NAN], 1.3, KNOWN);
        assert!(offset.cells.abs() < 1e-12 && (offset.sigma - UNIFORM_VARIANCE.sqrt()).abs() < 1e-12);
    }

    /// At an end of the extent: the side that is seen says where the target is, and less well than both.
    #[test]
    fn one_neighbour_is_better_than_none() {
        let (delta, kappa) = (0.3, 1.3);
        let power = |k: f64| 1.0 + 300.0 * (-kappa * (k - delta).powi(2)).exp();
        let one = interpolate([f64::NAN, power(0.0), power(1.0)], kappa, KNOWN);
        let both = interpolate([power(-1.0), power(0.0), power(1.0)], kappa, KNOWN);
        assert!((one.cells - delta).abs() < one.sigma, "{one:?}");
        assert!(both.sigma <= one.sigma && one.sigma < UNIFORM_VARIANCE.sqrt(), "{both:?} {one:?}");
    }

    #[test]
    fn bessel_functions_are_those_of_their_series() {
        for z in [0.0, 0.3, 2.0, 3.7, 3.8, 10.0, 30.0_f64] {
            // I_n(z) = Σ (z/2)^(2m + n)/(m! (m + n)!).
            let (mut term, mut zero, mut one) = (1.0, 0.0, 0.0);
            for m in 0..200_u32 {
                zero += term;
                one += term * 0.5 * z / f64::from(m + 1);
                term *= 0.25 * z * z / f64::from(m + 1).powi(2);
            }
            assert!((ln_bessel(z) - f64::ln(zero)).abs() < 1e-6, "{z}");
            assert!((bessel_ratio(z) - one / zero).abs() < 0.04, "{z}: {}", one / zero);
        }
    }

    proptest! {
        /// Whatever powers come in, a place within reach and a positive error go out.
        #[test]
        fn nothing_breaks_it(ln_powers in prop::array::uniform3(-30.0..30.0_f64), kappa in 0.05..8.0_f64) {
            let offset = interpolate(ln_powers.map(f64::exp), kappa, 32);
            prop_assert!(offset.cells.abs() <= FARTHEST, "{offset:?}");
            prop_assert!(offset.sigma >= SIGMA_FLOOR && offset.sigma <= FARTHEST, "{offset:?}");
        }
    }

    /// Normalised squared error of drawn echoes whose amplitudes are spread as assumed: mean in 0.9…1.1, by the power that was
    /// measured (standard error 0.02 and less). The target may lie beside the cell that came out largest.
    #[test]
    fn the_stated_error_is_the_error() {
        let mut rng = generator(2, Purpose::Test, 0, 0);
        for kappa in [1.33, 1.64] {
            // Bins of the measured peak, dB: 11-14, 14-17, 17-20, above.
            let (mut sums, mut counts) = ([0.0; 4], [0_u32; 4]);
            while counts.iter().any(|&count| count < 8000) {
                let delta: f64 = 4.0 * rng.random::<f64>() - 2.0;
                // p(S) ∝ S^(−7/4) above 1.
                let peak = (1.0 - rng.random::<f64>()).powf(-4.0 / 3.0).min(1e5);
                let mut power = |k: f64| {
                    let signal = (peak * (-kappa * (k - delta).powi(2)).exp()).sqrt();
                    let (rho, phi) = ((-rng.random::<f64>().ln()).sqrt(), rng.random::<f64>() * std::f64::consts::TAU);
                    (signal + rho * phi.cos()).powi(2) + (rho * phi.sin()).powi(2)
                };
                let powers = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(&mut power);
                if powers.iter().any(|&power| power > powers[3]) || powers[3] < 12.6 {
                    continue; // another cell would be the peak, or nothing is seen
                }
                let offset = interpolate([powers[2], powers[3], powers[4]], kappa, KNOWN);
                let bin = (((10.0 * powers[3].log10() - 11.0) / 3.0) as usize).min(3);
                sums[bin] += ((offset.cells - delta) / offset.sigma).powi(2);
                counts[bin] += 1;
            }
            for (bin, (sum, count)) in sums.iter().zip(counts).enumerate() {
                let mean = sum / f64::from(count);
                assert!((0.9..1.1).contains(&mean), "bin {bin}, κ {kappa}: {mean} ({count})");
            }
        }
    }
}
