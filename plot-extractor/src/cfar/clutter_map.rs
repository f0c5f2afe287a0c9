//! Clutter-map CFAR: each cell against its own average over earlier scans (C12).
//!
//! Whatever fills a cell scan after scan, land, a buoy, another radar's leakage, is in the average and gives no hit; so does a target
//! that stays. The factor is exact from the second scan on, because it is that of the scans which the average holds.

use std::collections::BTreeMap;

use common::amplitude::{MapMemory, NoiseEstimate};

use super::{Hit, square};

/// Cells worked on together: powers and averages stay in the first-level cache between the test and the update.
const BLOCK: usize = 2048;
/// Weights of the plain mean that began an average below this part make no difference to the factor.
const FORGOTTEN: f64 = 1e-6;

/// Detector with a map of the averages of all cells of a scan.
#[derive(Debug, Clone)]
pub struct ClutterMapCfar {
    memory: MapMemory,
    /// α by the number of scans in the average; the last one for all that follow.
    factors: Vec<f32>,
    /// By number of the dwell in its scan; each is made when the beam first comes there.
    dwells: BTreeMap<u32, DwellMap>,
}

/// Averages at one azimuth.
#[derive(Debug, Clone, Default)]
struct DwellMap {
    scans: u32,
    means: Vec<f32>,
}

impl ClutterMapCfar {
    /// A detector whose lasting averages vary as means of `memory` scans do.
    pub fn new(memory: u32, pfa: f64) -> Self {
        let weights = MapMemory::new(memory);
        let mut factors = vec![f32::INFINITY];
        let mut kept = 1.0;
        while kept > FORGOTTEN {
            let scans = factors.len() as u32;
            factors.push(NoiseEstimate::Averaged { memory, scans }.factor(pfa) as f32);
            kept = if weights.weight_of(scans) > weights.weight { 1.0 } else { kept * (1.0 - weights.weight) };
        }
        Self { memory: weights, factors, dwells: BTreeMap::new() }
    }

    /// As [`super::Detector::detect`].
    ///
    /// # Panics
    /// If `powers` has another length than `amplitudes`.
    pub fn detect(&mut self, dwell: u32, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        if !square(amplitudes, powers) {
            return false;
        }
        let map = self.dwells.entry(dwell).or_default();
        if map.means.len() != powers.len() {
            *map = DwellMap { scans: 0, means: vec![0.0; powers.len()] };
        }
        let factor = self.factors[(map.scans as usize).min(self.factors.len() - 1)];
        map.scans = map.scans.saturating_add(1);
        let weight = self.memory.weight_of(map.scans) as f32;
        let mut first_cell = 0;
        for (powers, means) in powers.chunks(BLOCK).zip(map.means.chunks_mut(BLOCK)) {
            if any_over(powers, means, factor) {
                let cells = powers.iter().zip(means.iter()).zip(first_cell..);
                let over = cells.filter(|&((&power, &noise), _)| power > factor * noise);
                hits.extend(over.map(|((&power, &noise), cell)| Hit { cell, power, noise }));
            }
            average(powers, means, weight);
            first_cell += powers.len() as u32;
        }
        true
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn any_over(powers: &[f32], means: &[f32], factor: f32) -> bool {
    let mut over = 0_u32;
    for (&power, &mean) in powers.iter().zip(means) {
        over |= u32::from(power > factor * mean);
    }
    over > 0
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn average(powers: &[f32], means: &mut [f32], weight: f32) {
    for (mean, &power) in means.iter_mut().zip(powers) {
        *mean += weight * (power - *mean);
    }
}
