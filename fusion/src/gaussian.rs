//! What is known of a target's position and velocity, as moments and as information.

use nalgebra::{Cholesky, Const, Matrix3, SMatrix, SVector, Vector3};

/// Components of a state [x y z ẋ ẏ ż]: m, m/s.
pub const STATE: usize = 6;
/// Farther or faster than this is no target, m, m/s.
const FARTHEST: f64 = 1e8;
/// What no radar knows of anything, m², m²/s².
const LEAST_VARIANCE: f64 = 1e-6;
/// A state.
pub type Vector = SVector<f64, STATE>;
/// A covariance, or its inverse.
pub type Matrix = SMatrix<f64, STATE, STATE>;

/// Mean and covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// x̂.
    pub mean: Vector,
    /// P.
    pub covariance: Matrix,
}

/// The same as information: Y = P⁻¹, y = P⁻¹ x̂. Information of independent sources adds up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Information {
    /// Y.
    pub matrix: Matrix,
    /// y.
    pub vector: Vector,
}

impl Gaussian {
    /// As information; `None` if the covariance is not positive definite.
    pub fn information(&self) -> Option<Information> {
        let matrix = factor(&self.covariance)?.inverse();
        Some(Information { matrix, vector: matrix * self.mean })
    }

    /// Position, m.
    pub fn position(&self) -> Vector3<f64> {
        self.mean.fixed_rows::<3>(0).into_owned()
    }

    /// Velocity, m/s.
    pub fn velocity(&self) -> Vector3<f64> {
        self.mean.fixed_rows::<3>(3).into_owned()
    }

    /// Variance of the place on the ground, east and north together, m².
    pub fn ground_variance(&self) -> f64 {
        self.covariance[(0, 0)] + self.covariance[(1, 1)]
    }

    /// Covariance of the position, m².
    pub fn position_covariance(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// In axes that are turned by `rotation`, about an origin that is shifted by `shift_m` afterwards.
    #[must_use]
    pub fn moved(&self, rotation: &Matrix3<f64>, shift_m: &Vector3<f64>) -> Self {
        let mut moved = *self;
        moved.mean.fixed_rows_mut::<3>(0).copy_from(&(rotation * self.position() + shift_m));
        moved.mean.fixed_rows_mut::<3>(3).copy_from(&(rotation * self.velocity()));
        for (row, column) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
            let block = self.covariance.fixed_view::<3, 3>(row, column).into_owned();
            moved.covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&turned(rotation, &block));
        }
        moved
    }

    /// Predicted by `step_s` s (F3): straight on, with white acceleration of the power density `noise`, m²/s³.
    #[must_use]
    pub fn predicted(&self, step_s: f64, noise: f64) -> Self {
        let mut to = *self;
        let velocity = self.velocity();
        let mut position = to.mean.fixed_rows_mut::<3>(0);
        position += step_s * velocity;
        let here = |row: usize, column: usize| self.covariance[(row, column)];
        for row in 0..3 {
            for column in 0..3 {
                let (pv, vp, vv) = (here(row, column + 3), here(row + 3, column), here(row + 3, column + 3));
                to.covariance[(row, column)] += step_s * (pv + vp + step_s * vv);
                to.covariance[(row, column + 3)] += step_s * vv;
                to.covariance[(row + 3, column)] += step_s * vv;
            }
            let age_s = step_s.abs();
            to.covariance[(row, row)] += noise * age_s.powi(3) / 3.0;
            let mixed = noise * step_s * age_s / 2.0;
            to.covariance[(row, row + 3)] += mixed;
            to.covariance[(row + 3, row)] += mixed;
            to.covariance[(row + 3, row + 3)] += noise * age_s;
        }
        to
    }

    /// Whether it is an estimate: a place that targets can be at, and a covariance that is positive definite.
    pub fn is_sound(&self) -> bool {
        let possible = self.mean.iter().all(|value| value.abs() < FARTHEST);
        let spread =
            (0..STATE).all(|axis| (LEAST_VARIANCE..FARTHEST * FARTHEST).contains(&self.covariance[(axis, axis)]));
        possible && spread && factor(&self.covariance).is_some()
    }
}

impl Information {
    /// As moments; `None` if the matrix is not positive definite.
    pub fn moments(&self) -> Option<Gaussian> {
        let covariance = factor(&self.matrix)?.inverse();
        Some(Gaussian { mean: covariance * self.vector, covariance })
    }
}

/// R B Rᵀ, in plain loops that the compiler unrolls.
fn turned(rotation: &Matrix3<f64>, block: &Matrix3<f64>) -> Matrix3<f64> {
    let product = |a: &Matrix3<f64>, b: &dyn Fn(usize, usize) -> f64| {
        Matrix3::from_fn(|row, column| (0..3).map(|k| a[(row, k)] * b(k, column)).sum())
    };
    let once: Matrix3<f64> = product(rotation, &|k, column| block[(k, column)]);
    product(&once, &|k, column| rotation[(column, k)])
}

/// Cholesky factor of a symmetric matrix; `None` if it is not positive definite.
pub(crate) fn factor(matrix: &Matrix) -> Option<Cholesky<f64, Const<STATE>>> {
    Cholesky::new(*matrix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    pub(crate) fn some() -> Gaussian {
        let root =
            Matrix::from_fn(|row, column| if row == column { 30.0 } else { ((row * 5 + column * 3) % 7) as f64 });
        Gaussian { mean: Vector::from_fn(|row, _| 1000.0 + 10.0 * row as f64), covariance: root * root.transpose() }
    }

    #[test]
    fn two_steps_are_one() {
        let (once, twice) = (some().predicted(5.0, 2.0), some().predicted(2.0, 2.0).predicted(3.0, 2.0));
        assert_relative_eq!(once.mean, twice.mean, max_relative = 1e-12);
        assert_relative_eq!(once.covariance, twice.covariance, max_relative = 1e-12);
    }

    #[test]
    fn information_and_back_is_the_same() {
        let back = some().information().and_then(|information| information.moments()).expect("positive definite");
        assert_relative_eq!(back.mean, some().mean, max_relative = 1e-10);
        assert_relative_eq!(back.covariance, some().covariance, max_relative = 1e-10);
    }
}
