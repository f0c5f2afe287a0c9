//! The families that there are, by the name that the configuration gives them.

use common::config::{Estimator, TrackerConfig};

use super::layout::Layout;
use super::seam::Filter;
use super::{cv, uav};
use crate::plots::radar::Radar;

/// The form of the states of a family.
pub fn layout_of(estimator: Estimator) -> Layout {
    match estimator {
        Estimator::ImmUav => uav::LAYOUT,
        Estimator::Cv => cv::LAYOUT,
    }
}

/// The family that the configuration names, for a radar.
pub fn family(config: &TrackerConfig, radar: &Radar, period_s: f64) -> Box<dyn Filter> {
    let axes = if radar.measured[2] { 3 } else { 2 };
    match config.estimator {
        Estimator::ImmUav => Box::new(uav::Uav::new(config, axes, period_s)),
        Estimator::Cv => Box::new(cv::ConstantVelocity::new(config.cv_noise_mps2, axes)),
    }
}
