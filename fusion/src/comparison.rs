//! Whether two estimates may be of the same target (F5).
//!
//! ```text
//! p = x₁ − x₂,  T = P₁ + P₂ − P₁₂ − P₁₂ᵀ,  χ² = pᵀ T⁻¹ p
//! ```

use nalgebra::{Const, DimMin, SMatrix, SVector};

/// χ² of a difference with covariance `spread`; infinite if that is not positive definite.
pub fn chi_squared<const N: usize>(difference: &SVector<f64, N>, spread: SMatrix<f64, N, N>) -> f64
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    spread.cholesky().map_or(f64::INFINITY, |root| difference.dot(&root.solve(difference)))
}

/// χ² that a difference in `degrees` dimensions exceeds with probability 1 − `probability`.
pub fn gate(degrees: usize, probability: f64) -> f64 {
    evaluation::quantile::chi_square(probability, degrees as f64)
}
