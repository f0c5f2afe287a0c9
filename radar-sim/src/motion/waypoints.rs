//! Legs between points, joined by circular turns, flown at constant speed.

use common::truth::{CONSTANT_VELOCITY, MANOEUVRE};
use nalgebra::Vector3;

use super::Kinematics;

/// Centripetal acceleration in turns, m/s².
const TURN_MPS2: f64 = 4.0;

/// A course of straight legs and arcs.
#[derive(Debug, Clone)]
pub struct Course {
    parts: Vec<Part>,
    speed_mps: f64,
    repeats: bool,
    length_m: f64,
}

#[derive(Debug, Clone, Copy)]
struct Part {
    from_m: f64,
    path: Path,
}

#[derive(Debug, Clone, Copy)]
enum Path {
    /// From `start` along the unit vector `along`.
    Leg { start: Vector3<f64>, along: Vector3<f64> },
    /// On a circle: centre + radius (−`inward` cos φ + `along` sin φ), φ from 0.
    Turn { centre: Vector3<f64>, radius_m: f64, along: Vector3<f64>, inward: Vector3<f64> },
}

impl Course {
    /// A course through the legs between `points`; corners are rounded with the radius of
    /// a 4 m/s² turn, less where a leg is too short for it. With `repeats` the last point
    /// leads to the first again; without, the last leg goes on for ever.
    pub fn new(points: &[Vector3<f64>], speed_mps: f64, repeats: bool) -> Self {
        let count = points.len();
        let legs = if repeats { count } else { count - 1 };
        let point = |index: usize| points[index % count];
        let length = |leg: usize| (point(leg + 1) - point(leg)).norm();
        let along = |leg: usize| (point(leg + 1) - point(leg)) / length(leg).max(1e-9);

        let mut course = Self { parts: Vec::new(), speed_mps, repeats, length_m: 0.0 };
        // Where the arc at the end of `leg` begins before, and ends after, the corner.
        let cut = |leg: usize| -> (f64, f64, f64) {
            let next = (leg + 1) % legs.max(1);
            if !repeats && leg + 1 >= legs {
                return (0.0, 0.0, 0.0);
            }
            let angle = along(leg).dot(&along(next)).clamp(-1.0, 1.0).acos();
            let tangent = (angle / 2.0).tan();
            if angle < 1e-6 || !tangent.is_finite() {
                return (0.0, 0.0, 0.0);
            }
            let radius = (speed_mps * speed_mps / TURN_MPS2).min(0.45 * length(leg).min(length(next)) / tangent);
            (radius * tangent, radius, angle)
        };
        let mut begins_at = if repeats { cut(legs - 1).0 } else { 0.0 };
        for leg in 0..legs {
            let (before_corner, radius_m, angle) = cut(leg);
            let start = point(leg) + along(leg) * begins_at;
            let straight_m = (length(leg) - begins_at - before_corner).max(0.0);
            course.append(Path::Leg { start, along: along(leg) }, straight_m);
            if radius_m > 0.0 {
                let (a, b) = (along(leg), along((leg + 1) % legs));
                let inward = (b - a * a.dot(&b)).normalize();
                let tangent_point = start + a * straight_m;
                let centre = tangent_point + inward * radius_m;
                course.append(Path::Turn { centre, radius_m, along: a, inward }, radius_m * angle);
            }
            begins_at = before_corner;
        }
        course
    }

    fn append(&mut self, path: Path, length_m: f64) {
        self.parts.push(Part { from_m: self.length_m, path });
        self.length_m += length_m;
    }

    /// State `time_s` after the start.
    pub fn at(&self, time_s: f64) -> Kinematics {
        let mut flown_m = self.speed_mps * time_s;
        if self.repeats {
            flown_m = flown_m.rem_euclid(self.length_m);
        }
        let index = self.parts.partition_point(|part| part.from_m <= flown_m).saturating_sub(1);
        let part = &self.parts[index];
        let s = flown_m - part.from_m;
        match part.path {
            Path::Leg { start, along } => Kinematics {
                position_m: start + along * s,
                velocity_mps: along * self.speed_mps,
                acceleration_mps2: Vector3::zeros(),
                mode: CONSTANT_VELOCITY,
            },
            Path::Turn { centre, radius_m, along, inward } => {
                let (sin, cos) = (s / radius_m).sin_cos();
                let outward = along * sin - inward * cos;
                Kinematics {
                    position_m: centre + outward * radius_m,
                    velocity_mps: (along * cos + inward * sin) * self.speed_mps,
                    acceleration_mps2: -outward * (self.speed_mps * self.speed_mps / radius_m),
                    mode: MANOEUVRE,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(repeats: bool) -> Course {
        let points = [[0.0, 0.0, 50.0], [1000.0, 0.0, 50.0], [1000.0, 1000.0, 80.0], [0.0, 1000.0, 80.0]];
        Course::new(&points.map(Vector3::from), 20.0, repeats)
    }

    /// Velocity is the derivative of position, its size never changes, and nothing jumps.
    #[test]
    fn the_course_is_smooth() {
        for repeats in [false, true] {
            let course = square(repeats);
            let h = 1e-4;
            for step in 0..4000 {
                let t = f64::from(step) * 0.1 + 0.033;
                let state = course.at(t);
                let slope = (course.at(t + h).position_m - course.at(t - h).position_m) / (2.0 * h);
                assert!((slope - state.velocity_mps).norm() < 0.01, "{repeats} {t}");
                assert!((state.velocity_mps.norm() - 20.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_repeating_course_comes_back() {
        let course = square(true);
        let turn_s = course.length_m / 20.0;
        assert!((course.at(3.0).position_m - course.at(3.0 + turn_s).position_m).norm() < 1e-6);
    }
}
