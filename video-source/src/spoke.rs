//! A spoke: the cells of one azimuth, as a radar sends them.

use std::hash::{DefaultHasher, Hash, Hasher};

use crate::cells::Packing;

/// Cells of one azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct Spoke {
    /// When it was received, or measured, ns UTC; none where the recording has no times.
    pub time_ns: Option<u64>,
    /// So many spokes that came with it were measured after it.
    pub followers: u32,
    /// SAC (high byte) and SIC (low byte) of the radar; 0 without.
    pub source_id: u32,
    /// Azimuth of its middle from north, rad.
    pub azimuth_rad: f64,
    /// Range of the first cell's centre, m.
    pub range_first_m: f64,
    /// Range between cells, m.
    pub range_step_m: f64,
    /// Cells.
    pub cells: usize,
    /// How they lie in `octets`.
    pub packing: Packing,
    /// The cells, at least as many as `cells`.
    pub octets: Box<[u8]>,
}

impl Spoke {
    /// What tells it from all others: a second one with the same azimuth and the same cells is a copy, as from a second line.
    pub fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.azimuth_rad.to_bits(), &self.octets).hash(&mut hasher);
        hasher.finish()
    }

    /// Writes the amplitude of each cell.
    ///
    /// # Panics
    /// Unless `amplitudes` has as many elements as the spoke has cells.
    pub fn fill(&self, amplitudes: &mut [f32]) {
        assert_eq!(amplitudes.len(), self.cells, "one amplitude for each cell");
        self.packing.unpack(&self.octets, amplitudes);
    }
}
