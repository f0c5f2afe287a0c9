//! OS-CFAR along range: the cell of rank k among the N reference cells (C11).
//!
//! No cell is sorted. q > α x₍k₎ holds where at most N − k of the reference cells reach q/α, and they are counted for vectors of
//! neighbouring cells together:
//!
//! ```text
//! for each group of cells:
//!     reached = how many of the near half of the reference cells reach q/α, cell by cell
//!     if N − k or fewer in any cell:                   hardly ever in noise
//!         reached += the same of the far half
//!         cells with N − k or fewer are hits
//! ```
//!
//! Only for hits is x₍k₎ itself looked for.

use common::amplitude::{NoiseEstimate, rank};

use super::Hit;
use super::rows::{BLOCK_ROWS, GROUP, Rows, each_block, windows_of};

/// OS-CFAR detector for dwells whose rows are range profiles of one length.
#[derive(Debug, Clone)]
pub struct OsCfar {
    rows: Rows,
    /// 1/α for a block of rows, α by the reference cells that exist.
    inverses: Vec<f32>,
    /// With so many cells that reach q/α there is no hit, for a block of rows: N − k + 1; 0 between rows and without reference cells.
    too_many: Vec<u32>,
    /// k and E g before division by it, by range cell.
    ranks: Vec<(usize, f32)>,
    /// Hits by their place in a block.
    found: Vec<u32>,
    reference_powers: Vec<f32>,
}

impl OsCfar {
    /// A detector over rows of `ranges` cells with `guard` and `reference` cells on each side.
    pub fn new(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        let rows = Rows::new(ranges, guard, reference);
        let (mut inverses, mut too_many, mut ranks) = (Vec::new(), Vec::new(), Vec::new());
        let (mut of, mut inverse, mut mean) = (usize::MAX, 0.0, 1.0);
        for cell in 0..ranges {
            let (before, after) = windows_of(cell, ranges, guard, reference);
            let cells = before + after;
            if of != cells {
                of = cells;
                if cells > 0 {
                    let noise = NoiseEstimate::Ordered(cells as u32);
                    mean = noise.mean();
                    inverse = mean / noise.factor(pfa);
                }
            }
            let k = rank(cells as u32) as usize;
            inverses.push(inverse as f32);
            too_many.push(if cells == 0 { 0 } else { (cells - k + 1) as u32 });
            ranks.push((k, mean as f32));
        }
        Self {
            inverses: rows.in_block(&inverses, f32::INFINITY),
            too_many: rows.in_block(&too_many, 0),
            found: Vec::with_capacity(BLOCK_ROWS * ranges),
            rows,
            ranks,
            reference_powers: Vec::with_capacity(2 * reference),
        }
    }

    /// As [`super::Detector::detect`].
    ///
    /// # Panics
    /// If `amplitudes` is not whole rows, or `powers` of another length.
    pub fn detect(&mut self, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        let (ranges, stride, half) = (self.rows.ranges, self.rows.stride(), self.rows.half());
        let (guard, reference) = (self.rows.guard, self.rows.reference);
        each_block(ranges, amplitudes, powers, hits, |first_row, rows, hits| {
            let (padded, cells) = self.rows.pad(rows);
            self.found.clear();
            let thresholds = (&self.inverses[..], &self.too_many[..]);
            find(padded, cells, (guard, reference), thresholds, &mut self.found);
            for &place in &self.found {
                let place = place as usize;
                let (row, range) = (place / stride, place % stride);
                let (k, mean) = self.ranks[range];
                let at = half + place;
                let (before, after) = windows_of(range, ranges, guard, reference);
                self.reference_powers.clear();
                self.reference_powers.extend(&padded[at - guard - before..at - guard]);
                self.reference_powers.extend(&padded[at + guard + 1..at + guard + 1 + after]);
                let (_, ordered, _) = self.reference_powers.select_nth_unstable_by(k - 1, f32::total_cmp);
                let noise = *ordered / mean;
                let cell = ((first_row + row) * ranges + range) as u32;
                hits.push(Hit { cell, power: padded[at], noise });
            }
        })
    }
}

/// Appends the places of the hits among `cells` cells of a block.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn find(
    padded: &[f32],
    cells: usize,
    (guard, reference): (usize, usize),
    (inverses, too_many): (&[f32], &[u32]),
    found: &mut Vec<u32>,
) {
    let near = reference.div_ceil(2);
    let half = guard + reference;
    for place in (0..cells).step_by(GROUP) {
        let powers = group(padded, half + place);
        let (inverses, too_many) = (group(inverses, place), group(too_many, place));
        let mut limits = [0.0; GROUP];
        for lane in 0..GROUP {
            limits[lane] = powers[lane] * inverses[lane];
        }
        // Reference cells before the group's cells, and after them.
        let lagging = &padded[place..];
        let leading = &padded[half + place + guard + 1..];
        let mut reached = [0; GROUP];
        count(&lagging[reference - near..], near, &limits, &mut reached);
        count(leading, near, &limits, &mut reached);
        if !any_below(&reached, too_many) {
            continue;
        }
        count(lagging, reference - near, &limits, &mut reached);
        count(&leading[near..], reference - near, &limits, &mut reached);
        let lanes = (0..GROUP.min(cells - place)).filter(|&lane| reached[lane] < too_many[lane]);
        found.extend(lanes.map(|lane| (place + lane) as u32));
    }
}

/// The values of a group of cells from `at` on.
#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn group<T>(values: &[T], at: usize) -> &[T; GROUP] {
    values[at..].first_chunk().expect("room for a whole group after the last cell")
}

/// Adds to each lane how many of its `offsets` cells reach its limit; those of lane 0 begin `powers`, those of each next one a
/// cell later. Four at a time, so that limits and sums are loaded a quarter as often. No sum can overflow: development builds, too,
/// need not look, which would keep them from vectors.
#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn count(powers: &[f32], offsets: usize, limits: &[f32; GROUP], reached: &mut [u32; GROUP]) {
    let at = |offset: usize| group(powers, offset);
    let rest = offsets - offsets % 4;
    for offset in (0..rest).step_by(4) {
        let (a, b, c, d) = (at(offset), at(offset + 1), at(offset + 2), at(offset + 3));
        for lane in 0..GROUP {
            let reaches = |powers: &[f32; GROUP]| u32::from(powers[lane] >= limits[lane]);
            let four = reaches(a).wrapping_add(reaches(b)).wrapping_add(reaches(c)).wrapping_add(reaches(d));
            reached[lane] = reached[lane].wrapping_add(four);
        }
    }
    for offset in rest..offsets {
        let powers = at(offset);
        for lane in 0..GROUP {
            reached[lane] = reached[lane].wrapping_add(u32::from(powers[lane] >= limits[lane]));
        }
    }
}

/// Whether any cell of a group may be a hit.
#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn any_below(reached: &[u32; GROUP], too_many: &[u32; GROUP]) -> bool {
    let mut any = 0;
    for lane in 0..GROUP {
        any |= u32::from(reached[lane] < too_many[lane]);
    }
    any > 0
}
