//! The settings of the tracker that are compared.

use common::config::{Clutter, GateRule, TrackerConfig};

use crate::world::Conditions;

/// Filter, gate and weights of one tracker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Settings {
    /// Those of \[L22\]: one mode's gate of three standard deviations, clutter density M/V, SNR and fluctuation known.
    Source,
    /// The same with P_G of each mode in the gate in use (T13).
    SourceWithGateProbability,
    /// Those of the chain (T20): nothing is told of the target's SNR and fluctuation.
    Default,
}

impl Settings {
    /// As in the JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Source => "source",
            Self::SourceWithGateProbability => "source+T13",
            Self::Default => "default",
        }
    }

    /// The configuration of the tracker under `conditions`.
    pub fn config(self, conditions: &Conditions) -> TrackerConfig {
        if self == Self::Default {
            return TrackerConfig::default();
        }
        TrackerConfig {
            gate_rule: GateRule::MostProbable,
            gate_union_probability: 0.0,
            gate_false_plots: 0.0,
            hover_noise_mps: 1.0,
            velocity_noise_mps2: 1.0,
            manoeuvre_noise_mps3: 7.0,
            gate_alpha: 3.0,
            stay_probability: 0.9,
            gate_probability_by_mode: self == Self::SourceWithGateProbability,
            range_rate_inflation: 0.8,
            clutter: Clutter::NonParametric,
            swerling: conditions.swerling,
            snr_db: conditions.snr_db,
            snr_spread_db: 0.0,
            snr_prior_scans: 0.0,
            detection_probability: 1.0 - 1e-12,
            ..TrackerConfig::default()
        }
    }
}
