//! Which plots lie near a place: a grid over azimuth and range, whose entries know range and elevation.
//!
//! ```text
//!            range bins ─▶
//!  azimuth  ┌───┬───┬───┐      plots sorted by cell, range varying faster (counting sort);
//!  bins  │  ├───┼───┼───┤      what a window touches of one azimuth bin is one slice of them
//!        ▼  └───┴───┴───┘
//! ```
//! The grid spans the azimuths and ranges at which there are plots. About as many cells as plots, so building is linear in the plots, and a query costs the entries of the cells that it
//! touches. Those are looked at one after the other without a branch, and the plots themselves are not. The buffers are kept: nothing is allocated once they have grown.

use std::f64::consts::TAU;

use common::angle;

use crate::plots::measurement::Measurement;

/// Windows are widened by this much against rounding, rad and m.
const MARGIN: f64 = 1e-9;
/// Bins per axis at most.
const MOST_BINS: usize = 4096;

/// An interval of azimuth, one of range and one of elevation, closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Middle of the azimuth interval, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// Half its width, rad; π and more is the whole circle.
    pub half_azimuth_rad: f64,
    /// Ends of the range interval, m.
    pub range_m: [f64; 2],
    /// Ends of the elevation interval, rad. A plot without elevation lies in any.
    pub elevation_rad: [f64; 2],
}

impl Window {
    /// The interval of all elevations.
    pub const ANY_ELEVATION: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
}

/// Where a plot lies.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    /// Its cell; sorted, which plot it is.
    number: u32,
    range_m: f32,
    /// NaN if not measured.
    elevation_rad: f32,
}

/// Indices of plots by azimuth and range.
#[derive(Debug, Clone, Default)]
pub struct PlotIndex {
    /// Bins of azimuth, and of range.
    bins: [usize; 2],
    nearest_m: f32,
    /// The azimuth from which plots' offsets are counted, and their smallest and largest offset.
    middle_rad: f64,
    offsets_rad: [f64; 2],
    /// Bins per rad, and per m.
    per_rad: f64,
    per_m: f32,
    /// Azimuths of the plots, as offsets.
    rows_rad: Vec<f64>,
    /// Where each cell starts in `sorted`; one more than there are cells.
    starts: Vec<u32>,
    /// Plots by cell, and by their own order within it.
    sorted: Vec<Entry>,
    /// In the order of the plots, with their cells: all that sorting needs of them.
    entries: Vec<Entry>,
}

impl PlotIndex {
    /// Sorts `plots` (at most 2³² − 1) in place of those before. They are looked at once.
    pub fn build<'a>(&mut self, plots: impl ExactSizeIterator<Item = &'a Measurement>) {
        let side = ((plots.len() as f64).sqrt().ceil() as usize).clamp(1, MOST_BINS);
        self.bins = [side; 2];
        let (mut nearest, mut farthest) = (f32::INFINITY, 0.0_f32);
        let mut offsets = [f64::INFINITY, f64::NEG_INFINITY];
        let mut middle = None;
        self.rows_rad.clear();
        self.entries.clear();
        self.entries.extend(plots.map(|plot| {
            let range_m = plot.polar[0] as f32;
            (nearest, farthest) = (nearest.min(range_m), farthest.max(range_m));
            let offset = angle::difference(plot.polar[1], *middle.get_or_insert(plot.polar[1]));
            offsets = [offsets[0].min(offset), offsets[1].max(offset)];
            self.rows_rad.push(offset);
            let elevation_rad = if plot.measured[2] { plot.polar[2] as f32 } else { f32::NAN };
            Entry { number: 0, range_m, elevation_rad }
        }));
        self.middle_rad = middle.unwrap_or(0.0);
        self.offsets_rad = offsets;
        self.per_rad = side as f64 / (offsets[1] - offsets[0]).max(MARGIN);
        self.nearest_m = nearest;
        self.per_m = side as f32 / (farthest - nearest).max(1.0);
        self.starts.clear();
        self.starts.resize(side * side + 1, 0);
        for plot in 0..self.entries.len() {
            let row = self.azimuth_bin(self.rows_rad[plot]);
            let cell = row * side + self.range_bin(self.entries[plot].range_m);
            self.entries[plot].number = cell as u32;
            self.starts[cell] += 1;
        }
        // Ends of the cells; filling from the back turns them into starts and keeps the order of plots.
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.sorted.clear();
        self.sorted.resize(self.entries.len(), Entry::default());
        for (plot, entry) in self.entries.iter().enumerate().rev() {
            let start = &mut self.starts[entry.number as usize];
            *start -= 1;
            self.sorted[*start as usize] = Entry { number: plot as u32, ..*entry };
        }
    }

    /// Makes room for so many plots, and for all that a search may find.
    pub fn reserve(&mut self, plots: usize, found: &mut Vec<u32>) {
        let cells = (plots as f64).sqrt().ceil() as usize;
        self.entries.reserve(plots.saturating_sub(self.entries.len()));
        self.rows_rad.reserve(plots.saturating_sub(self.rows_rad.len()));
        self.sorted.reserve(plots.saturating_sub(self.sorted.len()));
        self.starts.reserve((cells * cells + 1).saturating_sub(self.starts.len()));
        found.clear();
        found.reserve(self.sorted.capacity());
    }

    /// Finds the plots in the azimuth bins that `window` touches and in its intervals of range and elevation: every plot in
    /// the window, once, and some beside it. `found` is written anew.
    #[expect(clippy::needless_bitwise_bool, reason = "no branch to be guessed wrong")]
    pub fn find(&self, window: &Window, found: &mut Vec<u32>) {
        found.clear();
        found.reserve(self.sorted.capacity()); // no window holds more
        let [from_m, to_m] = window.range_m;
        let half = window.half_azimuth_rad + MARGIN;
        if !(from_m <= to_m && half >= 0.0 && window.azimuth_rad.is_finite()) || self.sorted.is_empty() {
            return;
        }
        let columns = self.bins[1];
        let [first, last] = self.rows_about(angle::difference(window.azimuth_rad, self.middle_rad), half);
        // Rounding is monotonous, so no plot leaves its window.
        let [from_m, to_m] = [(from_m - MARGIN) as f32, (to_m + MARGIN) as f32];
        let [lowest, highest] = window.elevation_rad.map(|end| end as f32);
        let (nearest, farthest) = (self.range_bin(from_m), self.range_bin(to_m));
        let mut used = 0;
        for row in first..last {
            let cell = row * columns;
            let entries = &self.sorted[self.starts[cell + nearest] as usize..self.starts[cell + farthest + 1] as usize];
            found.resize(used + entries.len(), 0);
            for entry in entries {
                found[used] = entry.number;
                let outside = (entry.range_m < from_m)
                    | (entry.range_m > to_m)
                    | (entry.elevation_rad < lowest)
                    | (entry.elevation_rad > highest);
                used += usize::from(!outside);
            }
        }
        found.truncate(used);
    }

    /// The azimuth bins, from the first to before the last, that lie within `half` of an offset, rad.
    fn rows_about(&self, offset: f64, half: f64) -> [usize; 2] {
        let [from, to] = self.offsets_rad;
        let mut found = [0; 2];
        let mut ways = 0;
        // A window across the point opposite the middle may hold plots on either side of it.
        for turn in [-TAU, 0.0, TAU] {
            let (low, high) = (offset + turn - half, offset + turn + half);
            if low <= to && high >= from {
                found = [self.azimuth_bin(low), self.azimuth_bin(high) + 1];
                ways += 1;
            }
        }
        if ways > 1 { [0, self.bins[0]] } else { found }
    }

    /// Offsets beyond the ends fall into the last bins.
    fn azimuth_bin(&self, offset_rad: f64) -> usize {
        (((offset_rad - self.offsets_rad[0]) * self.per_rad) as usize).min(self.bins[0].saturating_sub(1))
    }

    /// Ranges beyond the ends fall into the last bins.
    fn range_bin(&self, range_m: f32) -> usize {
        (((range_m - self.nearest_m) * self.per_m) as usize).min(self.bins[1].saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against looking at every plot.
        #[test]
        fn every_plot_in_the_window_is_found_once(
            places in prop::collection::vec((0.1..1e5_f64, -TAU..2.0 * TAU, -0.1..1.0_f64, 0..4_u8), 0..300),
            window in (0.0..TAU, 0.0..4.0_f64, 0.0..1e5_f64, 0.0..1e5_f64),
            elevations in (-0.2..0.7_f64, 0.0..0.7_f64),
            narrow in 1e-4..1.0_f64,
        ) {
            let place = |(r, b, e, seen): (f64, f64, f64, u8)| {
                let mut plot = Measurement::at(r, b);
                plot.measured[2] = seen > 0;
                plot.polar[2] = if seen > 0 { e } else { 0.0 };
                plot
            };
            let plots: Vec<Measurement> = places.into_iter().map(place).collect();
            let (azimuth_rad, half, from_m, length_m) = window;
            let half_azimuth_rad = half * narrow;
            let elevation_rad = [elevations.0, elevations.0 + elevations.1];
            let range_m = [from_m, from_m + length_m * narrow];
            let window = Window { azimuth_rad, half_azimuth_rad, range_m, elevation_rad };
            let mut index = PlotIndex::default();
            index.build(plots[..plots.len() / 2].iter()); // the buffers are reused
            index.build(plots.iter());
            let mut near = vec![7; 3]; // of an earlier search
            index.find(&window, &mut near);
            let mut found = vec![0; plots.len()];
            for &plot in &near {
                found[plot as usize] += 1;
            }
            for (plot, found) in plots.iter().zip(found) {
                let [range_m, azimuth_rad, elevation_rad, _] = plot.polar;
                let holds = |[from, to]: [f64; 2], value: f64| (from..=to).contains(&value);
                let at_elevation = !plot.measured[2] || holds(window.elevation_rad, elevation_rad);
                let inside = angle::difference(azimuth_rad, window.azimuth_rad).abs() <= half_azimuth_rad
                    && holds(window.range_m, range_m) && at_elevation;
                prop_assert!(found == 1 || (found == 0 && !inside));
                // Not by range or elevation beside it, but for rounding.
                let beside = |[from, to]: [f64; 2], slack: f64, value: f64| value < from - slack || value > to + slack;
                let far = beside(window.range_m, 0.01, range_m)
                    || (plot.measured[2] && beside(window.elevation_rad, 1e-6, elevation_rad));
                prop_assert!(found == 0 || !far);
            }
        }
    }

    #[test]
    fn a_window_across_north_looks_at_few_plots() {
        let plots: Vec<Measurement> =
            (0..10_000).map(|k| Measurement::at(1e3 + f64::from(k % 97), f64::from(k) * TAU / 1e4)).collect();
        let mut index = PlotIndex::default();
        index.build(plots.iter());
        let elevation_rad = Window::ANY_ELEVATION;
        let window = Window { azimuth_rad: 0.001, half_azimuth_rad: 0.01, range_m: [1010.0, 1012.0], elevation_rad };
        let mut near = Vec::new();
        index.find(&window, &mut near);
        assert!(near.len() < 30 && near.iter().any(|&k| k > 9000) && near.iter().any(|&k| k < 1000), "{near:?}");
        let impossible = Window { azimuth_rad: f64::NAN, ..window };
        index.find(&impossible, &mut near);
        assert!(near.is_empty());
    }
}
