//! Pieces of constant acceleration: straight lines and the trajectories of \[L22\].

use common::truth::MANOEUVRE;
use nalgebra::Vector3;

use super::{Kinematics, unaccelerated_mode};

/// Motion with piecewise constant acceleration; after the last piece it goes on unaccelerated.
#[derive(Debug, Clone)]
pub struct Segments {
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone, Copy)]
struct Piece {
    from_s: f64,
    position_m: Vector3<f64>,
    velocity_mps: Vector3<f64>,
    acceleration_mps2: Vector3<f64>,
}

impl Piece {
    fn at(&self, time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let t = time_s - self.from_s;
        let position = self.position_m + self.velocity_mps * t + self.acceleration_mps2 * (t * t / 2.0);
        (position, self.velocity_mps + self.acceleration_mps2 * t)
    }
}

/// (north, east) acceleration, m/s², and number of one-second steps.
pub type Step = (f64, f64, u32);

/// Trajectories of \[L22\] after the start at k = −1: steps k = 0…9, 10…15, 16…20, 21…25, 26…33, 34…39.
const A: [Step; 6] = [(0.0, 0.0, 10), (5.0, 0.0, 6), (0.0, 0.0, 5), (-2.0, 4.0, 5), (0.0, 0.0, 8), (3.0, 3.0, 6)];
const B: [Step; 6] = [(0.0, 0.0, 10), (7.0, -1.0, 6), (0.0, 0.0, 5), (-4.4, 5.2, 5), (0.0, 0.0, 8), (-4.0, 5.0, 6)];

impl Segments {
    /// A straight line; with zero velocity, hovering.
    pub fn straight(position_m: Vector3<f64>, velocity_mps: Vector3<f64>) -> Self {
        Self::new(position_m, velocity_mps, &[])
    }

    /// Trajectory `"a"`, `"b"` or `"cv"` of \[L22\], moved by `shift_m`. Time 0 is k = −1.
    pub fn published(name: &str, shift_m: Vector3<f64>) -> Self {
        let steps: &[Step] = match name {
            "a" => &A,
            "b" => &B,
            _ => &[],
        };
        let start = Vector3::new(800.0, 400.0, 100.0); // east 800, north 400
        Self::new(start + shift_m, Vector3::new(-20.0, -20.0, 0.0), steps)
    }

    /// From a start through steps of (north, east) acceleration (m/s²) and whole seconds.
    pub fn new(position_m: Vector3<f64>, velocity_mps: Vector3<f64>, steps: &[Step]) -> Self {
        let mut piece = Piece { from_s: 0.0, position_m, velocity_mps, acceleration_mps2: Vector3::zeros() };
        let mut pieces = Vec::with_capacity(steps.len() + 1);
        for &(north, east, seconds) in steps {
            piece.acceleration_mps2 = Vector3::new(east, north, 0.0);
            pieces.push(piece);
            let until_s = piece.from_s + f64::from(seconds);
            let (position_m, velocity_mps) = piece.at(until_s);
            piece = Piece { from_s: until_s, position_m, velocity_mps, acceleration_mps2: Vector3::zeros() };
        }
        pieces.push(piece);
        Self { pieces }
    }

    /// State `time_s` after the start.
    pub fn at(&self, time_s: f64) -> Kinematics {
        let index = self.pieces.partition_point(|piece| piece.from_s <= time_s).saturating_sub(1);
        let piece = &self.pieces[index];
        let (position_m, velocity_mps) = piece.at(time_s);
        let accelerated = piece.acceleration_mps2 != Vector3::zeros();
        let mode = if accelerated { MANOEUVRE } else { unaccelerated_mode(&velocity_mps) };
        Kinematics { position_m, velocity_mps, acceleration_mps2: piece.acceleration_mps2, mode }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::truth::{CONSTANT_VELOCITY, HOVER};

    /// The recursion of the source, x_k = x_{k−1} + vT + aT²/2, step by step.
    #[test]
    fn trajectory_b_follows_the_source() {
        let motion = Segments::published("b", Vector3::zeros());
        let acceleration = |k: i32| match k {
            10..=15 => (7.0, -1.0),
            21..=25 => (-4.4, 5.2),
            34..=39 => (-4.0, 5.0),
            _ => (0.0, 0.0),
        };
        let (mut north, mut east, mut vn, mut ve) = (400.0, 800.0, -20.0, -20.0);
        for k in 0..=50 {
            let (an, ae) = acceleration(k);
            north += vn + an / 2.0;
            east += ve + ae / 2.0;
            vn += an;
            ve += ae;
            let state = motion.at(f64::from(k + 1));
            assert!((state.position_m - Vector3::new(east, north, 100.0)).norm() < 1e-9, "k = {k}");
            assert!((state.velocity_mps - Vector3::new(ve, vn, 0.0)).norm() < 1e-9, "k = {k}");
        }
        assert_eq!(motion.at(5.0).mode, CONSTANT_VELOCITY);
        assert_eq!(motion.at(12.0).mode, MANOEUVRE);
        assert_eq!(motion.at(30.0).mode, HOVER);
    }
}
