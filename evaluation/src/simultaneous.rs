//! Several figures at once: how sure each must be that all are.
//!
//! Of 50 intervals of 95 %, two or three miss their value by chance alone. Who wants to say that *all* of k figures lie
//! in their intervals with probability L gives each of them a higher level.

/// Level of each of k intervals of *independent* figures so that all hold together with probability `level`.
///
/// ```text
/// L^(1/k)                Šidák
/// ```
///
/// Also valid for two-sided intervals of normal means with any correlation.
/// Source: Z. Šidák (1967).
pub fn sidak(level: f64, figures: usize) -> f64 {
    level.powf((figures.max(1) as f64).recip())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean::mean;
    use approx::assert_relative_eq;
    use chacha20::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// The usual example: ten figures at 95 % need 99.4884 % each.
    #[test]
    fn ten_figures() {
        assert_relative_eq!(sidak(0.95, 10), 0.994_884, max_relative = 1e-6);
        assert_relative_eq!(sidak(0.95, 1), 0.95);
    }

    /// 2000 times eight means of 40 uniform samples: all eight hold in 95 % of cases within four standard errors.
    #[test]
    fn all_hold_together_as_often_as_they_should() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let level = sidak(0.95, 8);
        let trials = 2000;
        let all_hold = (0..trials)
            .filter(|_| (0..8).all(|_| mean((0..40).map(|_| rng.random::<f64>()), level).contains(0.5)))
            .count();
        let share = all_hold as f64 / f64::from(trials);
        assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(), "{share}");
    }
}
