//! Counts of rare independent events, and their rates.

use crate::Estimate;
use crate::quantile::chi_square;

/// s in an hour.
const HOUR_S: f64 = 3600.0;

/// Exact interval of the mean of a Poisson distribution from one count.
///
/// ```text
/// [½ χ²_2k((1 − level)/2),  ½ χ²_(2k+2)((1 + level)/2)],   k = `count`
/// ```
///
/// Covers at least `level`; for k = 0 it begins at 0. Source: F. Garwood (1936).
pub fn count(count: u64, level: f64) -> Estimate {
    let tail = 0.5 * (1.0 - level);
    let freedom = 2.0 * count as f64;
    Estimate {
        value: count as f64,
        lo: if count == 0 { 0.0 } else { 0.5 * chi_square(tail, freedom) },
        hi: 0.5 * chi_square(1.0 - tail, freedom + 2.0),
        n: count,
    }
}

/// Events per hour, of `events` in `seconds` s, with their exact interval: false tracks per hour.
///
/// NaN and an unbounded interval without time.
pub fn per_hour(events: u64, seconds: f64, level: f64) -> Estimate {
    if seconds <= 0.0 {
        return Estimate { value: f64::NAN, lo: 0.0, hi: f64::INFINITY, n: events };
    }
    count(events, level).scaled(HOUR_S / seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// Values of Garwood's table (F. Garwood, *Fiducial limits for the Poisson distribution*, 1936), as reprinted.
    #[test]
    fn intervals_are_those_of_tables() {
        for (events, lo, hi) in
            [(0, 0.0, 3.689), (1, 0.0253, 5.572), (2, 0.242, 7.225), (10, 4.795, 18.39), (100, 81.36, 121.63)]
        {
            let estimate = count(events, 0.95);
            assert_abs_diff_eq!(estimate.lo, lo, epsilon = 5e-4 + 1e-4 * lo);
            assert_abs_diff_eq!(estimate.hi, hi, epsilon = 1e-3 + 1e-4 * hi);
        }
    }

    /// The definition: at the ends of the interval, the tails hold (1 − level)/2.
    #[test]
    fn tails_hold_what_they_should() {
        let at_most = |k: u32, mean: f64| {
            let term = |i: u32| (1..=i).fold((-mean).exp(), |term, j| term * mean / f64::from(j));
            (0..=k).map(term).sum::<f64>()
        };
        for k in [1, 3, 20] {
            let estimate = count(k.into(), 0.9);
            assert_relative_eq!(at_most(k, estimate.hi), 0.05, max_relative = 1e-6);
            assert_relative_eq!(1.0 - at_most(k - 1, estimate.lo), 0.05, max_relative = 1e-6);
        }
    }

    #[test]
    fn rates_are_per_hour() {
        let rate = per_hour(10, 1800.0, 0.95);
        assert_relative_eq!(rate.value, 20.0);
        assert_relative_eq!(rate.lo, 2.0 * 4.795, max_relative = 1e-3);
        assert!(per_hour(0, 0.0, 0.95).hi.is_infinite());
    }
}
