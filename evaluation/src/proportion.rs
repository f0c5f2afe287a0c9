//! A proportion: detections of targets, lost runs of all runs.

use crate::Estimate;
use crate::quantile::two_sided;

/// Clusters below which their scatter is not to be trusted.
const LEAST_CLUSTERS: usize = 30;

/// Wilson's interval of a proportion.
///
/// ```text
/// p̂ = x/n,   centre = (p̂ + z²/2n)/(1 + z²/n),   half = z/(1 + z²/n) · √(p̂(1 − p̂)/n + z²/4n²)
/// ```
///
/// | argument    | symbol | unit  |
/// |-------------|--------|-------|
/// | `successes` | x      | count |
/// | `trials`    | n      | count |
/// | `level`     | coverage, z its two-sided normal quantile | probability |
///
/// Never leaves [0, 1] and is sensible at 0 and n successes, where p̂ ± z s collapses. Without trials: all of [0, 1].
/// Trials must be independent; cells of one CFAR window are only nearly so.
///
/// Source: E. B. Wilson (1927); compared with other intervals by R. G. Newcombe (1998).
///
/// # Panics
/// If there are more successes than trials.
pub fn wilson(successes: u64, trials: u64, level: f64) -> Estimate {
    assert!(successes <= trials, "{successes} successes in {trials} trials");
    score(successes as f64, trials as f64, level).of(trials)
}

/// Wilson's interval of a proportion whose trials come in independent clusters [successes, trials]: cells of a
/// block that share their CFAR windows, scans of a run.
///
/// ```text
/// D = k/(k − 1) Σ (x_i − p̂ n_i)² / (n p̂(1 − p̂)),   Wilson with x/D and n/D for D > 1
/// ```
///
/// D, the design effect, is by how much the clusters scatter more than independent trials. Fewer than 30 clusters cannot tell
/// it: then it is taken as 1. Source: Korn & Graubard (1998) on the design effect.
pub fn clustered(clusters: &[[u64; 2]], level: f64) -> Estimate {
    let [successes, trials] = clusters.iter().fold([0, 0], |sum, cluster| [sum[0] + cluster[0], sum[1] + cluster[1]]);
    let (x, n, k) = (successes as f64, trials as f64, clusters.len() as f64);
    let p = x / n;
    let scatter: f64 = clusters.iter().map(|&[x, n]| (x as f64 - p * n as f64).powi(2)).sum();
    let effect = scatter * k / (k - 1.0) / (n * p * (1.0 - p));
    let effect = if clusters.len() >= LEAST_CLUSTERS && effect.is_finite() { effect.max(1.0) } else { 1.0 };
    score(x / effect, n / effect, level).of(trials)
}

impl Estimate {
    fn of(self, n: u64) -> Self {
        Self { n, ..self }
    }
}

/// The interval for numbers that need not be whole.
fn score(successes: f64, trials: f64, level: f64) -> Estimate {
    if trials <= 0.0 {
        return Estimate { value: f64::NAN, lo: 0.0, hi: 1.0, n: 0 };
    }
    let (n, z) = (trials, two_sided(level));
    let p = successes / n;
    let shrink = 1.0 / (1.0 + z * z / n);
    let centre = shrink * (p + z * z / (2.0 * n));
    let half = shrink * z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    // Exact at the ends, where rounding would leave a trace.
    let lo = if successes <= 0.0 { 0.0 } else { centre - half };
    let hi = if successes >= n { 1.0 } else { centre + half };
    Estimate { value: p, lo, hi, n: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantile::normal;
    use approx::assert_abs_diff_eq;
    use proptest::prelude::*;

    /// The four examples of R. G. Newcombe, *Two-sided confidence intervals for the single proportion* (1998),
    /// score method without continuity correction.
    #[test]
    fn published_examples() {
        for (successes, trials, lo, hi) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let estimate = wilson(successes, trials, 0.95);
            assert_abs_diff_eq!(estimate.lo, lo, epsilon = 5e-5);
            assert_abs_diff_eq!(estimate.hi, hi, epsilon = 5e-5);
        }
    }

    /// Trials that all come in pairs of equals are worth half as many.
    #[test]
    fn pairs_of_equals_count_once() {
        let singles: Vec<[u64; 2]> = (0..400).map(|i| [u64::from(i % 4 == 0), 1]).collect();
        let pairs: Vec<[u64; 2]> = singles.iter().map(|&[x, _]| [2 * x, 2]).collect();
        let (once, twice) = (clustered(&singles, 0.95), clustered(&pairs, 0.95));
        assert_abs_diff_eq!(once.lo, wilson(100, 400, 0.95).lo, epsilon = 1e-3);
        assert_abs_diff_eq!(once.hi, twice.hi, epsilon = 1e-3);
        assert_eq!((once.n, twice.n), (400, 800));
        assert_eq!(clustered(&[[0, 50], [0, 50]], 0.95), wilson(0, 100, 0.95));
    }

    proptest! {
        /// The definition: at both ends the observed proportion is z standard errors away.
        #[test]
        fn the_ends_solve_the_score_equation(trials in 1_u64..100_000, share in 0.0..=1.0_f64, level in 0.5..0.999_f64) {
            let successes = (share * trials as f64) as u64;
            let estimate = wilson(successes, trials, level);
            prop_assert!(estimate.contains(estimate.value) && estimate.lo >= 0.0 && estimate.hi <= 1.0);
            let z = normal(0.5 + 0.5 * level);
            for end in [estimate.lo, estimate.hi] {
                if end > 0.0 && end < 1.0 {
                    let standard_error = (end * (1.0 - end) / trials as f64).sqrt();
                    prop_assert!(((estimate.value - end).abs() / standard_error - z).abs() < 1e-6);
                }
            }
        }
    }
}
