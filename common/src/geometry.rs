//! Polar coordinates about the antenna and the local ENU frame.
//!
//! ```text
//! x = r cos ε sin β,  y = r cos ε cos β,  z = r sin ε                       (T5)
//! ```
//!
//! x east, y north, z up; β clockwise from north in [0, 2π); ε above the horizontal.
//! Derivation: `docs/theory/imm-pda.md`.

use nalgebra::Vector3;

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
}

/// Range rate of a target at `position` (m) with `velocity` (m/s), m/s; 0 at the origin.
pub fn range_rate_mps(position: &Vector3<f64>, velocity: &Vector3<f64>) -> f64 {
    let range = position.norm();
    if range > 0.0 { position.dot(velocity) / range } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
    }
}
