//! OS-CFAR along range: the cell of rank k among the N reference cells (C11).
//!
//! No cell is sorted. q > α x₍k₎ holds where at least k of the reference cells are below q/α, and to count them is N comparisons.
//! A hit has at most N − k cells that are not below, so three quarters of the near window tell of nearly every cell of noise that it is none: they
//! are counted on vectors of neighbouring cells, all others only for the few cells that are left. Only for hits is x₍k₎ itself looked for.

use common::amplitude::{NoiseEstimate, rank};

use super::rows::{BLOCK_ROWS, Rows, windows_of};
use super::{Hit, square};

/// OS-CFAR detector for dwells whose rows are range profiles of one length.
#[derive(Debug, Clone)]
pub struct OsCfar {
    rows: Rows,
    /// 1/α for a block of rows, α by the reference cells that exist; 0 without any.
    inverses: Vec<f32>,
    /// Cells below q/α that make a hit, for a block of rows: k, and the zeros beyond the ends of the row, which always are.
    required: Vec<u32>,
    /// k and E g before division by it, by range cell.
    ranks: Vec<(usize, f32)>,
    /// q/α, and how many of the first reference cells are below it.
    limits: Vec<f32>,
    counts: Vec<u32>,
    /// Places in a block of cells that may be hits.
    left: Vec<u32>,
    reference_powers: Vec<f32>,
}

impl OsCfar {
    /// A detector over rows of `ranges` cells with `guard` and `reference` cells on each side.
    pub fn new(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        let rows = Rows::new(ranges, guard, reference);
        let (mut inverses, mut required, mut ranks) = (Vec::new(), Vec::new(), Vec::new());
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
                } else {
                    inverse = 0.0; // no power of a cell is below 0
                }
            }
            let k = rank(cells as u32) as usize;
            inverses.push(inverse as f32);
            required.push((k + 2 * reference - cells).max(1) as u32);
            ranks.push((k, mean as f32));
        }
        let mut block_required = vec![u32::MAX; BLOCK_ROWS * rows.stride()];
        for row in block_required.chunks_mut(rows.stride()) {
            row[..ranges].copy_from_slice(&required);
        }
        Self {
            inverses: rows.in_block(&inverses),
            required: block_required,
            limits: vec![0.0; BLOCK_ROWS * rows.stride()],
            counts: vec![0; BLOCK_ROWS * rows.stride()],
            left: Vec::with_capacity(BLOCK_ROWS * rows.stride()),
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
        if !square(amplitudes, powers) {
            return false;
        }
        let (ranges, stride, half) = (self.rows.ranges, self.rows.stride(), self.rows.half());
        let (guard, reference) = (self.rows.guard, self.rows.reference);
        let first = reference * 3 / 4;
        let others = (2 * reference - first) as u32;
        for (block, rows) in powers.chunks(BLOCK_ROWS * ranges).enumerate() {
            let (padded, cells) = self.rows.pad(rows);
            let (limits, counts) = (&mut self.limits[..cells], &mut self.counts[..cells]);
            scale(&padded[half..], &self.inverses, limits);
            count_below(padded, first, limits, counts);
            self.left.clear();
            note_left(counts, &self.required, others, &mut self.left);
            for &place in &self.left {
                let place = place as usize;
                let (row, range) = (place / stride, place % stride);
                let Some(&(k, mean)) = self.ranks.get(range) else { continue };
                let required = self.required[place];
                let limit = limits[place];
                let below = |powers: &[f32]| powers.iter().map(|&power| u32::from(power < limit)).sum::<u32>();
                let at = half + place;
                let lagging = below(&padded[place + first..place + reference]);
                let leading = below(&padded[at + guard + 1..][..reference]);
                if counts[place] + lagging + leading < required {
                    continue;
                }
                let (before, after) = windows_of(range, ranges, guard, reference);
                self.reference_powers.clear();
                self.reference_powers.extend(&padded[at - guard - before..at - guard]);
                self.reference_powers.extend(&padded[at + guard + 1..at + guard + 1 + after]);
                let (_, ordered, _) = self.reference_powers.select_nth_unstable_by(k - 1, f32::total_cmp);
                let noise = *ordered / mean;
                let cell = ((block * BLOCK_ROWS + row) * ranges + range) as u32;
                hits.push(Hit { cell, power: padded[at], noise });
            }
        }
        true
    }
}

/// Writes power over α.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn scale(powers: &[f32], inverses: &[f32], limits: &mut [f32]) {
    for (limit, (&power, &inverse)) in limits.iter_mut().zip(powers.iter().zip(inverses)) {
        *limit = power * inverse;
    }
}

/// Counts, for each cell, those of the first `offsets` reference cells before it that are below its limit; `padded` begins with the first of
/// them. Four at a time, so that the counts are loaded and stored a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn count_below(padded: &[f32], offsets: usize, limits: &[f32], counts: &mut [u32]) {
    let cells = counts.len();
    let limits = &limits[..cells];
    counts.fill(0);
    let mut offset = 0;
    while offset + 4 <= offsets {
        let (a, b) = (&padded[offset..][..cells], &padded[offset + 1..][..cells]);
        let (c, d) = (&padded[offset + 2..][..cells], &padded[offset + 3..][..cells]);
        for cell in 0..cells {
            let limit = limits[cell];
            counts[cell] += u32::from(a[cell] < limit)
                + u32::from(b[cell] < limit)
                + u32::from(c[cell] < limit)
                + u32::from(d[cell] < limit);
        }
        offset += 4;
    }
    while offset < offsets {
        for (count, (&power, &limit)) in counts.iter_mut().zip(padded[offset..].iter().zip(limits)) {
            *count += u32::from(power < limit);
        }
        offset += 1;
    }
}

/// Cells looked at together for any that may be a hit.
const GROUP: usize = 32;

/// Appends the places of cells whose count may reach what is required with `others` more cells.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn note_left(counts: &[u32], required: &[u32], others: u32, left: &mut Vec<u32>) {
    for (group, (counts, required)) in counts.chunks(GROUP).zip(required.chunks(GROUP)).enumerate() {
        let mut any = 0_u32;
        for (&count, &required) in counts.iter().zip(required) {
            any |= u32::from(count + others >= required);
        }
        if any > 0 {
            let places = (group * GROUP) as u32..;
            let may =
                places.zip(counts.iter().zip(required)).filter(|(_, (count, required))| *count + others >= **required);
            left.extend(may.map(|(place, _)| place));
        }
    }
}
