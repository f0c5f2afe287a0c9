//! CA-CFAR along range (C3).
//!
//! ```text
//!   cell − half           cell           cell + half
//!      | reference | guard | CUT | guard | reference |
//! ```
//!
//! A cell is a hit when q > α(n) q̄, q̄ the mean power of the n reference cells that exist:
//! all of them in the middle of the range extent, fewer at its ends, so that the
//! probability of false alarm is the set one in every cell.

use common::amplitude::ca_cfar_factor;

/// A cell over threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the cell in its dwell.
    pub cell: u32,
    /// Power q in the cell.
    pub power: f32,
    /// Mean power q̄ of the reference cells.
    pub noise: f32,
}

/// Rows worked on together: their padded powers stay in the first-level cache.
const BLOCK_ROWS: usize = 8;

/// CA-CFAR detector for dwells whose rows are range profiles of one length.
#[derive(Debug, Clone)]
pub struct CaCfar {
    ranges: usize,
    guard: usize,
    reference: usize,
    /// α(n)/n by range cell: threshold = this times the sum of the reference cells.
    multipliers: Vec<f32>,
    /// `multipliers` for a block of padded rows; nothing exceeds the threshold of padding.
    block_multipliers: Vec<f32>,
    /// Powers of a block: `half` zeros, then each row followed by `half` zeros.
    padded: Vec<f32>,
    window: Vec<f32>,
    doubled: Vec<f32>,
    spare: Vec<f32>,
}

impl CaCfar {
    /// A detector over rows of `ranges` cells with `guard` and `reference` cells on each side.
    pub fn new(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        let half = guard + reference;
        let multipliers: Vec<f32> = (0..ranges)
            .map(|cell| {
                let cells = reference_cells(cell, ranges, guard, reference);
                if cells == 0 { f32::INFINITY } else { (ca_cfar_factor(cells as u32, pfa) / cells as f64) as f32 }
            })
            .collect();
        let length = half + BLOCK_ROWS * (ranges + half);
        let mut block_multipliers = vec![f32::INFINITY; length];
        for row in 0..BLOCK_ROWS {
            let start = half + row * (ranges + half);
            block_multipliers[start..start + ranges].copy_from_slice(&multipliers);
        }
        let zeros = vec![0.0; length + half + guard + 1];
        Self {
            ranges,
            guard,
            reference,
            multipliers,
            block_multipliers,
            padded: zeros.clone(),
            window: zeros.clone(),
            doubled: zeros.clone(),
            spare: zeros,
        }
    }

    /// Writes the power of every cell and appends the hits, by ascending cell. Returns
    /// false, with no hits, if an amplitude is NaN, infinite or negative.
    ///
    /// # Panics
    /// If `amplitudes` is not whole rows, or `powers` of another length.
    pub fn detect(&mut self, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        assert_eq!(amplitudes.len(), powers.len(), "one power per amplitude");
        assert_eq!(amplitudes.len() % self.ranges, 0, "whole range profiles");
        if !square(amplitudes, powers) {
            return false;
        }
        let half = self.guard + self.reference;
        let stride = self.ranges + half;
        let leading = half + self.guard + 1;
        for (block, rows) in powers.chunks(BLOCK_ROWS * self.ranges).enumerate() {
            let length = half + rows.len() / self.ranges * stride;
            for (row, profile) in rows.chunks_exact(self.ranges).enumerate() {
                let start = half + row * stride;
                self.padded[start..start + self.ranges].copy_from_slice(profile);
            }
            let work = Windows { doubled: &mut self.doubled, spare: &mut self.spare };
            window_sums(&self.padded, self.reference, &mut self.window, work, length + leading);
            let (lagging, leading) = (&self.window[..length - half], &self.window[leading..]);
            let thresholds = &self.block_multipliers[half..length];
            if !any_over(&self.padded[half..length], lagging, leading, thresholds) {
                continue;
            }
            for row in 0..rows.len() / self.ranges {
                for range in 0..self.ranges {
                    let place = row * stride + range;
                    let (power, sum) = (self.padded[half + place], lagging[place] + leading[place]);
                    if power > self.multipliers[range] * sum {
                        let cells = reference_cells(range, self.ranges, self.guard, self.reference);
                        let cell = (block * BLOCK_ROWS + row) * self.ranges + range;
                        hits.push(Hit { cell: cell as u32, power, noise: sum / cells as f32 });
                    }
                }
            }
        }
        true
    }
}

/// Reference cells that exist for a cell of a row.
fn reference_cells(cell: usize, ranges: usize, guard: usize, reference: usize) -> usize {
    let lagging = cell.saturating_sub(guard).min(reference);
    let leading = (ranges - 1 - cell).saturating_sub(guard).min(reference);
    lagging + leading
}

/// Squares amplitudes; false if one is NaN, infinite or negative. Non-negative finite
/// numbers are exactly those whose bits lie below those of infinity.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn square(amplitudes: &[f32], powers: &mut [f32]) -> bool {
    let mut largest = 0_u32;
    for (power, &amplitude) in powers.iter_mut().zip(amplitudes) {
        *power = amplitude * amplitude;
        largest = largest.max(amplitude.to_bits());
    }
    largest < f32::INFINITY.to_bits()
}

/// Scratch of [`window_sums`].
struct Windows<'a> {
    doubled: &'a mut [f32],
    spare: &'a mut [f32],
}

/// `window[i]` = Σ `values[i .. i + cells]`, for i < `length − cells`; sums of powers of two
/// are built by doubling: s₂ᵢ = sᵢ + sᵢ₊… All terms are positive, so f32 loses at most a few
/// units in the last place, which running sums beside a strong target would not.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn window_sums(values: &[f32], cells: usize, window: &mut [f32], work: Windows<'_>, length: usize) {
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

/// Whether any power exceeds its threshold.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn any_over(powers: &[f32], lagging: &[f32], leading: &[f32], multipliers: &[f32]) -> bool {
    let mut over = 0_u32;
    for (((&power, &lagging), &leading), &multiplier) in powers.iter().zip(lagging).zip(leading).zip(multipliers) {
        over += u32::from(power > multiplier * (lagging + leading));
    }
    over > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition, cell by cell, in double precision.
    fn detect_plain(amplitudes: &[f32], ranges: usize, guard: usize, reference: usize, pfa: f64) -> Vec<u32> {
        let mut hits = Vec::new();
        for (row, profile) in amplitudes.chunks(ranges).enumerate() {
            for cell in 0..ranges {
                let distance = |other: usize| other.abs_diff(cell);
                let near = |other: &usize| distance(*other) > guard && distance(*other) <= guard + reference;
                let cells: Vec<f64> = (0..ranges).filter(near).map(|other| f64::from(profile[other]).powi(2)).collect();
                if cells.is_empty() {
                    continue;
                }
                let mean = cells.iter().sum::<f64>() / cells.len() as f64;
                if f64::from(profile[cell]).powi(2) > ca_cfar_factor(cells.len() as u32, pfa) * mean {
                    hits.push((row * ranges + cell) as u32);
                }
            }
        }
        hits
    }

    proptest! {
        /// Amplitudes are whole numbers, so sums of squares are exact, and no threshold is met by chance.
        #[test]
        fn fast_path_equals_the_definition(
            rows in 1_usize..20,
            ranges in 1_usize..90,
            guard in 0_usize..5,
            reference in 1_usize..20,
            seed in any::<u64>(),
        ) {
            let mut state = seed | 1;
            let amplitudes: Vec<f32> = (0..rows * ranges).map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let draw = (state >> 33) % 97;
                if draw == 0 { 60.0 } else { (draw % 7) as f32 }
            }).collect();
            let mut cfar = CaCfar::new(ranges, guard, reference, 0.013_579);
            let (mut powers, mut hits) = (vec![0.0; amplitudes.len()], Vec::new());
            for _ in 0..2 { // the second time with used scratch
                hits.clear();
                prop_assert!(cfar.detect(&amplitudes, &mut powers, &mut hits));
            }
            let cells: Vec<u32> = hits.iter().map(|hit| hit.cell).collect();
            prop_assert_eq!(cells, detect_plain(&amplitudes, ranges, guard, reference, 0.013_579));
        }
    }

    #[test]
    fn impossible_amplitudes_are_refused() {
        for bad in [f32::NAN, f32::INFINITY, -1.0, -f32::NAN] {
            let mut amplitudes = vec![1.0; 140];
            amplitudes[77] = bad;
            let (mut powers, mut hits) = (vec![0.0; 140], Vec::new());
            assert!(!CaCfar::new(70, 2, 16, 1e-3).detect(&amplitudes, &mut powers, &mut hits), "{bad}");
            assert!(hits.is_empty());
        }
    }
}
