//! Estimates of the noise power by CFAR detectors, and how they are distributed (C8)-(C12).
//!
//! A detector compares the power of a cell with an estimate g of the noise power, here divided by its mean, so that E g = 1. All that
//! detection needs of g is its Laplace transform and two derivatives:
//!
//! ```text
//! M(s) = E e^(−sg),   A = −M'/M,   B = (ln M)''                                                (C8)
//! P(q > t) = M(t) in noise,   factor: M(t₀) = F
//! ```
//!
//! | estimate | g before division by its mean | M |
//! |---|---|---|
//! | known | 1 | e^(−s) |
//! | CA | mean of N cells | (1 + s/N)^(−N) (C3) |
//! | GO, SO | greater, smaller one of the means of two windows | a mixture of Γ powers (C9), (C10) |
//! | OS | k-th smallest of N cells | Π (N − i)/(N − i + s), i = 0 … k − 1 (C11) |
//! | clutter map | average with weights w_j over scans | Π 1/(1 + s w_j) (C12) |
//!
//! Derivation: `docs/theory/amplitude.md`.

use crate::plots::PlotsHeader;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a detector estimates the noise power of a cell.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[repr(u32)]
pub enum Cfar {
    /// Mean of the reference cells on both sides.
    #[default]
    Ca,
    /// Greater one of the means of the two sides: few false alarms at the edges of clutter.
    Go,
    /// Smaller one of the means of the two sides: targets beside other targets.
    So,
    /// Ordered statistic: three quarters of the reference cells are weaker. Others of the cells may hold targets.
    Os,
    /// Average of the cell itself over the scans before: what stands still disappears.
    ClutterMap,
}

impl Cfar {
    const ALL: [Self; 5] = [Self::Ca, Self::Go, Self::So, Self::Os, Self::ClutterMap];

    /// From its number in [`crate::plots::PlotsHeader::cfar`].
    pub fn of(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|&it| it as u32 == number)
    }
}

/// An estimate of the noise power of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseEstimate {
    /// Not estimated but known.
    Known,
    /// Mean of so many cells.
    Mean(u32),
    /// Greater one of the means of two windows of so many cells each.
    Greater(u32, u32),
    /// Smaller one of the means of two windows of so many cells each.
    Smaller(u32, u32),
    /// [`rank`] of so many cells.
    Ordered(u32),
    /// Average over scans: see [`MapMemory`].
    Averaged {
        /// A lasting average varies as the mean of so many scans does.
        memory: u32,
        /// Scans so far; `u32::MAX` for a lasting average.
        scans: u32,
    },
}

/// Which one of `cells` cells by ascending power OS-CFAR takes: k = ⌈¾ N⌉, as Rohling proposes.
pub fn rank(cells: u32) -> u32 {
    (3 * cells).div_ceil(4)
}

/// Weights of scans in a clutter map: the mean of all scans until the newest one would weigh less than w = 2/(N + 1), and w from
/// there on. The variance of such an average is 1/N of a cell's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapMemory {
    /// w.
    pub weight: f64,
}

impl MapMemory {
    /// Of an average that varies as the mean of `scans` scans.
    pub fn new(scans: u32) -> Self {
        Self { weight: 2.0 / (f64::from(scans.max(1)) + 1.0) }
    }

    /// Weight of the scan number `scan`, counted from 1.
    pub fn weight_of(self, scan: u32) -> f64 {
        (1.0 / f64::from(scan.max(1))).max(self.weight)
    }

    /// Scans whose plain mean begins the average.
    fn plain(self) -> u32 {
        (1.0 / self.weight).floor().max(1.0) as u32
    }
}

/// M and its derivatives at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    /// ln M.
    pub(super) ln_m: f64,
    /// A = −M'/M.
    pub(super) a: f64,
    /// B = (ln M)'' = M''/M − A².
    pub(super) b: f64,
}

/// No message has more reference cells, of other kinds than CA-CFAR.
const MOST_CELLS: u32 = 1024;
/// Factors of a product below this one are taken together as a power series.
const SMALL: f64 = 1e-3;
/// Terms of a mixture below this part of their sum are left out.
const NEGLIGIBLE: f64 = 1e-17;

impl NoiseEstimate {
    /// That of a detector with N reference cells, or N scans of memory, in its steady state; N = 0 stands for known noise.
    pub fn new(cfar: Cfar, cells: u32) -> Self {
        match cfar {
            _ if cells == 0 => Self::Known,
            Cfar::Ca => Self::Mean(cells),
            Cfar::Go => Self::Greater(cells.div_ceil(2), cells / 2),
            Cfar::So => Self::Smaller(cells.div_ceil(2), cells / 2),
            Cfar::Os => Self::Ordered(cells),
            Cfar::ClutterMap => Self::Averaged { memory: cells, scans: u32::MAX },
        }
    }

    /// That of the detector of a message; none if its kind is not known, or has more cells than any detector.
    pub fn of(header: &PlotsHeader) -> Option<Self> {
        let cfar = Cfar::of(header.cfar).filter(|&cfar| cfar == Cfar::Ca || header.reference_cells <= MOST_CELLS)?;
        Some(Self::new(cfar, header.reference_cells))
    }

    /// E g before division by it: what the estimate gives in noise of power 1.
    pub fn mean(self) -> f64 {
        match self {
            Self::Known | Self::Mean(_) | Self::Averaged { .. } => 1.0,
            Self::Greater(..) | Self::Smaller(..) | Self::Ordered(_) => self.raw(0.0).a,
        }
    }

    /// t with P(q > t) = `probability` in noise; infinite without any cell to estimate from. Over [`NoiseEstimate::mean`], it is what
    /// a detector multiplies an estimate by that has not been divided by its mean.
    ///
    /// # Panics
    /// Unless `probability` lies between 0 and 1, both excluded.
    pub fn factor(self, probability: f64) -> f64 {
        if let Self::Known | Self::Mean(_) = self {
            let cells = if let Self::Mean(cells) = self { cells } else { 0 };
            return super::ca_cfar_factor(cells, probability);
        }
        assert!(probability > 0.0 && probability < 1.0, "probability {probability} is not between 0 and 1");
        if self.is_empty() {
            return f64::INFINITY;
        }
        // ln M is convex and falls: steps of Newton's approach its root from the left, and none goes beyond it.
        let (ln_f, mean) = (probability.ln(), self.mean());
        let mut s = 0.0;
        for _ in 0..200 {
            let at = self.raw(s);
            let step = (at.ln_m - ln_f) / at.a;
            s += step;
            if step <= 1e-14 * s {
                break;
            }
        }
        s * mean
    }

    /// Cells whose mean varies as much: 1/var g.
    pub fn equivalent_cells(self) -> f64 {
        let at = self.raw(0.0);
        if at.b > 0.0 { at.a * at.a / at.b } else { f64::INFINITY }
    }

    /// P(q > t) in noise.
    pub fn survival(self, t: f64) -> f64 {
        self.transform(t).ln_m.exp()
    }

    fn is_empty(self) -> bool {
        matches!(self, Self::Mean(0) | Self::Greater(0, 0) | Self::Smaller(0, 0) | Self::Ordered(0))
            || matches!(self, Self::Averaged { scans: 0, .. })
    }

    /// (C8), of g with mean 1.
    pub(super) fn transform(self, s: f64) -> Transform {
        let mean = self.mean();
        let raw = self.raw(s / mean);
        Transform { ln_m: raw.ln_m, a: raw.a / mean, b: raw.b / (mean * mean) }
    }

    /// (C8), of g as it is.
    fn raw(self, s: f64) -> Transform {
        match self {
            Self::Known => Transform { ln_m: -s, a: 1.0, b: 0.0 },
            Self::Greater(cells, 0)
            | Self::Greater(0, cells)
            | Self::Smaller(cells, 0)
            | Self::Smaller(0, cells)
            | Self::Mean(cells) => mean_of(cells, s),
            Self::Greater(near, far) => mixture(f64::from(near), f64::from(far), s, true),
            Self::Smaller(near, far) => mixture(f64::from(near), f64::from(far), s, false),
            Self::Ordered(cells) => {
                let mut product = Product::default();
                (0..rank(cells)).for_each(|i| product.factor(1.0 / f64::from(cells - i), s));
                product.result()
            }
            Self::Averaged { memory, scans } => averaged(MapMemory::new(memory), scans, s),
        }
    }
}

/// Mean of `cells` cells (C3).
fn mean_of(cells: u32, s: f64) -> Transform {
    let n = f64::from(cells);
    Transform { ln_m: -n * (s / n).ln_1p(), a: n / (n + s), b: n / (n + s).powi(2) }
}

/// The greater or the smaller one of the means of windows of n₁ and n₂ cells: a mixture of Γ powers.
///
/// ```text
/// M(s) = Σ_k C(n₁+k−1, k) φ₁^n₁ φ₂^k u^(n₁+k) + the same with 1 and 2 exchanged                (C9), (C10)
/// φ_i = n_i/(n₁+n₂),  u = 1/(1 + s/(n₁+n₂));   k ≥ n₂ for the greater one, k < n₂ for the smaller one
/// ```
fn mixture(n1: f64, n2: f64, s: f64, greater: bool) -> Transform {
    let rate = n1 + n2 + s;
    // Σ, Σ m and Σ m (m + 1) over the terms, m = n + k, relative to the largest power of e among them.
    let mut sums = [0.0; 3];
    let mut scale = f64::NEG_INFINITY;
    for (n, other) in [(n1, n2), (n2, n1)] {
        let (own, step) = (n / rate, other / rate);
        let mut k = if greater { other } else { 0.0 };
        let ln_term = if greater {
            libm::lgamma(n + k) - libm::lgamma(n) - libm::lgamma(k + 1.0) + n * own.ln() + k * step.ln()
        } else {
            n * own.ln()
        };
        let rescaled = if scale > ln_term { 1.0 } else { (scale - ln_term).exp() };
        sums = sums.map(|sum| sum * rescaled);
        scale = scale.max(ln_term);
        let mut term = (ln_term - scale).exp();
        while greater || k < other {
            let m = n + k;
            sums[0] += term;
            sums[1] += m * term;
            sums[2] += m * (m + 1.0) * term;
            let growth = step * m / (k + 1.0);
            if greater && growth < 1.0 && term < NEGLIGIBLE * (1.0 - growth) * sums[0] {
                break;
            }
            term *= growth;
            k += 1.0;
        }
    }
    let (first, second) = (sums[1] / sums[0], sums[2] / sums[0]);
    Transform { ln_m: scale + sums[0].ln(), a: first / rate, b: (second - first * first).max(0.0) / (rate * rate) }
}

/// Average over scans (C12).
fn averaged(memory: MapMemory, scans: u32, s: f64) -> Transform {
    let (w, keep) = (memory.weight, 1.0 - memory.weight);
    let plain = memory.plain().min(scans.max(1));
    let mut product = Product::default();
    let mut weight = w;
    for _ in 0..scans - plain.min(scans) {
        if s * weight < SMALL && scans == u32::MAX {
            // The rest: Σ_j ln(1 + s w_j) with w_j = v r^j as a series in s v.
            let v = weight;
            let power = |m: i32| v.powi(m) / (1.0 - keep.powi(m));
            product.ln +=
                s * power(1) - s * s / 2.0 * power(2) + s.powi(3) / 3.0 * power(3) - s.powi(4) / 4.0 * power(4);
            product.a += power(1) - s * power(2) + s * s * power(3) - s.powi(3) * power(4);
            product.b += power(2) - 2.0 * s * power(3) + 3.0 * s * s * power(4);
            return product.result();
        }
        product.factor(weight, s);
        weight *= keep;
    }
    // What is left of the plain mean that began it.
    let share = weight / w / f64::from(plain);
    for _ in 0..plain {
        product.factor(share, s);
    }
    product.result()
}

/// Π 1/(1 + s w_j) over exponential powers of means w_j.
#[derive(Debug)]
struct Product {
    /// Σ ln(1 + s w_j) of factors that are done.
    ln: f64,
    /// Those of which the logarithm is still to be taken.
    pending: f64,
    a: f64,
    b: f64,
}

impl Default for Product {
    fn default() -> Self {
        Self { ln: 0.0, pending: 1.0, a: 0.0, b: 0.0 }
    }
}

impl Product {
    fn factor(&mut self, weight: f64, s: f64) {
        let x = s * weight;
        let rate = weight / (1.0 + x);
        self.a += rate;
        self.b += rate * rate;
        if x < SMALL {
            self.ln += x.ln_1p();
            return;
        }
        self.pending *= 1.0 + x;
        if self.pending > 1e200 {
            self.ln += self.pending.ln();
            self.pending = 1.0;
        }
    }

    fn result(self) -> Transform {
        Transform { ln_m: -(self.ln + self.pending.ln()), a: self.a, b: self.b }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, generator};
    use approx::assert_relative_eq;
    use proptest::prelude::*;
    use rand::RngExt;

    const ALL: [NoiseEstimate; 8] = [
        NoiseEstimate::Mean(16),
        NoiseEstimate::Greater(16, 16),
        NoiseEstimate::Greater(16, 3),
        NoiseEstimate::Smaller(16, 16),
        NoiseEstimate::Smaller(5, 16),
        NoiseEstimate::Ordered(32),
        NoiseEstimate::Averaged { memory: 32, scans: u32::MAX },
        NoiseEstimate::Averaged { memory: 8, scans: 3 },
    ];

    /// One draw of g, by its definition.
    fn draw(estimate: NoiseEstimate, power: &mut impl FnMut() -> f64) -> f64 {
        let mut mean = |cells: u32| (0..cells).map(|_| power()).sum::<f64>() / f64::from(cells);
        match estimate {
            NoiseEstimate::Known => 1.0,
            NoiseEstimate::Mean(cells) => mean(cells),
            NoiseEstimate::Greater(near, far) => mean(near).max(mean(far)),
            NoiseEstimate::Smaller(near, far) => mean(near).min(mean(far)),
            NoiseEstimate::Ordered(cells) => {
                let mut all: Vec<f64> = (0..cells).map(|_| power()).collect();
                all.sort_by(f64::total_cmp);
                all[rank(cells) as usize - 1]
            }
            NoiseEstimate::Averaged { memory, scans } => {
                let memory = MapMemory::new(memory);
                let mut average = 0.0;
                for scan in 1..=scans.min(2000) {
                    average += memory.weight_of(scan) * (power() - average);
                }
                average
            }
        }
    }

    /// M, its mean and its spread against draws: within five standard errors of them.
    #[test]
    fn the_transform_is_that_of_the_estimate() {
        for (index, estimate) in (0..).zip(ALL) {
            let mut rng = generator(2, Purpose::Test, index, 0);
            let mut power = || -(1.0 - rng.random::<f64>()).ln();
            let draws = if matches!(estimate, NoiseEstimate::Averaged { .. }) { 5_000 } else { 40_000 };
            let draws: Vec<f64> = (0..draws).map(|_| draw(estimate, &mut power) / estimate.mean()).collect();
            let of = |f: &dyn Fn(f64) -> f64| {
                let values: Vec<f64> = draws.iter().map(|&g| f(g)).collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
                (mean, (square / values.len() as f64).sqrt())
            };
            let near = |(mean, error): (f64, f64), expected: f64| {
                assert!((mean - expected).abs() < 5.0 * error, "{estimate:?}: {mean} ± {error}, expected {expected}");
            };
            near(of(&|g| g), 1.0);
            near(of(&|g| (g - 1.0).powi(2)), 1.0 / estimate.equivalent_cells());
            for s in [0.5, 2.0, 6.0] {
                near(of(&|g| (-s * g).exp()), estimate.survival(s));
            }
        }
    }

    /// A and B are derivatives of ln M, which begins at 0.
    #[test]
    fn derivatives_are_those_of_the_transform() {
        for estimate in ALL {
            assert!(estimate.transform(0.0).ln_m.abs() < 1e-12, "{estimate:?}");
            for s in [0.1, 3.0, 14.0, 80.0] {
                let step = 1e-4 * s;
                let [before, at, after] = [s - step, s, s + step].map(|s| estimate.transform(s));
                assert_relative_eq!(at.a, (before.ln_m - after.ln_m) / (2.0 * step), max_relative = 1e-6);
                assert_relative_eq!(at.b, (before.a - after.a) / (2.0 * step), max_relative = 1e-6);
            }
        }
    }

    /// Values of other sources: the sums of (C9), (C10) by rational arithmetic for windows of two cells, and the products.
    #[test]
    fn small_cases_by_hand() {
        // Two windows of one cell: min is exponential of mean ½, max is their sum minus it.
        for s in [0.7_f64, 5.0] {
            let min = 1.0 / (1.0 + s / 2.0);
            let max = 2.0 / (1.0 + s) - min;
            assert_relative_eq!(NoiseEstimate::Smaller(1, 1).raw(s).ln_m.exp(), min, max_relative = 1e-13);
            assert_relative_eq!(NoiseEstimate::Greater(1, 1).raw(s).ln_m.exp(), max, max_relative = 1e-12);
            // Windows of two cells: P(min > x) = ((1 + 2x) e^(−2x))², M = 1 − s ∫ e^(−sx) P(min > x) dx.
            let r = s + 4.0;
            let min = 1.0 - s * (1.0 / r + 4.0 / r.powi(2) + 8.0 / r.powi(3));
            assert_relative_eq!(NoiseEstimate::Smaller(2, 2).raw(s).ln_m.exp(), min, max_relative = 1e-12);
            let max = 2.0 / (1.0 + s / 2.0).powi(2) - min;
            assert_relative_eq!(NoiseEstimate::Greater(2, 2).raw(s).ln_m.exp(), max, max_relative = 1e-12);
            // The third of four.
            let third = 4.0 / (4.0 + s) * 3.0 / (3.0 + s) * 2.0 / (2.0 + s);
            assert_relative_eq!(NoiseEstimate::Ordered(4).raw(s).ln_m.exp(), third, max_relative = 1e-13);
            // Weights ½, ¼, … with the first scan's share equal to the last.
            let three = NoiseEstimate::Averaged { memory: 3, scans: 3 }.raw(s).ln_m.exp();
            let product = 1.0 / ((1.0 + s / 2.0) * (1.0 + s / 4.0) * (1.0 + s / 4.0));
            assert_relative_eq!(three, product, max_relative = 1e-13);
        }
    }

    /// A lasting average is the limit of many scans.
    #[test]
    fn the_series_of_a_lasting_average_is_its_product() {
        for s in [1e-4, 0.3, 20.0, 1e5] {
            let [many, lasting] =
                [3000, u32::MAX].map(|scans| NoiseEstimate::Averaged { memory: 32, scans }.transform(s));
            assert_relative_eq!(many.ln_m, lasting.ln_m, max_relative = 1e-10);
            assert_relative_eq!(many.a, lasting.a, max_relative = 1e-8);
            assert_relative_eq!(many.b, lasting.b, max_relative = 1e-6);
        }
    }

    proptest! {
        /// M(t₀) = F for every estimate, down to the smallest probabilities.
        #[test]
        fn the_factor_gives_the_set_probability(
            exponent in 0.5..60.0_f64, near in 1_u32..64, far in 0_u32..64, scans in 1_u32..400,
        ) {
            let pfa = 10.0_f64.powf(-exponent);
            for estimate in [
                NoiseEstimate::Mean(near),
                NoiseEstimate::Greater(near, far),
                NoiseEstimate::Smaller(near, far),
                NoiseEstimate::Ordered(near + far),
                NoiseEstimate::Averaged { memory: near + far, scans },
            ] {
                let t = estimate.factor(pfa);
                prop_assert!((estimate.transform(t).ln_m / pfa.ln() - 1.0).abs() < 1e-9, "{estimate:?}: {t}");
            }
        }

        /// Between the means of one and of both windows.
        #[test]
        fn a_greater_or_smaller_window_lies_about_one_window(n in 1_u32..40, t in 0.1..40.0_f64) {
            let survival = |estimate: NoiseEstimate| estimate.raw(t).ln_m.exp();
            let one = survival(NoiseEstimate::Mean(n));
            let (greater, smaller) = (survival(NoiseEstimate::Greater(n, n)), survival(NoiseEstimate::Smaller(n, n)));
            prop_assert!(greater <= one && one <= smaller);
            prop_assert!((greater + smaller - 2.0 * one).abs() < 1e-11 * one, "{greater} + {smaller} != 2 {one}");
        }
    }
}
