//! `[recorder]`: what is recorded, and where.

use serde::{Deserialize, Serialize};

use super::load::{ConfigError, within};

/// Recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RecorderConfig {
    /// Whether a recording is written. The report is written in any case.
    pub record: bool,
    /// Folder of the recordings.
    pub directory: String,
    /// Whether dwells are recorded too (10⁸ bytes per second).
    pub dwells: bool,
    /// A chunk is closed at this size, KiB.
    pub chunk_kib: u32,
}

impl Default for RecorderConfig {
    fn default() -> Self {
        Self { record: true, directory: "recordings".into(), dwells: false, chunk_kib: 768 }
    }
}

impl RecorderConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        within("recorder.chunk_kib", self.chunk_kib.into(), 16..=65_536)
    }
}
