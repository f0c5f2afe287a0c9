//! Which plots lie near a place: a grid over azimuth and range.
//!
//! ```text
//!            range bins ─▶
//!  azimuth  ┌───┬───┬───┐      plots sorted by cell, range varying faster (counting sort);
//!  bins  │  ├───┼───┼───┤      what a window touches of one azimuth bin is one slice of them
//!        ▼  └───┴───┴───┘
//! ```
//! About as many cells as plots, so building is linear in the plots, and a query costs what it returns plus the azimuth
//! bins that it crosses. The buffers are kept: nothing is allocated once they have grown.

use std::f64::consts::{PI, TAU};

use common::angle;

use crate::measurement::Measurement;

/// Windows are widened by this much against rounding, rad and m.
const MARGIN: f64 = 1e-9;
/// Bins per axis at most.
const MOST_BINS: usize = 4096;

/// An interval of azimuth and one of range, closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Middle of the azimuth interval, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// Half its width, rad; π and more is the whole circle.
    pub half_azimuth_rad: f64,
    /// Ends of the range interval, m.
    pub range_m: [f64; 2],
}

/// Where a plot lies.
#[derive(Debug, Clone, Copy)]
struct Key {
    /// Its azimuth bin; once the extent of the ranges is known, its cell.
    bin: u32,
    range_m: f32,
}

/// Indices of plots by azimuth and range.
#[derive(Debug, Clone, Default)]
pub struct PlotIndex {
    /// Bins of azimuth, and of range.
    bins: [usize; 2],
    nearest_m: f32,
    /// Bins per rad, and per m.
    per_rad: f64,
    per_m: f32,
    /// Where each cell starts in `order`; one more than there are cells.
    starts: Vec<u32>,
    /// Plots by cell, and by their own order within it.
    order: Vec<u32>,
    /// Azimuth bin and range of each plot, and then its cell and range: all that sorting needs of the plots.
    keys: Vec<Key>,
}

impl PlotIndex {
    /// Sorts `plots` (at most 2³² − 1) in place of those before. They are looked at once.
    pub fn build<'a>(&mut self, plots: impl ExactSizeIterator<Item = &'a Measurement>) {
        let side = ((plots.len() as f64).sqrt().ceil() as usize).clamp(1, MOST_BINS);
        self.bins = [side; 2];
        let per_rad = side as f64 / TAU;
        self.per_rad = per_rad;
        let (mut nearest, mut farthest) = (f32::INFINITY, 0.0_f32);
        self.keys.clear();
        self.keys.extend(plots.map(|plot| {
            let range_m = plot.polar[0] as f32;
            (nearest, farthest) = (nearest.min(range_m), farthest.max(range_m));
            let row = ((angle::wrap(plot.polar[1]) * per_rad) as usize).min(side - 1);
            Key { bin: row as u32, range_m }
        }));
        self.nearest_m = nearest;
        self.per_m = side as f32 / (farthest - nearest).max(1.0);
        self.starts.clear();
        self.starts.resize(side * side + 1, 0);
        for plot in 0..self.keys.len() {
            let Key { bin, range_m } = self.keys[plot];
            let cell = bin as usize * side + self.range_bin(range_m);
            self.keys[plot].bin = cell as u32;
            self.starts[cell] += 1;
        }
        // Ends of the cells; filling from the back turns them into starts and keeps the order of plots.
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.order.clear();
        self.order.resize(self.keys.len(), 0);
        for (plot, key) in self.keys.iter().enumerate().rev() {
            let start = &mut self.starts[key.bin as usize];
            *start -= 1;
            self.order[*start as usize] = plot as u32;
        }
    }

    /// The plots in all cells that `window` touches, a slice of indices for each azimuth bin: every plot in the window, once,
    /// and some beside it.
    pub fn near<'a>(&'a self, window: &Window) -> impl Iterator<Item = &'a [u32]> + use<'a> {
        let [from_m, to_m] = window.range_m;
        let half = window.half_azimuth_rad + MARGIN;
        let any = from_m <= to_m && half >= 0.0 && window.azimuth_rad.is_finite() && !self.order.is_empty();
        let [rows, columns] = self.bins;
        let (first, count) = if !any {
            (0, 0)
        } else if half >= PI {
            (0, rows)
        } else {
            // A turn ahead, so that the window's left end is not below zero and truncation is the floor.
            let first = ((window.azimuth_rad - half + TAU) * self.per_rad) as usize;
            let last = ((window.azimuth_rad + half + TAU) * self.per_rad) as usize;
            (first % rows, (last - first + 1).min(rows))
        };
        let (nearest, farthest) = (self.range_bin((from_m - MARGIN) as f32), self.range_bin((to_m + MARGIN) as f32));
        (0..count).map(move |step| {
            let row = if first + step < rows { first + step } else { first + step - rows };
            let cell = row * columns;
            &self.order[self.starts[cell + nearest] as usize..self.starts[cell + farthest + 1] as usize]
        })
    }

    /// Ranges beyond the ends fall into the last bins. Rounding is monotonous, so no plot leaves its window.
    fn range_bin(&self, range_m: f32) -> usize {
        (((range_m - self.nearest_m) * self.per_m) as usize).min(self.bins[1].saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plot(range_m: f64, azimuth_rad: f64) -> Measurement {
        Measurement {
            time_ns: 0,
            position: [0.0; 3],
            polar: [range_m, azimuth_rad, 0.0, 0.0],
            variance: [1.0; 4],
            power: 0.0,
            measured: [true; 4],
            has_power: false,
        }
    }

    proptest! {
        /// Against looking at every plot.
        #[test]
        fn every_plot_in_the_window_is_found_once(
            places in prop::collection::vec((0.1..1e5_f64, -TAU..2.0 * TAU), 0..300),
            window in (0.0..TAU, 0.0..4.0_f64, 0.0..1e5_f64, 0.0..1e5_f64),
            narrow in 1e-4..1.0_f64,
        ) {
            let plots: Vec<Measurement> = places.into_iter().map(|(r, b)| plot(r, b)).collect();
            let (azimuth_rad, half, from_m, length_m) = window;
            let half_azimuth_rad = half * narrow;
            let window = Window { azimuth_rad, half_azimuth_rad, range_m: [from_m, from_m + length_m * narrow] };
            let mut index = PlotIndex::default();
            index.build(plots[..plots.len() / 2].iter()); // the buffers are reused
            index.build(plots.iter());
            let mut found = vec![0; plots.len()];
            for &near in index.near(&window).flatten() {
                found[near as usize] += 1;
            }
            for (plot, found) in plots.iter().zip(found) {
                let inside = angle::difference(plot.polar[1], azimuth_rad).abs() <= half_azimuth_rad
                    && (window.range_m[0]..=window.range_m[1]).contains(&plot.polar[0]);
                prop_assert!(found == 1 || (found == 0 && !inside));
            }
        }
    }

    #[test]
    fn a_window_across_north_looks_at_few_plots() {
        let plots: Vec<Measurement> =
            (0..10_000).map(|k| plot(1e3 + f64::from(k % 97), f64::from(k) * TAU / 1e4)).collect();
        let mut index = PlotIndex::default();
        index.build(plots.iter());
        let window = Window { azimuth_rad: 0.001, half_azimuth_rad: 0.01, range_m: [1010.0, 1012.0] };
        let near: Vec<u32> = index.near(&window).flatten().copied().collect();
        assert!(near.len() < 30 && near.iter().any(|&k| k > 9000) && near.iter().any(|&k| k < 1000), "{near:?}");
        let impossible = Window { azimuth_rad: f64::NAN, ..window };
        assert_eq!(index.near(&impossible).flatten().count(), 0);
    }
}
