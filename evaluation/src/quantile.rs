//! Quantiles of the distributions that intervals are made of.
//!
//! Every function returns x with P(X ≤ x) = p for 0 < p < 1 and is tested against printed tables.

use statrs::distribution::{ContinuousCDF, Gamma, Normal, StudentsT};

/// Standard normal.
pub fn normal(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// Student's t with `freedom` > 0 degrees of freedom; the normal one where they no longer differ.
///
/// # Panics
/// Unless `freedom` is positive.
pub fn student(p: f64, freedom: f64) -> f64 {
    if freedom > 1e6 {
        return normal(p);
    }
    StudentsT::new(0.0, 1.0, freedom).expect("positive degrees of freedom").inverse_cdf(p)
}

/// χ² with `freedom` > 0 degrees of freedom.
///
/// # Panics
/// Unless `freedom` is positive.
pub fn chi_square(p: f64, freedom: f64) -> f64 {
    if freedom > 1e5 {
        // Wilson & Hilferty (1931): the relative error falls with freedom² and is below 10⁻⁹ here.
        let spread = 2.0 / (9.0 * freedom);
        return freedom * (1.0 - spread + normal(p) * spread.sqrt()).powi(3);
    }
    // χ² of k degrees is a gamma variable of shape k/2 and rate ½.
    Gamma::new(0.5 * freedom, 0.5).expect("positive degrees of freedom").inverse_cdf(p)
}

/// z with P(|X| ≤ z) = `level` for a standard normal X.
pub fn two_sided(level: f64) -> f64 {
    normal(0.5 + 0.5 * level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Printed values of the usual tables (Abramowitz & Stegun 1964, tables 26.1, 26.8, 26.10).
    #[test]
    fn quantiles_are_those_of_tables() {
        assert_relative_eq!(normal(0.975), 1.959_963_985, max_relative = 1e-9);
        assert_relative_eq!(two_sided(0.99), 2.575_829_304, max_relative = 1e-9);
        for (p, freedom, value) in
            [(0.975, 1.0, 12.706), (0.975, 10.0, 2.228), (0.995, 30.0, 2.750), (0.975, 120.0, 1.980)]
        {
            assert_relative_eq!(student(p, freedom), value, max_relative = 3e-4);
        }
        for (p, freedom, value) in [
            (0.95, 1.0, 3.841_46),
            (0.975, 2.0, 7.377_76),
            (0.025, 10.0, 3.246_97),
            (0.99, 30.0, 50.892_2),
            (0.025, 100.0, 74.221_9),
            (0.975, 100.0, 129.561),
        ] {
            assert_relative_eq!(chi_square(p, freedom), value, max_relative = 3e-6);
        }
    }

    /// Where the formula changes, nothing jumps; and the quantile of two degrees is −2 ln(1 − p).
    #[test]
    fn chi_square_is_smooth_and_exact_where_it_can_be() {
        for p in [1e-6, 0.025, 0.5, 0.975, 0.999] {
            assert_relative_eq!(chi_square(p, 2.0), -2.0 * (-p).ln_1p(), max_relative = 1e-8);
            assert_relative_eq!(chi_square(p, 1e5 - 1e-3), chi_square(p, 1e5 + 1e-3), max_relative = 1e-7);
        }
    }
}
