//! Whether the targets went on over a jump of the clock as if nothing had happened.
//!
//! A clock that is set ahead and a recording that pauses look alike but for the targets: after a step they are where one
//! turn of the antenna brought them, after a pause where the time of the clock brought them, or gone. Of each target that
//! was seen in the last two turns, with velocity v and the variance σ² of a place per axis, the nearest plot after the
//! jump lies d from where it is expected after the time t of either:
//!
//! ```text
//! ln L = max(−d²/(2 s²) − ln(s²/σ²), −8),   s² = σ² (1 + (1 + t/T)² + (t/T)²) + (a t²/2)²
//! ```
//!
//! (1 for the plot, 1 + t/T and t/T for the two before it, a what a target may accelerate). A target that stands still
//! speaks for neither: after a pause it may also be where it was.

use common::geometry::Polar;
use common::units::NS_PER_S;
use nalgebra::Vector3;

use crate::radar::{Cycle, Report};

/// A target moves at most so far in a turn that its plots are paired, m/s.
const FASTEST_MPS: f64 = 400.0;
/// Its velocity changes by about this, m/s².
const ACCELERATION_MPS2: f64 = 1.0;
/// What one target says at most.
const LEAST: f64 = -8.0;
/// So much more likely must a step be than a pause: the clock is believed otherwise.
const SURE: f64 = 5.0;

/// The time between two start-of-cycle messages, and the reports about it.
#[derive(Debug)]
pub struct Gap<'a> {
    /// Between the two messages, ns of the clock.
    pub elapsed_ns: i64,
    /// Longest time between two successive entries of the file, ns of the clock.
    pub widest_ns: i64,
    /// Time of a turn, ns.
    pub turn_ns: i64,
    /// Reports before and after the widest gap.
    before: &'a [Report],
    after: &'a [Report],
    /// Clock at both ends of the widest gap, ns.
    ends_ns: (i64, i64),
}

impl<'a> Gap<'a> {
    /// The widest gap between the messages of `pair`.
    pub fn widest(pair: &[Cycle], reports: &'a [Report], turn_ns: i64) -> Self {
        let (from, to) = (pair[0], pair[1]);
        let between = reports[from.reports_before..to.reports_before].iter().enumerate();
        let mut gap = (i64::MIN, from.reports_before, (from.clock_ns, from.clock_ns));
        let mut last_ns = from.clock_ns;
        let times = between.filter_map(|(index, report)| Some((from.reports_before + index, report.clock_ns?)));
        for (index, time_ns) in times.chain([(to.reports_before, to.clock_ns)]) {
            if time_ns - last_ns > gap.0 {
                gap = (time_ns - last_ns, index, (last_ns, time_ns));
            }
            last_ns = time_ns;
        }
        let (widest_ns, split, ends_ns) = gap;
        let (before, after) = reports.split_at(split);
        Self { elapsed_ns: to.clock_ns - from.clock_ns, widest_ns, turn_ns, before, after, ends_ns }
    }

    /// Whether the targets are where one turn would have brought them. `errors`: standard errors, m and rad.
    pub fn targets_went_on(&self, errors: (f64, f64)) -> bool {
        let turn_s = self.turn_ns as f64 / NS_PER_S;
        let jump_s = (self.elapsed_ns - self.turn_ns) as f64 / NS_PER_S;
        let window = |reports: &mut dyn Iterator<Item = &Report>, from_ns: i64, to_ns: i64| -> Vec<Place> {
            let near = reports.take_while(|report| {
                report.clock_ns.is_none_or(|time_ns| {
                    (self.ends_ns.0 - 3 * self.turn_ns..=self.ends_ns.1 + 3 * self.turn_ns).contains(&time_ns)
                })
            });
            let within = |report: &&Report| report.clock_ns.is_some_and(|time_ns| (from_ns..to_ns).contains(&time_ns));
            near.filter(within).filter_map(|report| Place::of(report, self.ends_ns.0, errors)).collect()
        };
        let (end, turn) = (self.ends_ns.0 + 1, self.turn_ns);
        let last = window(&mut self.before.iter().rev(), end - turn - turn / 20, end);
        let previous = window(&mut self.before.iter().rev(), end - 2 * turn - turn / 5, end - turn + turn / 5);
        let next = window(&mut self.after.iter(), self.ends_ns.1, self.ends_ns.1 + turn + turn / 5);
        let speaks_for_step = |place: &Place| {
            let velocity = place.velocity(&previous, turn_s)?;
            let likelihood = |velocity: Vector3<f64>, jump_s: f64| {
                let of = |other: &Place| place.expectation(other, velocity, other.time_s - jump_s, turn_s);
                next.iter().map(of).fold(LEAST, f64::max)
            };
            let pause = likelihood(velocity, 0.0).max(likelihood(Vector3::zeros(), jump_s));
            Some(likelihood(velocity, jump_s) - pause)
        };
        last.iter().filter_map(speaks_for_step).sum::<f64>() > SURE
    }
}

/// Where a report was.
#[derive(Debug, Clone, Copy)]
struct Place {
    time_s: f64,
    position_m: Vector3<f64>,
    error_m: f64,
}

impl Place {
    fn of(report: &Report, since_ns: i64, (sigma_m, sigma_rad): (f64, f64)) -> Option<Self> {
        let Report { range_m, azimuth_rad, .. } = *report;
        let position_m = Polar { range_m, azimuth_rad, elevation_rad: 0.0 }.to_enu();
        let time_s = (report.clock_ns? - since_ns) as f64 / NS_PER_S;
        Some(Self { time_s, position_m, error_m: sigma_m.hypot(range_m * sigma_rad) })
    }

    /// ln L of `other` as the same target at `time_s`.
    fn expectation(&self, other: &Self, velocity: Vector3<f64>, time_s: f64, turn_s: f64) -> f64 {
        let passed_s = time_s - self.time_s;
        let turns = passed_s / turn_s;
        let growth = 1.0 + (1.0 + turns).powi(2) + turns.powi(2);
        let variance = self.error_m.powi(2);
        let spread = variance * growth + (0.5 * ACCELERATION_MPS2 * passed_s.powi(2)).powi(2);
        let distance = (other.position_m - self.position_m - velocity * passed_s).norm();
        -distance.powi(2) / (2.0 * spread) - (spread / variance).ln()
    }

    /// Velocity of the target from the nearest place a turn before, m/s.
    fn velocity(&self, previous: &[Self], turn_s: f64) -> Option<Vector3<f64>> {
        let distance = |other: &Self| (self.position_m - other.position_m).norm();
        let a_turn_ago = |other: &&Self| ((self.time_s - other.time_s) / turn_s - 1.0).abs() < 0.3;
        let nearest = previous.iter().filter(a_turn_ago).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let velocity = (self.position_m - nearest.position_m) / (self.time_s - nearest.time_s);
        (velocity.norm() < FASTEST_MPS).then_some(velocity)
    }
}
