//! `[video_source]`: recordings of radar video.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Recorded radar video. Dwells, sectors and the responses of beam and pulse are those of `[radar]`; the recording says how many
/// cells there are and how far they reach.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VideoSourceConfig {
    /// Recording: ASTERIX category 240 or spokes of a HALO radar, as blocks or in a capture of the network.
    pub file: String,
}
