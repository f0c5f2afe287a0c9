//! `[ipc]`: the shared-memory domain of the chain.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};

/// Chains with different prefixes do not see each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct IpcConfig {
    /// Prefix of all files in shared memory: letters, digits, `-`, `_`.
    pub prefix: String,
    /// Folder for the domain's management files; each prefix gets a folder of its own in it.
    pub root: String,
}

impl Default for IpcConfig {
    fn default() -> Self {
        Self { prefix: "radar".into(), root: "/tmp".into() }
    }
}

impl IpcConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = !self.prefix.is_empty()
            && self.prefix.len() <= 40
            && self.prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        require("ipc.prefix", &self.prefix, valid, "1 to 40 letters, digits, `-` or `_`")?;
        let valid = self.root.starts_with('/') && self.root.len() <= 100;
        require("ipc.root", &self.root, valid, "an absolute path of at most 100 bytes")
    }
}
