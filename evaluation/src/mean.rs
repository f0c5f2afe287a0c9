//! The mean of independent samples.

use crate::Estimate;
use crate::quantile::student;

/// Number, mean and sum of squared deviations of a stream of samples.
///
/// ```text
/// m ← m + (x − m)/n,   M₂ ← M₂ + (x − m_before)(x − m_after)
/// ```
///
/// Keeps its precision where Σx² − (Σx)²/n would cancel. Source: B. P. Welford (1962); merging of two streams:
/// Chan, Golub & LeVeque (1979).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Moments {
    n: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Takes one sample.
    pub fn add(&mut self, x: f64) {
        self.n += 1;
        let before = x - self.mean;
        self.mean += before / self.n as f64;
        self.squares += before * (x - self.mean);
    }

    /// Takes the samples of another stream.
    pub fn merge(&mut self, other: &Self) {
        let n = self.n + other.n;
        if n == 0 {
            return;
        }
        let difference = other.mean - self.mean;
        let share = other.n as f64 / n as f64;
        self.squares += other.squares + difference * difference * self.n as f64 * share;
        self.mean += difference * share;
        self.n = n;
    }

    /// Samples so far.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// Mean; NaN without samples.
    pub fn mean(&self) -> f64 {
        if self.n == 0 { f64::NAN } else { self.mean }
    }

    /// Unbiased variance; NaN for fewer than two samples.
    pub fn variance(&self) -> f64 {
        if self.n < 2 { f64::NAN } else { self.squares / (self.n - 1) as f64 }
    }

    /// Student's interval of the mean, see [`mean`].
    pub fn estimate(&self, level: f64) -> Estimate {
        let standard_error = (self.variance() / self.n as f64).sqrt();
        with_standard_error(self.mean(), standard_error, self.n, level)
    }
}

impl Extend<f64> for Moments {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, samples: T) {
        samples.into_iter().for_each(|x| self.add(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<T: IntoIterator<Item = f64>>(samples: T) -> Self {
        let mut moments = Self::default();
        moments.extend(samples);
        moments
    }
}

/// Mean of independent samples with Student's interval.
///
/// ```text
/// m ± t_(n−1) · s/√n
/// ```
///
/// Exact for normal samples, good for many samples of any kind. Below two samples the interval is the whole line.
/// Scans of one run are *not* independent: take one value per run.
pub fn mean(samples: impl IntoIterator<Item = f64>, level: f64) -> Estimate {
    samples.into_iter().collect::<Moments>().estimate(level)
}

/// The interval of a mean of `n` samples whose standard error is known.
fn with_standard_error(value: f64, standard_error: f64, n: u64, level: f64) -> Estimate {
    if n < 2 {
        return Estimate { value, lo: f64::NEG_INFINITY, hi: f64::INFINITY, n };
    }
    let half = student(0.5 + 0.5 * level, (n - 1) as f64) * standard_error;
    Estimate { value, lo: value - half, hi: value + half, n }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Student's own example: additional hours of sleep of ten patients by the second drug ("Student" 1908, after
    /// Cushny & Peebles 1905): mean 2.33, s = 2.002, t₉ = 2.262.
    #[test]
    fn sleep_of_ten_patients() {
        let gained = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let estimate = mean(gained, 0.95);
        assert_relative_eq!(estimate.value, 2.33, max_relative = 1e-12);
        assert_relative_eq!(estimate.hi - estimate.value, 2.262_157 * 2.002_249 / 10.0_f64.sqrt(), max_relative = 1e-5);
        assert_eq!(estimate.n, 10);
    }

    #[test]
    fn few_samples_say_nothing() {
        assert!(mean([], 0.95).value.is_nan());
        let one = mean([3.0], 0.95);
        assert_eq!(one, Estimate { value: 3.0, lo: f64::NEG_INFINITY, hi: f64::INFINITY, n: 1 });
    }

    proptest! {
        /// Streams and merged streams agree with the definition, also far from zero.
        #[test]
        fn moments_are_those_of_the_definition(
            samples in prop::collection::vec(-10.0..10.0_f64, 2..60),
            cut in 0_usize..60,
            offset in -1e6..1e6_f64,
        ) {
            let samples: Vec<f64> = samples.iter().map(|x| x + offset).collect();
            let (first, second) = samples.split_at(cut.min(samples.len()));
            let mut merged: Moments = first.iter().copied().collect();
            merged.merge(&second.iter().copied().collect());
            let n = samples.len() as f64;
            let mean = samples.iter().sum::<f64>() / n;
            let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
            prop_assert!((merged.mean() - mean).abs() < 1e-9 * (1.0 + mean.abs()));
            prop_assert!((merged.variance() - variance).abs() < 1e-7 * (1.0 + variance));
        }
    }
}
