//! Two independent figures against each other: their difference, sum and ratio.
//!
//! ```text
//! difference   a − b,   lo = a − b − √((a − lo_a)² + (hi_b − b)²),   hi = a − b + √((hi_a − a)² + (b − lo_b)²)
//! sum          a + b,   lo = a + b − √((a − lo_a)² + (b − lo_b)²),   hi likewise
//! ratio        a / b,   lo = [ab − √(a²b² − lo_a hi_b (2a − lo_a)(2b − hi_b))] / [hi_b (2b − hi_b)],
//!                       hi = [ab + √(a²b² − hi_a lo_b (2a − hi_a)(2b − lo_b))] / [lo_b (2b − lo_b)]
//! ```
//!
//! The distances from each figure to the ends of its own interval stand for its standard error, on the side where it matters: of
//! proportions with Wilson's interval this is method 10 of Newcombe, which neither collapses at 0 and 1 nor leaves [−1, 1]. Both
//! figures must be independent and their intervals of one level, which is that of the result. Of the same runs
//! twice, resample the runs instead ([`crate::bootstrap`]).
//!
//! Source: R. G. Newcombe, *Interval estimation for the difference between independent proportions* (1998); for figures of any kind
//! Zou & Donner (2008), of ratios Donner & Zou (2012).

use crate::Estimate;

/// a − b; `n` is the smaller number of samples.
pub fn difference(a: &Estimate, b: &Estimate) -> Estimate {
    sum(a, &b.scaled(-1.0))
}

/// a + b; `n` is the smaller number of samples.
pub fn sum(a: &Estimate, b: &Estimate) -> Estimate {
    let value = a.value + b.value;
    Estimate {
        value,
        lo: value - (a.value - a.lo).hypot(b.value - b.lo),
        hi: value + (a.hi - a.value).hypot(b.hi - b.value),
        n: a.n.min(b.n),
    }
}

/// a / b of figures that are not negative; `n` is the smaller number of samples. Unbounded above if b may be 0.
pub fn ratio(a: &Estimate, b: &Estimate) -> Estimate {
    let product = a.value * b.value;
    let root = |a_end: f64, b_end: f64| {
        (product * product - a_end * b_end * (2.0 * a.value - a_end) * (2.0 * b.value - b_end)).max(0.0).sqrt()
    };
    let over = |b_end: f64| b_end * (2.0 * b.value - b_end);
    let bound = |sign: f64, a_end: f64, b_end: f64| (product + sign * root(a_end, b_end)) / over(b_end);
    let lo = if over(b.hi) > 0.0 { bound(-1.0, a.lo, b.hi) } else { 0.0 };
    let hi = if over(b.lo) > 0.0 { bound(1.0, a.hi, b.lo) } else { f64::INFINITY };
    Estimate { value: a.value / b.value, lo, hi, n: a.n.min(b.n) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean::mean;
    use crate::proportion::wilson;
    use approx::assert_abs_diff_eq;
    use chacha20::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Examples of Newcombe (1998), method 10: (a) 56/70 − 48/80 and (b) 9/10 − 3/10.
    #[test]
    fn published_examples() {
        for ([x, m], [y, n], lo, hi) in [([56, 70], [48, 80], 0.0524, 0.3339), ([9, 10], [3, 10], 0.1705, 0.8090)] {
            let found = difference(&wilson(x, m, 0.95), &wilson(y, n, 0.95));
            assert_abs_diff_eq!(found.lo, lo, epsilon = 5e-5);
            assert_abs_diff_eq!(found.hi, hi, epsilon = 5e-5);
        }
        // 997 and 1000 of 1000 do not differ; 970 and 1000 do.
        let against = |count| difference(&wilson(count, 1000, 0.95), &wilson(1000, 1000, 0.95));
        assert!(against(997).contains(0.0) && !against(970).contains(0.0));
    }

    /// Where the shares leave no scatter, their intervals still do.
    #[test]
    fn ratios_at_the_ends() {
        let all = ratio(&wilson(200, 200, 0.95), &wilson(200, 200, 0.95));
        assert!((0.97..0.99).contains(&all.lo) && (1.01..1.03).contains(&all.hi), "{all:?}");
        let none = ratio(&wilson(0, 200, 0.95), &wilson(100, 200, 0.95));
        assert!(none.value == 0.0 && none.lo == 0.0 && (0.03..0.05).contains(&none.hi), "{none:?}");
        assert!(ratio(&wilson(1, 20, 0.95), &wilson(0, 20, 0.95)).hi.is_infinite());
    }

    /// 2000 times the sum, the difference and the ratio of two means: all hold in 95 % of cases within four standard errors.
    #[test]
    fn intervals_hold_as_often_as_they_should() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let trials = 2000;
        let mut held = [0_u32; 3];
        for _ in 0..trials {
            let [a, b] = [60, 25].map(|n| mean((0..n).map(|_| rng.random::<f64>()), 0.95));
            held[0] += u32::from(sum(&a, &b).contains(1.0));
            held[1] += u32::from(difference(&a, &b).contains(0.0));
            held[2] += u32::from(ratio(&a, &b).contains(1.0));
        }
        for held in held {
            let share = f64::from(held) / f64::from(trials);
            assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(), "{share}");
        }
    }
}
