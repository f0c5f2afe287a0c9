//! Range profiles side by side with zeros between them, and the sums of their reference windows.

use super::{Hit, square};

/// Rows worked on together: their padded powers stay in the first-level cache.
pub(super) const BLOCK_ROWS: usize = 8;
/// Cells that may be read together from any cell of a block on.
pub(super) const GROUP: usize = 32;

/// Squares the amplitudes of rows of `ranges` cells, block by block so that powers are still in cache, and hands each block's powers to
/// `detect` with the number of its first row. Returns false, with no new hits and powers without meaning, if an amplitude is NaN, infinite or
/// negative.
///
/// # Panics
/// If `powers` has another length.
pub(super) fn each_block(
    ranges: usize,
    amplitudes: &[f32],
    powers: &mut [f32],
    hits: &mut Vec<Hit>,
    mut detect: impl FnMut(usize, &[f32], &mut Vec<Hit>),
) -> bool {
    assert_eq!(amplitudes.len(), powers.len(), "one power per amplitude");
    let before = hits.len();
    let cells = BLOCK_ROWS * ranges;
    for (block, (amplitudes, powers)) in amplitudes.chunks(cells).zip(powers.chunks_mut(cells)).enumerate() {
        if !square(amplitudes, powers) {
            hits.truncate(before);
            return false;
        }
        detect(block * BLOCK_ROWS, powers, hits);
    }
    true
}

/// Rows of one length, in blocks.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    pub(super) ranges: usize,
    pub(super) guard: usize,
    pub(super) reference: usize,
    /// Powers of a block: `half` zeros, then each row followed by `half` zeros.
    padded: Vec<f32>,
    window: Vec<f32>,
    spare: [Vec<f32>; 2],
}

/// A block of rows, [`Rows::stride`] apart, and the sums of the windows before and after each cell.
pub(super) struct Windows<'a> {
    pub(super) powers: &'a [f32],
    pub(super) lagging: &'a [f32],
    pub(super) leading: &'a [f32],
}

impl Rows {
    pub(super) fn new(ranges: usize, guard: usize, reference: usize) -> Self {
        let half = guard + reference;
        let length = half + BLOCK_ROWS * (ranges + half);
        let zeros = vec![0.0; length + half + guard + 1 + GROUP];
        Self { ranges, guard, reference, padded: zeros.clone(), window: zeros.clone(), spare: [zeros.clone(), zeros] }
    }

    /// Guard and reference cells of one side.
    pub(super) fn half(&self) -> usize {
        self.guard + self.reference
    }

    /// From one row of a block to the next.
    pub(super) fn stride(&self) -> usize {
        self.ranges + self.half()
    }

    /// Reference cells that exist for a cell of a row.
    pub(super) fn reference_cells(&self, cell: usize) -> usize {
        let (before, after) = windows_of(cell, self.ranges, self.guard, self.reference);
        before + after
    }

    /// Values by range cell for a block of rows and a group more, `between` for the zeros between them.
    pub(super) fn in_block<T: Copy>(&self, of_row: &[T], between: T) -> Vec<T> {
        let mut values = vec![between; BLOCK_ROWS * self.stride() + GROUP];
        for row in values.chunks_exact_mut(self.stride()).take(BLOCK_ROWS) {
            row[..self.ranges].copy_from_slice(of_row);
        }
        values
    }

    /// Takes over a block of rows: its powers with all that their windows may reach, the first cell at [`Rows::half`], and how
    /// many cells there are from that on.
    pub(super) fn pad(&mut self, rows: &[f32]) -> (&[f32], usize) {
        assert_eq!(rows.len() % self.ranges, 0, "whole range profiles");
        let (half, stride) = (self.half(), self.stride());
        for (row, profile) in rows.chunks_exact(self.ranges).enumerate() {
            let start = half + row * stride;
            self.padded[start..start + self.ranges].copy_from_slice(profile);
        }
        (&self.padded, rows.len() / self.ranges * stride)
    }

    /// The same with sums of the windows.
    pub(super) fn sum(&mut self, rows: &[f32]) -> Windows<'_> {
        let (_, cells) = self.pad(rows);
        let half = self.half();
        let leading = half + self.guard + 1;
        window_sums(&self.padded[..half + cells + leading], self.reference, &mut self.window, &mut self.spare);
        Windows {
            powers: &self.padded[half..half + cells],
            lagging: &self.window[..cells],
            leading: &self.window[leading..leading + cells],
        }
    }
}

/// Reference cells before and after a cell of a row that exist.
pub(super) fn windows_of(cell: usize, ranges: usize, guard: usize, reference: usize) -> (usize, usize) {
    let before = cell.saturating_sub(guard).min(reference);
    let after = (ranges - 1 - cell).saturating_sub(guard).min(reference);
    (before, after)
}

/// `window[i]` = Σ `values[i .. i + cells]` wherever all of them exist; sums of powers of two are built by doubling, s₂ᵢ = sᵢ + sᵢ₊…,
/// twice in one pass where it can be. All terms are positive, so f32 loses at most a few units in the last place, which running
/// sums beside a strong target would not.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn window_sums(values: &[f32], cells: usize, window: &mut [f32], [sums, next]: &mut [Vec<f32>; 2]) {
    let window = &mut window[..values.len() + 1 - cells];
    let (mut rest, mut width, mut covered, mut length) = (cells, 1, 0, values.len());
    loop {
        let source = if width == 1 { values } else { &sums[..length] };
        if rest & 1 == 1 {
            add(&source[covered..], covered == 0, window);
            covered += width;
        }
        let factor = if rest & 0b110 == 0b100 { 4 } else { 2 };
        rest /= factor;
        if rest == 0 {
            return;
        }
        if rest == 1 && covered == 0 {
            return double(source, width, factor, window);
        }
        length -= (factor - 1) * width;
        double(source, width, factor, &mut next[..length]);
        std::mem::swap(sums, next);
        width *= factor;
    }
}

/// Adds a part of each window, the first of which begins it.
#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn add(parts: &[f32], is_first: bool, window: &mut [f32]) {
    if is_first {
        window.copy_from_slice(&parts[..window.len()]);
    } else {
        for (window, &part) in window.iter_mut().zip(parts) {
            *window += part;
        }
    }
}

/// Sums of `width` values to sums of twice as many or, where `factor` is 4, twice that.
#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn double(sums: &[f32], width: usize, factor: usize, doubled: &mut [f32]) {
    let part = |index: usize| &sums[index * width..][..doubled.len()];
    if factor == 2 {
        let (a, b) = (part(0), part(1));
        for ((doubled, &a), &b) in doubled.iter_mut().zip(a).zip(b) {
            *doubled = a + b;
        }
    } else {
        let (a, b, c, d) = (part(0), part(1), part(2), part(3));
        for ((doubled, (&a, &b)), (&c, &d)) in doubled.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
            *doubled = (a + b) + (c + d);
        }
    }
}
