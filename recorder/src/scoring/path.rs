//! The last seconds of a track or target, and where it was between its reports.

use std::collections::VecDeque;

use common::tracks::Track;
use common::truth::TruthTarget;
use common::units::{NS_PER_S, seconds_between};

/// One report in the plane: m and m/s, east and north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarPoint {
    /// ns UTC.
    pub time_ns: u64,
    /// m.
    pub position_m: [f64; 2],
    /// m/s.
    pub velocity_mps: [f64; 2],
}

impl From<&Track> for PlanarPoint {
    fn from(track: &Track) -> Self {
        let ([x, y, _], [vx, vy, _]) = (track.position_m(), track.velocity_mps());
        Self { time_ns: track.time_ns, position_m: [x, y], velocity_mps: [vx, vy] }
    }
}

impl From<&TruthTarget> for PlanarPoint {
    fn from(target: &TruthTarget) -> Self {
        let ([x, y, _], [vx, vy, _]) = (target.position_m(), target.velocity_mps());
        Self { time_ns: target.time_ns, position_m: [x, y], velocity_mps: [vx, vy] }
    }
}

/// Reports of one track or target by time.
#[derive(Debug, Clone, Default)]
pub struct Path {
    points: VecDeque<PlanarPoint>,
}

impl Path {
    /// Appends a report; one that is not later than the last is left out.
    pub fn push(&mut self, point: PlanarPoint) {
        if self.points.back().is_none_or(|last| last.time_ns < point.time_ns) {
            self.points.push_back(point);
        }
    }

    /// The reports.
    pub fn points(&self) -> impl Iterator<Item = &PlanarPoint> {
        self.points.iter()
    }

    /// Whether there is no report left.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Where it was at `time_ns`: on the straight line between the reports around that time if
    /// they are not more than `gap_max_s` apart, or at most `hold_max_s` after the last one, on
    /// by its velocity. `None` at other times.
    pub fn position_at(&self, time_ns: u64, gap_max_s: f64, hold_max_s: f64) -> Option<[f64; 2]> {
        let after = self.points.partition_point(|point| point.time_ns <= time_ns);
        let before = self.points.get(after.checked_sub(1)?)?;
        let elapsed_s = seconds_between(before.time_ns, time_ns);
        let step = match self.points.get(after) {
            Some(next) => {
                let gap_s = seconds_between(before.time_ns, next.time_ns);
                if gap_s > gap_max_s && elapsed_s > 0.0 {
                    return None;
                }
                let share = elapsed_s / gap_s;
                [0, 1].map(|axis| (next.position_m[axis] - before.position_m[axis]) * share)
            }
            None if elapsed_s <= hold_max_s => before.velocity_mps.map(|velocity| velocity * elapsed_s),
            None => return None,
        };
        Some([before.position_m[0] + step[0], before.position_m[1] + step[1]])
    }

    /// Forgets reports older than `time_ns`, but the last of them, while there are later ones.
    pub fn forget_before(&mut self, time_ns: u64) {
        while self.points.get(1).is_some_and(|next| next.time_ns <= time_ns) {
            self.points.pop_front();
        }
    }

    /// Time of the last report.
    pub fn last_ns(&self) -> u64 {
        self.points.back().map_or(0, |point| point.time_ns)
    }
}

/// Distance in the plane, m.
pub fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Seconds as ns.
pub fn ns(seconds: f64) -> u64 {
    (seconds * NS_PER_S) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> Path {
        let mut path = Path::default();
        for (second, x) in [(10.0, 0.0), (11.0, 10.0), (15.0, 20.0)] {
            path.push(PlanarPoint { time_ns: ns(second), position_m: [x, 1.0], velocity_mps: [4.0, 0.0] });
        }
        path
    }

    #[test]
    fn between_and_after_the_reports() {
        let at = |second: f64| path().position_at(ns(second), 2.0, 1.0);
        assert_eq!(at(9.9), None);
        assert_eq!(at(10.0), Some([0.0, 1.0]));
        assert_eq!(at(10.25), Some([2.5, 1.0]));
        assert_eq!(at(12.0), None); // the gap is too long
        assert_eq!(at(15.5), Some([22.0, 1.0]));
        assert_eq!(at(16.5), None);
    }

    #[test]
    fn what_is_needed_to_interpolate_is_kept() {
        let mut path = path();
        path.forget_before(ns(10.5));
        assert_eq!(path.position_at(ns(10.5), 2.0, 1.0), Some([5.0, 1.0]));
        path.forget_before(ns(99.0));
        assert_eq!((path.points().count(), path.last_ns()), (1, ns(15.0)));
    }
}
