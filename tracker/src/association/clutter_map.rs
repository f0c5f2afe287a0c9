//! Expected false plots per resolution cell, and their power, learnt where they fall.
//!
//! ```text
//! F(p) = max(design, floor) + largest of the estimates of ring, area, place, ray and crowd
//! ρ_c(p) = F(p) / (δ_r δ_β δ_ε δ_ṙ r² cos ε)                    per unit of y's measure (T12)
//! n = Σ κ^age (1 − claimed) over the plots in a bin,   N' = Σ κ^age over scans,   κ = 1 − 1/N
//! ```
//!
//! | map | bins | estimate |
//! |---|---|---|
//! | whole | from the antenna to the farthest plot | n / ((0.2 + N') cells) |
//! | zones | octaves of range | (n + 1) / (N' cells + 1/F(whole)) |
//! | rings | one cell of range, all around | (n + 1) / (N' cells + 1/F(zone)) |
//! | areas | four cells of range, 15° | (n − 2) / ((2 + N') cells) |
//! | places | two by two cells | (n − 2) / ((40 + N') cells): fixed objects, slow to believe |
//! | rays | two cells of azimuth, an octave of range | (n − 3) / ((1 + N') cells): strobes and interference; few plots may be a target's |
//!
//! A ring in which little has been seen is taken to be like its zone, and a zone like the whole, so that sparse clutter is known after one scan. Bins of elevation and |ṙ|
//! widen threefold from the ground and from zero, where clutter is. Every bin knows its cells, whatever the radar: only bins that
//! have met a plot are kept, and those that have forgotten it make room.
//!
//! False plots are stronger than noise for two reasons. Clutter has a larger mean excess over the threshold, which is learnt along. And some are of
//! any strength: other radars' pulses, strobes, spikes. Those that noise would hardly give are counted, and their share says how little a
//! strong plot proves there ([`FalsePower::outliers`]).

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::hash::{BuildHasherDefault, Hasher};

use common::amplitude::{Detector, FalsePower};

use crate::association::FalsePlots;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// Bins that there is room for from the start.
const ROOM: usize = 1 << 16;
/// Bins that stay at most when those that have forgotten their plots make room.
const MOST: usize = 1 << 18;
/// A bin whose plots have faded to this is forgotten.
const FADED: f32 = 0.02;
/// Share of a plot that counts for nothing: a track that is sure takes the rest.
const NOTHING: f64 = 0.01;
/// Plots of noise that every bin's mean power starts with.
const PRIOR_PLOTS: f32 = 3.0;
/// A plot stronger than this above the mean of noise counts as this strong: it may be a target's.
const STRONGEST: f64 = 40.0;
/// Probability that noise in a cell is as strong as an outlier.
const OUTLIER: f64 = 1e-9;
/// Share of noise's plots that are as strong, at most.
const OUTLIER_SHARE: f64 = 1e-3;
/// Outliers per cell and scan of a radar of which nothing has been learnt.
const OUTLIERS_EXPECTED: f64 = 1e-9;

/// Outliers in a bin that say nothing.
const OUTLIERS_IGNORED: f64 = 4.0;

/// One of the maps.
#[derive(Debug, Clone, Copy)]
struct Map {
    /// Width of a bin of range, cells; 0 for octaves, infinite for the whole range.
    range_cells: f64,
    /// Width of a bin of azimuth, cells; 0 for all around.
    azimuth_cells: f64,
    /// Scans without a plot that every bin starts with.
    prior_scans: f64,
    /// Plots that say nothing.
    ignored: f64,
}

/// The whole range, its octaves, its rings: of the first maps each is what the next is taken to be like.
const NESTED: usize = 3;
const MAPS: usize = 6;
/// The first octave of range, cells.
const OCTAVE_CELLS: f64 = 16.0;

/// Expected false plots.
#[derive(Debug)]
pub struct ClutterMap {
    radar: Radar,
    detector: Detector,
    /// Power of an outlier, see [`OUTLIER`].
    outlier_power: f64,
    base: f64,
    memory_scans: f64,
    /// δ_r δ_β δ_ε δ_ṙ, of what is measured.
    cells_product: f64,
    first_scan: Option<u32>,
    /// Range of the farthest plot of late, cells.
    farthest_cells: f64,
    latest_scan: u32,
    maps: [Map; MAPS],
    bins: HashMap<u64, Bin, BuildHasherDefault<Mix>>,
}

/// Plots of a track that the map has counted as false ones, in the bins of its last plot: they must not speak against it.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct OwnPlots {
    /// By map: the bin, and the track's plots and outliers in it.
    keys: [u64; MAPS],
    plots: [f32; MAPS],
    outliers: [f32; MAPS],
}

/// A place as all maps see it.
#[derive(Debug, Clone, Copy)]
struct Place {
    range_cells: f64,
    /// In [0, 2π).
    azimuth_rad: f64,
    /// Classes of elevation and range rate.
    classes: [u32; 2],
}

/// What the bins at a place hold.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    /// Estimates per cell: of all plots, of outliers.
    per_cell: [f64; 2],
    mean_excess: f64,
}

impl ClutterMap {
    /// `base`: false plots per cell and scan that are always expected. `memory_scans` is N; 0 learns nothing.
    pub fn new(radar: Radar, detector: Detector, base: f64, memory_scans: u32) -> Self {
        let area = TAU / 24.0 / radar.cell[1];
        let map =
            |range_cells, azimuth_cells, prior_scans, ignored| Map { range_cells, azimuth_cells, prior_scans, ignored };
        let maps = [
            map(f64::INFINITY, 0.0, 0.2, 0.0),
            map(0.0, 0.0, 0.0, 0.0),
            map(1.0, 0.0, 0.0, 0.0),
            map(4.0, area, 2.0, 2.0),
            map(2.0, 2.0, 40.0, 2.0),
            map(0.0, 2.0, 1.0, 3.0),
        ];
        let cells_product = radar.volume(|i| radar.cell[i], 1.0, 1.0);
        let mut bins = HashMap::default();
        bins.reserve(if memory_scans > 0 { ROOM } else { 0 });
        Self {
            radar,
            detector,
            outlier_power: detector.power_exceeded_by(OUTLIER.min(OUTLIER_SHARE * detector.pfa)),
            base,
            memory_scans: f64::from(memory_scans),
            cells_product,
            first_scan: None,
            farthest_cells: 1.0,
            latest_scan: 0,
            maps,
            bins,
        }
    }

    /// Counts a plot of scan `scan` of which `share` is not claimed by a track.
    pub fn observe(&mut self, measurement: &Measurement, share: f64, scan: u32) {
        self.first_scan.get_or_insert(scan);
        if self.memory_scans <= 0.0 {
            return;
        }
        self.farthest_cells *= f64::from(self.keep(scan.saturating_sub(self.latest_scan)));
        self.farthest_cells = self.farthest_cells.max(measurement.polar[0] / self.radar.cell[0]).max(1.0);
        self.latest_scan = self.latest_scan.max(scan);
        if self.bins.len() + MAPS > self.bins.capacity() {
            self.forget(scan);
        }
        let sums = [share, share * self.excess(measurement), if self.is_outlier(measurement) { share } else { 0.0 }];
        let place = self.place(&measurement.polar);
        for map in 0..MAPS {
            let key = self.key(map, &place);
            let bin = self.bins.entry(key).or_insert(Bin { sums: [0.0; 3], scan });
            *bin = bin.at(scan, self.memory_scans);
            for (sum, term) in bin.sums.iter_mut().zip(sums) {
                *sum += term as f32;
            }
        }
    }

    /// Drops the bins that have forgotten their plots; where they are too many, also those that nearly have.
    fn forget(&mut self, scan: u32) {
        let (memory_scans, mut faded) = (self.memory_scans, FADED);
        loop {
            self.bins.retain(|_, bin| bin.at(scan, memory_scans).sums[0] > faded);
            if self.bins.len() < MOST {
                break;
            }
            faded *= 2.0;
        }
        self.bins.reserve(self.bins.len().clamp(MAPS, MOST));
    }

    fn excess(&self, measurement: &Measurement) -> f64 {
        let limit = STRONGEST * self.detector.noise_mean_excess();
        (measurement.power - self.detector.threshold).clamp(0.0, limit)
    }

    fn is_outlier(&self, measurement: &Measurement) -> bool {
        measurement.has_power && measurement.power > self.outlier_power
    }

    /// What to expect at each plot of a scan without a track's `own` plots.
    pub fn in_scan(&self, scan: u32, own: OwnPlots) -> impl Fn(&Measurement) -> FalsePlots {
        let scans = self.scans_learnt(scan);
        move |plot| self.expect(plot, scan, scans, &own)
    }

    /// False plots to expect in a resolution cell and scan at a range, azimuth, elevation and range rate, as of the latest plot.
    pub fn expected_per_cell(&self, polar: &[f64; COORDINATES]) -> f64 {
        if self.bins.is_empty() {
            return self.base;
        }
        let scan = self.latest_scan;
        self.base + self.look_up(polar, scan, self.scans_learnt(scan), &OwnPlots::default()).per_cell[0]
    }

    /// The same where nothing has been learnt.
    pub fn least_expected(&self) -> f64 {
        self.base
    }

    /// Adds a plot of which the map has counted `share` to those of a track; bins that the track has left are forgotten.
    pub fn add_own(&self, own: &mut OwnPlots, plot: &Measurement, share: f64) {
        if share < NOTHING || self.memory_scans <= 0.0 {
            return;
        }
        let outlier = if self.is_outlier(plot) { share } else { 0.0 };
        let place = self.place(&plot.polar);
        for map in 0..MAPS {
            let key = self.key(map, &place);
            if own.keys[map] != key {
                (own.keys[map], own.plots[map], own.outliers[map]) = (key, 0.0, 0.0);
            }
            own.plots[map] += share as f32;
            own.outliers[map] += outlier as f32;
        }
    }

    /// Some scans have passed: a track's plots fade as those of the map do.
    pub fn fade(&self, own: &mut OwnPlots, scans: u32) {
        // The whole range is the last bin that a track leaves.
        if own.plots[0] == 0.0 {
            return;
        }
        let keep = self.keep(scans);
        for sum in own.plots.iter_mut().chain(&mut own.outliers) {
            *sum *= keep;
        }
    }

    /// κ to the power of a number of scans.
    fn keep(&self, scans: u32) -> f32 {
        keep(scans, self.memory_scans)
    }

    /// N': Σ κ^age over the scans so far.
    fn scans_learnt(&self, scan: u32) -> f64 {
        if self.bins.is_empty() {
            return 0.0;
        }
        let passed = scan.saturating_sub(self.first_scan.unwrap_or(scan));
        self.memory_scans * f64::from(1.0 - self.keep(passed))
    }

    fn expect(&self, plot: &Measurement, scan: u32, scans: f64, own: &OwnPlots) -> FalsePlots {
        let found = if self.bins.is_empty() { Found::default() } else { self.look_up(&plot.polar, scan, scans, own) };
        let [all, outliers] = found.per_cell;
        // In a crowd, of strength unknown.
        let crowd = f64::from(plot.crowd);
        let (all, outliers) = (all.max(crowd), outliers.max(crowd));
        let per_cell = self.base + all;
        FalsePlots {
            density: per_cell / self.radar.volume_at(plot, |i| self.radar.cell[i]),
            power: FalsePower {
                mean_excess: found.mean_excess,
                outliers: ((outliers + OUTLIERS_EXPECTED) / per_cell).min(1.0),
            },
        }
    }

    fn look_up(&self, polar: &[f64; COORDINATES], scan: u32, scans: f64, own: &OwnPlots) -> Found {
        let mut found = Found::default();
        let mut nested = [0.0; 2];
        let noise = self.detector.noise_mean_excess() as f32;
        let place = self.place(polar);
        for (map, form) in self.maps.iter().enumerate() {
            let key = self.key(map, &place);
            let mut sums = [0.0; 3];
            if let Some(bin) = self.bins.get(&key) {
                sums = bin.at(scan, self.memory_scans).sums;
                if own.keys[map] == key && sums[0] > 0.0 {
                    let left = (sums[0] - own.plots[map]).max(0.0);
                    sums = [left, sums[1] * left / sums[0], (sums[2] - own.outliers[map]).max(0.0)];
                }
            }
            let [plots, excess, outliers] = sums;
            let cells = self.cells_of(*form, &place);
            // Strong plots that are few may be targets'.
            let counts = [f64::from(plots), (f64::from(outliers) - OUTLIERS_IGNORED).max(0.0)];
            for (k, count) in counts.into_iter().enumerate() {
                if map == 0 {
                    nested[k] = count / ((form.prior_scans + scans) * cells);
                } else if map < NESTED {
                    nested[k] = if nested[k] > 0.0 { (count + 1.0) / (scans * cells + 1.0 / nested[k]) } else { 0.0 };
                } else {
                    let ignored = if k == 0 { form.ignored } else { 0.0 };
                    let rate = (count - ignored).max(0.0) / ((form.prior_scans + scans) * cells);
                    found.per_cell[k] = found.per_cell[k].max(rate);
                }
                if map + 1 == NESTED {
                    found.per_cell[k] = nested[k];
                }
            }
            if map + 1 >= NESTED && plots > form.ignored as f32 {
                let mean = (PRIOR_PLOTS * noise + excess) / (PRIOR_PLOTS + plots);
                found.mean_excess = found.mean_excess.max(f64::from(mean));
            }
        }
        found
    }

    /// Volume of a resolution cell in the measure of y, m³·m/s or what the radar measures of it.
    pub fn cell_volume(&self, plot: &Measurement) -> f64 {
        let (r, cos_e) = (plot.polar[0].max(1.0), plot.cos_elevation.max(1e-3));
        self.cells_product * if self.radar.measured[2] { r * r * cos_e } else { r }
    }

    fn place(&self, polar: &[f64; COORDINATES]) -> Place {
        let class_of = |i: usize, value: f64| class((value / self.radar.cell[i]).abs());
        let measured = |i: usize| self.radar.measured[i];
        let elevation = if measured(2) { class_of(2, polar[2]) } else { 0 };
        // Range rates that the radar cannot tell apart are the same.
        let range_rate = if measured(3) { class_of(3, self.radar.unfold(polar[3], 0.0)) } else { 0 };
        Place {
            range_cells: polar[0] / self.radar.cell[0],
            azimuth_rad: common::angle::wrap(polar[1]),
            classes: [elevation, range_rate],
        }
    }

    /// Which bin of a map a place is in.
    fn key(&self, map: usize, place: &Place) -> u64 {
        let Map { range_cells, azimuth_cells, .. } = self.maps[map];
        let range = place.range_cells;
        let range = if range_cells > 0.0 { (range / range_cells) as u64 } else { u64::from(octave(range)) };
        let azimuth =
            if azimuth_cells > 0.0 { (place.azimuth_rad / (azimuth_cells * self.radar.cell[1])) as u64 } else { 0 };
        let [elevation, range_rate] = place.classes.map(u64::from);
        (((range << 20 | azimuth & 0xf_ffff) << 4 | elevation) << 4 | range_rate) << 3 | map as u64
    }

    /// Resolution cells in the bin of a map at a place.
    fn cells_of(&self, map: Map, place: &Place) -> f64 {
        let octave_cells =
            |octave: u32| OCTAVE_CELLS * if octave == 0 { 1.0 } else { f64::from(1_u32 << (octave - 1)) };
        let range = if map.range_cells > 0.0 {
            map.range_cells.min(self.farthest_cells)
        } else {
            octave_cells(octave(place.range_cells))
        };
        let around = (TAU / self.radar.cell[1]).max(1.0);
        let azimuth = if map.azimuth_cells > 0.0 { map.azimuth_cells.min(around) } else { around };
        // Of what is not measured, the class is that of width 1.
        let [elevation, range_rate] = place.classes.map(class_width);
        let both_signs = if self.radar.measured[3] { 2.0 } else { 1.0 };
        range * azimuth * elevation * both_signs * range_rate
    }
}

/// Octave of a range in cells: 0 for the first [`OCTAVE_CELLS`].
fn octave(range_cells: f64) -> u32 {
    let octaves = (range_cells / OCTAVE_CELLS) as u32;
    u32::BITS - octaves.min(1 << 30).leading_zeros()
}

/// Class of a magnitude in cells: below 1, 3, 9 and so on.
fn class(value: f64) -> u32 {
    let (mut class, mut edge) = (0, 1.0);
    while value >= edge && class < 12 {
        class += 1;
        edge *= 3.0;
    }
    class
}

/// Width of a class, cells.
fn class_width(class: u32) -> f64 {
    if class == 0 { 1.0 } else { 2.0 * 3.0_f64.powi(class as i32 - 1) }
}

/// κ to the power of a number of scans.
fn keep(scans: u32, memory_scans: f64) -> f32 {
    (1.0 - 1.0 / memory_scans.max(1.0)).powi(scans.min(i32::MAX as u32) as i32) as f32
}

/// Decayed sums of one bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    /// Plots, their q − t₀, outliers among them.
    sums: [f32; 3],
    /// Scan to which the sums are brought.
    scan: u32,
}

impl Bin {
    fn at(self, scan: u32, memory_scans: f64) -> Self {
        let age = scan.saturating_sub(self.scan);
        if age == 0 {
            return self;
        }
        let keep = keep(age, memory_scans);
        Self { sums: self.sums.map(|sum| sum * keep), scan }
    }
}

/// Spreads the keys of bins: the same in every run, so that results are.
#[derive(Debug, Default)]
struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ mixed >> 29;
    }
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
        let radar = Radar { variance: [1.0; 4], cell, measured: [true; 4], range_rate_interval_mps: 0.0 };
        let detector = Detector::new(1e-6, 0);
        let mut map = ClutterMap::new(radar, detector, 1e-6, 20);
        for scan in 0..60 {
            for k in 0..60 {
                map.observe(&plot(430.0, 0.05 + 0.1 * f64::from(k), detector.threshold + 10.0), 1.0, scan);
            }
        }
        let place = plot(430.0, 1.2, 0.0);
        let here = map.in_scan(59, OwnPlots::default())(&place);
        // A ring of one range cell, 628 azimuth cells, one of elevation, two of range rate.
        let expected = 60.0 / (628.3 * 2.0);
        let per_cell = here.density * map.cell_volume(&place);
        assert!(per_cell > 0.8 * expected && per_cell < 3.0 * expected, "{per_cell} {expected}");
        assert!((here.power.mean_excess - 10.0).abs() < 1.0, "{}", here.power.mean_excess);
        let elsewhere = Measurement { polar: [3000.0, 3.0, 0.1, 60.0], ..place };
        let empty = map.in_scan(59, OwnPlots::default())(&elsewhere);
        assert!((empty.density * map.cell_volume(&elsewhere) - 1e-6).abs() < 1e-12);
        assert!(empty.power.mean_excess == 0.0);
    }
}
