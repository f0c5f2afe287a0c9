//! `[extractor]`: detection of plots.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::amplitude::Cfar;

use super::load::{ConfigError, require, within};

/// CFAR (C3), (C9)-(C12) and clustering.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ExtractorConfig {
    /// How the noise power of a cell is estimated: `ca`, the mean of the reference cells; `go` or `so`, the greater or smaller
    /// one of the means of both sides; `os`, the cell that three quarters of the reference cells are weaker than; `clutter-map`, an
    /// average of the cell itself over earlier scans.
    pub cfar: Cfar,
    /// Probability of false alarm per cell.
    pub pfa: f64,
    /// Cells left out on each side of the cell under test.
    pub guard_cells: u32,
    /// Reference cells on each side; at the ends of the range extent only those that exist count. A clutter map remembers twice
    /// as many scans.
    pub reference_cells: u32,
    /// A cluster is closed when it spans this many dwells, whatever follows.
    pub max_dwells: u32,
}

impl Default for ExtractorConfig {
    fn default() -> Self {
        Self { cfar: Cfar::Ca, pfa: 1e-6, guard_cells: 2, reference_cells: 16, max_dwells: 12 }
    }
}

impl ExtractorConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = self.pfa > 0.0 && self.pfa <= 0.1;
        require("extractor.pfa", self.pfa, valid, "a probability above 0, at most 0.1")?;
        within("extractor.guard_cells", self.guard_cells.into(), 0..=64)?;
        within("extractor.reference_cells", self.reference_cells.into(), 2..=256)?;
        within("extractor.max_dwells", self.max_dwells.into(), 1..=64)
    }
}
