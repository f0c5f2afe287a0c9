//! `[tracker.turn]`: filters of coordinated turns.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, positive, require};
use crate::tracks::MODELS;

/// Coordinated turns: `imm-turn`, `adaptive-grid`, `switching-grid`. Numbers like (V3) refer to `docs/theory/turns.md`.
///
/// Rates are positive from east towards north, to port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TurnConfig {
    /// σ_a: noise of the acceleration over a step, the same in all models, m/s².
    pub noise_mps2: f64,
    /// Probability that a target keeps its turn rate for 1 s.
    pub stay_probability: f64,
    /// For `imm-turn` and `switching-grid`: the turn rates, ascending, three to eight (V2), (V4), °/s.
    pub rates_deg_per_s: Vec<f64>,
    /// For `adaptive-grid`: ω_max: the greatest turn rate, °/s.
    pub greatest_rate_deg_per_s: f64,
    /// For `adaptive-grid`: r: half width of the grid at the start, and least spacing before it is halved, °/s.
    pub spacing_deg_per_s: f64,
    /// For `adaptive-grid`: t₁: probability of the centre below which it moves to the mean rate (V3).
    pub recentre_probability: f64,
    /// For `adaptive-grid`: t₂: probability of a side below which its spacing is halved (V3).
    pub narrow_probability: f64,
    /// For `adaptive-grid`: t₃: probability of a side above which its spacing is doubled (V3).
    pub widen_probability: f64,
    /// For `switching-grid`: t: probability of a model from which the grid moves to it (V4).
    pub switch_probability: f64,
}

impl Default for TurnConfig {
    fn default() -> Self {
        Self {
            noise_mps2: 0.1,
            stay_probability: 0.965,
            rates_deg_per_s: vec![-2.0, -1.0, 0.0, 1.0, 2.0],
            greatest_rate_deg_per_s: 3.0,
            spacing_deg_per_s: 2.0,
            recentre_probability: 0.2,
            narrow_probability: 0.25,
            widen_probability: 0.75,
            switch_probability: 0.35,
        }
    }
}

impl TurnConfig {
    /// Fastest turn that a target may make, °/s.
    const FASTEST_DEG_PER_S: f64 = 90.0;

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        positive("tracker.turn.noise_mps2", self.noise_mps2)?;
        let stay = self.stay_probability;
        require("tracker.turn.stay_probability", stay, stay > 0.34 && stay < 1.0, "a number above 0.34, below 1")?;
        let rates = &self.rates_deg_per_s;
        let possible = (3..=MODELS).contains(&rates.len())
            && rates.iter().all(|rate| rate.abs() <= Self::FASTEST_DEG_PER_S)
            && rates.windows(2).all(|pair| pair[0] < pair[1]);
        require(
            "tracker.turn.rates_deg_per_s",
            format!("{rates:?}"),
            possible,
            "three to eight numbers from -90 to 90, ascending",
        )?;
        let greatest = self.greatest_rate_deg_per_s;
        let possible = greatest > 0.0 && greatest <= Self::FASTEST_DEG_PER_S;
        require("tracker.turn.greatest_rate_deg_per_s", greatest, possible, "a number above 0, up to 90")?;
        let spacing = self.spacing_deg_per_s;
        let possible = spacing > 0.0 && spacing <= greatest;
        require("tracker.turn.spacing_deg_per_s", spacing, possible, "a number above 0, up to the greatest rate")?;
        for (key, value) in [
            ("tracker.turn.recentre_probability", self.recentre_probability),
            ("tracker.turn.narrow_probability", self.narrow_probability),
            ("tracker.turn.widen_probability", self.widen_probability),
            ("tracker.turn.switch_probability", self.switch_probability),
        ] {
            require(key, value, (0.0..=1.0).contains(&value), "a number from 0 to 1")?;
        }
        Ok(())
    }
}
