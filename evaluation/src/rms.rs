//! Root mean square errors.

use crate::Estimate;
use crate::mean::mean;

/// Root mean square of errors, in their unit; NaN without errors.
///
/// ```text
/// rms = √( (1/n) Σ e² )
/// ```
pub fn rms(errors: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = errors.into_iter().fold((0.0, 0_u64), |(sum, n), e| (sum + e * e, n + 1));
    (sum / n as f64).sqrt()
}

/// Root mean square of independent errors: the square root of the interval of the mean square.
///
/// The squares of normal errors are skewed; below some 30 errors prefer [`crate::bootstrap`].
pub fn estimate(errors: impl IntoIterator<Item = f64>, level: f64) -> Estimate {
    mean(errors.into_iter().map(|e| e * e), level).square_root()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantile::normal;
    use approx::assert_relative_eq;

    #[test]
    fn rms_of_three_four() {
        assert_relative_eq!(rms([3.0, -4.0, 0.0, 0.0]), 2.5);
        assert!(rms([]).is_nan());
    }

    /// Errors at the quantiles of a normal distribution of σ = 2: rms 2, interval ± 2 · 1.96/√(2n).
    #[test]
    fn interval_of_normal_errors() {
        let n = 4000;
        let errors = (0..n).map(|i| 2.0 * normal((f64::from(i) + 0.5) / f64::from(n)));
        let estimate = estimate(errors, 0.95);
        assert_relative_eq!(estimate.value, 2.0, max_relative = 2e-3);
        let half = 2.0 * 1.96 / (2.0 * f64::from(n)).sqrt();
        assert_relative_eq!(estimate.hi - estimate.lo, 2.0 * half, max_relative = 0.02);
    }
}
