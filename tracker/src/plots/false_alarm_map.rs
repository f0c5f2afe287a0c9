//! Where false alarms fall: plots that no track explains, in a polar grid that covers all of them.
//!
//! The rings are as narrow as a resolution cell at first. A plot beyond the last one doubles their width.

use std::f64::consts::TAU;

use common::clutter_map::{AZIMUTHS, ClutterCell, RANGES};

use crate::plots::measurement::Measurement;

/// A cell with less than this is left out: one plot says nothing, and several are forgotten some day.
const FADED: f32 = 1.0;

/// The grid.
#[derive(Debug)]
pub struct FalseAlarmMap {
    /// Width of a ring, m; 0 before the first plot.
    range_step_m: f64,
    /// Wedge by wedge.
    bins: Vec<Bin>,
}

/// Decayed sums over the false plots of a cell, each weighted by the probability that no track has caused it.
#[derive(Debug, Default, Clone, Copy)]
struct Bin {
    plots: f32,
    elevation_rad: f32,
    /// Magnitudes, m/s.
    range_rate_mps: f32,
}

impl Bin {
    fn plus(self, other: Self) -> Self {
        Self {
            plots: self.plots + other.plots,
            elevation_rad: self.elevation_rad + other.elevation_rad,
            range_rate_mps: self.range_rate_mps + other.range_rate_mps,
        }
    }

    fn times(self, factor: f32) -> Self {
        Self {
            plots: self.plots * factor,
            elevation_rad: self.elevation_rad * factor,
            range_rate_mps: self.range_rate_mps * factor,
        }
    }
}

impl Default for FalseAlarmMap {
    fn default() -> Self {
        Self { range_step_m: 0.0, bins: vec![Bin::default(); AZIMUTHS * RANGES] }
    }
}

impl FalseAlarmMap {
    /// Width of a wedge, rad.
    pub const AZIMUTH_STEP_RAD: f64 = TAU / AZIMUTHS as f64;

    /// Width of a ring, m; 0 before the first plot.
    pub fn range_step_m(&self) -> f64 {
        self.range_step_m
    }

    /// Takes a plot; `unclaimed` is the probability that no track has caused it, `finest_m` the least width of a ring.
    pub(super) fn observe(&mut self, plot: &Measurement, unclaimed: f64, finest_m: f64) {
        let [range_m, azimuth_rad, elevation_rad, range_rate_mps] = plot.polar;
        self.range_step_m = self.range_step_m.max(finest_m);
        while range_m >= self.range_step_m * RANGES as f64 {
            self.widen();
        }
        let wedge = (common::angle::wrap(azimuth_rad) / Self::AZIMUTH_STEP_RAD) as usize % AZIMUTHS;
        let ring = (range_m / self.range_step_m) as usize;
        let one = Bin { plots: 1.0, elevation_rad: elevation_rad as f32, range_rate_mps: range_rate_mps.abs() as f32 };
        let bin = &mut self.bins[wedge * RANGES + ring.min(RANGES - 1)];
        *bin = bin.plus(one.times(unclaimed as f32));
    }

    /// A turn has ended, of which `keep` is what remains.
    pub(super) fn end_turn(&mut self, keep: f32) {
        for bin in &mut self.bins {
            *bin = bin.times(keep);
        }
    }

    /// The cells that hold anything, and in each what `expected` says of the mean place of its plots: range, azimuth,
    /// elevation, range rate.
    pub fn cells(&self, expected: impl Fn([f64; 4]) -> f64) -> impl Iterator<Item = ClutterCell> {
        let held = self.bins.iter().enumerate().filter(|(_, bin)| bin.plots >= FADED);
        held.map(move |(index, bin)| {
            let (wedge, ring) = (index / RANGES, index % RANGES);
            let mean = |sum: f32| f64::from(sum / bin.plots);
            let middle = |index: usize, step: f64| (index as f64 + 0.5) * step;
            let place = [
                middle(ring, self.range_step_m),
                middle(wedge, Self::AZIMUTH_STEP_RAD),
                mean(bin.elevation_rad),
                mean(bin.range_rate_mps),
            ];
            ClutterCell {
                azimuth: wedge as u16,
                range: ring as u16,
                found: bin.plots,
                expected: expected(place) as f32,
            }
        })
    }

    fn widen(&mut self) {
        self.range_step_m *= 2.0;
        for rings in self.bins.chunks_exact_mut(RANGES) {
            for ring in 0..RANGES / 2 {
                rings[ring] = rings[2 * ring].plus(rings[2 * ring + 1]);
            }
            rings[RANGES / 2..].fill(Bin::default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(map: &FalseAlarmMap) -> Vec<(u16, u16, f32)> {
        map.cells(|_| 0.0).map(|cell| (cell.azimuth, cell.range, cell.found)).collect()
    }

    #[test]
    fn a_plot_beyond_the_grid_widens_it_and_nothing_is_lost() {
        let mut map = FalseAlarmMap::default();
        let plot = |range_m, wedge: f64| Measurement::at(range_m, (wedge + 0.5) * FalseAlarmMap::AZIMUTH_STEP_RAD);
        for _ in 0..4 {
            map.observe(&plot(105.0, 2.0), 1.0, 10.0);
        }
        for _ in 0..2 {
            map.observe(&plot(119.0, 2.0), 1.0, 10.0);
        }
        assert_eq!(held(&map), [(2, 10, 4.0), (2, 11, 2.0)]);
        map.observe(&plot(1000.0, 89.0), 1.0, 10.0);
        assert_eq!((map.range_step_m(), held(&map)), (20.0, vec![(2, 5, 6.0), (89, 50, 1.0)]));
        map.end_turn(0.5);
        assert_eq!((map.range_step_m(), held(&map)), (20.0, vec![(2, 5, 3.0)]));
    }

    /// Half a plot a scan at one far place, among plots that come but once.
    #[test]
    fn what_comes_again_and_again_far_away_is_kept() {
        let mut map = FalseAlarmMap::default();
        for turn in 0..200_u32 {
            for k in 0..20 {
                let (range, wedge) = (f64::from((turn * 20 + k) * 37 % 500), f64::from((turn * 20 + k) * 53 % 80));
                map.observe(&Measurement::at(range, (wedge + 0.5) * FalseAlarmMap::AZIMUTH_STEP_RAD), 1.0, 10.0);
            }
            let fixed = Measurement::at(900.0, 85.5 * FalseAlarmMap::AZIMUTH_STEP_RAD);
            map.observe(&fixed, 0.5, 10.0);
            map.end_turn(0.99);
        }
        let found = held(&map).into_iter().find(|cell| cell.0 == 85).expect("a cell").2;
        let expected = 0.5 * 0.99 * (1.0 - 0.99_f32.powi(200)) / 0.01;
        assert!((found / expected - 1.0).abs() < 1e-3, "{found}, expected {expected}");
    }

    #[test]
    fn what_is_expected_is_asked_for_at_the_mean_place() {
        let mut map = FalseAlarmMap::default();
        for (elevation_rad, range_rate_mps) in [(0.1, -6.0), (0.3, 2.0)] {
            let polar = [15.0, 0.01, elevation_rad, range_rate_mps];
            map.observe(&Measurement { polar, ..Measurement::at(15.0, 0.01) }, 1.0, 10.0);
        }
        let places = std::cell::RefCell::new(Vec::new());
        let cells: Vec<_> = map
            .cells(|place| {
                places.borrow_mut().push(place);
                0.5
            })
            .collect();
        let [range_m, azimuth_rad, elevation_rad, range_rate_mps] = places.borrow()[0];
        assert_eq!((cells.len(), cells[0].expected, range_m), (1, 0.5, 15.0));
        assert!((azimuth_rad - FalseAlarmMap::AZIMUTH_STEP_RAD / 2.0).abs() < 1e-9);
        assert!((elevation_rad - 0.2).abs() < 1e-6 && (range_rate_mps - 4.0).abs() < 1e-6);
    }
}
