//! Range profiles side by side with zeros between them, and the sums of their reference windows.

/// Rows worked on together: their padded powers stay in the first-level cache.
pub(super) const BLOCK_ROWS: usize = 8;

/// Rows of one length, in blocks.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    pub(super) ranges: usize,
    pub(super) guard: usize,
    pub(super) reference: usize,
    /// Powers of a block: `half` zeros, then each row followed by `half` zeros.
    padded: Vec<f32>,
    window: Vec<f32>,
    doubled: Vec<f32>,
    spare: Vec<f32>,
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
        let zeros = vec![0.0; length + half + guard + 1];
        Self {
            ranges,
            guard,
            reference,
            padded: zeros.clone(),
            window: zeros.clone(),
            doubled: zeros.clone(),
            spare: zeros,
        }
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

    /// Values by range cell for a block of rows; infinite for the zeros between them.
    pub(super) fn in_block(&self, of_row: &[f32]) -> Vec<f32> {
        let mut values = vec![f32::INFINITY; BLOCK_ROWS * self.stride()];
        for row in values.chunks_mut(self.stride()) {
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
        let work = Spare { doubled: &mut self.doubled, spare: &mut self.spare };
        window_sums(&self.padded, self.reference, &mut self.window, work, half + cells + leading);
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

/// Scratch of [`window_sums`].
struct Spare<'a> {
    doubled: &'a mut [f32],
    spare: &'a mut [f32],
}

/// `window[i]` = Σ `values[i .. i + cells]`, for i < `length − cells`; sums of powers of two
/// are built by doubling: s₂ᵢ = sᵢ + sᵢ₊… All terms are positive, so f32 loses at most a few
/// units in the last place, which running sums beside a strong target would not.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn window_sums(values: &[f32], cells: usize, window: &mut [f32], work: Spare<'_>, length: usize) {
    let length = length.min(values.len()).min(window.len());
    let (mut sums, mut next) = (work.doubled, work.spare);
    let window = &mut window[..length];
    sums[..length].copy_from_slice(&values[..length]);
    let (mut rest, mut width, mut covered) = (cells, 1, 0);
    loop {
        if rest & 1 == 1 {
            let part = &sums[covered..length];
            if covered == 0 {
                window.copy_from_slice(part);
            } else {
                for (window, &part) in window.iter_mut().zip(part) {
                    *window += part;
                }
            }
            covered += width;
        }
        rest >>= 1;
        if rest == 0 {
            return;
        }
        let (near, far) = (&sums[..length - width], &sums[width..length]);
        for ((next, &near), &far) in next.iter_mut().zip(near).zip(far) {
            *next = near + far;
        }
        next[length - width..length].copy_from_slice(&sums[length - width..length]);
        std::mem::swap(&mut sums, &mut next);
        width *= 2;
    }
}
