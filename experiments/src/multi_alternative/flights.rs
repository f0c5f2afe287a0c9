//! The published flights: 60 s at 300 m/s, with a manoeuvre each, and what a radar measures of them.

use common::random::{Purpose, generator};
use rand_distr::{Distribution, StandardNormal};
use tracker::plots::measurement::Measurement;

/// T, s.
pub(crate) const STEP_S: f64 = 0.1;
/// σ of each coordinate, m.
pub(super) const SIGMA_M: f64 = 10.0;
/// One g, m/s².
pub(super) const G_MPS2: f64 = 9.806_65;
/// a_max, m/s².
pub(super) const GREATEST_MPS2: f64 = 5.0 * G_MPS2;
const SPEED_MPS: f64 = 300.0;
/// From the first coordinate towards the second: it matters, because each coordinate decides for itself.
const COURSE_DEG: f64 = 30.0;
const END_S: f64 = 60.0;
/// Integration steps within a scan.
const FINE: u32 = 100;
/// Errors count from the beginning of the manoeuvre to this long after its end, s.
const AFTER_S: f64 = 4.0;

/// One flight; accelerations in g are across the velocity, positive to port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Flight {
    /// No manoeuvre.
    Straight,
    /// A constant turn from 20 to 35 s.
    Turn(f64),
    /// A sine of 10 s from 20 to 50 s.
    Weave(f64),
    /// A turn that changes sides every 6 s, from 20 to 44 s.
    Reversal(f64),
}

/// All of them.
pub(crate) const FLIGHTS: [Flight; 5] =
    [Flight::Straight, Flight::Turn(3.0), Flight::Turn(5.0), Flight::Weave(4.0), Flight::Reversal(4.0)];

/// Position, velocity and acceleration, first and second coordinate; m, m/s, m/s².
pub(crate) type Motion = [[f64; 2]; 3];

impl Flight {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Turn(g) if g < 4.0 => "turn 3 g",
            Self::Turn(_) => "turn 5 g",
            Self::Weave(_) => "weave 4 g",
            Self::Reversal(_) => "reversal 4 g",
        }
    }

    /// From when to when it manoeuvres, s; of the straight flight the whole of it once filters have settled.
    pub(super) fn manoeuvre_s(self) -> [f64; 2] {
        match self {
            Self::Straight => [10.0, END_S - AFTER_S],
            Self::Turn(_) => [20.0, 35.0],
            Self::Weave(_) => [20.0, 50.0],
            Self::Reversal(_) => [20.0, 44.0],
        }
    }

    /// Scans whose errors count.
    pub(crate) fn counted(self) -> std::ops::Range<usize> {
        let [from_s, to_s] = self.manoeuvre_s();
        (from_s / STEP_S).round() as usize..((to_s + AFTER_S) / STEP_S).round() as usize + 1
    }

    /// Across the velocity, m/s².
    fn acceleration(self, t: f64) -> f64 {
        let [from_s, to_s] = self.manoeuvre_s();
        if !(from_s..to_s).contains(&t) {
            return 0.0;
        }
        let since = t - from_s;
        G_MPS2
            * match self {
                Self::Straight => 0.0,
                Self::Turn(g) => g,
                Self::Weave(g) => g * (std::f64::consts::TAU * since / 10.0).sin(),
                Self::Reversal(g) => g * if ((since / 6.0) as u32).is_multiple_of(2) { 1.0 } else { -1.0 },
            }
    }

    /// The aircraft at every scan.
    pub(crate) fn truth(self) -> Vec<Motion> {
        let fine_s = STEP_S / f64::from(FINE);
        let (mut angle, mut position) = (COURSE_DEG.to_radians(), [0.0; 2]);
        let scans = (END_S / STEP_S).round() as u32;
        let mut all = Vec::new();
        for step in 0..=scans * FINE {
            let t = f64::from(step) * fine_s;
            let across = self.acceleration(t + 0.5 * fine_s);
            let velocity = [SPEED_MPS * angle.cos(), SPEED_MPS * angle.sin()];
            if step % FINE == 0 {
                let acceleration = [-across * angle.sin(), across * angle.cos()];
                all.push([position, velocity, acceleration]);
            }
            // An arc of constant rate.
            let middle = angle + 0.5 * across / SPEED_MPS * fine_s;
            position[0] += SPEED_MPS * middle.cos() * fine_s;
            position[1] += SPEED_MPS * middle.sin() * fine_s;
            angle += across / SPEED_MPS * fine_s;
        }
        all
    }
}

/// What is measured in one run, scan by scan: both coordinates with equal errors.
pub(crate) fn plots(truth: &[Motion], seed: u64, run: u32) -> Vec<Measurement> {
    let mut rng = generator(seed, Purpose::Measurement, run, 0);
    let mut normal = || SIGMA_M * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let measure = |[position, ..]: &Motion| {
        let place = position.map(|axis| axis + normal());
        // One metre away: equal errors in range and across.
        Measurement { polar: [1.0, 0.0, 0.0, 0.0], ..Measurement::in_plane(place, [SIGMA_M, SIGMA_M]) }
    };
    truth.iter().map(measure).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flights_keep_their_speed_and_turn_as_stated() {
        for flight in FLIGHTS {
            let truth = flight.truth();
            assert_eq!(truth.len(), 601);
            for [_, velocity, acceleration] in &truth {
                assert!((velocity[0].hypot(velocity[1]) - SPEED_MPS).abs() < 1e-9);
                assert!(acceleration[0].hypot(acceleration[1]) <= GREATEST_MPS2 + 1e-9);
            }
            let moved = |k: usize| (0..2).map(|i| (truth[k][0][i] - truth[k - 1][0][i]).powi(2)).sum::<f64>().sqrt();
            assert!((1..601).all(|k| (moved(k) - SPEED_MPS * STEP_S).abs() < 0.01));
        }
        let turned = |flight: Flight| {
            let truth = flight.truth();
            let of = |k: usize| truth[k][1][1].atan2(truth[k][1][0]);
            (of(600) - of(0)).rem_euclid(std::f64::consts::TAU)
        };
        let expected = 3.0 * G_MPS2 * 15.0 / SPEED_MPS;
        assert!((turned(Flight::Turn(3.0)) - expected).abs() < 1e-6);
        assert!(turned(Flight::Reversal(4.0)).min(std::f64::consts::TAU - turned(Flight::Reversal(4.0))) < 1e-6);
    }
}
