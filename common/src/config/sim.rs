//! `[sim]`: targets and clutter of the simulated radar.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use std::path::Path;

pub use crate::amplitude::Swerling;

use super::load::{ConfigError, not_negative, positive, require};
use super::site::{Position, check_position};

/// How a target moves. Positions are east, north, up of the antenna in m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "motion", rename_all = "kebab-case", deny_unknown_fields)]
pub enum MotionConfig {
    /// Straight line at constant velocity (zero velocity hovers).
    Straight {
        /// Where it is at the start, m.
        position_m: [f64; 3],
        /// East, north, up, m/s.
        velocity_mps: [f64; 3],
    },
    /// A trajectory of \[L22\]: `a`, `b` or `cv`, in its own place.
    Trajectory {
        /// `"a"`, `"b"` or `"cv"`.
        trajectory: String,
        /// Added to all positions, m.
        #[serde(default)]
        shift_m: [f64; 3],
    },
    /// From point to point at constant speed, smoothly turning where the course changes; the last leg goes on.
    Waypoints {
        /// At least two points, m.
        points_m: Vec<[f64; 3]>,
        /// Along the way, m/s.
        speed_mps: f64,
        /// After the last point to the first again, for ever.
        #[serde(default)]
        repeat: bool,
    },
    /// Legs of constant turn rate at constant speed, one after the other; after the last one straight on.
    Turns {
        /// Where it is at the start, m.
        position_m: [f64; 3],
        /// East, north, up, m/s.
        velocity_mps: [f64; 3],
        /// [duration, s; turn rate, °/s, positive to port] of each leg.
        legs_s_deg_per_s: Vec<[f64; 2]>,
        /// After the last leg the first again, for ever.
        #[serde(default)]
        repeat: bool,
    },
    /// A recorded flight: CSV with `timestamp` or `time` (seconds or ISO 8601), `latitude`, `longitude`, `altitude (m)`.
    Csv {
        /// The file; beside the configuration if it is a relative path.
        file: String,
        /// Where the first row is put, m.
        position_m: [f64; 3],
    },
}

/// One target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetConfig {
    /// Name in reports.
    pub name: String,
    /// How it moves (`motion = "straight" | "trajectory" | "waypoints" | "turns" | "csv"`).
    #[serde(flatten)]
    pub motion: MotionConfig,
    /// Radar cross-section, m²; the signal-to-noise ratio then follows the radar equation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rcs_m2: Option<f64>,
    /// Fixed signal-to-noise ratio instead, dB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub snr_db: Option<f64>,
    /// `"0"`, `"I"` or `"III"`.
    pub swerling: Swerling,
    /// First scan in which it exists.
    #[serde(default)]
    pub first_scan: u32,
}

/// `[sim.clutter]`: Weibull ground clutter near zero Doppler in the lowest beams.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ClutterConfig {
    /// Clutter reaches out to this range, m; 0 for none.
    pub range_m: f64,
    /// Clutter-to-noise ratio in the lowest beam at the first range cell, dB; falls with range⁻³.
    pub cnr_db: f64,
    /// Weibull shape of the amplitude: 2 is Rayleigh, less is spikier.
    pub shape: f64,
}

impl Default for ClutterConfig {
    fn default() -> Self {
        Self { range_m: 1000.0, cnr_db: 15.0, shape: 1.7 }
    }
}

/// Targets and clutter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SimConfig {
    /// Where the positions of the targets are counted from (WGS-84); the first site's antenna without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Position>,
    /// Ground clutter.
    pub clutter: ClutterConfig,
    /// Targets, numbered from 1 in this order.
    pub targets: Vec<TargetConfig>,
}

impl SimConfig {
    /// Looks for recorded flights in `folder`: a scenario and its flights are moved together, and stages read a copy elsewhere.
    pub(super) fn find_flights(&mut self, folder: &Path) {
        for target in &mut self.targets {
            if let MotionConfig::Csv { file, .. } = &mut target.motion {
                let path = folder.join(&*file);
                *file = std::path::absolute(&path).unwrap_or(path).display().to_string();
            }
        }
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        self.origin.map_or(Ok(()), |origin| check_position(&origin, "sim.origin"))?;
        not_negative("sim.clutter.range_m", self.clutter.range_m)?;
        require("sim.clutter.cnr_db", self.clutter.cnr_db, self.clutter.cnr_db.is_finite(), "a finite number")?;
        let shape = self.clutter.shape;
        require("sim.clutter.shape", shape, (0.5..=4.0).contains(&shape), "a number from 0.5 to 4")?;
        let count = self.targets.len();
        let limit = crate::truth::MAX_TARGETS;
        require("sim.targets", count, count <= limit, &format!("at most {limit} targets"))?;
        for (index, target) in self.targets.iter().enumerate() {
            let is_new = self.targets[..index].iter().all(|earlier| earlier.name != target.name);
            require(&format!("sim.targets[{index}].name"), &target.name, is_new, "a name that no other target has")?;
            target.check(index)?;
        }
        Ok(())
    }
}

impl TargetConfig {
    fn check(&self, index: usize) -> Result<(), ConfigError> {
        let key = |name: &str| format!("sim.targets[{index}].{name}");
        match (self.rcs_m2, self.snr_db) {
            (Some(rcs), None) => positive(&key("rcs_m2"), rcs)?,
            (None, Some(snr)) => require(&key("snr_db"), snr, snr.is_finite(), "a finite number")?,
            _ => require(&key("rcs_m2"), "not the only one", false, "exactly one of rcs_m2 and snr_db")?,
        }
        let finite = |name: &str, vector: &[f64; 3]| {
            let valid = vector.iter().all(|value| value.is_finite());
            require(&key(name), format!("{vector:?}"), valid, "three finite numbers")
        };
        match &self.motion {
            MotionConfig::Straight { position_m, velocity_mps } => {
                finite("position_m", position_m)?;
                finite("velocity_mps", velocity_mps)
            }
            MotionConfig::Trajectory { trajectory, shift_m } => {
                require(
                    &key("trajectory"),
                    trajectory,
                    ["a", "b", "cv"].contains(&trajectory.as_str()),
                    "`a`, `b` or `cv`",
                )?;
                finite("shift_m", shift_m)
            }
            MotionConfig::Waypoints { points_m, speed_mps, .. } => {
                positive(&key("speed_mps"), *speed_mps)?;
                require(&key("points_m"), points_m.len(), points_m.len() >= 2, "at least two points")?;
                points_m.iter().try_for_each(|point| finite("points_m", point))
            }
            MotionConfig::Turns { position_m, velocity_mps, legs_s_deg_per_s: legs, .. } => {
                finite("position_m", position_m)?;
                finite("velocity_mps", velocity_mps)?;
                let valid = |[time_s, rate]: &[f64; 2]| *time_s > 0.0 && *time_s <= 1e6 && rate.abs() <= 360.0;
                let expected = "at least one leg of [seconds above 0, °/s from -360 to 360]";
                let possible = !legs.is_empty() && legs.iter().all(valid);
                require(&key("legs_s_deg_per_s"), format!("{legs:?}"), possible, expected)
            }
            MotionConfig::Csv { position_m, .. } => finite("position_m", position_m),
        }
    }
}
