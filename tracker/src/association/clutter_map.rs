//! Expected false plots per resolution cell, and their power, learnt where they fall.
//!
//! ```text
//! F(p) = max(design, floor) + n̄(bin of p) / cells of the bin
//! ρ_c(p) = F(p) / (δ_r δ_β δ_ε δ_ṙ r² cos ε)                    per unit of y's measure (T12)
//! n̄ = Σ κ^age (1 − claimed) / (n₀ + Σ κ^age),   κ = 1 − 1/N     over the plots in the bin and over scans
//! ```
//!
//! Three maps over range, azimuth, elevation and |ṙ|; the largest answer counts. Rings all around the radar learn ground
//! clutter in one scan, areas learn where it lies, and a fine map, slow to believe (n₀), learns fixed objects. Bins of elevation and |ṙ|
//! widen threefold from the ground and from zero, where clutter is. Clutter has stronger plots than noise: the mean
//! excess of their power over the threshold is learnt along. A bin decays when it is looked at,
//! so that a scan costs only its plots.

use std::f64::consts::TAU;

use common::amplitude::Detector;

use crate::association::FalsePlots;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// Outer edges of the classes of elevation and of |ṙ|, in cells; the last class is open.
const EDGES: [f64; 4] = [1.0, 3.0, 9.0, 27.0];
/// Bins of a map at most (of 12 bytes).
const MAX_BINS: usize = 1 << 19;
/// Bins of range at most; the last one is open.
const MAX_RANGE_BINS: usize = 512;
/// Bins of azimuth at most.
const MAX_AZIMUTH_BINS: f64 = 512.0;
/// Plots of noise that every bin's mean power starts with.
const PRIOR_PLOTS: f32 = 3.0;
/// A plot stronger than this above the mean of noise counts as this strong: it may be a target's.
const STRONGEST: f64 = 40.0;

/// Expected false plots.
#[derive(Debug)]
pub struct ClutterMap {
    radar: Radar,
    detector: Detector,
    base: f64,
    memory_scans: f64,
    /// δ_r δ_β δ_ε δ_ṙ, of what is measured.
    cells_product: f64,
    first_scan: Option<u32>,
    layers: [Layer; 3],
}

impl ClutterMap {
    /// `base`: false plots per cell and scan that are always expected. `memory_scans` is N; 0 learns nothing.
    pub fn new(radar: Radar, detector: Detector, base: f64, memory_scans: u32) -> Self {
        let layer = |range_cells, azimuth_rad, prior_scans| {
            Layer::new(&radar, range_cells, azimuth_rad, prior_scans, memory_scans > 0)
        };
        let layers = [layer(1.0, TAU, 1.0), layer(4.0, TAU / 24.0, 2.0), layer(2.0, 2.0 * radar.cell[1], 40.0)];
        let cells_product = radar.volume(|i| radar.cell[i], 1.0, 1.0);
        Self { radar, detector, base, memory_scans: f64::from(memory_scans), cells_product, first_scan: None, layers }
    }

    /// Counts a plot of scan `scan` of which `share` is not claimed by a track.
    pub fn observe(&mut self, measurement: &Measurement, share: f64, scan: u32) {
        self.first_scan.get_or_insert(scan);
        let excess = self.excess(measurement);
        for layer in self.layers.iter_mut().filter(|layer| !layer.bins.is_empty()) {
            let index = layer.bin(&self.radar, &measurement.polar).0;
            if let Some(bin) = layer.bins.get_mut(index) {
                *bin = bin.at(scan, self.memory_scans);
                bin.plots += share as f32;
                bin.excess += (share * excess) as f32;
            }
        }
    }

    fn excess(&self, measurement: &Measurement) -> f64 {
        let limit = STRONGEST * self.detector.noise_mean_excess();
        (measurement.power - self.detector.threshold).clamp(0.0, limit)
    }

    /// What to expect at each plot of a scan.
    pub fn in_scan(&self, scan: u32) -> impl Fn(&Measurement) -> FalsePlots {
        let scans = self.scans_learnt(scan);
        move |plot| self.expect(plot, scan, scans, None)
    }

    /// What to expect at the place of `plot` in a scan without `own`, a plot of the scan before: it must not speak against itself.
    pub fn without(&self, plot: &Measurement, scan: u32, own: &Measurement) -> FalsePlots {
        self.expect(plot, scan, self.scans_learnt(scan), Some(own))
    }

    /// Σ κ^age over the scans so far.
    fn scans_learnt(&self, scan: u32) -> f64 {
        let passed = f64::from(scan.saturating_sub(self.first_scan.unwrap_or(scan)));
        let keep = 1.0 - 1.0 / self.memory_scans.max(1.0);
        self.memory_scans * (1.0 - keep.powf(passed))
    }

    fn expect(&self, plot: &Measurement, scan: u32, scans: f64, own: Option<&Measurement>) -> FalsePlots {
        let (mut per_cell, mut mean_excess) = (0.0_f64, 0.0_f64);
        let noise = self.detector.noise_mean_excess();
        for layer in self.layers.iter().filter(|layer| !layer.bins.is_empty()) {
            let (index, cells) = layer.bin(&self.radar, &plot.polar);
            let Some(bin) = layer.bins.get(index).filter(|bin| bin.plots > 0.0) else { continue };
            let mut bin = bin.at(scan, self.memory_scans);
            if let Some(own) = own.filter(|own| layer.bin(&self.radar, &own.polar).0 == index) {
                bin.plots = (bin.plots - 1.0).max(0.0);
                bin.excess = (bin.excess - self.excess(own) as f32).max(0.0);
            }
            per_cell = per_cell.max(f64::from(bin.plots) / ((layer.prior_scans + scans) * cells));
            let mean = (PRIOR_PLOTS * noise as f32 + bin.excess) / (PRIOR_PLOTS + bin.plots);
            mean_excess = mean_excess.max(f64::from(mean));
        }
        FalsePlots { density: (self.base + per_cell) / self.cell_volume(plot), mean_excess }
    }

    /// Volume of a resolution cell in the measure of y, m³·m/s or what the radar measures of it.
    pub fn cell_volume(&self, plot: &Measurement) -> f64 {
        let (r, cos_e) = (plot.polar[0].max(1.0), plot.cos_elevation.max(1e-3));
        self.cells_product * if self.radar.measured[2] { r * r * cos_e } else { r }
    }
}

/// Decayed sums of one bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    /// Plots.
    plots: f32,
    /// Their q − t₀.
    excess: f32,
    /// Scan to which the sums are brought.
    scan: u32,
}

impl Bin {
    fn at(self, scan: u32, memory_scans: f64) -> Self {
        let age = scan.saturating_sub(self.scan);
        if age == 0 {
            return self;
        }
        let keep = (1.0 - 1.0 / memory_scans.max(1.0)).powf(f64::from(age)) as f32;
        Self { plots: self.plots * keep, excess: self.excess * keep, scan }
    }
}

/// One resolution of the map.
#[derive(Debug)]
struct Layer {
    /// Width of a bin of range, cells.
    range_cells: f64,
    /// n₀: scans without a plot that every bin starts with.
    prior_scans: f64,
    range_bins: usize,
    azimuth_bins: usize,
    /// Classes of elevation and |ṙ|.
    classes: [usize; 2],
    /// By [range][azimuth][elevation][|ṙ|].
    bins: Vec<Bin>,
}

impl Layer {
    fn new(radar: &Radar, range_cells: f64, azimuth_rad: f64, prior_scans: f64, learns: bool) -> Self {
        let azimuth_bins = (TAU / azimuth_rad).round().clamp(1.0, MAX_AZIMUTH_BINS) as usize;
        let classes = [2, 3].map(|i| if radar.measured[i] { EDGES.len() } else { 1 });
        let per_range = azimuth_bins * classes[0] * classes[1];
        let range_bins = MAX_RANGE_BINS.min(MAX_BINS / per_range);
        // Not all zero, so that the memory is there from the start.
        let empty = Bin { plots: 0.0, excess: 0.0, scan: 1 };
        let bins = vec![empty; if learns { range_bins * per_range } else { 0 }];
        Self { range_cells, prior_scans, range_bins, azimuth_bins, classes, bins }
    }

    /// Index of the bin of a place, and the number of its resolution cells.
    fn bin(&self, radar: &Radar, polar: &[f64; COORDINATES]) -> (usize, f64) {
        let range = (polar[0] / (radar.cell[0] * self.range_cells)) as usize;
        let azimuth = (common::angle::wrap(polar[1]) / TAU * self.azimuth_bins as f64) as usize;
        let class = |i: usize| if radar.measured[i] { class((polar[i] / radar.cell[i]).abs()) } else { (0, 1.0) };
        let ((elevation, elevation_cells), (range_rate, range_rate_cells)) = (class(2), class(3));
        let ring = range.min(self.range_bins - 1) * self.azimuth_bins + azimuth.min(self.azimuth_bins - 1);
        let index = (ring * self.classes[0] + elevation) * self.classes[1] + range_rate;
        let azimuth_cells = (TAU / self.azimuth_bins as f64 / radar.cell[1]).max(1.0);
        let both_signs = if radar.measured[3] { 2.0 } else { 1.0 };
        (index, self.range_cells * azimuth_cells * elevation_cells * both_signs * range_rate_cells)
    }
}

/// Class of a magnitude in cells, and the width of the class.
fn class(value: f64) -> (usize, f64) {
    let class = EDGES.iter().take(EDGES.len() - 1).position(|edge| value < *edge).unwrap_or(EDGES.len() - 1);
    (class, EDGES[class] - if class == 0 { 0.0 } else { EDGES[class - 1] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(range_m: f64, azimuth_rad: f64, power: f64) -> Measurement {
        let polar = [range_m, azimuth_rad, 0.005, 5.0];
        Measurement { polar, power, has_power: true, ..Measurement::at(range_m, azimuth_rad) }
    }

    /// Sixty plots a scan on one ring: their density and power are known after a few scans, and nothing elsewhere.
    #[test]
    fn ground_clutter_is_learnt() {
        let cell = [50.0, 0.01, 0.01, 30.0];
        let radar = Radar { variance: [1.0; 4], cell, measured: [true; 4] };
        let detector = Detector::new(1e-6, 0);
        let mut map = ClutterMap::new(radar, detector, 1e-6, 20);
        for scan in 0..60 {
            for k in 0..60 {
                map.observe(&plot(430.0, 0.05 + 0.1 * f64::from(k), detector.threshold + 10.0), 1.0, scan);
            }
        }
        let place = plot(430.0, 1.2, 0.0);
        let here = map.in_scan(59)(&place);
        // A ring of one range cell, 628 azimuth cells, one of elevation, two of range rate.
        let expected = 60.0 / (628.3 * 2.0);
        let per_cell = here.density * map.cell_volume(&place);
        assert!(per_cell > 0.8 * expected && per_cell < 3.0 * expected, "{per_cell} {expected}");
        assert!((here.mean_excess - 10.0).abs() < 1.0, "{}", here.mean_excess);
        let elsewhere = Measurement { polar: [3000.0, 3.0, 0.1, 60.0], ..place };
        let empty = map.in_scan(59)(&elsewhere);
        assert!((empty.density * map.cell_volume(&elsewhere) - 1e-6).abs() < 1e-12);
        assert!(empty.mean_excess == 0.0);
    }
}
