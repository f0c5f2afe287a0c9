//! Targets: straight on but for random accelerations, and for a turn.

use nalgebra::Vector3;
use rand::{Rng, RngExt};

use super::normal;
use crate::gaussian::Vector;

/// Longest step of the integration, s.
const STEP_S: f64 = 0.5;

/// A turn at constant rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Acceleration to the right of the velocity, m/s².
    pub right_mps2: f64,
    /// Begin, s after the beginning of the run.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}

/// A target in the axes of the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// The turn that it makes.
    pub turn: Option<Turn>,
}

impl Target {
    /// An aircraft in level flight, 2 to 10 km high, 100 to 300 m/s fast, in a square of this half side, m.
    pub fn any(rng: &mut impl Rng, extent_m: f64) -> Self {
        let course = rng.random_range(0.0..std::f64::consts::TAU);
        let speed_mps = rng.random_range(100.0..300.0);
        let mut coordinate = || rng.random_range(-extent_m..extent_m);
        let ground = [coordinate(), coordinate()];
        Self {
            position_m: Vector3::new(ground[0], ground[1], rng.random_range(2000.0..10_000.0)),
            velocity_mps: Vector3::new(course.sin(), course.cos(), 0.0) * speed_mps,
            turn: None,
        }
    }

    /// Position and velocity.
    pub fn state(&self) -> Vector {
        let mut state = Vector::zeros();
        state.fixed_rows_mut::<3>(0).copy_from(&self.position_m);
        state.fixed_rows_mut::<3>(3).copy_from(&self.velocity_mps);
        state
    }

    pub(super) fn advance(&mut self, from_s: f64, step_s: f64, noise: f64, rng: &mut impl Rng) {
        let steps = (step_s / STEP_S).ceil().max(1.0);
        let dt_s = step_s / steps;
        if dt_s <= 0.0 {
            return;
        }
        for step in 0..steps as u32 {
            let now_s = from_s + f64::from(step) * dt_s;
            let turning = self.turn.filter(|turn| (turn.from_s..turn.to_s).contains(&now_s));
            let right = Vector3::new(self.velocity_mps.y, -self.velocity_mps.x, 0.0).normalize();
            let random = Vector3::from_fn(|_, _| normal(rng)) * (noise / dt_s).sqrt();
            let acceleration = right * turning.map_or(0.0, |turn| turn.right_mps2) + random;
            self.position_m += self.velocity_mps * dt_s + acceleration * (dt_s * dt_s / 2.0);
            self.velocity_mps += acceleration * dt_s;
        }
    }
}
