//! GO- and SO-CFAR along range: the greater or the smaller one of the means of the two windows (C9), (C10).
//!
//! At the edge of clutter, half of the reference cells of a cell in the clutter lie outside: their mean is too small, and CA-CFAR
//! takes clutter for targets. The greater mean is that of the clutter alone. A second target in one window raises the mean; the
//! smaller one is free of it.

use common::amplitude::NoiseEstimate;

use super::Hit;
use super::rows::{Rows, each_block, windows_of};

/// GO- or SO-CFAR detector for dwells whose rows are range profiles of one length.
#[derive(Debug, Clone)]
pub struct GoSoCfar {
    rows: Rows,
    greater: bool,
    /// α/n₁ and α/n₂ for a block of rows, n the cells of the windows before and after a cell. A window
    /// without cells decides nothing: its multiplier is 0 in GO-CFAR. In SO-CFAR, and where both are empty, it is infinite, which
    /// times the sum 0 is NaN: no power exceeds it, and neither `max` nor `min` takes it.
    lagging: Vec<f32>,
    leading: Vec<f32>,
    /// Threshold over estimate of unit mean, by range cell.
    factors: Vec<f32>,
}

impl GoSoCfar {
    /// GO-CFAR over rows of `ranges` cells with `guard` and `reference` cells on each side.
    pub fn greater(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        Self::new(ranges, guard, reference, pfa, true)
    }

    /// The same, SO-CFAR.
    pub fn smaller(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        Self::new(ranges, guard, reference, pfa, false)
    }

    fn new(ranges: usize, guard: usize, reference: usize, pfa: f64, greater: bool) -> Self {
        let rows = Rows::new(ranges, guard, reference);
        let (mut lagging, mut leading, mut factors) = (Vec::new(), Vec::new(), Vec::new());
        let (mut of, mut factor, mut mean) = (None, 0.0, 1.0);
        for cell in 0..ranges {
            let (before, after) = windows_of(cell, ranges, guard, reference);
            if of != Some((before, after)) {
                let (before, after) = (before as u32, after as u32);
                let noise =
                    if greater { NoiseEstimate::Greater(before, after) } else { NoiseEstimate::Smaller(before, after) };
                (factor, mean) = (noise.factor(pfa), noise.mean());
                of = Some((before as usize, after as usize));
            }
            let multiplier = |cells: usize| match (cells, before + after) {
                (0, 1..) if greater => 0.0,
                (0, _) => f32::INFINITY,
                _ => (factor / mean / cells as f64) as f32,
            };
            lagging.push(multiplier(before));
            leading.push(multiplier(after));
            factors.push(factor as f32);
        }
        Self {
            lagging: rows.in_block(&lagging, f32::INFINITY),
            leading: rows.in_block(&leading, f32::INFINITY),
            rows,
            greater,
            factors,
        }
    }

    /// As [`super::Detector::detect`].
    ///
    /// # Panics
    /// If `amplitudes` is not whole rows, or `powers` of another length.
    pub fn detect(&mut self, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        let (ranges, stride) = (self.rows.ranges, self.rows.stride());
        each_block(ranges, amplitudes, powers, hits, |first_row, rows, hits| {
            let windows = self.rows.sum(rows);
            let factors = (&self.lagging[..windows.powers.len()], &self.leading[..windows.powers.len()]);
            if !any_over(windows.powers, (windows.lagging, windows.leading), factors, self.greater) {
                return;
            }
            for row in 0..rows.len() / ranges {
                for (range, &factor) in self.factors.iter().enumerate() {
                    let cell = row * stride + range;
                    let (power, lagging, leading) = (
                        windows.powers[cell],
                        factors.0[cell] * windows.lagging[cell],
                        factors.1[cell] * windows.leading[cell],
                    );
                    let threshold = if self.greater { lagging.max(leading) } else { lagging.min(leading) };
                    if power > threshold {
                        let cell = ((first_row + row) * ranges + range) as u32;
                        hits.push(Hit { cell, power, noise: threshold / factor });
                    }
                }
            }
        })
    }
}

/// Whether any power exceeds its threshold: both that of the one window and that of the other (GO), or one of them (SO). One that is
/// NaN decides nothing.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn any_over(powers: &[f32], sums: (&[f32], &[f32]), factors: (&[f32], &[f32]), greater: bool) -> bool {
    if greater { any(powers, sums, factors, |a, b| a & b) } else { any(powers, sums, factors, |a, b| a | b) }
}

#[expect(clippy::inline_always, reason = "compiled for the instructions of its caller")]
#[inline(always)]
fn any(powers: &[f32], sums: (&[f32], &[f32]), factors: (&[f32], &[f32]), is_over: impl Fn(u32, u32) -> u32) -> bool {
    let mut over = 0;
    let lagging = sums.0.iter().zip(factors.0);
    let leading = sums.1.iter().zip(factors.1);
    for ((&power, (&before, &a)), (&after, &b)) in powers.iter().zip(lagging).zip(leading) {
        over |= is_over(u32::from(power > a * before), u32::from(power > b * after));
    }
    over > 0
}
