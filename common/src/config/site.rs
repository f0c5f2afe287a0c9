//! `[site]`: which radar this is.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};

/// Identity of the radar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SiteConfig {
    /// Name in service names (`radar/<name>/plots`): letters, digits, `-`, `_`.
    pub name: String,
    /// System area code.
    pub sac: u8,
    /// System identification code.
    pub sic: u8,
}

impl Default for SiteConfig {
    fn default() -> Self {
        Self { name: "site1".into(), sac: 0, sic: 1 }
    }
}

impl SiteConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = !self.name.is_empty()
            && self.name.len() <= 32
            && self.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        require("site.name", &self.name, valid, "1 to 32 letters, digits, `-` or `_`")
    }

    /// SAC in the high byte, SIC in the low byte, as in messages.
    pub fn source_id(&self) -> u32 {
        u32::from(self.sac) << 8 | u32::from(self.sic)
    }
}
