//! Radars: where they stand, what they measure, and what they do wrong.

use common::geodesy::{FrameChange, Position, enu_axes};
use common::geometry::Polar;
use nalgebra::{Matrix3, Vector3};
use rand::Rng;

use super::normal;
use super::target::Target;
use crate::registration::Bias;

/// A radar and its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radar {
    /// Where the antenna stands.
    pub position: Position,
    /// Greatest range, m.
    pub range_m: f64,
    /// Time of a turn, s.
    pub period_s: f64,
    /// Standard deviations of range, azimuth, elevation; m, rad, rad.
    pub sigma: [f64; 3],
    /// What it measures too much.
    pub bias: Bias,
    /// What its clock is ahead, s.
    pub clock_s: f64,
}

/// A measured position and its covariance; m, m².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measured {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) covariance: Matrix3<f64>,
}

impl Radar {
    /// A radar without bias that sees 400 km far, `east_m` and `north_m` from a place.
    pub fn near(place: &Position, [east_m, north_m]: [f64; 2], sigma: [f64; 3], period_s: f64) -> Self {
        const DEGREE_M: f64 = 111_200.0;
        let latitude_deg = place.latitude_deg + north_m / DEGREE_M;
        let longitude_deg = place.longitude_deg + east_m / (DEGREE_M * place.latitude_deg.to_radians().cos());
        let position = Position { latitude_deg, longitude_deg, height_m: place.height_m };
        Self { position, range_m: 400_000.0, period_s, sigma, bias: Bias::zeros(), clock_s: 0.0 }
    }

    /// Measures a target of the axes of `centre`, in the radar's own axes.
    pub(super) fn measure(&self, target: &Target, centre: &Position, rng: &mut impl Rng) -> Measured {
        let change = FrameChange::new(centre, &self.position);
        let position = Vector3::from(change.position_m(target.position_m.into()));
        let velocity = Vector3::from(change.vector(target.velocity_mps.into()));
        let polar = Polar::from_enu(&(position + velocity * self.bias[3]));
        let [range_m, azimuth_rad, elevation_rad] = [polar.range_m, polar.azimuth_rad, polar.elevation_rad];
        let mut error = |axis: usize| self.bias[axis] + self.sigma[axis] * normal(rng);
        let measured = Polar {
            range_m: range_m + error(0),
            azimuth_rad: azimuth_rad + error(1),
            elevation_rad: elevation_rad + error(2),
        };
        Measured { position_m: measured.to_enu(), covariance: self.covariance(&measured) }
    }

    /// A measured position in the axes of `centre`.
    pub(super) fn in_centre(&self, measured: &Measured, centre: &Position) -> Measured {
        let turn = enu_axes(centre) * enu_axes(&self.position).transpose();
        let position_m = FrameChange::new(&self.position, centre).position_m(measured.position_m.into()).into();
        Measured { position_m, covariance: turn * measured.covariance * turn.transpose() }
    }

    fn covariance(&self, at: &Polar) -> Matrix3<f64> {
        let (sin_a, cos_a) = at.azimuth_rad.sin_cos();
        let (sin_e, cos_e) = at.elevation_rad.sin_cos();
        let axes = Matrix3::from_columns(&[
            Vector3::new(cos_e * sin_a, cos_e * cos_a, sin_e),
            Vector3::new(cos_a, -sin_a, 0.0),
            Vector3::new(-sin_e * sin_a, -sin_e * cos_a, cos_e),
        ]);
        let [range, azimuth, elevation] = self.sigma;
        let sigma = Vector3::new(range, at.range_m * cos_e * azimuth, at.range_m * elevation);
        axes * Matrix3::from_diagonal(&sigma.component_mul(&sigma)) * axes.transpose()
    }
}
