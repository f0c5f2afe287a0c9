//! From a radar's east-north-up frame to latitude, longitude and height (WGS-84).

use common::config::Position;
use common::geodesy::{ecef_m, enu_axes};
use nalgebra::{Matrix3, Vector3};

/// Semi-major axis, m, and first eccentricity squared of the ellipsoid.
const A_M: f64 = 6_378_137.0;
const E2: f64 = 6.694_379_990_141_316e-3;
/// Latitude is found to less than 10⁻¹² rad in so many steps, at any height of aircraft.
const STEPS: usize = 5;

/// The frame of a radar.
#[derive(Debug, Clone, Copy)]
pub struct RadarFrame {
    origin_m: Vector3<f64>,
    axes: Matrix3<f64>,
}

impl RadarFrame {
    /// Of a radar that stands at `site`.
    pub fn new(site: &Position) -> Self {
        Self { origin_m: ecef_m(site), axes: enu_axes(site) }
    }

    /// The place of a position east, north and up of the radar, m.
    pub fn place(&self, position_m: [f64; 3]) -> Position {
        let earth_m = self.origin_m + self.axes.transpose() * Vector3::from(position_m);
        let from_axis_m = earth_m.x.hypot(earth_m.y);
        let mut latitude = earth_m.z.atan2(from_axis_m * (1.0 - E2));
        let mut height_m = 0.0;
        for _ in 0..STEPS {
            let (sin, cos) = latitude.sin_cos();
            let normal_m = A_M / (1.0 - E2 * sin * sin).sqrt();
            height_m = from_axis_m * cos + earth_m.z * sin - A_M * A_M / normal_m;
            latitude = earth_m.z.atan2(from_axis_m * (1.0 - E2 * normal_m / (normal_m + height_m)));
        }
        Position {
            latitude_deg: latitude.to_degrees(),
            longitude_deg: earth_m.y.atan2(earth_m.x).to_degrees(),
            height_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place seen from a radar, and found again: to a millimetre, from any radar.
    #[test]
    fn places_are_found_again() {
        for latitude_deg in [-89.9, -33.0, 0.0, 41.3, 78.0] {
            for longitude_deg in [-179.9, 0.0, 2.1, 120.0] {
                let site = Position { latitude_deg, longitude_deg, height_m: 120.0 };
                let frame = RadarFrame::new(&site);
                for position_m in [[0.0, 0.0, 0.0], [80_000.0, -3000.0, 11_000.0], [-5.0, 150_000.0, -900.0]] {
                    let earth_m = ecef_m(&frame.place(position_m));
                    let expected_m = frame.origin_m + frame.axes.transpose() * Vector3::from(position_m);
                    assert!((earth_m - expected_m).norm() < 1e-3, "{position_m:?} from {site:?}");
                }
            }
        }
    }
}
