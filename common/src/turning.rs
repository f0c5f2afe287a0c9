//! Which way an antenna turns, and the angle of its beam.
//!
//! The *beam angle* grows with time whichever way the antenna turns: it is what the antenna has turned since it last passed
//! north. Azimuths are clockwise from north always.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{COUNTER_CLOCKWISE, STANDING};

/// How an antenna turns, seen from above.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Turning {
    /// Azimuth grows with time.
    #[default]
    Clockwise,
    /// Azimuth falls with time.
    CounterClockwise,
    /// It sees all azimuths, or one alone, all the time. A scan is a period in which each target is reported once.
    Standing,
}

impl Turning {
    /// Of the flags of a message.
    pub fn of_flags(flags: u32) -> Self {
        match flags {
            flags if flags & STANDING != 0 => Self::Standing,
            flags if flags & COUNTER_CLOCKWISE != 0 => Self::CounterClockwise,
            _ => Self::Clockwise,
        }
    }

    /// What the flags of a message say of it.
    pub fn flags(self) -> u32 {
        match self {
            Self::Clockwise => 0,
            Self::CounterClockwise => COUNTER_CLOCKWISE,
            Self::Standing => STANDING,
        }
    }

    /// Beam angle at an azimuth, and azimuth at a beam angle, rad, neither wrapped; meaningless of an antenna that stands.
    pub fn mirrored(self, angle_rad: f64) -> f64 {
        if self == Self::CounterClockwise { -angle_rad } else { angle_rad }
    }

    /// Beam angle at an azimuth (rad), as a share of a turn in [0, 1).
    pub fn turned(self, azimuth_rad: f64) -> f64 {
        let turned = (self.mirrored(azimuth_rad) / TAU).rem_euclid(1.0);
        if turned < 1.0 { turned } else { 0.0 }
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clockwise => "clockwise",
            Self::CounterClockwise => "counter-clockwise",
            Self::Standing => "standing",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beam_angle_grows_whichever_way_the_antenna_turns() {
        let azimuths_deg: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
        let quarters =
            |turning: Turning, azimuth_deg: f64| (4.0 * turning.turned(azimuth_deg.to_radians())).round() as u32;
        let turned = |turning: Turning| azimuths_deg.map(|azimuth_deg| quarters(turning, azimuth_deg));
        assert_eq!(turned(Turning::Clockwise), [0, 1, 2, 3]);
        assert_eq!(turned(Turning::CounterClockwise), [0, 3, 2, 1]);
        assert!(Turning::CounterClockwise.turned(1e-300) < 1.0);
        for turning in [Turning::Clockwise, Turning::CounterClockwise, Turning::Standing] {
            assert_eq!(Turning::of_flags(turning.flags() | 7), turning);
        }
    }
}
