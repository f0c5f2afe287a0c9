//! Expected false plots per resolution cell, learnt where they fall.
//!
//! ```text
//! F(p) = max(design, floor) + n̄(bin of p) / cells of the bin
//! ρ_c(p) = F(p) / (δ_r δ_β δ_ε δ_ṙ r² cos ε)                    per unit of y's measure (T12)
//! n̄ ← n̄ (1 − 1/N) per scan, + (1 − explained)/N per plot
//! ```
//!
//! Two maps over range, azimuth, elevation and |ṙ|: a coarse one that learns an area of ground clutter within a few
//! scans, and a fine one for fixed objects; the larger of the two counts. Bins of elevation and |ṙ| widen threefold
//! from the ground and from zero, where clutter is. A bin decays when it is looked at, so that a scan costs
//! only its plots.

use std::f64::consts::TAU;

use crate::gate::Radar;
use crate::measurement::{COORDINATES, Measurement};

/// Outer edges of the classes of elevation, in cells.
const ELEVATION_EDGES: [f64; 4] = [3.0, 9.0, 27.0, 81.0];
/// Outer edges of the classes of |ṙ|, in cells.
const RANGE_RATE_EDGES: [f64; 4] = [1.0, 3.0, 9.0, 27.0];
/// Bins of a map at most (of 8 bytes).
const MAX_BINS: usize = 1 << 19;
/// Bins of range at most; the last one is open.
const MAX_RANGE_BINS: usize = 512;
/// Bins of azimuth at most.
const MAX_AZIMUTH_BINS: f64 = 512.0;

/// Expected false plots.
#[derive(Debug)]
pub struct ClutterMap {
    radar: Radar,
    base: f64,
    coarse: Layer,
    fine: Layer,
}

impl ClutterMap {
    /// `base`: false plots per cell and scan that are always expected. `memory_scans` is N; 0 learns nothing.
    pub fn new(radar: Radar, base: f64, memory_scans: u32) -> Self {
        let coarse = Layer::new(&radar, 4.0, TAU / 24.0, memory_scans);
        let fine = Layer::new(&radar, 2.0, 2.0 * radar.cell[1], memory_scans);
        Self { radar, base, coarse, fine }
    }

    /// Counts a plot of scan `scan` of which `share` is not explained by confirmed tracks.
    pub fn observe(&mut self, measurement: &Measurement, share: f64, scan: u32) {
        for layer in [&mut self.coarse, &mut self.fine] {
            layer.observe(&self.radar, &measurement.polar, share, scan);
        }
    }

    /// ρ_c at (r, β, ε, ṙ), 1/(m³·m/s) or what the radar measures of it.
    pub fn density(&self, polar: &[f64; COORDINATES], scan: u32) -> f64 {
        let learnt =
            self.coarse.per_cell(&self.radar, polar, scan).max(self.fine.per_cell(&self.radar, polar, scan));
        let cell = self.radar.volume(|i| self.radar.cell[i], polar[0].max(1.0), polar[2].cos().max(1e-3));
        (self.base + learnt) / cell
    }
}

/// One resolution of the map.
#[derive(Debug)]
struct Layer {
    /// Width of a bin of range, cells.
    range_cells: f64,
    range_bins: usize,
    azimuth_bins: usize,
    /// Weight of one scan, 1/N.
    gain: f32,
    /// n̄ and the scan it was last brought up to, by [range][azimuth][elevation][|ṙ|].
    bins: Vec<(f32, u32)>,
    classes: (usize, usize),
}

impl Layer {
    fn new(radar: &Radar, range_cells: f64, azimuth_width_rad: f64, memory_scans: u32) -> Self {
        let azimuth_bins = (TAU / azimuth_width_rad).round().clamp(1.0, MAX_AZIMUTH_BINS) as usize;
        let classes = (
            if radar.measured[2] { ELEVATION_EDGES.len() } else { 1 },
            if radar.measured[3] { RANGE_RATE_EDGES.len() } else { 1 },
        );
        let per_range = azimuth_bins * classes.0 * classes.1;
        let range_bins = MAX_RANGE_BINS.min(MAX_BINS / per_range);
        let count = if memory_scans == 0 { 0 } else { range_bins * per_range };
        Self {
            range_cells,
            range_bins,
            azimuth_bins,
            gain: if memory_scans == 0 { 0.0 } else { 1.0 / memory_scans as f32 },
            // Not all zero, so that the memory is there from the start.
            bins: vec![(0.0, 1); count],
            classes,
        }
    }

    /// Index of the bin of a place, and the number of its resolution cells.
    fn bin(&self, radar: &Radar, polar: &[f64; COORDINATES]) -> (usize, f64) {
        let range = (polar[0] / (radar.cell[0] * self.range_cells)) as usize;
        let azimuth = (common::angle::wrap(polar[1]) / TAU * self.azimuth_bins as f64) as usize;
        let (elevation, elevation_cells) =
            if radar.measured[2] { class(&ELEVATION_EDGES, polar[2] / radar.cell[2]) } else { (0, 1.0) };
        let (range_rate, range_rate_cells) =
            if radar.measured[3] { class(&RANGE_RATE_EDGES, (polar[3] / radar.cell[3]).abs()) } else { (0, 0.5) };
        let index = (range.min(self.range_bins - 1) * self.azimuth_bins + azimuth.min(self.azimuth_bins - 1))
            * self.classes.0
            * self.classes.1
            + elevation * self.classes.1
            + range_rate;
        let azimuth_cells = (TAU / self.azimuth_bins as f64 / radar.cell[1]).max(1.0);
        (index, self.range_cells * azimuth_cells * elevation_cells * 2.0 * range_rate_cells)
    }

    fn observe(&mut self, radar: &Radar, polar: &[f64; COORDINATES], share: f64, scan: u32) {
        let (index, _) = self.bin(radar, polar);
        let gain = self.gain;
        if let Some(bin) = self.bins.get_mut(index) {
            *bin = (decayed(*bin, gain, scan) + gain * share as f32, scan);
        }
    }

    fn per_cell(&self, radar: &Radar, polar: &[f64; COORDINATES], scan: u32) -> f64 {
        let (index, cells) = self.bin(radar, polar);
        self.bins.get(index).map_or(0.0, |bin| f64::from(decayed(*bin, self.gain, scan)) / cells)
    }
}

/// n̄ after the scans that have passed since the bin was looked at.
fn decayed((value, last): (f32, u32), gain: f32, scan: u32) -> f32 {
    if value == 0.0 { 0.0 } else { value * (1.0 - gain).powi(scan.saturating_sub(last).min(100_000) as i32) }
}

/// Class of a value by its outer edges (the last is open) and the width of the class.
fn class(edges: &[f64; 4], value: f64) -> (usize, f64) {
    let class = edges.iter().take(3).position(|edge| value < *edge).unwrap_or(3);
    (class, edges[class] - if class == 0 { 0.0 } else { edges[class - 1] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten false plots a scan, always in one area: the map finds their density per cell.
    #[test]
    fn the_density_of_an_area_is_learnt() {
        let cell = [50.0, 0.01, 0.01, 30.0];
        let radar = Radar { variance: [1.0; 4], cell, measured: [true; 4] };
        let mut map = ClutterMap::new(radar, 1e-6, 20);
        let plot = |k: u32| Measurement {
            time_ns: 0,
            position: [0.0; 3],
            polar: [430.0 + 10.0 * f64::from(k), 0.02 + 0.02 * f64::from(k), 0.005, 5.0],
            variance: [1.0; 4],
            power: 20.0,
            measured: [true; 4],
            has_power: true,
        };
        for scan in 0..200 {
            for k in 0..10 {
                map.observe(&plot(k), 1.0, scan);
            }
        }
        // Coarse bin: 4 range cells × 26.2 azimuth cells × 3 × 2; ten plots a scan.
        let expected = 1e-6 + 10.0 / (4.0 * TAU / 24.0 / 0.01 * 3.0 * 2.0);
        let place = plot(3).polar;
        let density = map.density(&place, 199) * radar.volume(|i| cell[i], place[0], place[2].cos());
        let fine = 1.0 / (2.0 * 2.0 * 3.0 * 2.0);
        assert!(density > 0.9 * expected && density < 1.1 * (expected + fine), "{density} {expected}");
        let elsewhere = [3000.0, 3.0, 0.1, 60.0];
        let empty = map.density(&elsewhere, 199) * radar.volume(|i| cell[i], 3000.0, 0.1_f64.cos());
        assert!((empty - 1e-6).abs() < 1e-12);
    }
}
