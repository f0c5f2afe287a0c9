//! From the cooperative sensor's tangent plane to the radar's.
//!
//! ```text
//! o(φ, λ, h) = [(N + h) cos φ cos λ, (N + h) cos φ sin λ, (N (1 − e²) + h) sin φ],  N = a / √(1 − e² sin² φ)
//! E(φ, λ)    = rows: east, north and up at (φ, λ) in Earth-centred coordinates
//! p_radar    = E_radar (E_truthᵀ p_truth + o_truth − o_radar) + offset − d·heading
//! ```
//!
//! φ, λ: WGS-84 latitude and longitude; d: how far the radar sees the centroid of an
//! aircraft behind its cooperative position. Derivation: `docs/theory/registration.md`.

use common::config::RegistrationConfig;
use nalgebra::{Matrix3, Vector3};

/// Equatorial radius a of WGS-84, m.
const EQUATORIAL_RADIUS_M: f64 = 6_378_137.0;
/// First eccentricity squared e² of WGS-84.
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_141_316e-3;
/// Step of I010/202 in the specification, m/s.
const SPECIFIED_VELOCITY_STEP_MPS: f64 = 1.0 / 16.0;

/// The registration of one pair of sensors, ready to be applied.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    rotation: Matrix3<f64>,
    shift_m: Vector3<f64>,
    azimuth_bias_rad: f64,
    centroid_behind_m: f64,
    velocity_step_mps: f64,
}

impl Registration {
    /// Prepares a configured registration.
    pub fn new(config: &RegistrationConfig) -> Self {
        let radar = Place::new(config.radar_latitude_deg, config.radar_longitude_deg, config.radar_height_m);
        let truth = Place::new(config.truth_latitude_deg, config.truth_longitude_deg, config.truth_height_m);
        let to_radar = radar.east_north_up();
        let offset = Vector3::new(config.truth_offset_east_m, config.truth_offset_north_m, 0.0);
        Self {
            rotation: to_radar * truth.east_north_up().transpose(),
            shift_m: to_radar * (truth.earth_centred_m() - radar.earth_centred_m()) + offset,
            azimuth_bias_rad: config.azimuth_bias_deg.to_radians(),
            centroid_behind_m: config.centroid_behind_m,
            velocity_step_mps: match config.truth_velocity_step_mps {
                0.0 => SPECIFIED_VELOCITY_STEP_MPS,
                step => step,
            },
        }
    }

    /// How much too large the radar reads azimuth, rad.
    pub fn azimuth_bias_rad(&self) -> f64 {
        self.azimuth_bias_rad
    }

    /// A position of the cooperative sensor in the radar's ENU frame, m.
    pub fn position_enu(&self, truth_m: (f64, f64)) -> Vector3<f64> {
        self.rotation * Vector3::new(truth_m.0, truth_m.1, 0.0) + self.shift_m
    }

    /// A velocity of the cooperative sensor (I010/202) in the radar's ENU frame, m/s.
    pub fn velocity_enu(&self, steps: (i16, i16)) -> Vector3<f64> {
        self.rotation * Vector3::new(f64::from(steps.0), f64::from(steps.1), 0.0) * self.velocity_step_mps
    }

    /// From an aircraft's cooperative position to the centroid that the radar sees, m, given its heading.
    pub fn centroid_shift_m(&self, heading: &Vector3<f64>) -> Vector3<f64> {
        -self.centroid_behind_m * heading
    }
}

/// A place on the Earth.
struct Place {
    latitude_rad: f64,
    longitude_rad: f64,
    height_m: f64,
}

impl Place {
    fn new(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Self {
        Self { latitude_rad: latitude_deg.to_radians(), longitude_rad: longitude_deg.to_radians(), height_m }
    }

    fn earth_centred_m(&self) -> Vector3<f64> {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        let normal_m = EQUATORIAL_RADIUS_M / (1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat).sqrt();
        let ground = (normal_m + self.height_m) * cos_lat;
        let along_axis = (normal_m * (1.0 - ECCENTRICITY_SQUARED) + self.height_m) * sin_lat;
        Vector3::new(ground * cos_lon, ground * sin_lon, along_axis)
    }

    fn east_north_up(&self) -> Matrix3<f64> {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        Matrix3::new(
            -sin_lon,
            cos_lon,
            0.0,
            -sin_lat * cos_lon,
            -sin_lat * sin_lon,
            cos_lat,
            cos_lat * cos_lon,
            cos_lat * sin_lon,
            sin_lat,
        )
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
        let arc = EQUATORIAL_RADIUS_M * 0.01_f64.to_radians();
        assert!((east - Vector3::new(arc, 0.0, -arc * arc / (2.0 * EQUATORIAL_RADIUS_M))).norm() < 1e-3, "{east}");
        let meridian_radius_m = 6_335_439.0; // of WGS-84 at the equator
        let north =
            Registration::new(&RegistrationConfig { truth_latitude_deg: 0.01, ..RegistrationConfig::default() })
                .position_enu((0.0, 0.0));
        assert!((north.y - meridian_radius_m * 0.01_f64.to_radians()).abs() < 1e-2, "{north}");
    }
}
