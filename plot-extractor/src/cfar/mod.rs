//! CFAR detectors: cells whose power stands out of an estimate of the noise in them.
//!
//! ```text
//!   cell − half           cell           cell + half
//!      | reference | guard | CUT | guard | reference |        along range
//! ```
//!
//! | detector | estimate of the noise | use |
//! |---|---|---|
//! | [`CaCfar`] | mean of the reference cells | noise alone; long hulls, which it finds by their ends |
//! | [`GoSoCfar`] | greater (GO) or smaller (SO) one of the means of the two sides | edges of clutter; targets beside others |
//! | [`OsCfar`] | the cell of rank ¾ N among the N reference cells | several targets in the reference cells |
//! | [`ClutterMapCfar`] | average of the cell itself over earlier scans | whatever stands still |
//!
//! Each has its exact factor for exponential noise, (C3) and (C9)-(C12), also where fewer reference cells exist, and hands on its
//! estimate divided by its mean, so that power over noise is an unbiased ratio for all of them.

mod ca;
mod clutter_map;
mod go_so;
mod os;
mod rows;

pub use ca::{CaCfar, LONGEST_HULL};
pub use clutter_map::ClutterMapCfar;
pub use go_so::GoSoCfar;
pub use os::OsCfar;

use common::config::{Cfar, ExtractorConfig};

/// A cell over threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the cell in its dwell.
    pub cell: u32,
    /// Power q in the cell.
    pub power: f32,
    /// Mean power q̄ of the reference cells.
    pub noise: f32,
}

/// The detector that the configuration names.
#[derive(Debug, Clone)]
pub enum Detector {
    /// `cfar = "ca"`.
    Ca(CaCfar),
    /// `cfar = "go"` or `"so"`.
    GoSo(GoSoCfar),
    /// `cfar = "os"`.
    Os(OsCfar),
    /// `cfar = "clutter-map"`.
    ClutterMap(ClutterMapCfar),
}

impl Detector {
    /// A detector for dwells of rows of `ranges` cells.
    pub fn new(config: &ExtractorConfig, ranges: usize) -> Self {
        let (guard, reference, pfa) = (config.guard_cells as usize, config.reference_cells as usize, config.pfa);
        match config.cfar {
            Cfar::Ca => Self::Ca(CaCfar::new(ranges, guard, reference, pfa)),
            Cfar::Go => Self::GoSo(GoSoCfar::greater(ranges, guard, reference, pfa)),
            Cfar::So => Self::GoSo(GoSoCfar::smaller(ranges, guard, reference, pfa)),
            Cfar::Os => Self::Os(OsCfar::new(ranges, guard, reference, pfa)),
            Cfar::ClutterMap => Self::ClutterMap(ClutterMapCfar::new(2 * config.reference_cells, pfa)),
        }
    }

    /// Writes the power of every cell of the dwell number `dwell` of a scan and appends the hits, by ascending cell. Returns
    /// false, with no hits and powers without meaning, if an amplitude is NaN, infinite or negative.
    ///
    /// # Panics
    /// If `amplitudes` is not whole rows, or `powers` of another length.
    pub fn detect(&mut self, dwell: u32, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        match self {
            Self::Ca(cfar) => cfar.detect(amplitudes, powers, hits),
            Self::GoSo(cfar) => cfar.detect(amplitudes, powers, hits),
            Self::Os(cfar) => cfar.detect(amplitudes, powers, hits),
            Self::ClutterMap(cfar) => cfar.detect(dwell, amplitudes, powers, hits),
        }
    }
}

/// Squares amplitudes; false if one is NaN, infinite, negative or too great to be squared. Non-negative finite
/// numbers are exactly those whose bits lie below those of infinity.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn square(amplitudes: &[f32], powers: &mut [f32]) -> bool {
    assert_eq!(amplitudes.len(), powers.len(), "one power per amplitude");
    let mut largest = 0_u32;
    for (power, &amplitude) in powers.iter_mut().zip(amplitudes) {
        *power = amplitude * amplitude;
        largest = largest.max(amplitude.to_bits()).max(power.to_bits());
    }
    largest < f32::INFINITY.to_bits()
}

#[cfg(test)]
mod tests;
