//! From the cooperative sensor's tangent plane to the radar's.
//!
//! ```text
//! p_radar = frame(truth → radar) p_truth + offset − d·heading
//! ```
//!
//! The change of frames is (F1), (F2) of [`common::geodesy`]; d: how far the radar sees the centroid of an
//! aircraft behind its cooperative position. Derivation: `docs/theory/registration.md`.

use asterix::cat010::VELOCITY_STEP_MPS;
use common::config::{Position, RegistrationConfig};
use common::geodesy::FrameChange;
use nalgebra::Vector3;

/// The registration of one pair of sensors, ready to be applied.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    to_radar: FrameChange,
    offset_m: Vector3<f64>,
    azimuth_bias_rad: f64,
    centroid_behind_m: f64,
    /// Step of the sensor's velocity over that of the specification.
    velocity_scale: f64,
}

impl Registration {
    /// Prepares a configured registration.
    pub fn new(config: &RegistrationConfig) -> Self {
        let radar = Position {
            latitude_deg: config.radar_latitude_deg,
            longitude_deg: config.radar_longitude_deg,
            height_m: config.radar_height_m,
        };
        let truth = Position {
            latitude_deg: config.truth_latitude_deg,
            longitude_deg: config.truth_longitude_deg,
            height_m: config.truth_height_m,
        };
        Self {
            to_radar: FrameChange::new(&truth, &radar),
            offset_m: Vector3::new(config.truth_offset_east_m, config.truth_offset_north_m, 0.0),
            azimuth_bias_rad: config.azimuth_bias_deg.to_radians(),
            centroid_behind_m: config.centroid_behind_m,
            velocity_scale: match config.truth_velocity_step_mps {
                0.0 => 1.0,
                step_mps => step_mps / VELOCITY_STEP_MPS,
            },
        }
    }

    /// How much too large the radar reads azimuth, rad.
    pub fn azimuth_bias_rad(&self) -> f64 {
        self.azimuth_bias_rad
    }

    /// A position of the cooperative sensor in the radar's ENU frame, m.
    pub fn position_enu(&self, truth_m: (f64, f64)) -> Vector3<f64> {
        Vector3::from(self.to_radar.position_m([truth_m.0, truth_m.1, 0.0])) + self.offset_m
    }

    /// A velocity of the cooperative sensor (I010/202, m/s by the specification) in the radar's ENU frame, m/s.
    pub fn velocity_enu(&self, velocity_mps: (f64, f64)) -> Vector3<f64> {
        Vector3::from(self.to_radar.vector([velocity_mps.0, velocity_mps.1, 0.0])) * self.velocity_scale
    }

    /// From an aircraft's cooperative position to the centroid that the radar sees, m, given its heading.
    pub fn centroid_shift_m(&self, heading: &Vector3<f64>) -> Vector3<f64> {
        -self.centroid_behind_m * heading
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn barcelona() -> RegistrationConfig {
        RegistrationConfig {
            radar_latitude_deg: 41.295_618_33,
            radar_longitude_deg: 2.095_114_167,
            truth_latitude_deg: 41.297_062_78,
            truth_longitude_deg: 2.078_447_222,
            ..RegistrationConfig::default()
        }
    }

    /// In the radar's plane the origin of Barcelona's multilateration lies 1396.0 m west and
    /// 160.6 m north of it: figures made independently of this code.
    #[test]
    fn the_sensors_lie_to_each_other_as_the_data_says() {
        let origin = Registration::new(&barcelona()).position_enu((0.0, 0.0));
        assert!((origin.x + 1396.0).abs() < 0.05 && (origin.y - 160.6).abs() < 0.05, "{origin}");
        // Curvature drops it by s²/(2R) at a distance s of 1.4 km: 0.155 m.
        assert!((origin.z + 0.155).abs() < 0.005, "{origin}");
    }

    #[test]
    fn the_axes_are_east_north_up() {
        let east = Registration::new(&RegistrationConfig {
            radar_latitude_deg: 0.0,
            radar_longitude_deg: 10.0,
            truth_latitude_deg: 0.0,
            truth_longitude_deg: 10.01,
            ..RegistrationConfig::default()
        })
        .position_enu((0.0, 0.0));
        let radius_m = 6_378_137.0;
        let arc = radius_m * 0.01_f64.to_radians();
        assert!((east - Vector3::new(arc, 0.0, -arc * arc / (2.0 * radius_m))).norm() < 1e-3, "{east}");
        let meridian_radius_m = 6_335_439.0; // of WGS-84 at the equator
        let north =
            Registration::new(&RegistrationConfig { truth_latitude_deg: 0.01, ..RegistrationConfig::default() })
                .position_enu((0.0, 0.0));
        assert!((north.y - meridian_radius_m * 0.01_f64.to_radians()).abs() < 1e-2, "{north}");
    }
}
