//! OS-CFAR along range: the cell of rank k among the N reference cells (C11).
//!
//! No cell is sorted. q > α x₍k₎ holds where at least k of the reference cells are below q/α, and to count them is N comparisons
//! on vectors of neighbouring cells. Only for hits is x₍k₎ itself looked for.

use common::amplitude::{NoiseEstimate, rank};

use super::rows::{BLOCK_ROWS, Rows, windows_of};
use super::{Hit, square};

/// Cells counted for together: their counts stay in registers.
const LANES: usize = 16;

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
    counts: Vec<u32>,
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
            counts: vec![0; BLOCK_ROWS * rows.stride()],
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
        for (block, rows) in powers.chunks(BLOCK_ROWS * ranges).enumerate() {
            let (padded, cells) = self.rows.pad(rows);
            let counts = &mut self.counts[..cells];
            if !count_below(padded, &self.inverses[..cells], &self.required[..cells], (guard, reference), counts) {
                continue;
            }
            for row in 0..rows.len() / ranges {
                for (range, &(k, mean)) in self.ranks.iter().enumerate() {
                    let place = row * stride + range;
                    if counts[place] < self.required[place] {
                        continue;
                    }
                    let (before, after) = windows_of(range, ranges, guard, reference);
                    let at = half + place;
                    self.reference_powers.clear();
                    self.reference_powers.extend(&padded[at - guard - before..at - guard]);
                    self.reference_powers.extend(&padded[at + guard + 1..at + guard + 1 + after]);
                    let (_, ordered, _) = self.reference_powers.select_nth_unstable_by(k - 1, f32::total_cmp);
                    let noise = *ordered / mean;
                    let cell = ((block * BLOCK_ROWS + row) * ranges + range) as u32;
                    hits.push(Hit { cell, power: padded[at], noise });
                }
            }
        }
        true
    }
}

/// Counts, for each cell, the reference cells below its power over α; whether any count is as large as required.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn count_below(
    padded: &[f32],
    inverses: &[f32],
    required: &[u32],
    (guard, reference): (usize, usize),
    counts: &mut [u32],
) -> bool {
    let half = guard + reference;
    let mut over = 0_u32;
    let mut first = 0;
    while first < counts.len() {
        // The last cells are counted with ones before them, some for a second time.
        let begin = if first + LANES <= counts.len() { first } else { counts.len().saturating_sub(LANES) };
        let lanes = LANES.min(counts.len());
        if lanes < LANES {
            for cell in 0..lanes {
                let limit = padded[half + cell] * inverses[cell];
                let below = |powers: &[f32]| powers.iter().filter(|&&power| power < limit).count() as u32;
                counts[cell] =
                    below(&padded[cell..cell + reference]) + below(&padded[cell + half + guard + 1..=cell + 2 * half]);
                over |= u32::from(counts[cell] >= required[cell]);
            }
            break;
        }
        let mut limits = [0.0_f32; LANES];
        for (limit, (&power, &inverse)) in
            limits.iter_mut().zip(padded[half + begin..][..LANES].iter().zip(&inverses[begin..][..LANES]))
        {
            *limit = power * inverse;
        }
        let mut below = [0_u32; LANES];
        for window in [begin, begin + half + guard + 1] {
            for offset in 0..reference {
                let powers = &padded[window + offset..][..LANES];
                for ((below, &power), &limit) in below.iter_mut().zip(powers).zip(&limits) {
                    *below += u32::from(power < limit);
                }
            }
        }
        let wanted = &required[begin..][..LANES];
        for ((count, &below), &wanted) in counts[begin..][..LANES].iter_mut().zip(&below).zip(wanted) {
            *count = below;
            over |= u32::from(below >= wanted);
        }
        first = begin + LANES;
    }
    over > 0
}
