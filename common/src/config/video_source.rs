//! `[video_source]`: radar video, recorded or from the network.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require};

/// Radar video, recorded or from the network. Dwells, sectors and the responses of beam and pulse are those of `[radar]`; the recording says how many
/// cells there are and how far they reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VideoSourceConfig {
    /// Recording: ASTERIX category 240 or spokes of a HALO radar, as blocks or in a capture of the network.
    pub file: String,
    /// Where a radar is listened to instead: `udp://ADDRESS:PORT`, or `udp://GROUP:PORT?interface=NAME`.
    pub listen: Vec<String>,
    /// Spokes from the network with more cells are rejected: shared memory is reserved for so many.
    pub largest_cells: u32,
}

impl Default for VideoSourceConfig {
    fn default() -> Self {
        Self { file: String::new(), listen: Vec::new(), largest_cells: 8192 }
    }
}

impl VideoSourceConfig {
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let most = 1..=65_536;
        require("video_source.largest_cells", self.largest_cells, most.contains(&self.largest_cells), "1 to 65536")
    }
}
