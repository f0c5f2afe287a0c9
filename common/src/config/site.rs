//! `[site]`: which radar this is.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};
pub use crate::geodesy::Position;

/// Identity of the radar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SiteConfig {
    /// Name in service names (`radar/<name>/plots`): letters, digits, `-`, `_`.
    pub name: String,
    /// System area code. Of a recording, reports of another one are left out; without it any is taken, if there is one only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sac: Option<u8>,
    /// System identification code, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sic: Option<u8>,
    /// Where the antenna stands (WGS-84).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<Position>,
}

/// Checks a place, which the configuration names `key`.
pub(super) fn check_position(position: &Position, key: &str) -> Result<(), ConfigError> {
    let within = |name: &str, value: f64, most: f64| {
        let key = format!("{key}.{name}");
        require(&key, value, value.abs() <= most, &format!("a number from -{most} to {most}"))
    };
    within("latitude_deg", position.latitude_deg, 90.0)?;
    within("longitude_deg", position.longitude_deg, 180.0)?;
    within("height_m", position.height_m, 100_000.0)
}

impl Default for SiteConfig {
    fn default() -> Self {
        Self { name: "site1".into(), sac: None, sic: None, position: None }
    }
}

impl SiteConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = !self.name.is_empty()
            && self.name.len() <= 32
            && self.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        require("site.name", &self.name, valid, "1 to 32 letters, digits, `-` or `_`")?;
        self.position.map_or(Ok(()), |position| check_position(&position, "site.position"))
    }

    /// SAC in the high byte, SIC in the low byte, as in messages; 0 and 1 where they are not given.
    pub fn source_id(&self) -> u32 {
        u32::from(self.sac.unwrap_or(0)) << 8 | u32::from(self.sic.unwrap_or(1))
    }
}
