//! Whether errors are as large as the filter says: NEES, NIS.
//!
//! ```text
//! NEES  ε = eᵀ P⁻¹ e,   e = x̂ − x           of an estimate against truth
//! NIS   ε = νᵀ S⁻¹ ν                          of an innovation, without truth
//! ```
//!
//! Both are χ² of their dimension if the errors are normal with the stated covariance. Source: Bar-Shalom, Li & Kirubarajan (2001).

use nalgebra::{SMatrix, SVector};

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

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{Matrix2, Vector2};
    use proptest::prelude::*;

    #[test]
    fn a_covariance_that_is_none_is_refused() {
        assert_eq!(normalised_square(&Vector2::new(1.0, 0.0), &Matrix2::new(1.0, 2.0, 2.0, 1.0)), None);
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
