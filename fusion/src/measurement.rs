//! What an update of a local track has brought, as a measurement of the system track.
//!
//! ```text
//! ΔY = P⁻¹ − P⁻_⁻¹ = L Lᵀ,  Δy = P⁻¹ x − P⁻_⁻¹ x⁻ = L z          (F6)
//! z = Lᵀ x + n,  n ~ N(0, 1)
//! ```
//!
//! x, P here are the moments of what the radar measures, the position. That is exact for a Kalman filter, since the measurement
//! depends on nothing else; and where a filter has several models, what changes between them in the other components is not taken for
//! a measurement. What a Doppler radar knows of the range rate is left out. In the form of z the information is absorbed by any prediction, and
//! says how likely it was with it.

use nalgebra::{Cholesky, Matrix3, SMatrix, Vector3};

use crate::gaussian::{Gaussian, Matrix, STATE, Vector};

/// Share of the information after an update below which a part of the gain is rounding.
const ROUNDING: f64 = 1e-9;
/// Share of the information that an update may seem to have lost.
const LOSS: f64 = 1e-2;

/// A measurement of several numbers with independent errors of variance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// L, columns beyond the last number 0.
    root: SMatrix<f64, STATE, 3>,
    /// z.
    value: Vector3<f64>,
    /// How many numbers.
    pub count: usize,
}

/// How well a measurement fits a prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Logarithm of its density, but for what is the same for every prediction.
    pub log_likelihood: f64,
    /// Normalised innovation squared, χ² with as many degrees as there are numbers.
    pub innovation: f64,
}

impl Measurement {
    /// What `after` knows more than `before` of the position; `None` where it knows less of anything, so that no measurement can have
    /// made it.
    pub fn of_position(after: &Gaussian, before: &Gaussian) -> Option<Self> {
        let weight = |of: &Gaussian| of.position_covariance().try_inverse();
        let (after_y, before_y) = (weight(after)?, weight(before)?);
        let mut rest = after_y - before_y;
        let mut own = Matrix3::zeros();
        let mut count = 0;
        let share = |rest: &Matrix3<f64>, i: usize| rest[(i, i)] / after_y[(i, i)];
        while count < 3 {
            let most = (0..3).fold(0, |best, i| if share(&rest, i) > share(&rest, best) { i } else { best });
            if share(&rest, most) <= ROUNDING {
                break;
            }
            let column = rest.column(most) / rest[(most, most)].sqrt();
            rest -= column * column.transpose();
            own.set_column(count, &column);
            count += 1;
        }
        if (0..3).any(|i| share(&rest, i) < -LOSS) {
            return None;
        }
        let mut squares = own.tr_mul(&own);
        (count..3).for_each(|i| squares[(i, i)] = 1.0);
        let gain = after_y * after.position() - before_y * before.position();
        let value = Cholesky::new(squares)?.solve(&own.tr_mul(&gain));
        let mut root = SMatrix::<f64, STATE, 3>::zeros();
        root.fixed_rows_mut::<3>(0).copy_from(&own);
        Some(Self { root, value, count })
    }

    /// The same of the state `age_s` s later, during which the target may have accelerated with the power density `noise`.
    #[must_use]
    pub fn aged(&self, age_s: f64, noise: f64) -> Self {
        // x(t) = F(−T) x(t + T) − F(−T) w: rows of L of the velocity take those of the position with −T.
        let mut root = self.root;
        for row in 0..3 {
            for column in 0..self.count {
                root[(row + 3, column)] -= age_s * self.root[(row, column)];
            }
        }
        let none = Gaussian { mean: Vector::zeros(), covariance: Matrix::zeros() };
        let drift = none.predicted(age_s, noise).covariance;
        let noise = Matrix3::identity() + root.tr_mul(&(drift * root));
        let Some(whitening) = Cholesky::new(noise) else { return *self };
        let lower = whitening.l();
        let turned = lower.solve_lower_triangular(&root.transpose()).map_or(root, |rows| rows.transpose());
        Self { root: turned, value: lower.solve_lower_triangular(&self.value).unwrap_or(self.value), count: self.count }
    }

    /// Updates a prediction: number after number, since their errors are independent.
    pub fn absorb(&self, state: &mut Gaussian) -> Fit {
        let mut fit = Fit { log_likelihood: 0.0, innovation: 0.0 };
        for number in 0..self.count {
            let root = self.root.column(number);
            let mut gain = [0.0; STATE];
            let (mut innovation, mut variance) = (self.value[number], 1.0);
            for (row, gain) in gain.iter_mut().enumerate() {
                *gain = (0..STATE).map(|column| state.covariance[(row, column)] * root[column]).sum();
                innovation -= root[row] * state.mean[row];
                variance += root[row] * *gain;
            }
            for row in 0..STATE {
                state.mean[row] += gain[row] * (innovation / variance);
                for column in 0..STATE {
                    state.covariance[(row, column)] -= gain[row] * gain[column] / variance;
                }
            }
            let squared = innovation * innovation / variance;
            fit.innovation += squared;
            fit.log_likelihood -= 0.5 * (squared + variance.ln());
        }
        fit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn prediction() -> Gaussian {
        let root =
            Matrix::from_fn(|row, column| if row == column { 20.0 } else { ((row * 5 + column * 3) % 7) as f64 });
        Gaussian { mean: Vector::from_fn(|row, _| 100.0 + row as f64), covariance: root * root.transpose() }
    }

    /// A Kalman update by the position, its noise 9 m².
    fn updated(before: &Gaussian, by: f64) -> Gaussian {
        let mut information = before.information().expect("a covariance");
        for i in 0..3 {
            information.matrix[(i, i)] += 1.0 / 9.0;
            information.vector[i] += (before.mean[i] + by) / 9.0;
        }
        information.moments().expect("positive definite")
    }

    #[test]
    fn the_prediction_that_it_was_made_with_becomes_the_posterior_again() {
        let (before, after) = (prediction(), updated(&prediction(), 7.0));
        let measurement = Measurement::of_position(&after, &before).expect("a gain");
        assert_eq!(measurement.count, 3);
        let mut again = before;
        let fit = measurement.absorb(&mut again);
        assert_relative_eq!(again.mean, after.mean, max_relative = 1e-9);
        assert_relative_eq!(again.covariance, after.covariance, max_relative = 1e-7, epsilon = 1e-7);
        let innovation = nalgebra::Vector3::repeat(7.0);
        let spread = before.position_covariance() + nalgebra::Matrix3::identity() * 9.0;
        let expected = crate::comparison::chi_squared(&innovation, spread);
        assert_relative_eq!(fit.innovation, expected, max_relative = 1e-6);
    }

    #[test]
    fn an_update_that_loses_is_no_measurement_and_one_that_brings_nothing_is_empty() {
        let (before, after) = (prediction(), updated(&prediction(), 0.0));
        assert_eq!(Measurement::of_position(&before, &after), None);
        assert_eq!(Measurement::of_position(&before, &before).map(|nothing| nothing.count), Some(0));
    }

    /// Absorbed late is absorbed in time and predicted, where the target did not accelerate.
    #[test]
    fn a_late_one_is_worth_what_it_was() {
        let measurement = Measurement::of_position(&updated(&prediction(), 7.0), &prediction()).expect("a gain");
        let mut in_time = prediction();
        measurement.absorb(&mut in_time);
        let mut late = prediction().predicted(2.0, 0.0);
        measurement.aged(2.0, 0.0).absorb(&mut late);
        let expected = in_time.predicted(2.0, 0.0);
        assert_relative_eq!(late.mean, expected.mean, max_relative = 1e-9);
        assert_relative_eq!(late.covariance, expected.covariance, max_relative = 1e-7, epsilon = 1e-7);
        let mut drifting = prediction().predicted(2.0, 4.0);
        measurement.aged(2.0, 4.0).absorb(&mut drifting);
        assert!(drifting.covariance[(0, 0)] > late.covariance[(0, 0)]);
    }
}
