//! Statistics of a plot's power, with and without a target behind it (C3)-(C5).
//!
//! The decision statistic of a cell is q = z²: its power over the noise power, which is either
//! known or estimated: as the mean of N reference cells (CA-CFAR), or otherwise ([`NoiseEstimate`]). All formulas are in q; a
//! [`crate::plots::Plot`] carries z. S is the mean signal-to-noise ratio as a power ratio.
//!
//! ```text
//! CA-CFAR threshold      α = N (F^(−1/N) − 1);  known noise  t₀ = −ln F          (C3)
//! noise                  P(q > t) = (1 + t/N)^(−N)        → e^(−t)  for N → ∞    (C4)
//! Swerling I             as noise with t/(1+S) for t
//! Swerling III           1/(1+a) of an exponential and a/(1+a) of a Γ(2) power, both of
//!                        scale 1+a, a = S/2
//! Swerling 0             a Poisson mixture of Γ(k+1) powers, k of mean S
//! λ(q) = [f_S(q)/D] / [f_N(q)/F],  D = P_S(q > t₀)                               (C5)
//! ```
//!
//! Every ratio is formed in logarithms: nothing overflows 50 dB above the noise or far out in
//! the tails. Derivation: `docs/theory/amplitude.md`.

mod noise;
mod target;

pub use noise::{Cfar, MapMemory, NoiseEstimate, rank};
pub use target::{MAX_RATIO, Swerling, TargetStatistics};

use crate::units::from_db;
use noise::Transform;
use target::SNR_POINTS;

/// Factor α of CA-CFAR (C3): with `q > α q̄` over `reference_cells` cells of exponential noise
/// the probability of false alarm is exactly `pfa`. 0 cells stand for known noise.
///
/// ```text
/// α = N (F^(−1/N) − 1),   −ln F for N = 0
/// ```
///
/// # Panics
/// Unless `pfa` lies between 0 and 1, both excluded.
pub fn ca_cfar_factor(reference_cells: u32, pfa: f64) -> f64 {
    assert!(pfa > 0.0 && pfa < 1.0, "probability of false alarm {pfa} is not between 0 and 1");
    if reference_cells == 0 {
        return -pfa.ln();
    }
    let n = f64::from(reference_cells);
    n * (-pfa.ln() / n).exp_m1()
}

/// Logarithm of how far outliers reach above the threshold: 60 dB.
const LN_OUTLIERS: f64 = 6.0 * std::f64::consts::LN_10;

/// How strong false plots are that are not all noise's.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct FalsePower {
    /// m: mean of q − t₀ above the threshold; 0 for that of noise.
    pub mean_excess: f64,
    /// η: share of false plots that may be of any strength, every decibel alike up to 60 dB above the threshold.
    pub outliers: f64,
}

/// A detector: its threshold and the statistics of q in noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detector {
    /// F, probability of false alarm per cell.
    pub pfa: f64,
    /// How the noise power is estimated.
    pub noise: NoiseEstimate,
    /// t₀, threshold on q.
    pub threshold: f64,
}

impl Detector {
    /// A CA-CFAR over `reference_cells` cells; 0 for known noise.
    ///
    /// # Panics
    /// Unless `pfa` lies between 0 and 1, both excluded.
    pub fn new(pfa: f64, reference_cells: u32) -> Self {
        Self::with(pfa, NoiseEstimate::new(Cfar::Ca, reference_cells))
    }

    /// A detector with this estimate of the noise.
    ///
    /// # Panics
    /// As [`Detector::new`].
    pub fn with(pfa: f64, noise: NoiseEstimate) -> Self {
        Self { pfa, noise, threshold: noise.factor(pfa) }
    }

    /// P(q > t) in noise (C4); F at the threshold.
    pub fn noise_survival(&self, t: f64) -> f64 {
        self.gamma_1(t, 1.0).survival()
    }

    /// Density of q in noise, not normalised above the threshold (C4).
    pub fn noise_density(&self, q: f64) -> f64 {
        self.gamma_1(q, 1.0).ln_density.exp()
    }

    /// Mean of q − t₀ over false alarms: 1 for known noise, (N + t₀)/(N − 1) for CA-CFAR, and this with the numbers of the
    /// Γ power that is like g at t₀ for the others (C13).
    pub fn noise_mean_excess(&self) -> f64 {
        match self.noise {
            NoiseEstimate::Known | NoiseEstimate::Mean(0..2) => 1.0,
            NoiseEstimate::Mean(cells) => (f64::from(cells) + self.threshold) / (f64::from(cells) - 1.0),
            other => {
                let gamma = Gamma::like(other.transform(self.threshold), 0.0);
                if gamma.shape > 1.0 { gamma.rate / (gamma.shape - 1.0) } else { 1.0 }
            }
        }
    }

    /// Power that noise exceeds with a probability.
    pub fn power_exceeded_by(&self, probability: f64) -> f64 {
        self.noise.factor(probability)
    }

    /// Share of false plots that exceed t ≥ t₀.
    pub fn false_share_above(&self, t: f64, among: FalsePower) -> f64 {
        let noise = self.noise_survival(t) / self.pfa;
        let clutter = (-(t - self.threshold) / among.mean_excess).exp();
        let outliers = among.outliers * (1.0 - (t / self.threshold).ln() / LN_OUTLIERS).max(0.0);
        noise.max(outliers).max(if among.mean_excess > 0.0 { clutter } else { 0.0 })
    }

    /// The same detector before a target of mean signal-to-noise ratio `snr` (power ratio ≥ 0).
    pub fn target(&self, swerling: Swerling, snr: f64) -> TargetStatistics {
        TargetStatistics::new(*self, swerling, [snr; SNR_POINTS], 1)
    }

    /// The same before a target whose signal-to-noise ratio is only known to lie within `spread_db` of `snr_db`: densities and D
    /// are averaged over the interval, every decibel alike (T20.5).
    pub fn target_within(&self, swerling: Swerling, snr_db: f64, spread_db: f64) -> TargetStatistics {
        if spread_db <= 0.0 {
            return self.target(swerling, from_db(snr_db));
        }
        let step_db = 2.0 * spread_db / SNR_POINTS as f64;
        let first_db = snr_db - spread_db + 0.5 * step_db;
        TargetStatistics::new(
            *self,
            swerling,
            std::array::from_fn(|k| from_db(first_db + step_db * k as f64)),
            SNR_POINTS,
        )
    }

    /// The same before a target of which nothing is known but that most are about `snr_db` strong and some 10 and 20 dB more.
    pub fn target_of_unknown_power(&self, swerling: Swerling, snr_db: f64) -> TargetStatistics {
        TargetStatistics::new(
            *self,
            swerling,
            [0.0, 0.0, 0.0, 10.0, 20.0].map(|more_db| from_db(snr_db + more_db)),
            SNR_POINTS,
        )
    }

    /// An exponential power of mean `mean` over the noise estimate.
    fn gamma_1(&self, q: f64, mean: f64) -> Tail {
        self.gamma_1_of(q, mean, mean.ln())
    }

    /// The same with the logarithm of the mean at hand.
    #[inline]
    fn gamma_1_of(&self, q: f64, mean: f64, ln_mean: f64) -> Tail {
        match self.noise {
            NoiseEstimate::Known => Tail { ln_survival: -q / mean, ln_density: -q / mean - ln_mean },
            NoiseEstimate::Mean(cells) => {
                let n = f64::from(cells);
                let ln_y = (q / (n * mean)).ln_1p();
                Tail { ln_survival: -n * ln_y, ln_density: -(n + 1.0) * ln_y - ln_mean }
            }
            other => {
                let at = other.transform(q / mean);
                Tail { ln_survival: at.ln_m, ln_density: at.ln_m + at.a.ln() - ln_mean }
            }
        }
    }

    /// A power of two degrees Γ(2) with scale `scale` over the noise estimate.
    fn gamma_2(&self, q: f64, scale: f64) -> Tail {
        let y = q / scale;
        match self.noise {
            NoiseEstimate::Known => Tail { ln_survival: -y + y.ln_1p(), ln_density: -y + y.ln() - scale.ln() },
            NoiseEstimate::Mean(cells) => {
                let n = f64::from(cells);
                let y = q / (n * scale);
                let ln_y = y.ln_1p();
                Tail {
                    ln_survival: -n * ln_y + (n * y / (1.0 + y)).ln_1p(),
                    ln_density: -(n + 2.0) * ln_y + ((n + 1.0) * y).ln() - scale.ln(),
                }
            }
            other => {
                let Transform { ln_m, a, b } = other.transform(y);
                Tail { ln_survival: ln_m + (y * a).ln_1p(), ln_density: ln_m + (y * (a * a + b)).ln() - scale.ln() }
            }
        }
    }

    /// The Γ power in whose place the noise estimate stands before a steady target of `snr`, seen at a power `t` (C13); none
    /// for known noise.
    ///
    /// The product of the densities of target and estimate is largest near g = 1 if S is at least t. If it is less, the draws of
    /// g that count are those that noise at the power s = t − √(S t) favours.
    fn gamma_at(&self, t: f64, snr: f64) -> Option<Gamma> {
        match self.noise {
            NoiseEstimate::Known => None,
            NoiseEstimate::Mean(cells) => {
                let n = f64::from(cells);
                Some(Gamma { shape: n, rate: n + t, ln_survival: -n * (t / n).ln_1p() })
            }
            other => {
                let favoured = (t - (snr * t).sqrt()).max(0.0);
                Some(Gamma::like(other.transform(favoured), t - favoured))
            }
        }
    }
}

/// A Γ power like g, among the draws of g that noise at some power favours (C13).
#[derive(Debug, Clone, Copy)]
struct Gamma {
    shape: f64,
    /// Including the power.
    rate: f64,
    /// ln of the probability that noise exceeds the power.
    ln_survival: f64,
}

impl Gamma {
    /// Of mean A and variance B at one power, seen `beyond` it.
    fn like(at: Transform, beyond: f64) -> Self {
        let (shape, rate) = (at.a * at.a / at.b, at.a / at.b);
        Self { shape, rate: rate + beyond, ln_survival: at.ln_m - shape * (beyond / rate).ln_1p() }
    }
}

/// Tail probability and density of a power at one place, as logarithms.
#[derive(Debug, Clone, Copy)]
struct Tail {
    ln_survival: f64,
    ln_density: f64,
}

impl Tail {
    fn survival(self) -> f64 {
        self.ln_survival.exp()
    }
}

#[cfg(test)]
mod tests {
    use super::target::{GLINTS, ln_poisson};
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    const ALL: [Swerling; 3] = [Swerling::Zero, Swerling::One, Swerling::Three];

    /// ∫ f above `from` by Gauss-Legendre panels that follow the tail.
    fn integral(f: impl Fn(f64) -> f64, from: f64, scale: f64) -> f64 {
        // Nodes and weights of 5-point Gauss-Legendre.
        let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_47, 0.236_926_885_056_189_08];
        let (mut sum, mut left, mut width) = (0.0, from, 0.02 * scale);
        while left < from + 1e9 * scale {
            let (middle, half) = (left + 0.5 * width, 0.5 * width);
            let mut panel = weights[0] * f(middle);
            for (node, weight) in nodes.iter().zip(weights).skip(1) {
                panel += weight * (f(middle - half * node) + f(middle + half * node));
            }
            sum += panel * half;
            left += width;
            width *= 1.02;
        }
        sum
    }

    #[test]
    fn detection_probability_is_the_integral_of_the_density() {
        for cells in [0, 8, 32] {
            for swerling in ALL {
                for (snr_db, pfa) in [(3.0, 1e-2), (12.0, 1e-4), (17.0, 1e-6)] {
                    let detector = Detector::new(pfa, cells);
                    let target = detector.target(swerling, from_db(snr_db));
                    let area = integral(|q| target.density(q), detector.threshold, 5.0);
                    assert_relative_eq!(area, target.detection_probability, max_relative = 1e-7);
                    let noise = integral(|q| detector.noise_density(q), detector.threshold, 1.0);
                    assert_relative_eq!(noise, pfa, max_relative = 1e-7);
                }
            }
        }
    }

    /// Every kind of estimate: D is the integral of the density, and what noise gives above the threshold is F.
    #[test]
    fn densities_of_all_estimates_integrate_to_their_probabilities() {
        for cfar in [Cfar::Go, Cfar::So, Cfar::Os, Cfar::ClutterMap] {
            let detector = Detector::with(1e-4, NoiseEstimate::new(cfar, 32));
            let noise = integral(|q| detector.noise_density(q), detector.threshold, 1.0);
            assert_relative_eq!(noise, 1e-4, max_relative = 1e-6);
            for swerling in [Swerling::One, Swerling::Three] {
                let target = detector.target(swerling, from_db(13.0));
                let area = integral(|q| target.density(q), detector.threshold, 5.0);
                assert_relative_eq!(area, target.detection_probability, max_relative = 1e-6);
            }
            let mean = integral(|q| (q - detector.threshold) * detector.noise_density(q), detector.threshold, 1.0);
            assert_relative_eq!(mean / detector.pfa, detector.noise_mean_excess(), max_relative = 0.02);
        }
    }

    /// A steady target before OS-CFAR: I is a sum of geometric counts, one for each exponential power of which g is the sum.
    #[test]
    fn a_steady_target_before_an_ordered_statistic() {
        let cells = 32;
        let detector = Detector::with(1e-4, NoiseEstimate::new(Cfar::Os, cells));
        for snr_db in [0.0, 6.0, 9.0, 11.0, 13.0, 16.0] {
            let snr = from_db(snr_db);
            let mut counts = vec![0.0; 400];
            counts[0] = 1.0;
            for i in 0..rank(cells) {
                let y = detector.threshold / detector.noise.mean() / f64::from(cells - i);
                let mut before = 0.0;
                for count in &mut counts {
                    before = (*count + y * before) / (1.0 + y);
                    *count = before;
                }
            }
            let (mut at_most, mut exact) = (0.0, 0.0);
            for (k, count) in counts.iter().enumerate() {
                at_most += count;
                exact += ln_poisson(k as f64, snr).exp() * at_most;
            }
            let target = detector.target(Swerling::Zero, snr);
            assert_relative_eq!(target.detection_probability, exact, max_relative = 0.01);
            let area = integral(|q| target.density(q), detector.threshold, 5.0);
            assert_relative_eq!(area, exact, max_relative = 0.01);
        }
    }

    #[test]
    fn many_reference_cells_are_known_noise() {
        for swerling in ALL {
            let known = Detector::new(1e-3, 0).target(swerling, 30.0);
            let many = Detector::new(1e-3, 100_000_000).target(swerling, 30.0);
            assert_relative_eq!(known.detection_probability, many.detection_probability, max_relative = 1e-6);
            assert_relative_eq!(known.likelihood_ratio(20.0), many.likelihood_ratio(20.0), max_relative = 1e-5);
        }
    }

    #[test]
    fn mean_excess_of_false_alarms() {
        for cells in [0, 16, 32] {
            let detector = Detector::new(1e-4, cells);
            let mean = integral(|q| (q - detector.threshold) * detector.noise_density(q), detector.threshold, 1.0);
            assert_relative_eq!(mean / detector.pfa, detector.noise_mean_excess(), max_relative = 1e-6);
        }
    }

    #[test]
    fn factor_of_sixteen_cells() {
        // 16 ((1e-4)^(-1/16) - 1) by hand: 1e-4^(-1/16) = 10^0.25.
        assert_relative_eq!(ca_cfar_factor(16, 1e-4), 16.0 * (10.0_f64.powf(0.25) - 1.0), max_relative = 1e-14);
        assert_relative_eq!(ca_cfar_factor(0, 1e-6), 6.0 * 10.0_f64.ln(), max_relative = 1e-14);
    }

    proptest! {
        /// However false plots are spread.
        #[test]
        fn no_ratio_is_greater_than_the_greatest(
            kind in 0_usize..3, cells in 0_u32..40, snr_db in 3.0..30.0_f64, exponent in 2.0..8.0_f64,
            above in 0.0..200.0_f64, mean_excess in 0.0..50.0_f64, outliers in 0.0..1.0_f64,
        ) {
            let detector = Detector::new(10.0_f64.powf(-exponent), cells);
            let q = detector.threshold + above;
            for target in [
                detector.target_within(ALL[kind], snr_db, 6.0),
                detector.target_of_unknown_power(ALL[kind], snr_db),
            ] {
                let greatest = target.greatest_likelihood_ratio(q);
                for (mean_excess, outliers) in [(0.0, 0.0), (mean_excess, 0.0), (0.0, outliers), (mean_excess, outliers)] {
                    let ratio = target.likelihood_ratio_among(q, FalsePower { mean_excess, outliers });
                    prop_assert!(ratio <= greatest, "{ratio} > {greatest}: {mean_excess} {outliers}");
                }
                prop_assert!(greatest < 10.0 * target.likelihood_ratio(q) + 10.0 * GLINTS * q.exp(), "of no use: {greatest}");
            }
        }

        #[test]
        fn nothing_overflows(
            snr_db in -20.0..50.0_f64,
            ln_q in -3.0..16.0_f64,
            pfa_exponent in 1.0..9.0_f64,
            cells in 0_u32..64,
            index in 0_usize..3,
            kind in 0_u32..5,
        ) {
            let cfar = Cfar::of(kind).expect("five kinds");
            let cells = if cfar == Cfar::Ca { cells } else { cells.max(4) };
            let detector = Detector::with(10.0_f64.powf(-pfa_exponent), NoiseEstimate::new(cfar, cells));
            let target = detector.target(ALL[index], from_db(snr_db));
            let d = target.detection_probability;
            prop_assert!(d > 0.0 && d <= 1.0, "D {d}");
            prop_assert!(d >= detector.pfa * (1.0 - 1e-9), "a target is not harder to detect than noise: {d}");
            let ratio = target.likelihood_ratio(detector.threshold + ln_q.exp());
            prop_assert!(ratio.is_finite() && ratio >= 0.0, "λ {ratio}");
        }

        #[test]
        fn clutter_never_speaks_for_a_target(q in 14.0..300.0_f64, mean_excess in 1.0..30.0_f64) {
            let target = Detector::new(1e-6, 32).target(Swerling::One, 50.0);
            let noise = target.likelihood_ratio(q);
            let clutter = target.likelihood_ratio_among(q, FalsePower { mean_excess, outliers: 0.0 });
            prop_assert!(clutter <= noise && clutter >= 0.0);
        }

        /// A power below the threshold, which no detector of this kind gives, is a number all the same.
        #[test]
        fn powers_below_the_threshold_are_no_outliers(share in 0.0..1.0_f64, outliers in 0.0..1.0_f64) {
            let target = Detector::new(1e-6, 0).target(Swerling::One, 30.0);
            let q = share * target.detector().threshold;
            let among = target.likelihood_ratio_among(q, FalsePower { mean_excess: 0.0, outliers });
            prop_assert!(among >= 0.0 && among <= target.likelihood_ratio(q), "{among}");
        }

        /// However strong a plot is, it proves no more than that it is one of few outliers, and a glint no less than its share.
        #[test]
        fn among_outliers_power_proves_little(ln_q in 2.7..14.0_f64, snr_db in 5.0..40.0_f64, outliers in 0.01..1.0_f64) {
            let target = Detector::new(1e-6, 0).target(Swerling::One, from_db(snr_db));
            let q = ln_q.exp();
            let ratio = target.likelihood_ratio_among(q, FalsePower { mean_excess: 0.0, outliers });
            prop_assert!(ratio <= 1.0 / outliers, "{ratio}");
            if outliers / (q * LN_OUTLIERS) > (target.detector().threshold - q).exp() {
                prop_assert!(ratio >= GLINTS / outliers * (1.0 - 1e-9), "{ratio}");
            }
        }

        #[test]
        fn the_ratio_grows_with_the_statistic(snr_db in 0.0..40.0_f64, q in 0.1..300.0_f64, cells in 0_u32..64, index in 0_usize..3) {
            let target = Detector::new(1e-4, cells).target(ALL[index], from_db(snr_db));
            prop_assert!(target.ln_ratio(q * 1.01) >= target.ln_ratio(q) - 1e-9);
        }
    }
}
