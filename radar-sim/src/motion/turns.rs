//! Legs of constant turn rate: ships that turn, aircraft that manoeuvre.

use common::angle;
use common::truth::MANOEUVRE;
use nalgebra::{Rotation3, Vector3};

use super::{Kinematics, unaccelerated_mode};

/// Legs of constant turn rate one after the other, at constant speed; then straight on, or the same legs again from where they end.
#[derive(Debug, Clone)]
pub struct Turns {
    start: Leg,
    legs: Vec<Leg>,
    end: Leg,
    /// How far one round of all legs turns, rad, in [−π, π).
    round_rad: f64,
    repeats: bool,
}

/// From when on, and the state then.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from_s: f64,
    position_m: Vector3<f64>,
    velocity_mps: Vector3<f64>,
    /// Positive from east towards north.
    rate_rad_per_s: f64,
}

fn turned(angle_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle_rad)
}

impl Leg {
    fn at(&self, time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let t = time_s - self.from_s;
        let half = 0.5 * self.rate_rad_per_s * t;
        // The chord lies half way between both courses.
        let chord = if half == 0.0 { 1.0 } else { half.sin() / half };
        let mut moved = turned(half) * self.velocity_mps * (t * chord);
        moved.z = self.velocity_mps.z * t;
        (self.position_m + moved, turned(2.0 * half) * self.velocity_mps)
    }
}

impl Turns {
    /// From a start through legs of (duration, s; turn rate, rad/s, positive from east towards north).
    pub fn new(position_m: Vector3<f64>, velocity_mps: Vector3<f64>, legs: &[(f64, f64)], repeats: bool) -> Self {
        let start = Leg { from_s: 0.0, position_m, velocity_mps, rate_rad_per_s: 0.0 };
        let (mut next, mut all) = (start, Vec::with_capacity(legs.len()));
        let turns_rad: f64 = legs.iter().map(|(duration_s, rate_rad_per_s)| duration_s * rate_rad_per_s).sum();
        for &(duration_s, rate_rad_per_s) in legs {
            let leg = Leg { rate_rad_per_s, ..next };
            let from_s = leg.from_s + duration_s;
            let (position_m, velocity_mps) = leg.at(from_s);
            all.push(leg);
            next = Leg { from_s, position_m, velocity_mps, rate_rad_per_s: 0.0 };
        }
        Self { start, legs: all, end: next, round_rad: angle::difference(turns_rad, 0.0), repeats }
    }

    /// State `time_s` after the start.
    pub fn at(&self, time_s: f64) -> Kinematics {
        let rounds = if self.repeats { (time_s / self.end.from_s).floor().max(0.0) } else { 0.0 };
        let local_s = time_s - rounds * self.end.from_s;
        let index = self.legs.partition_point(|leg| leg.from_s <= local_s).saturating_sub(1);
        let leg = if local_s < self.end.from_s { self.legs.get(index).unwrap_or(&self.end) } else { &self.end };
        let (position, velocity) = leg.at(local_s);
        // One round moves by D and turns by Θ: n of them move by D + R(Θ) D + … = R((n − 1) Θ/2) D sin(n Θ/2)/sin(Θ/2). Whole circles do
        // not count, so that the sine is 0 only with Θ.
        let total = self.round_rad;
        let one = self.end.position_m - self.start.position_m;
        let sine = (0.5 * total).sin();
        let times = if sine.abs() < 1e-9 { rounds } else { (0.5 * rounds * total).sin() / sine };
        let mut moved = turned(0.5 * (rounds - 1.0) * total) * one * times;
        moved.z = rounds * one.z;
        let around = turned(rounds * total);
        let velocity_mps = around * velocity;
        let rate = leg.rate_rad_per_s;
        Kinematics {
            position_m: self.start.position_m + moved + around * (position - self.start.position_m),
            velocity_mps,
            acceleration_mps2: Vector3::new(-rate * velocity_mps.y, rate * velocity_mps.x, 0.0),
            mode: if rate == 0.0 { unaccelerated_mode(&velocity_mps) } else { MANOEUVRE },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Velocity is the derivative of position and acceleration that of velocity, the speed never changes, and nothing jumps, through many rounds.
    #[test]
    fn the_way_is_smooth() {
        let legs = [(10.0, 0.0), (15.0, 0.1), (7.0, -0.05), (3.0, 0.0)];
        let no_turn = [(6.0, 0.1), (6.0, -0.1)];
        let circles = |number: f64| [(5.0, 0.0), (60.0 * number.abs(), number.signum() * TAU / 60.0)];
        let ways = [&legs[..], &no_turn, &circles(1.0), &circles(-1.0), &circles(2.0)];
        for (legs, repeats) in ways.into_iter().flat_map(|legs| [(legs, false), (legs, true)]) {
            let turns = Turns::new(Vector3::new(1e3, 2e3, 50.0), Vector3::new(30.0, 40.0, 1.0), legs, repeats);
            let h = 1e-4;
            let mut before = turns.at(0.033);
            for step in 1..4000 {
                let t = f64::from(step) * 0.1 + 0.033;
                let state = turns.at(t);
                let slope = (turns.at(t + h).position_m - turns.at(t - h).position_m) / (2.0 * h);
                assert!((slope - state.velocity_mps).norm() < 0.01, "{t}: {slope} {}", state.velocity_mps);
                assert!((state.velocity_mps.xy().norm() - 50.0).abs() < 1e-9);
                assert!((state.velocity_mps - before.velocity_mps).norm() < 0.7, "{t}");
                assert!((state.position_m - before.position_m).norm() < 5.1, "{t}: {}", state.position_m);
                assert!((state.position_m.z - 50.0 - t).abs() < 1e-6);
                before = state;
            }
        }
    }

    #[test]
    fn a_turn_is_a_circle() {
        let turns = Turns::new(Vector3::zeros(), Vector3::new(0.0, 10.0, 0.0), &[(1e3, 0.1)], false);
        let state = turns.at(std::f64::consts::PI / 0.1);
        assert!((state.position_m - Vector3::new(-200.0, 0.0, 0.0)).norm() < 1e-9, "to port: {}", state.position_m);
        assert!((state.acceleration_mps2.norm() - 1.0).abs() < 1e-12 && state.mode == MANOEUVRE);
        let on = turns.at(2e3);
        assert!(on.mode != MANOEUVRE && on.acceleration_mps2.norm() < 1e-12);
    }
}
