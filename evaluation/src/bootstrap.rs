//! Intervals of figures that have no formula of their own: ratios, rms, medians.

use rand::{Rng, RngExt};

use crate::proportion::wilson;
use crate::{Estimate, contrast};

/// Percentile interval by the bootstrap.
///
/// Draws as many samples as there are with replacement, `resamples` times, and takes the (1 ∓ level)/2 quantiles of
/// `statistic`. The samples must be independent: whole runs, not scans of a run. Below some 20 samples the
/// interval is too narrow; for extremes (a maximum) the method fails. Statistics that are NaN, as a ratio without
/// denominator, are left out. Without samples nothing is known.
///
/// Source: B. Efron (1979); Efron & Tibshirani (1993).
pub fn interval<T>(
    samples: &[T],
    resamples: usize,
    level: f64,
    rng: &mut impl Rng,
    statistic: impl Fn(&[&T]) -> f64,
) -> Estimate {
    if samples.is_empty() {
        return Estimate::UNKNOWN;
    }
    let mut drawn: Vec<&T> = samples.iter().collect();
    let value = statistic(&drawn);
    let mut values = Vec::with_capacity(resamples);
    for _ in 0..resamples {
        drawn.fill_with(|| &samples[rng.random_range(0..samples.len())]);
        let value = statistic(&drawn);
        if !value.is_nan() {
            values.push(value);
        }
    }
    values.sort_unstable_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - level);
    Estimate { value, lo: quantile(&values, tail), hi: quantile(&values, 1.0 - tail), n: samples.len() as u64 }
}

/// Mean of the samples, where Student's interval is doubtful.
pub fn mean(samples: &[f64], resamples: usize, level: f64, rng: &mut impl Rng) -> Estimate {
    interval(samples, resamples, level, rng, |drawn| drawn.iter().copied().sum::<f64>() / drawn.len() as f64)
}

/// Ratio of sums Σa/Σb over pairs [a, b], one pair a run: errors per scan, hits per opportunity.
pub fn ratio(pairs: &[[f64; 2]], resamples: usize, level: f64, rng: &mut impl Rng) -> Estimate {
    interval(pairs, resamples, level, rng, |drawn| {
        let sums = drawn.iter().fold([0.0; 2], |sums, pair| [sums[0] + pair[0], sums[1] + pair[1]]);
        sums[0] / sums[1]
    })
}

/// Ratio Σa/Σb of how often two things happened in the same runs, [a, b] a run.
///
/// Where resampling leaves no scatter, as a never happened or both always did, it would say that nothing else can be: there the
/// interval is that of [`contrast::ratio`] from Wilson's, which takes the two as independent and is wider than need be.
pub fn ratio_of_shares(pairs: &[[bool; 2]], resamples: usize, level: f64, rng: &mut impl Rng) -> Estimate {
    let numbers: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(|happened| f64::from(u8::from(happened)))).collect();
    let found = ratio(&numbers, resamples, level, rng);
    if pairs.is_empty() || found.lo < found.hi {
        return found;
    }
    let n = pairs.len() as u64;
    let share = |which: usize| wilson(pairs.iter().filter(|pair| pair[which]).count() as u64, n, level);
    contrast::ratio(&share(0), &share(1))
}

/// Value below which the share `p` of sorted values lies, linear between neighbours.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = p * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    let share = place - below as f64;
    // Ratios may be infinite, and between those there is nothing.
    if share <= 0.0 || sorted[below].is_infinite() {
        return sorted[below];
    }
    sorted[below] + (sorted[above] - sorted[below]) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use chacha20::ChaCha8Rng;
    use rand::SeedableRng;

    fn rng() -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(5)
    }

    /// Survival of the seven treated mice (Efron & Tibshirani 1993): the interval of 20,000 draws against that of
    /// all 7⁷ resamples there are.
    #[test]
    fn draws_agree_with_all_resamples() {
        let mice = [94.0, 197.0, 16.0, 38.0, 99.0, 141.0, 23.0];
        let mut all: Vec<f64> = (0..7_usize.pow(7))
            .map(|mut code| {
                let mut sum = 0.0;
                for _ in 0..7 {
                    sum += mice[code % 7];
                    code /= 7;
                }
                sum / 7.0
            })
            .collect();
        all.sort_unstable_by(f64::total_cmp);
        let estimate = mean(&mice, 20_000, 0.95, &mut rng());
        assert_relative_eq!(estimate.value, 86.857, max_relative = 1e-5);
        assert_abs_diff_eq!(estimate.lo, quantile(&all, 0.025), epsilon = 1.5);
        assert_abs_diff_eq!(estimate.hi, quantile(&all, 0.975), epsilon = 1.5);
    }

    /// For many samples the interval of the mean tends to the normal one.
    #[test]
    fn many_samples_give_the_interval_of_the_mean() {
        let mut generator = rng();
        let samples: Vec<f64> = (0..2000).map(|_| generator.random::<f64>()).collect();
        let exact = crate::mean::mean(samples.iter().copied(), 0.95);
        let drawn = mean(&samples, 4000, 0.95, &mut generator);
        assert_abs_diff_eq!(exact.lo, drawn.lo, epsilon = 0.001);
        assert_abs_diff_eq!(exact.hi, drawn.hi, epsilon = 0.001);
    }

    #[test]
    fn ratios_are_of_sums_and_repeat_with_the_seed() {
        let pairs = [[1.0, 2.0], [3.0, 4.0], [0.0, 0.0], [2.0, 2.0]];
        let first = ratio(&pairs, 500, 0.95, &mut rng());
        assert_relative_eq!(first.value, 6.0 / 8.0);
        assert!(first.lo >= 0.5 && first.hi <= 1.0 && first.lo < first.hi);
        assert_eq!(first, ratio(&pairs, 500, 0.95, &mut rng()));
        assert!(ratio(&[], 500, 0.95, &mut rng()).value.is_nan());
        let without_end = ratio(&[[1.0, 0.0], [1.0, 1.0], [1.0, 0.0]], 500, 0.95, &mut rng());
        assert!(without_end.lo >= 1.0 && without_end.hi == f64::INFINITY, "{without_end:?}");
    }

    #[test]
    fn what_never_happened_may_happen() {
        let runs = |a: usize, b: usize| -> Vec<[bool; 2]> { (0..200).map(|run| [run < a, run < b]).collect() };
        let never = ratio_of_shares(&runs(0, 100), 500, 0.95, &mut rng());
        assert!(never.value == 0.0 && never.lo == 0.0 && (0.02..0.06).contains(&never.hi), "{never:?}");
        let always = ratio_of_shares(&runs(200, 200), 500, 0.95, &mut rng());
        assert!(always.lo < 1.0 && always.hi > 1.0, "{always:?}");
        let some = ratio_of_shares(&runs(50, 100), 500, 0.95, &mut rng());
        assert_relative_eq!(some.value, 0.5);
        assert!((0.35..0.5).contains(&some.lo) && (0.5..0.65).contains(&some.hi), "{some:?}");
    }
}
