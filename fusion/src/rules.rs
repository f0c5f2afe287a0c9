//! Rules that make one estimate of several of the same target at the same time (F6).
//!
//! ```text
//! information     P = (Σ P_i⁻¹)⁻¹,  x̂ = P Σ P_i⁻¹ x_i                      errors are independent
//! intersection    P = (Σ w_i P_i⁻¹)⁻¹,  x̂ = P Σ w_i P_i⁻¹ x_i,  Σ w_i = 1   whatever errors have in common
//! known_common    Gauss and Markov, P_ij = ρ L_i L_jᵀ                        errors have the share ρ in common
//! tracklet        Y += P⁻¹ − P⁻_⁻¹,  y += P⁻¹ x − P⁻_⁻¹ x⁻                    what a local update has brought
//! mean, by_trace  for comparison only
//! ```
//!
//! Source: \[K18\]; the two last ones are the source's.

use nalgebra::{DMatrix, DVector};

use crate::gaussian::{Gaussian, Information, Matrix, STATE, Vector, factor};

/// Σ P_i⁻¹ and Σ P_i⁻¹ x_i as moments; `None` if a covariance is not positive definite.
pub fn information(estimates: &[Gaussian]) -> Option<Gaussian> {
    weighted(estimates, |_| 1.0)
}

/// Covariance intersection with weights inverse to the traces of the covariances, each component in units of its least variance.
pub fn intersection(estimates: &[Gaussian]) -> Option<Gaussian> {
    let least = |axis: usize| estimates.iter().map(|of| of.covariance[(axis, axis)]).fold(f64::INFINITY, f64::min);
    let unit = Vector::from_fn(|axis, _| least(axis));
    let inverse_trace = |of: &Gaussian| 1.0 / of.covariance.diagonal().component_div(&unit).sum();
    let sum: f64 = estimates.iter().map(inverse_trace).sum();
    weighted(estimates, |index| inverse_trace(&estimates[index]) / sum)
}

fn weighted(estimates: &[Gaussian], weight: impl Fn(usize) -> f64) -> Option<Gaussian> {
    let mut sum = Information { matrix: Matrix::zeros(), vector: Vector::zeros() };
    for (index, estimate) in estimates.iter().enumerate() {
        let Information { matrix, vector } = estimate.information()?;
        sum.matrix += weight(index) * matrix;
        sum.vector += weight(index) * vector;
    }
    sum.moments()
}

/// Best linear unbiased estimate where the errors of any two have P_ij = ρ L_i L_jᵀ in common, L the Cholesky factors.
pub fn known_common(estimates: &[Gaussian], share: f64) -> Option<Gaussian> {
    let roots: Vec<Matrix> =
        estimates.iter().map(|of| factor(&of.covariance).map(|root| root.l())).collect::<Option<_>>()?;
    let size = STATE * estimates.len();
    let joint = DMatrix::from_fn(size, size, |row, column| {
        let ((i, r), (j, c)) = ((row / STATE, row % STATE), (column / STATE, column % STATE));
        if i == j { estimates[i].covariance[(r, c)] } else { share * roots[i].row(r).dot(&roots[j].row(c)) }
    });
    let means = DVector::from_fn(size, |row, _| estimates[row / STATE].mean[row % STATE]);
    let all = DMatrix::from_fn(size, STATE, |row, column| f64::from(u8::from(row % STATE == column)));
    let weights = joint.cholesky()?.solve(&all);
    let matrix = Matrix::from_iterator((all.transpose() * &weights).iter().copied());
    let vector = Vector::from_iterator((weights.transpose() * means).iter().copied());
    Information { matrix, vector }.moments()
}

/// What an update of a local track has brought; exact where a Kalman filter made it of measurements that nobody else has.
pub fn tracklet(posterior: &Gaussian, prediction: &Gaussian) -> Option<Information> {
    let (after, before) = (posterior.information()?, prediction.information()?);
    Some(Information { matrix: after.matrix - before.matrix, vector: after.vector - before.vector })
}

/// Mean of the means: worse than the best of unequal radars.
pub fn mean(estimates: &[Gaussian]) -> Vector {
    estimates.iter().map(|of| of.mean).sum::<Vector>() / estimates.len() as f64
}

/// Means weighted by 1/tr P of the positions.
pub fn by_trace(estimates: &[Gaussian]) -> Vector {
    let weight = |of: &Gaussian| 1.0 / of.position_covariance().trace();
    estimates.iter().map(|of| weight(of) * of.mean).sum::<Vector>() / estimates.iter().map(weight).sum::<f64>()
}
