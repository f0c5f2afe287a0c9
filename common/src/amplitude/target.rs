//! Power of a cell that holds a target: detection, density and likelihood ratio by Swerling's cases (C4), (C5), (C13).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Detector, FalsePower, LN_OUTLIERS, NoiseEstimate};

/// Largest likelihood ratio returned: beyond, only the sign of the evidence matters, and
/// products with a Gaussian density stay finite.
pub const MAX_RATIO: f64 = 1e250;

/// ζ: share of a target's plots that may be of any strength.
pub(super) const GLINTS: f64 = 0.05;

/// By how much sums of a few logarithms may be off.
const ROUNDING: f64 = 1e-9;

/// Signal-to-noise ratios over which an unknown one is averaged.
pub(super) const SNR_POINTS: usize = 5;

/// How the amplitude of a target fluctuates from scan to scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Swerling {
    /// Swerling 0: constant.
    #[serde(rename = "0")]
    Zero,
    /// Swerling I: exponential power, one draw a scan.
    #[serde(rename = "I")]
    One,
    /// Swerling III: χ² power with 4 degrees of freedom, one draw a scan.
    #[serde(rename = "III")]
    Three,
}

/// Statistics of q in a cell that holds a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetStatistics {
    detector: Detector,
    swerling: Swerling,
    /// S; the first `points` of them count, equally.
    snr: [f64; SNR_POINTS],
    points: usize,
    /// D, probability that the target is detected.
    pub detection_probability: f64,
    /// ln F.
    ln_pfa: f64,
    /// ln(F/D).
    ln_scale: f64,
    /// ln (1 + S), by point.
    ln_mean: [f64; SNR_POINTS],
}

impl TargetStatistics {
    /// Before a target whose mean S is, with equal probability, one of the first `points` of `snr`.
    pub(super) fn new(detector: Detector, swerling: Swerling, snr: [f64; SNR_POINTS], points: usize) -> Self {
        let ln_mean = snr.map(f64::ln_1p);
        let ln_pfa = detector.pfa.ln();
        let mut target =
            Self { detector, swerling, snr, points, detection_probability: 1.0, ln_pfa, ln_scale: 0.0, ln_mean };
        target.detection_probability = target.survival(detector.threshold).clamp(f64::MIN_POSITIVE, 1.0);
        target.ln_scale = ln_pfa - target.detection_probability.ln();
        target
    }

    /// The detector before which the target stands.
    pub fn detector(&self) -> &Detector {
        &self.detector
    }

    /// P_S(q > t).
    pub fn survival(&self, t: f64) -> f64 {
        let points = &self.snr[..self.points];
        points.iter().map(|&snr| self.survival_at(t, snr)).sum::<f64>() / self.points as f64
    }

    fn survival_at(&self, t: f64, snr: f64) -> f64 {
        match self.swerling {
            Swerling::Zero => self.steady_survival(t, snr),
            Swerling::One => self.detector.gamma_1(t, 1.0 + snr).survival(),
            Swerling::Three => {
                let a = 0.5 * snr;
                let one = self.detector.gamma_1(t, 1.0 + a).survival();
                let two = self.detector.gamma_2(t, 1.0 + a).survival();
                (one + a * two) / (1.0 + a)
            }
        }
    }

    /// f_S(q), not normalised above the threshold.
    pub fn density(&self, q: f64) -> f64 {
        (self.ln_ratio(q) + self.detector.gamma_1(q, 1.0).ln_density).exp()
    }

    /// ln ℓ(q), ℓ = f_S/f_N without thresholds.
    pub fn ln_ratio(&self, q: f64) -> f64 {
        if self.points == 1 {
            return self.ln_ratio_at(q, 0);
        }
        let ratios: [f64; SNR_POINTS] = std::array::from_fn(|point| self.ln_ratio_at(q, point));
        let largest = ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = ratios.iter().map(|ratio| (ratio - largest).exp()).sum::<f64>() / SNR_POINTS as f64;
        largest + mean.ln()
    }

    fn ln_ratio_at(&self, q: f64, point: usize) -> f64 {
        let snr = self.snr[point];
        match self.swerling {
            Swerling::Zero => self.steady_ln_ratio(q, snr),
            Swerling::One if self.detector.noise == NoiseEstimate::Known => q * snr / (1.0 + snr) - self.ln_mean[point],
            Swerling::One | Swerling::Three => self.ln_density_at(q, point) - self.detector.gamma_1(q, 1.0).ln_density,
        }
    }

    /// ln f_S(q) for one of the signal-to-noise ratios.
    fn ln_density_at(&self, q: f64, point: usize) -> f64 {
        let snr = self.snr[point];
        match self.swerling {
            Swerling::Zero => self.steady_ln_ratio(q, snr) + self.detector.gamma_1(q, 1.0).ln_density,
            Swerling::One => self.detector.gamma_1_of(q, 1.0 + snr, self.ln_mean[point]).ln_density,
            Swerling::Three => {
                let a = 0.5 * snr;
                let one = self.detector.gamma_1(q, 1.0 + a).ln_density;
                let two = self.detector.gamma_2(q, 1.0 + a).ln_density + a.ln();
                let larger = one.max(two);
                larger + ((one - larger).exp() + (two - larger).exp()).ln() - a.ln_1p()
            }
        }
    }

    /// λ(q) of (C5), at most [`MAX_RATIO`].
    pub fn likelihood_ratio(&self, q: f64) -> f64 {
        (self.ln_ratio(q) + self.ln_scale).exp().min(MAX_RATIO)
    }

    /// λ(q) against false plots that are not all noise's:
    ///
    /// ```text
    /// min( [(1 − ζ) f_S(q)/D + ζ h(q)] / max( f_N(q)/F,  e^(−(q − t₀)/m)/m,  η h(q) ),  1/η ),   h(q) = 1/(q ln 10⁶)
    /// ```
    ///
    /// The largest of the densities is the cautious one: spiky clutter and other radars' pulses then prove nothing, nor do pulses that are all as
    /// strong as the target. A target may glint: ζ of its plots are of any strength too.
    pub fn likelihood_ratio_among(&self, q: f64, among: FalsePower) -> f64 {
        let FalsePower { mean_excess, outliers } = among;
        let ln_noise = || self.detector.gamma_1(q, 1.0).ln_density - self.ln_pfa;
        let excess = q - self.detector.threshold;
        if outliers <= 0.0 {
            let ln_ratio = self.ln_ratio(q) + self.ln_scale;
            if mean_excess <= 0.0 {
                return ln_ratio.exp().min(MAX_RATIO);
            }
            let ln_clutter = -excess / mean_excess - mean_excess.ln();
            return (ln_ratio + (ln_noise() - ln_clutter).min(0.0)).exp().min(MAX_RATIO);
        }
        // No density of false plots vanishes here, so that logarithms are not needed.
        let any_strength = if excess >= 0.0 { 1.0 / (q * LN_OUTLIERS) } else { 0.0 };
        let clutter = if mean_excess > 0.0 { (-excess / mean_excess).exp() / mean_excess } else { 0.0 };
        let false_plots = ln_noise().exp().max(clutter).max(outliers * any_strength);
        let points = (0..self.points).map(|point| self.ln_density_at(q, point).exp());
        let density = points.sum::<f64>() / (self.points as f64 * self.detection_probability);
        let target = (1.0 - GLINTS) * density + GLINTS * any_strength;
        (target / false_plots).min(1.0 / outliers)
    }

    /// At least λ(q), whatever the false plots are like, and quickly: the likeliest signal-to-noise ratio stands for all, and false plots are
    /// those of noise, the fewest there are.
    pub fn greatest_likelihood_ratio(&self, q: f64) -> f64 {
        let points = (0..self.points).map(|point| self.ln_ratio_at(q, point));
        let target = (points.fold(f64::NEG_INFINITY, f64::max) + self.ln_scale + ROUNDING).exp();
        let ln_noise = self.detector.gamma_1(q, 1.0).ln_density - self.ln_pfa;
        let glints = if q > 0.0 { GLINTS / (q * LN_OUTLIERS) * (-ln_noise).exp() } else { 0.0 };
        target + glints
    }

    /// Swerling 0: D = Σ_k Poisson(k; S) P(I ≤ k), where I counts the noise events before the
    /// threshold: Poisson of mean t for known noise, negative binomial for CA-CFAR (the
    /// identity between gamma or beta tails and counts). All terms are positive.
    fn steady_survival(&self, t: f64, snr: f64) -> f64 {
        let noise = self.detector.gamma_at(t, snr);
        let mut event = noise.map_or(-t, |gamma| gamma.ln_survival).exp(); // P(I = 0)
        let mut at_most = event;
        let (mut sum, mut poisson_sum) = (0.0, 0.0);
        let end = snr + 12.0 * snr.sqrt() + 40.0;
        let mut k = 0.0;
        while k <= end {
            let poisson = ln_poisson(k, snr).exp();
            sum += poisson * at_most;
            poisson_sum += poisson;
            k += 1.0;
            event *= noise.map_or(t, |gamma| t / gamma.rate * (gamma.shape + k - 1.0)) / k;
            at_most += event;
            // Past the bulk of I every further k is a detection.
            if k > t && event < 1e-18 * at_most {
                return (sum + (1.0 - poisson_sum).max(0.0)).min(1.0);
            }
        }
        sum.min(1.0)
    }

    /// Swerling 0: ℓ = Σ_k T_k with T_k = Poisson(k; S) · q^k/k! for known noise and
    /// Poisson(k; S) · x^k C(N+k, k), x = q/(N+q), for CA-CFAR; summed outwards from the largest term. Other estimates take
    /// the place of a Γ power (C13), whose own density in noise is exchanged for theirs.
    fn steady_ln_ratio(&self, q: f64, snr: f64) -> f64 {
        let noise = self.detector.gamma_at(q, snr);
        let known = noise.is_none();
        let (n, x) = noise.map_or((0.0, 1.0), |gamma| (gamma.shape, q / gamma.rate));
        let exchanged = match (self.detector.noise, noise) {
            (NoiseEstimate::Known | NoiseEstimate::Mean(_), _) | (_, None) => 0.0,
            (_, Some(gamma)) => {
                gamma.ln_survival + (gamma.shape / gamma.rate).ln() - self.detector.gamma_1(q, 1.0).ln_density
            }
        };
        let step = |k: f64| {
            // T_(k+1) / T_k
            let growth = if known { snr * q } else { snr * x * (n + k + 1.0) };
            growth / ((k + 1.0) * (k + 1.0))
        };
        let rate = snr * x;
        let peak = if known { (snr * q).sqrt() } else { 0.5 * (rate + (rate * rate + 4.0 * rate * n).sqrt()) }.floor();
        let ln_peak = if peak == 0.0 {
            -snr
        } else if known {
            ln_poisson(peak, snr) + peak * q.ln() - ln_factorial(peak)
        } else {
            ln_poisson(peak, snr) + peak * x.ln() + ln_factorial(n + peak) - ln_factorial(n) - ln_factorial(peak)
        };
        let (mut sum, mut term, mut k) = (1.0, 1.0, peak);
        while term > 1e-18 * sum {
            term *= step(k);
            k += 1.0;
            sum += term;
        }
        (term, k) = (1.0, peak);
        while k > 0.0 && term > 1e-18 * sum {
            k -= 1.0;
            term /= step(k);
            sum += term;
        }
        exchanged + ln_peak + sum.ln()
    }
}

/// ln of the Poisson probability of `k` at mean `mean`.
pub(super) fn ln_poisson(k: f64, mean: f64) -> f64 {
    if k == 0.0 {
        return -mean;
    }
    k * mean.ln() - mean - ln_factorial(k)
}

fn ln_factorial(k: f64) -> f64 {
    libm::lgamma(k + 1.0)
}
