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

/// Longest name of a socket that Linux takes, bytes.
const SOCKET_NAME: usize = 107;
/// What the middleware adds to folder and prefix, which stands in it twice:
/// `ROOT/radar-chain-PREFIX/PREFIX.rc_NNNNNNNN_` and a number of up to 32 digits with `.event`.
const SOCKET_NAME_FIXED: usize = 65;

impl IpcConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = !self.prefix.is_empty()
            && self.prefix.len() <= 40
            && self.prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        require("ipc.prefix", &self.prefix, valid, "1 to 40 letters, digits, `-` or `_`")?;
        let valid = self.root.starts_with('/') && self.root.len() <= 100;
        require("ipc.root", &self.root, valid, "an absolute path of at most 100 bytes")?;
        // As the sockets are named: without symbolic links.
        let root = std::fs::canonicalize(&self.root).map_or(self.root.len(), |root| root.as_os_str().len());
        let room = SOCKET_NAME - SOCKET_NAME_FIXED;
        let shortest = 2 * Self::default().prefix.len();
        let expected = format!("at most {} bytes, so that the names of sockets fit", room - shortest);
        require("ipc.root", &self.root, root + shortest <= room, &expected)?;
        let most = (room - root) / 2;
        let expected =
            format!("at most {most} characters with ipc.root = \"{}\", so that the names of sockets fit", self.root);
        require("ipc.prefix", &self.prefix, self.prefix.len() <= most, &expected)
    }
}
