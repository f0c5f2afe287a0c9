//! When and where the beam will meet a target, and how far about that place its plots may lie.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use common::angle;
use common::turning::Turning;
use common::units::seconds_between;

use super::sweep::{Sweep, shift};
use crate::association::gate::Gate;

/// Plots may have larger errors than the nominal ones.
const GATE_MARGIN: f64 = 1.3;

/// Predicted time of detection: where and when the beam meets a target again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionTime {
    /// Time of what is known of the target, ns UTC.
    pub from_ns: u64,
    /// Time of the meeting, ns UTC.
    pub to_ns: u64,
    /// Unwrapped beam angle at that time.
    pub angle_rad: f64,
}

impl DetectionTime {
    /// When the beam meets a target at `position` (m) with `velocity` (m/s), east and north, both valid at `time_ns` when the beam stood at
    /// `angle_rad`, in about one turn.
    ///
    /// The beam meets the target where both are; two steps of a fixed point suffice, as targets move slowly
    /// in azimuth, and where they do not (above the antenna) azimuth means little. An antenna that stands meets it once in a
    /// period.
    pub fn predict(position: [f64; 2], velocity: [f64; 2], time_ns: u64, angle_rad: f64, sweep: &Sweep) -> Self {
        if sweep.turning() == Turning::Standing {
            return Self { from_ns: time_ns, to_ns: shift(time_ns, sweep.period_s()), angle_rad: angle_rad + TAU };
        }
        let beam_rad = |x: f64, y: f64| sweep.turning().mirrored(x.atan2(y));
        let now_rad = beam_rad(position[0], position[1]);
        let mut change_rad = 0.0;
        for _ in 0..2 {
            let after_s = sweep.period_s() * (1.0 + change_rad / TAU);
            let (x, y) = (position[0] + velocity[0] * after_s, position[1] + velocity[1] * after_s);
            change_rad = angle::difference(beam_rad(x, y), now_rad);
        }
        // The last detection was at the expected azimuth, not quite at the estimated one.
        let offset_rad = angle::difference(now_rad, angle_rad);
        let next_rad = angle_rad + TAU + (offset_rad + change_rad).clamp(-PI, PI);
        let step_s = sweep.period_s() * (next_rad - angle_rad) / TAU;
        Self { from_ns: time_ns, to_ns: shift(time_ns, step_s), angle_rad: next_rad }
    }

    /// The time between, s; never negative.
    pub fn step_s(&self) -> f64 {
        seconds_between(self.from_ns, self.to_ns).max(0.0)
    }
}

/// Predicted detection opportunity: the beam over a target, once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opportunity {
    /// When the beam will be there.
    pub time_ns: u64,
    /// Unwrapped beam angle at that time.
    pub angle_rad: f64,
    /// Half width of the gates in azimuth, about that angle.
    pub half_width_rad: f64,
    /// Between which ranges the gates lie, for plots of nominal errors, m.
    pub range_m: [f64; 2],
    /// Between which elevations, rad.
    pub elevation_rad: [f64; 2],
    /// Where the target is then expected, m.
    pub position_m: [f64; 3],
}

impl Opportunity {
    /// At a place, without any gate.
    pub fn at(position_m: [f64; 3], range_m: f64, time_ns: u64, angle_rad: f64) -> Self {
        let elevation_rad = [(position_m[2] / range_m).clamp(-1.0, 1.0).asin(); 2];
        Self { time_ns, angle_rad, half_width_rad: 0.0, range_m: [range_m; 2], elevation_rad, position_m }
    }

    /// Of a target that is expected at `position_m`; `gates` are those of its components.
    pub fn new(
        when: &DetectionTime,
        position_m: [f64; 3],
        gates: impl Iterator<Item = Gate> + Clone,
        sweep: &Sweep,
    ) -> Self {
        let azimuth_rad = sweep.azimuth_at(when.angle_rad, position_m);
        let mut half_width_rad: f64 = 0.0;
        for gate in gates.clone() {
            let shift_rad = angle::difference(gate.centre[1], azimuth_rad).abs();
            half_width_rad = half_width_rad.max(shift_rad + gate.half[1] * GATE_MARGIN);
        }
        let half_width_rad = half_width_rad.min(FRAC_PI_2);
        // What is at the edges is passed that much earlier or later; what an antenna sees that stands, at any time of a period.
        let early_rad = if sweep.turning() == Turning::Standing { PI } else { half_width_rad };
        let early_s = early_rad / TAU * sweep.period_s();
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for gate in gates {
            for (i, ends) in [0, 2].into_iter().zip(&mut ends) {
                let half = gate.half[i] * GATE_MARGIN + gate.drift[i].abs() * early_s;
                *ends = [ends[0].min(gate.centre[i] - half), ends[1].max(gate.centre[i] + half)];
            }
        }
        let [range_m, elevation_rad] = ends;
        Self { time_ns: when.to_ns, angle_rad: when.angle_rad, half_width_rad, range_m, elevation_rad, position_m }
    }

    /// Angle at which the gates begin.
    pub fn begins_rad(&self) -> f64 {
        self.angle_rad - self.half_width_rad
    }

    /// Angle at which all plots of the gates have arrived.
    pub fn due_rad(&self) -> f64 {
        self.angle_rad + self.half_width_rad
    }
}
