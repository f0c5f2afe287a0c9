//! Places on the earth: geodetic (WGS-84), earth-centred, and the local frames of sites.
//!
//! ```text
//! N(B) = a / √(1 − e² sin² B)                                                (F1)
//! X = (N + h) cos B cos L,  Y = (N + h) cos B sin L,  Z = (N (1 − e²) + h) sin B
//! E = (−sin L, cos L, 0)                                                     (F2)
//! N = (−sin B cos L, −sin B sin L, cos B)
//! U = (cos B cos L, cos B sin L, sin B)
//! p_site = A_site [ Aᵀ_origin p_origin + (X_origin − X_site) ]
//! ```
//!
//! B latitude, L longitude, h height above the ellipsoid. Two local frames differ by a shift **and** a rotation.
//! Source: \[K18\], with the signs of (F2) corrected.

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A place on the earth (WGS-84).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Position {
    /// North, degrees.
    pub latitude_deg: f64,
    /// East, degrees.
    pub longitude_deg: f64,
    /// Above the ellipsoid, m.
    #[serde(default)]
    pub height_m: f64,
}

/// An ellipsoid of revolution about the earth's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Semi-major axis a, m.
    pub semi_major_m: f64,
    /// Flattening f.
    pub flattening: f64,
}

impl Ellipsoid {
    /// That of GPS, the reference of every [`Position`] here.
    pub const WGS84: Self = Self { semi_major_m: 6_378_137.0, flattening: 1.0 / 298.257_223_563 };
    /// That of the datum SK-42.
    pub const KRASOVSKY: Self = Self { semi_major_m: 6_378_245.0, flattening: 1.0 / 298.3 };

    /// First eccentricity, squared.
    fn e2(&self) -> f64 {
        self.flattening * (2.0 - self.flattening)
    }

    /// Earth-centred, earth-fixed coordinates of a place, m (F1).
    pub fn ecef_m(&self, place: &Position) -> Vector3<f64> {
        let (sin_b, cos_b) = place.latitude_deg.to_radians().sin_cos();
        let (sin_l, cos_l) = place.longitude_deg.to_radians().sin_cos();
        let n = self.semi_major_m / (1.0 - self.e2() * sin_b * sin_b).sqrt();
        let h = place.height_m;
        Vector3::new((n + h) * cos_b * cos_l, (n + h) * cos_b * sin_l, (n * (1.0 - self.e2()) + h) * sin_b)
    }

    /// The place of earth-centred coordinates, m: (F1) inverted by Bowring's step, repeated until nothing changes.
    pub fn position(&self, ecef_m: &Vector3<f64>) -> Position {
        let (a, e2) = (self.semi_major_m, self.e2());
        let ground = ecef_m.x.hypot(ecef_m.y);
        // tan of the reduced latitude, first of a point on the ellipsoid.
        let ratio = 1.0 - self.flattening;
        let mut reduced = (ecef_m.z / (ratio * ground)).atan();
        let mut latitude = reduced;
        for _ in 0..4 {
            let (sin, cos) = reduced.sin_cos();
            let up = ecef_m.z + e2 / ratio * a * sin.powi(3);
            latitude = up.atan2(ground - e2 * a * cos.powi(3));
            reduced = (ratio * latitude.sin()).atan2(latitude.cos());
        }
        let (sin_b, cos_b) = latitude.sin_cos();
        let height_m = ground * cos_b + ecef_m.z * sin_b - a * (1.0 - e2 * sin_b * sin_b).sqrt();
        Position { latitude_deg: latitude.to_degrees(), longitude_deg: ecef_m.y.atan2(ecef_m.x).to_degrees(), height_m }
    }
}

/// From the earth-centred axes of one datum to those of another: shift, small rotation (position vectors turn), scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DatumShift {
    /// Along X, Y, Z, m.
    pub shift_m: [f64; 3],
    /// About X, Y, Z, seconds of arc.
    pub rotation_arcsec: [f64; 3],
    /// Scale less 1, millionths.
    pub scale_ppm: f64,
}

impl DatumShift {
    /// Coordinates in the other datum, m.
    pub fn apply(&self, ecef_m: &Vector3<f64>) -> Vector3<f64> {
        let rotation = Vector3::from(self.rotation_arcsec.map(|arcsec| (arcsec / 3600.0).to_radians()));
        Vector3::from(self.shift_m) + (ecef_m + rotation.cross(ecef_m)) * (1.0 + self.scale_ppm * 1e-6)
    }
}

/// Earth-centred, earth-fixed coordinates of a place, m (F1).
pub fn ecef_m(place: &Position) -> Vector3<f64> {
    Ellipsoid::WGS84.ecef_m(place)
}

/// Rotation from earth-centred axes to east, north, up at a place: rows E, N, U (F2).
pub fn enu_axes(place: &Position) -> Matrix3<f64> {
    let (sin_b, cos_b) = place.latitude_deg.to_radians().sin_cos();
    let (sin_l, cos_l) = place.longitude_deg.to_radians().sin_cos();
    Matrix3::new(-sin_l, cos_l, 0.0, -sin_b * cos_l, -sin_b * sin_l, cos_b, cos_b * cos_l, cos_b * sin_l, sin_b)
}

/// The local frame of a place: east, north, up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFrame {
    origin_m: Vector3<f64>,
    axes: Matrix3<f64>,
}

impl LocalFrame {
    /// That of a radar or a centre at `origin`.
    pub fn new(origin: &Position) -> Self {
        Self { origin_m: ecef_m(origin), axes: enu_axes(origin) }
    }

    /// The place of a position east, north and up of the origin, m.
    pub fn place(&self, position_m: [f64; 3]) -> Position {
        Ellipsoid::WGS84.position(&(self.origin_m + self.axes.transpose() * Vector3::from(position_m)))
    }
}

/// From the local frame of one place to that of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameChange {
    rotation: Matrix3<f64>,
    shift_m: Vector3<f64>,
}

impl FrameChange {
    /// From the local frame of `origin` to that of `site`.
    pub fn new(origin: &Position, site: &Position) -> Self {
        let axes = enu_axes(site);
        Self { rotation: axes * enu_axes(origin).transpose(), shift_m: axes * (ecef_m(origin) - ecef_m(site)) }
    }

    /// A position, m.
    pub fn position_m(&self, position: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(position) + self.shift_m).into()
    }

    /// A velocity, acceleration or any other vector without a place.
    pub fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(vector)).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const SEMI_MAJOR_M: f64 = Ellipsoid::WGS84.semi_major_m;
    const FLATTENING: f64 = Ellipsoid::WGS84.flattening;

    fn place(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Position {
        Position { latitude_deg, longitude_deg, height_m }
    }

    /// Points on the axes of the ellipsoid, whose coordinates follow from its definition.
    #[test]
    fn the_axes_of_the_ellipsoid_are_where_they_are() {
        let semi_minor_m = SEMI_MAJOR_M * (1.0 - FLATTENING);
        for (at, expected) in [
            (place(0.0, 0.0, 0.0), [SEMI_MAJOR_M, 0.0, 0.0]),
            (place(0.0, 90.0, 10.0), [0.0, SEMI_MAJOR_M + 10.0, 0.0]),
            (place(90.0, 30.0, 0.0), [0.0, 0.0, semi_minor_m]),
            (place(-90.0, 0.0, 5.0), [0.0, 0.0, -semi_minor_m - 5.0]),
        ] {
            assert_relative_eq!(ecef_m(&at), Vector3::from(expected), epsilon = 1e-8);
        }
    }

    /// Values of an independent program in 40 digits (m): geodetic to earth-centred, and a target in the frame of a command
    /// post.
    #[test]
    fn golden_values_come_out_to_a_micrometre() {
        for (at, expected) in [
            (place(50.45, 30.52, 180.0), [3_505_685.897_855_746_6, 2_066_655.458_958_513, 4_894_951.672_282_747]),
            (
                place(-33.9, -179.999, 12_000.0),
                [-5_309_413.104_320_026, -92.666_740_029_914_52, -3_543_938.289_213_012],
            ),
        ] {
            assert_relative_eq!(ecef_m(&at), Vector3::from(expected), epsilon = 1e-6);
        }
        let (post, target) = (place(50.45, 30.52, 180.0), place(51.2, 31.9, 9500.0));
        let enu = FrameChange::new(&target, &post).position_m([0.0; 3]);
        let expected = [96_589.766_988_461_53, 84_452.616_612_915_07, 8_032.399_513_560_232];
        assert_relative_eq!(Vector3::from(enu), Vector3::from(expected), epsilon = 1e-6);
    }

    #[test]
    fn places_come_back_from_earth_centred_coordinates() {
        for ellipsoid in [Ellipsoid::WGS84, Ellipsoid::KRASOVSKY] {
            for (latitude_deg, longitude_deg, height_m) in [
                (50.45, 30.52, 180.0),
                (-33.9, -179.999, 12_000.0),
                (89.999, 10.0, 0.0),
                (0.0, 0.0, -50.0),
                (45.0, 90.0, 4e5),
            ] {
                let back = ellipsoid.position(&ellipsoid.ecef_m(&place(latitude_deg, longitude_deg, height_m)));
                assert_relative_eq!(back.latitude_deg, latitude_deg, epsilon = 1e-12);
                assert_relative_eq!(back.longitude_deg, longitude_deg, epsilon = 1e-12);
                assert_relative_eq!(back.height_m, height_m, epsilon = 2e-8);
            }
        }
    }

    #[test]
    fn there_and_back_is_where_one_was() {
        let (a, b) = (place(50.45, 30.52, 120.0), place(50.7, 31.9, 80.0));
        let (there, back) = (FrameChange::new(&a, &b), FrameChange::new(&b, &a));
        let (position, velocity) = ([12_000.0, -3_000.0, 900.0], [20.0, -5.0, 1.0]);
        for (again, was) in back.position_m(there.position_m(position)).into_iter().zip(position) {
            assert_relative_eq!(again, was, epsilon = 1e-8);
        }
        for (again, was) in back.vector(there.vector(velocity)).into_iter().zip(velocity) {
            assert_relative_eq!(again, was, epsilon = 1e-12);
        }
    }

    /// A place seen from another one, and found again: to a micrometre, also near the poles and the date line.
    #[test]
    fn a_local_frame_finds_the_place_of_what_it_sees() {
        for (latitude_deg, longitude_deg) in [(-89.9, 2.1), (-33.0, -179.9), (0.0, 120.0), (78.0, 0.0)] {
            let site = place(latitude_deg, longitude_deg, 120.0);
            for seen_m in [[0.0; 3], [80_000.0, -3000.0, 11_000.0], [-5.0, 150_000.0, -900.0]] {
                let found = LocalFrame::new(&site).place(seen_m);
                let again_m = FrameChange::new(&found, &site).position_m([0.0; 3]);
                assert_relative_eq!(Vector3::from(again_m), Vector3::from(seen_m), epsilon = 1e-6);
            }
        }
    }

    /// A target above `a` lies below the horizon of `b` by the curvature of the earth, s²/2R.
    #[test]
    fn the_earth_is_round() {
        let (a, b) = (place(0.0, 0.0, 0.0), place(0.0, 1.0, 0.0));
        let [east, north, up] = FrameChange::new(&a, &b).position_m([0.0; 3]);
        let angle = 1_f64.to_radians();
        assert_relative_eq!(east, -SEMI_MAJOR_M * angle.sin(), max_relative = 1e-12);
        assert_relative_eq!(north, 0.0, epsilon = 1e-8);
        assert_relative_eq!(up, SEMI_MAJOR_M * (angle.cos() - 1.0), max_relative = 1e-9);
    }
}
