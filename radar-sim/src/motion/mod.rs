//! How targets move: position, velocity and acceleration at any time.

mod flight;
mod flight_time;
mod segments;
mod turns;
mod waypoints;

use common::config::{MotionConfig, TargetConfig};
use common::geodesy::FrameChange;
use common::truth::{CONSTANT_VELOCITY, HOVER};
use nalgebra::Vector3;

use crate::SimError;
pub use flight::Flight;
pub use segments::{Segments, Step};
pub use turns::Turns;
pub use waypoints::Course;

/// State of a target in ENU about the antenna.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// m/s².
    pub acceleration_mps2: Vector3<f64>,
    /// Mode of motion, as in [`common::truth`].
    pub mode: u32,
}

impl Kinematics {
    /// The same state in another frame.
    #[must_use]
    pub fn in_frame(&self, frame: &FrameChange) -> Self {
        Self {
            position_m: frame.position_m(self.position_m.into()).into(),
            velocity_mps: frame.vector(self.velocity_mps.into()).into(),
            acceleration_mps2: frame.vector(self.acceleration_mps2.into()).into(),
            mode: self.mode,
        }
    }
}

/// The motion of one target.
#[derive(Debug, Clone)]
pub enum Motion {
    /// Pieces of constant acceleration; also straight lines.
    Segments(Segments),
    /// Legs and turns at constant speed.
    Course(Course),
    /// Legs of constant turn rate.
    Turns(Turns),
    /// A recorded flight.
    Flight(Flight),
}

impl Motion {
    /// The motion that `target` asks for; reads the file of a recorded flight.
    ///
    /// # Errors
    /// [`SimError::Flight`].
    pub fn of(target: &TargetConfig) -> Result<Self, SimError> {
        Ok(match &target.motion {
            MotionConfig::Straight { position_m, velocity_mps } => {
                Self::Segments(Segments::straight((*position_m).into(), (*velocity_mps).into()))
            }
            MotionConfig::Trajectory { trajectory, shift_m } => {
                Self::Segments(Segments::published(trajectory, (*shift_m).into()))
            }
            MotionConfig::Waypoints { points_m, speed_mps, repeat } => {
                let points = points_m.iter().map(|&point| point.into()).collect::<Vec<_>>();
                Self::Course(Course::new(&points, *speed_mps, *repeat))
            }
            MotionConfig::Turns { position_m, velocity_mps, legs_s_deg_per_s, repeat } => {
                let legs: Vec<_> = legs_s_deg_per_s.iter().map(|[time_s, rate]| (*time_s, rate.to_radians())).collect();
                Self::Turns(Turns::new((*position_m).into(), (*velocity_mps).into(), &legs, *repeat))
            }
            MotionConfig::Csv { file, position_m } => {
                Self::Flight(Flight::read(file, (*position_m).into()).map_err(|reason| SimError::Flight {
                    target: target.name.clone(),
                    file: file.clone(),
                    reason,
                })?)
            }
        })
    }

    /// What was left out of the file of a flight, in words.
    pub fn dropped(&self) -> Option<String> {
        match self {
            Self::Flight(flight) => flight.dropped(),
            Self::Segments(_) | Self::Course(_) | Self::Turns(_) => None,
        }
    }

    /// State `time_s` after the start of the motion.
    pub fn at(&self, time_s: f64) -> Kinematics {
        match self {
            Self::Segments(segments) => segments.at(time_s),
            Self::Course(course) => course.at(time_s),
            Self::Turns(turns) => turns.at(time_s),
            Self::Flight(flight) => flight.at(time_s),
        }
    }
}

/// Hover or constant velocity, by the speed.
fn unaccelerated_mode(velocity_mps: &Vector3<f64>) -> u32 {
    if velocity_mps.norm() < 0.5 { HOVER } else { CONSTANT_VELOCITY }
}
