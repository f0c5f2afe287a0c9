//! `[fusion]`: tracks of several sites to one set of system tracks, at a site with `source = "fusion"`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative, positive, require, within};

/// How tracks of several sites are fused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FusionConfig {
    /// Time of a cycle: system tracks are published so often, measurement time, s.
    pub cycle_s: f64,
    /// Sectors about the centre that the tracks of a cycle are published in.
    pub sectors: u32,
    /// In real time, how far a site may be behind the clock of most before a cycle goes without it, measurement time, s. In lossless
    /// mode all wait for all.
    pub wait_s: f64,
    /// Greatest range of sites that do not say theirs, m.
    pub range_m: f64,
    /// Standard deviation of the bias that a radar may have in range, m; 0 for none.
    pub range_bias_m: f64,
    /// The same in azimuth, degrees.
    pub azimuth_bias_deg: f64,
    /// The same in elevation, degrees.
    pub elevation_bias_deg: f64,
    /// The same in time, s.
    pub time_bias_s: f64,
    /// Power density of the acceleration of targets that fly straight on, m²/s³.
    pub straight_noise: f64,
    /// The same while they manoeuvre, m²/s³.
    pub manoeuvre_noise: f64,
    /// Mean time that targets fly straight on before anything is learned of it, s.
    pub straight_s: f64,
    /// Mean time that they manoeuvre, s.
    pub manoeuvre_s: f64,
    /// Time that a system track lives without local tracks where a site should see it, s.
    pub coast_s: f64,
    /// The same where no site can see it, s.
    pub hidden_s: f64,
}

impl Default for FusionConfig {
    fn default() -> Self {
        Self {
            cycle_s: 1.0,
            sectors: 8,
            wait_s: 1.0,
            range_m: 400_000.0,
            range_bias_m: 60.0,
            azimuth_bias_deg: 0.1,
            elevation_bias_deg: 0.1,
            time_bias_s: 0.0,
            straight_noise: 0.5,
            manoeuvre_noise: 300.0,
            straight_s: 1000.0,
            manoeuvre_s: 30.0,
            coast_s: 15.0,
            hidden_s: 60.0,
        }
    }
}

impl FusionConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = (1e-3..=1e4).contains(&self.cycle_s);
        require("fusion.cycle_s", self.cycle_s, valid, "a number from 0.001 to 10000")?;
        within("fusion.sectors", self.sectors.into(), 1..=4096)?;
        for (key, value) in [
            ("range_m", self.range_m),
            ("straight_noise", self.straight_noise),
            ("manoeuvre_noise", self.manoeuvre_noise),
            ("straight_s", self.straight_s),
            ("manoeuvre_s", self.manoeuvre_s),
            ("coast_s", self.coast_s),
            ("hidden_s", self.hidden_s),
        ] {
            positive(&format!("fusion.{key}"), value)?;
        }
        for (key, value) in [
            ("wait_s", self.wait_s),
            ("range_bias_m", self.range_bias_m),
            ("azimuth_bias_deg", self.azimuth_bias_deg),
            ("elevation_bias_deg", self.elevation_bias_deg),
            ("time_bias_s", self.time_bias_s),
        ] {
            not_negative(&format!("fusion.{key}"), value)?;
        }
        Ok(())
    }
}
