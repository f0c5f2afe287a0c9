//! Polar coordinates about the antenna and the local ENU frame, with covariance.
//!
//! ```text
//! x = r cos ε sin β,  y = r cos ε cos β,  z = r sin ε                       (T5)
//! J = [e_r, ρ cos ε e_β, ρ e_ε],  R = J diag(σ_r², σ_β², σ_ε²) Jᵀ           (T6)
//! ```
//!
//! x east, y north, z up; β clockwise from north in [0, 2π); ε above the horizontal.
//! Derivation: `docs/theory/imm-pda.md`.

use nalgebra::{Matrix3, Vector3};

use crate::angle;

/// A place in polar coordinates about the antenna.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polar {
    /// Slant range r, m.
    pub range_m: f64,
    /// Azimuth β, rad, clockwise from north.
    pub azimuth_rad: f64,
    /// Elevation ε, rad, above the horizontal.
    pub elevation_rad: f64,
}

impl Polar {
    /// The place as ENU coordinates, m (T5).
    pub fn to_enu(self) -> Vector3<f64> {
        let (sin_b, cos_b) = self.azimuth_rad.sin_cos();
        let (sin_e, cos_e) = self.elevation_rad.sin_cos();
        Vector3::new(cos_e * sin_b, cos_e * cos_b, sin_e) * self.range_m
    }

    /// The polar coordinates of an ENU position, m. Azimuth and elevation of the origin are 0.
    pub fn from_enu(position: &Vector3<f64>) -> Self {
        let ground = position.x.hypot(position.y);
        Self {
            range_m: ground.hypot(position.z),
            azimuth_rad: angle::wrap(position.x.atan2(position.y)),
            elevation_rad: position.z.atan2(ground),
        }
    }

    /// Jacobian J = ∂(x, y, z)/∂(r, β, ε) of [`Polar::to_enu`] here (T6); m/m and m/rad.
    pub fn jacobian(self) -> Matrix3<f64> {
        let (sin_b, cos_b) = self.azimuth_rad.sin_cos();
        let (sin_e, cos_e) = self.elevation_rad.sin_cos();
        let e_r = Vector3::new(cos_e * sin_b, cos_e * cos_b, sin_e);
        let e_b = Vector3::new(cos_b, -sin_b, 0.0);
        let e_e = Vector3::new(-sin_e * sin_b, -sin_e * cos_b, cos_e);
        Matrix3::from_columns(&[e_r, e_b * (self.range_m * cos_e), e_e * self.range_m])
    }

    /// Covariance in ENU of a measurement at this place with the given standard errors
    /// of range (m), azimuth and elevation (rad): J diag(σ²) Jᵀ (T6), m². Positive definite
    /// whenever r cos ε and all σ are.
    pub fn covariance_enu(self, sigma: [f64; 3]) -> Matrix3<f64> {
        let mut scaled = self.jacobian();
        for (mut column, sigma) in scaled.column_iter_mut().zip(sigma) {
            column *= sigma;
        }
        scaled * scaled.transpose()
    }
}

/// Range rate of a target at `position` (m) with `velocity` (m/s), m/s; 0 at the origin.
pub fn range_rate_mps(position: &Vector3<f64>, velocity: &Vector3<f64>) -> f64 {
    let range = position.norm();
    if range > 0.0 { position.dot(velocity) / range } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, generator};
    use approx::assert_relative_eq;
    use proptest::prelude::*;
    use rand::RngExt;

    fn polar() -> impl Strategy<Value = Polar> {
        (1.0..1e5_f64, 0.0..std::f64::consts::TAU, -1.5..1.5_f64)
            .prop_map(|(range_m, azimuth_rad, elevation_rad)| Polar { range_m, azimuth_rad, elevation_rad })
    }

    proptest! {
        #[test]
        fn polar_to_enu_and_back(place in polar()) {
            let back = Polar::from_enu(&place.to_enu());
            prop_assert!((back.range_m - place.range_m).abs() < 1e-9 * place.range_m);
            prop_assert!(angle::difference(back.azimuth_rad, place.azimuth_rad).abs() < 1e-9);
            prop_assert!((back.elevation_rad - place.elevation_rad).abs() < 1e-9);
        }

        #[test]
        fn covariance_is_positive_definite(place in polar(), s in prop::array::uniform3(1e-4..0.1_f64)) {
            prop_assert!(place.covariance_enu([s[0] * 100.0, s[1], s[2]]).cholesky().is_some());
        }

        #[test]
        fn jacobian_is_the_derivative(place in polar()) {
            let h = 1e-6;
            let ahead = Polar { azimuth_rad: place.azimuth_rad + h, ..place }.to_enu();
            let behind = Polar { azimuth_rad: place.azimuth_rad - h, ..place }.to_enu();
            let difference = (ahead - behind) / (2.0 * h);
            prop_assert!((difference - place.jacobian().column(1)).norm() < 1e-6 * place.range_m);
        }
    }

    /// (T6) against 4 million drawn measurements at \[L22\]'s errors: 0.5 % of the standard
    /// deviations along range, azimuth and elevation (standard error of a variance 0.07 %).
    #[test]
    fn covariance_agrees_with_monte_carlo() {
        use rand_distr_free_normal as normal;
        let place = Polar { range_m: 900.0, azimuth_rad: 1.1, elevation_rad: 0.11 };
        let sigma = [20.0, 0.1_f64.to_radians(), 0.1_f64.to_radians()];
        let covariance = place.covariance_enu(sigma);
        let centre = place.to_enu();
        let mut rng = generator(5, Purpose::Test, 0, 0);
        let mut sum = Matrix3::zeros();
        let runs = 4_000_000;
        for _ in 0..runs {
            let [a, b, c, _] = [normal(&mut rng), normal(&mut rng), normal(&mut rng), 0.0];
            let drawn = Polar {
                range_m: place.range_m + sigma[0] * a,
                azimuth_rad: place.azimuth_rad + sigma[1] * b,
                elevation_rad: place.elevation_rad + sigma[2] * c,
            };
            let error = drawn.to_enu() - centre;
            sum += error * error.transpose();
        }
        sum /= f64::from(runs);
        let scale = place.jacobian();
        for axis in 0..3 {
            let along = scale.column(axis).normalize();
            let drawn = (along.transpose() * sum * along).x;
            let formula = (along.transpose() * covariance * along).x;
            assert_relative_eq!(drawn, formula, max_relative = 0.005);
        }
    }

    /// One standard normal number by Box and Muller.
    fn rand_distr_free_normal(rng: &mut impl rand::Rng) -> f64 {
        let (u, v): (f64, f64) = (rng.random(), rng.random());
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}
