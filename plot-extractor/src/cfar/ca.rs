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
//!
//! A **hull**, a target longer than the guard, would mask itself: its own cells are the reference of its others. Its ends
//! give it away, because one of the two windows of a cell there is free of it:
//!
//! ```text
//!   | reference | guard | edge ▒▒▒▒▒▒▒▒▒ hull ▒▒▒▒▒▒▒▒▒ last | guard | reference |
//! ```
//!
//! A hull begins where the stronger window of a cell has so much more power than the weaker one, or the cell itself more
//! than its weaker window allows (and the stronger one twice as much), that noise does it a thousand times more rarely than it
//! exceeds the threshold: what follows adds nothing to the probability of false alarm. From there the hull
//! reaches to the first cell whose outer window is free again (at most twice the power of the first). Its cells are
//! tested against the two free windows: the same test with a guard that has grown to the size of the target. Land, which has
//! no second free window within [`LONGEST_HULL`] cells, is left to the simple test. Between the outermost hits of a hull
//! a quarter of the threshold is enough, and gaps no longer than the guard are filled, so that fading does not break it up.

use std::ops::Range;

use common::amplitude::ca_cfar_factor;

use super::Hit;
use super::rows::{Rows, each_block, windows_of};

/// No hull is longer, cells.
pub const LONGEST_HULL: usize = 128;
/// Hulls begin at cells whose probability of false alarm is this part of the set one.
const RARE: f64 = 1e-3;
/// A window is free if it has at most so many times the power of another one.
const FREE: f32 = 2.0;
/// Part of the threshold that is enough inside a hull.
const INSIDE: f32 = 0.25;

/// CA-CFAR detector for dwells whose rows are range profiles of one length.
#[derive(Debug, Clone)]
pub struct CaCfar {
    rows: Rows,
    /// α(n)/n by range cell: threshold = this times the sum of the reference cells.
    multipliers: Vec<f32>,
    /// `multipliers` for a block of padded rows; nothing exceeds the threshold of padding.
    block_multipliers: Vec<f32>,
    /// α of one window over its cells.
    edge: f32,
    /// `edge` for a block of padded rows; infinite where a window is not whole.
    edge_multipliers: Vec<f32>,
    /// The stronger window has so many times the power of the weaker one where a hull begins.
    contrast: f32,
    /// Hulls of a row: first cell, last cell, sum of the free windows.
    hulls: Vec<(usize, usize, f32)>,
}

impl CaCfar {
    /// A detector over rows of `ranges` cells with `guard` and `reference` cells on each side.
    pub fn new(ranges: usize, guard: usize, reference: usize, pfa: f64) -> Self {
        let rows = Rows::new(ranges, guard, reference);
        let multipliers: Vec<f32> = (0..ranges)
            .map(|cell| {
                let cells = rows.reference_cells(cell);
                if cells == 0 { f32::INFINITY } else { (ca_cfar_factor(cells as u32, pfa) / cells as f64) as f32 }
            })
            .collect();
        let edge = (ca_cfar_factor(reference as u32, RARE * pfa) / reference as f64) as f32;
        let mut edges = vec![f32::INFINITY; ranges];
        if ranges > 2 * rows.half() {
            edges[rows.half()..ranges - rows.half()].fill(edge);
        }
        Self {
            block_multipliers: rows.in_block(&multipliers, f32::INFINITY),
            edge_multipliers: rows.in_block(&edges, f32::INFINITY),
            rows,
            multipliers,
            edge,
            contrast: contrast(reference as u32, RARE * pfa) as f32,
            hulls: Vec::new(),
        }
    }

    /// Writes the power of every cell and appends the hits, by ascending cell. Returns
    /// false, with no hits and powers without meaning, if an amplitude is NaN, infinite or negative.
    ///
    /// # Panics
    /// If `amplitudes` is not whole rows, or `powers` of another length.
    pub fn detect(&mut self, amplitudes: &[f32], powers: &mut [f32], hits: &mut Vec<Hit>) -> bool {
        let (ranges, guard, reference, stride) =
            (self.rows.ranges, self.rows.guard, self.rows.reference, self.rows.stride());
        each_block(ranges, amplitudes, powers, hits, |first_row, rows, hits| {
            let windows = self.rows.sum(rows);
            let length = windows.powers.len();
            let (thresholds, edges) = (&self.block_multipliers[..length], &self.edge_multipliers[..length]);
            if !any_over(windows.powers, windows.lagging, windows.leading, thresholds, (edges, self.contrast)) {
                return;
            }
            for row in 0..rows.len() / ranges {
                let of_row = row * stride..row * stride + ranges;
                let row = Row {
                    powers: &windows.powers[of_row.clone()],
                    lagging: &windows.lagging[of_row.clone()],
                    leading: &windows.leading[of_row],
                    multipliers: &self.multipliers,
                    edge: self.edge,
                    contrast: self.contrast,
                    guard,
                    reference,
                    first_cell: (first_row + row) * ranges,
                };
                row.find_hulls(&mut self.hulls);
                row.detect(&self.hulls, hits);
            }
        })
    }
}

/// A range profile with its windows.
struct Row<'a> {
    powers: &'a [f32],
    lagging: &'a [f32],
    leading: &'a [f32],
    multipliers: &'a [f32],
    /// α of one whole window over its cells.
    edge: f32,
    contrast: f32,
    guard: usize,
    reference: usize,
    first_cell: usize,
}

impl Row<'_> {
    /// Replaces `hulls` by those of the row, in order.
    fn find_hulls(&self, hulls: &mut Vec<(usize, usize, f32)>) {
        hulls.clear();
        let half = self.guard + self.reference;
        let mut next = half;
        while next + half < self.powers.len() {
            let cell = next;
            next += 1;
            let (lagging, leading) = (self.lagging[cell], self.leading[cell]);
            let (weaker, stronger) = (lagging.min(leading), lagging.max(leading));
            let is_strong = self.powers[cell] > self.edge * weaker && stronger > FREE * weaker;
            if weaker <= 0.0 || !(is_strong || stronger > self.contrast * weaker) {
                continue;
            }
            // The free window is on the near side of a near edge, on the far side of a far one.
            let longest = LONGEST_HULL.min(self.powers.len());
            let other = if lagging < leading {
                (cell + 1..(cell + longest).min(self.powers.len() - half))
                    .find(|&far| self.leading[far] <= FREE * lagging)
            } else {
                (half.max((cell + 1).saturating_sub(longest))..cell)
                    .rev()
                    .find(|&near| self.lagging[near] <= FREE * leading)
            };
            let Some(other) = other else { continue };
            let (near, far) = (cell.min(other), cell.max(other));
            let (first, last) = (near - self.guard, far + self.guard);
            if hulls.last().is_none_or(|&(_, before, _)| before < first) {
                hulls.push((first, last, self.lagging[near] + self.leading[far]));
            }
            next = next.max(last + 1);
        }
    }

    /// Appends the hits of the row, by ascending cell.
    fn detect(&self, hulls: &[(usize, usize, f32)], hits: &mut Vec<Hit>) {
        let mut done = 0;
        for &(first, last, sum) in hulls {
            self.test(done..first, hits);
            let threshold = self.multipliers[self.powers.len() / 2] * sum;
            let noise = sum / (2 * self.reference) as f32;
            let over = |cell: &usize| self.powers[*cell] > threshold;
            if let (Some(near), Some(far)) = ((first..=last).find(over), (first..=last).rev().find(over)) {
                let mut last = near;
                for cell in (near..=far).filter(|&cell| self.powers[cell] > INSIDE * threshold) {
                    let from = if cell - last <= self.guard + 1 { (last + 1).min(cell) } else { cell };
                    hits.extend((from..=cell).map(|cell| self.hit(cell, noise)));
                    last = cell;
                }
            }
            done = last + 1;
        }
        self.test(done..self.powers.len(), hits);
    }

    /// The simple test.
    fn test(&self, cells: Range<usize>, hits: &mut Vec<Hit>) {
        for cell in cells {
            let sum = self.lagging[cell] + self.leading[cell];
            if self.powers[cell] > self.multipliers[cell] * sum {
                let (before, after) = windows_of(cell, self.powers.len(), self.guard, self.reference);
                hits.push(self.hit(cell, sum / (before + after) as f32));
            }
        }
    }

    fn hit(&self, cell: usize, noise: f32) -> Hit {
        Hit { cell: (self.first_cell + cell) as u32, power: self.powers[cell], noise }
    }
}

/// Ratio of the powers of two windows of `cells` cells of noise that the larger exceeds with the probability `rare`:
/// ```text
/// ½ rare = Σ C(n + k − 1, k) Rᵏ/(1 + R)ⁿ⁺ᵏ,  k = 0 … n − 1
/// ```
/// (of the n-th and later of events of two kinds, equally frequent: a negative binomial distribution).
fn contrast(cells: u32, rare: f64) -> f64 {
    let n = f64::from(cells);
    let probability = |ratio: f64| {
        let mut term = (1.0 + ratio).powf(-n);
        let mut sum = 0.0;
        for k in 0..cells {
            sum += term;
            term *= (n + f64::from(k)) / f64::from(k + 1) * ratio / (1.0 + ratio);
        }
        2.0 * sum
    };
    let (mut low, mut high) = (1.0_f64, 1e12_f64);
    for _ in 0..100 {
        let middle = (low * high).sqrt();
        if probability(middle) > rare { low = middle } else { high = middle }
    }
    high
}

/// Whether any power exceeds its threshold, or a hull may begin: a power exceeds by its weaker window alone that of an edge, or
/// one window the other.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn any_over(
    powers: &[f32],
    lagging: &[f32],
    leading: &[f32],
    multipliers: &[f32],
    (edges, contrast): (&[f32], f32),
) -> bool {
    let mut over = 0_u32;
    let windows = lagging.iter().zip(leading);
    for (((&power, (&lagging, &leading)), &multiplier), &edge) in powers.iter().zip(windows).zip(multipliers).zip(edges)
    {
        let weaker = lagging.min(leading);
        let is_edge = (power > edge * weaker) | (edge < f32::INFINITY) & (lagging.max(leading) > contrast * weaker);
        over |= u32::from(power > multiplier * (lagging + leading)) | u32::from(is_edge);
    }
    over > 0
}

#[cfg(test)]
mod tests {
    use std::ops::RangeInclusive;

    use super::*;
    use common::random::{Purpose, generator};
    use proptest::prelude::*;
    use rand::RngExt;

    /// The definition, cell by cell, in double precision.
    fn detect_plain(amplitudes: &[f32], ranges: usize, guard: usize, reference: usize, pfa: f64) -> Vec<u32> {
        let mut hits = Vec::new();
        for (row, profile) in amplitudes.chunks(ranges).enumerate() {
            let power = |cell: usize| f64::from(profile[cell]).powi(2);
            let before = |cell: usize| cell.saturating_sub(guard + reference)..cell.saturating_sub(guard);
            let after = |cell: usize| (cell + guard + 1).min(ranges)..(cell + guard + reference + 1).min(ranges);
            let sum = |cells: Range<usize>| cells.map(power).sum::<f64>();
            let factor = |cells: usize, pfa: f64| ca_cfar_factor(cells as u32, pfa) / cells as f64;
            let mut hulls: Vec<(usize, usize, f64)> = Vec::new();
            let half = guard + reference;
            let mut from = half;
            for cell in half..ranges.saturating_sub(half) {
                let (lagging, leading) = (sum(before(cell)), sum(after(cell)));
                let (weaker, stronger) = (lagging.min(leading), lagging.max(leading));
                let threshold = factor(reference, RARE * pfa) * weaker;
                let is_strong = power(cell) > threshold && stronger > 2.0 * weaker;
                let contrast = contrast(reference as u32, RARE * pfa) * weaker;
                if cell < from || weaker <= 0.0 || !(is_strong || stronger > contrast) {
                    continue;
                }
                let within = |other: &usize| *other != cell && other.abs_diff(cell) < LONGEST_HULL;
                let mut others = (half..ranges - half).filter(within);
                let other = if lagging < leading {
                    others.find(|&other| other > cell && sum(after(other)) <= 2.0 * lagging)
                } else {
                    others.rfind(|&other| other < cell && sum(before(other)) <= 2.0 * leading)
                };
                let Some(other) = other else { continue };
                let (near, far) = (cell.min(other), cell.max(other));
                let (first, last) = (near - guard, far + guard);
                if hulls.last().is_none_or(|hull| hull.1 < first) {
                    hulls.push((first, last, sum(before(near)) + sum(after(far))));
                }
                from = last + 1;
            }
            for cell in 0..ranges {
                let is_hit = if let Some(&(first, last, sum)) = hulls.iter().find(|it| (it.0..=it.1).contains(&cell)) {
                    let threshold = factor(2 * reference, pfa) * sum;
                    let over = |mut cells: RangeInclusive<usize>| cells.any(|cell| power(cell) > threshold);
                    let inside =
                        |cell: &usize| power(*cell) > 0.25 * threshold && over(first..=*cell) && over(*cell..=last);
                    let (before, after) = ((first..=cell).rev().find(inside), (cell..=last).find(inside));
                    before.zip(after).is_some_and(|(before, after)| after - before <= guard + 1)
                } else {
                    let cells = before(cell).len() + after(cell).len();
                    cells > 0 && power(cell) > factor(cells, pfa) * (sum(before(cell)) + sum(after(cell)))
                };
                if is_hit {
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
            ranges in 1_usize..120,
            guard in 0_usize..5,
            reference in 1_usize..20,
            hull in 0_usize..70,
            seed in any::<u64>(),
        ) {
            let mut state = seed | 1;
            let mut amplitudes: Vec<f32> = (0..rows * ranges).map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let draw = (state >> 33) % 97;
                if draw == 0 { 60.0 } else { (draw % 7) as f32 }
            }).collect();
            let begin = seed as usize % ranges;
            amplitudes[begin..(begin + hull).min(ranges)].fill(99.0);
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

    /// Hulls of any length at any place with both windows free: every cell of them is a hit, and no other.
    #[test]
    fn a_hull_does_not_mask_itself() {
        for length in 1..=80 {
            for begin in [20, 57, 100] {
                let mut amplitudes = vec![1.0; 200];
                amplitudes[begin..begin + length].fill(10.0);
                let (mut powers, mut hits) = (vec![0.0; 200], Vec::new());
                assert!(CaCfar::new(200, 2, 16, 1e-6).detect(&amplitudes, &mut powers, &mut hits));
                let cells: Vec<usize> = hits.iter().map(|hit| hit.cell as usize).collect();
                assert_eq!(cells, (begin..begin + length).collect::<Vec<_>>());
                assert!(hits.iter().all(|hit| hit.noise < 2.0), "{length}: {hits:?}");
            }
        }
    }

    /// Drawn windows exceed the contrast as often as they should.
    #[test]
    fn windows_of_noise_rarely_differ() {
        let mut rng = generator(1, Purpose::Test, 0, 0);
        let ratio = contrast(4, 0.01);
        let mut sum = || (0..4).map(|_| -f64::ln(1.0 - rng.random::<f64>())).sum::<f64>();
        let exceeded = (0..100_000)
            .filter(|_| {
                let (a, b) = (sum(), sum());
                a.max(b) > ratio * a.min(b)
            })
            .count();
        assert!((900..1100).contains(&exceeded), "{exceeded}");
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
