//! The families that there are, by the name that the configuration gives them.

use common::config::{Estimator, TrackerConfig};

use super::layout::Layout;
use super::seam::Filter;
use super::{bank, cv, turn, uav};
use crate::plots::radar::Radar;

/// The form of the states of the family that the configuration names.
pub fn layout_of(config: &TrackerConfig) -> Layout {
    match config.estimator {
        Estimator::ImmUav => uav::LAYOUT,
        Estimator::Cv => cv::LAYOUT,
        Estimator::ImmTurn => turn::layout(config.turn.rates_deg_per_s.len()),
        Estimator::AdaptiveGrid | Estimator::SwitchingGrid => turn::layout(3),
        Estimator::MultiAlternative => {
            bank::layout_of_hypotheses(config.bank.hypotheses as usize, config.bank.window_scans as usize)
        }
        Estimator::AdaptiveBandwidth => bank::ADAPTIVE_LAYOUT,
    }
}

/// The family that the configuration names, for a radar.
pub fn family(config: &TrackerConfig, radar: &Radar, period_s: f64) -> Box<dyn Filter> {
    let axes = if radar.measured[2] { 3 } else { 2 };
    match config.estimator {
        Estimator::ImmUav => Box::new(uav::Uav::new(config, axes, period_s)),
        Estimator::Cv => Box::new(cv::ConstantVelocity::new(config.cv_noise_mps2, axes)),
        Estimator::ImmTurn | Estimator::AdaptiveGrid | Estimator::SwitchingGrid => {
            Box::new(turn::Turn::configured(config, axes))
        }
        Estimator::MultiAlternative => Box::new(bank::MultiAlternative::configured(&config.bank, axes)),
        Estimator::AdaptiveBandwidth => Box::new(bank::AdaptiveBandwidth::configured(&config.bandwidth, axes)),
    }
}
