//! Whether errors are as large as the filter says: NEES, NIS and the χ² region of their average.
//!
//! ```text
//! NEES  ε = eᵀ P⁻¹ e,   e = x̂ − x           of an estimate against truth
//! NIS   ε = νᵀ S⁻¹ ν                          of an innovation, without truth
//! ```
//!
//! Both are χ² of their dimension if the errors are normal with the stated covariance, so the sum of N independent
//! ones is χ² of N times the dimension. Source: Bar-Shalom, Li & Kirubarajan (2001).

use nalgebra::{SMatrix, SVector};

use crate::Estimate;
use crate::mean::Moments;
use crate::quantile::chi_square;

/// NEES of an error and its stated covariance, or NIS of an innovation: eᵀ P⁻¹ e.
///
/// | argument     | symbol | shape | unit                |
/// |--------------|--------|-------|---------------------|
/// | `error`      | e, ν   | N     | of the states       |
/// | `covariance` | P, S   | N×N   | products of those   |
///
/// `None` if the covariance has no Cholesky factor: a filter that says so is broken, not merely inconsistent.
pub fn normalised_square<const N: usize>(error: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>) -> Option<f64> {
    Some(error.dot(&covariance.cholesky()?.solve(error)))
}

/// Region in which the average of `samples` independent NEES of `dimension` lies with probability `level` if the
/// filter is consistent.
///
/// ```text
/// [χ²_(N n)((1 − level)/2)/N,  χ²_(N n)((1 + level)/2)/N]
/// ```
///
/// # Panics
/// If there are no samples or the dimension is 0.
pub fn average_region(dimension: u32, samples: u64, level: f64) -> [f64; 2] {
    assert!(samples > 0 && dimension > 0, "{samples} samples of dimension {dimension}");
    let n = samples as f64;
    let freedom = n * f64::from(dimension);
    [0.5 * (1.0 - level), 0.5 * (1.0 + level)].map(|p| chi_square(p, freedom) / n)
}

/// Average NEES (or NIS) with its interval, and the region of a consistent filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consistency {
    /// Average with Student's interval, which assumes nothing of the errors.
    pub average: Estimate,
    /// Where the average of a consistent filter lies, see [`average_region`].
    pub region: [f64; 2],
}

impl Consistency {
    /// Of independent samples of one dimension: one per run at a given scan, not the scans of a run.
    ///
    /// # Panics
    /// If there are no samples or the dimension is 0.
    pub fn of(samples: &[f64], dimension: u32, level: f64) -> Self {
        let moments: Moments = samples.iter().copied().collect();
        Self { average: moments.estimate(level), region: average_region(dimension, moments.n(), level) }
    }

    /// Whether the average lies in the region.
    pub fn is_consistent(&self) -> bool {
        (self.region[0]..=self.region[1]).contains(&self.average.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use nalgebra::{Matrix2, Vector2};
    use proptest::prelude::*;

    /// The example of Bar-Shalom, Li & Kirubarajan (2001): 50 runs, two states, 95 %: [1.5, 2.6]; and a single run of
    /// two states: [0.05, 7.38].
    #[test]
    fn published_regions() {
        let [lo, hi] = average_region(2, 50, 0.95);
        assert_abs_diff_eq!(lo, 1.5, epsilon = 0.05);
        assert_abs_diff_eq!(hi, 2.6, epsilon = 0.05);
        let [lo, hi] = average_region(2, 1, 0.95);
        assert_abs_diff_eq!(lo, 0.05, epsilon = 0.005);
        assert_abs_diff_eq!(hi, 7.38, epsilon = 0.005);
    }

    #[test]
    fn a_covariance_that_is_none_is_refused() {
        assert_eq!(normalised_square(&Vector2::new(1.0, 0.0), &Matrix2::new(1.0, 2.0, 2.0, 1.0)), None);
    }

    #[test]
    fn averages_outside_the_region_are_told() {
        let optimistic = Consistency::of(&[6.0; 50], 2, 0.95);
        assert!(!optimistic.is_consistent());
        let consistent = Consistency::of(&[2.1; 50], 2, 0.95);
        assert!(consistent.is_consistent() && consistent.average.contains(2.1));
    }

    proptest! {
        /// Against the inverse written out for two dimensions.
        #[test]
        fn the_square_is_that_of_the_inverse(a in 0.5..9.0_f64, c in 0.5..9.0_f64, rho in -0.95..0.95_f64, e in [-9.0..9.0_f64, -9.0..9.0_f64]) {
            let b = rho * (a * c).sqrt();
            let found = normalised_square(&Vector2::from(e), &Matrix2::new(a, b, b, c)).expect("positive definite");
            let by_hand = (c * e[0] * e[0] - 2.0 * b * e[0] * e[1] + a * e[1] * e[1]) / (a * c - b * b);
            assert_relative_eq!(found, by_hand, max_relative = 1e-9, epsilon = 1e-12);
        }
    }
}
