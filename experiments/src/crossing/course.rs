//! Two drones: how they fly, and what the radar sees of them.

use common::config::Swerling;
use nalgebra::Vector3;
use radar_sim::motion::{Kinematics, Segments};
use rand::Rng;
use tracker::plots::measurement::COORDINATES;

use crate::turning::CELL;
use crate::world::{Conditions, SIGMA, offset, place, power, scattered};

/// Scans side by side.
pub(super) const TOGETHER: u32 = 10;
/// Scans of converging and of parting.
const APART: u32 = 14;
/// Scans in which the speed towards each other is taken up or given up.
const TURN: u32 = 2;
/// Scans of a run.
pub(super) const SCANS: u32 = 2 * APART + TOGETHER + 2 * TURN;
/// Where they meet, east of the antenna: range and height, m.
const RANGE_M: f64 = 1500.0;
const HEIGHT_M: f64 = 150.0;
/// Speed of each towards the other, m/s.
pub(super) const CLOSING_MPS: f64 = 8.0;
/// Speed along the common course, m/s.
const ALONG_MPS: f64 = 12.0;
/// A track follows a drone within this distance, m.
pub(super) const FOLLOWS_M: f64 = 50.0;
/// What surrounds the drones.
pub(super) const CONDITIONS: Conditions =
    Conditions { pfa: 1e-3, snr_db: 16.0, swerling: Swerling::One, reference_cells: 0 };

/// How the two part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// Each goes on to the other's side.
    Cross,
    /// Each turns back to its own.
    Part,
}

impl Course {
    /// Both.
    pub(super) const ALL: [Self; 2] = [Self::Cross, Self::Part];

    /// As in the JSON.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Cross => "cross",
            Self::Part => "part",
        }
    }
}

/// The ways of both, at a separation in cells of range.
pub(super) fn paths(course: Course, separation_cells: f64) -> [Segments; 2] {
    [1.0, -1.0].map(|side| path(course, separation_cells * CELL[0], side))
}

/// The way of one drone: `side` of the middle, east of the antenna and flying north.
fn path(course: Course, separation_m: f64, side: f64) -> Segments {
    let closing_s = f64::from(APART) + 0.5 * f64::from(TURN);
    let east_m = RANGE_M + side * (0.5 * separation_m + CLOSING_MPS * closing_s);
    let start = Vector3::new(east_m, -0.5 * ALONG_MPS * f64::from(SCANS), HEIGHT_M);
    let turn = side * CLOSING_MPS / f64::from(TURN);
    let away = if course == Course::Cross { -turn } else { turn };
    let steps = [(0.0, 0.0, APART), (0.0, turn, TURN), (0.0, 0.0, TOGETHER), (0.0, away, TURN)];
    Segments::new(start, Vector3::new(-side * CLOSING_MPS, ALONG_MPS, 0.0), &steps)
}

/// A plot before it has a form.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// r, β, ε, ṙ.
    pub(super) polar: [f64; COORDINATES],
    /// q.
    pub(super) power: f64,
    /// When the beam passed, s.
    pub(super) time_s: f64,
}

/// One plot of each drone, whether it exceeds the threshold or not; of two drones within a cell on every axis, if these merge, one
/// of both powers between them.
pub(super) fn plots(drones: &[Segments; 2], times_s: [f64; 2], merge: bool, rng: &mut impl Rng) -> Vec<Seen> {
    let places = [0, 1].map(|i: usize| place(&drones[i].at(times_s[i])));
    let [a, b] = [0, 1].map(|i: usize| {
        let polar = scattered(&places[i], &SIGMA, rng);
        Seen { polar, power: power(&CONDITIONS, rng), time_s: times_s[i] }
    });
    let near = |i: usize| offset(places[0][i], places[1][i], i).abs() < CELL[i];
    if !merge || !(0..COORDINATES).all(near) {
        return vec![a, b];
    }
    let share = a.power / (a.power + b.power);
    vec![Seen {
        polar: std::array::from_fn(|i| b.polar[i] + share * offset(a.polar[i], b.polar[i], i)),
        power: a.power + b.power,
        time_s: b.time_s + share * (a.time_s - b.time_s),
    }]
}

/// Distance of the two drones, m.
pub(super) fn apart_m(truth: &[Kinematics; 2]) -> f64 {
    (truth[0].position_m - truth[1].position_m).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};

    #[test]
    fn they_meet_at_the_separation_and_part_on_the_right_sides() {
        for course in Course::ALL {
            let drones = paths(course, 0.5);
            let at = |scan: u32| [0, 1].map(|i: usize| drones[i].at(f64::from(scan)));
            for scan in APART + TURN..=APART + TURN + TOGETHER {
                assert!((apart_m(&at(scan)) - 0.5 * CELL[0]).abs() < 1e-9);
            }
            assert!(apart_m(&at(0)) > 200.0 && apart_m(&at(SCANS)) > 200.0);
            let exchanged = at(SCANS)[0].position_m.x < at(SCANS)[1].position_m.x;
            assert_eq!(exchanged, course == Course::Cross);
        }
    }

    #[test]
    fn near_drones_give_one_plot_of_both_powers_if_these_merge() {
        let drones = paths(Course::Cross, 0.5);
        let [together, apart] = [f64::from(APART + TURN), 0.0];
        let plots = |time_s: f64, merge| plots(&drones, [time_s; 2], merge, &mut generator(1, Purpose::Test, 0, 0));
        let (one, two) = (plots(together, true), plots(together, false));
        assert_eq!((one.len(), two.len(), plots(apart, true).len()), (1, 2, 2));
        assert!((one[0].power - two[0].power - two[1].power).abs() < 1e-9);
        let [lo, hi] = [two[0].polar[0].min(two[1].polar[0]), two[0].polar[0].max(two[1].polar[0])];
        assert!((lo..=hi).contains(&one[0].polar[0]));
    }
}
