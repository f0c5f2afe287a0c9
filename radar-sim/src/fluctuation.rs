//! Amplitude and phase of a target's echo from passage to passage of the beam.

use common::config::Swerling;
use common::random::{Purpose, generator};
use rand::RngExt;
use rand_distr::{Distribution, Exp1};

/// Power of target `target_id` in the beam's `passage` over its mean: 1 (Swerling 0), exponential (I), or χ² with four degrees
/// of freedom (III); one draw a passage (C2). Passages have the number of the scan in which the beam is on the target.
pub fn power(swerling: Swerling, seed: u64, passage: u32, target_id: u32) -> f64 {
    let mut rng = generator(seed, Purpose::Fluctuation, passage, target_id);
    let mut exponential = || -> f64 { Exp1.sample(&mut rng) };
    match swerling {
        Swerling::Zero => 1.0,
        Swerling::One => exponential(),
        Swerling::Three => f64::midpoint(exponential(), exponential()),
    }
}

/// Phase of the echo of `target_id` in one dwell, rad: uniform, because a target moves
/// by many wavelengths between dwells.
pub fn phase(seed: u64, scan: u32, dwell: u32, target_id: u32) -> f64 {
    const TARGETS: u32 = 1 << 12; // more than there can be
    let mut rng = generator(seed, Purpose::Phase, scan, dwell * TARGETS + target_id);
    rng.random::<f64>() * std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean 1 and variances 0, 1, ½ within five standard errors of 20,000 draws.
    #[test]
    fn powers_have_the_moments_of_their_case() {
        let scans = 20_000;
        for (case, variance, fourth) in
            [(Swerling::Zero, 0.0, 0.0), (Swerling::One, 1.0, 9.0), (Swerling::Three, 0.5, 1.5)]
        {
            let draws: Vec<f64> = (0..scans).map(|scan| power(case, 3, scan, 1)).collect();
            let n = f64::from(scans);
            let mean = draws.iter().sum::<f64>() / n;
            let spread = draws.iter().map(|draw| (draw - 1.0).powi(2)).sum::<f64>() / n;
            assert!((mean - 1.0).abs() <= 5.0 * (variance / n).sqrt() + 1e-12, "{case:?}");
            let error = 5.0 * ((fourth - variance * variance) / n).sqrt();
            assert!((spread - variance).abs() <= error + 1e-12, "{case:?}: {spread}");
        }
    }
}
