//! A grid of three rates that follows the target: AGMM (V3).

use super::grid::{CENTRE, LEFT, RIGHT};

/// Rates left, centre and right, adapted from scan to scan.
///
/// ```text
/// ω_C' = Σ μ_i ω_i if μ_C < t₁, else ω_C
/// δ_L = max(ω_C − ω_L, r),   δ_R = max(ω_R − ω_C, r)
/// largest μ (of equals the centre, then the left):                                       (V3)
///   centre: ω_L' = ω_C' − δ_L, δ_L halved if μ_L < t₂;   ω_R' = ω_C' + δ_R, δ_R halved if μ_R < t₂
///   left:   ω_L' = ω_C' − δ_L, δ_L doubled if μ_L > t₃;  ω_R' = ω_C' + δ_R
///   right:  the mirror image
/// ```
/// each clipped to ±ω_max. The halving acts after the floor r, so r is twice the spacing that the grid ends with; too small an r leaves
/// the grid too narrow to reach the target's rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveGrid {
    /// Rates of a new track, rad/s.
    pub first: [f64; 3],
    /// ω_max, rad/s.
    pub greatest: f64,
    /// r, rad/s.
    pub spacing: f64,
    /// t₁.
    pub recentre: f64,
    /// t₂.
    pub narrow: f64,
    /// t₃.
    pub widen: f64,
}

impl AdaptiveGrid {
    /// The rates of the next scan, rad/s, from those of the last and their probabilities.
    pub fn adapt(&self, rates: [f64; 3], mu: [f64; 3]) -> [f64; 3] {
        let mean = || rates.iter().zip(&mu).map(|(rate, probability)| probability * rate).sum();
        let centre: f64 = if mu[CENTRE] < self.recentre { mean() } else { rates[CENTRE] };
        let mut left = (rates[CENTRE] - rates[LEFT]).max(self.spacing);
        let mut right = (rates[RIGHT] - rates[CENTRE]).max(self.spacing);
        if mu[CENTRE] >= mu[LEFT] && mu[CENTRE] >= mu[RIGHT] {
            left *= if mu[LEFT] < self.narrow { 0.5 } else { 1.0 };
            right *= if mu[RIGHT] < self.narrow { 0.5 } else { 1.0 };
        } else if mu[LEFT] >= mu[RIGHT] {
            left *= if mu[LEFT] > self.widen { 2.0 } else { 1.0 };
        } else {
            right *= if mu[RIGHT] > self.widen { 2.0 } else { 1.0 };
        }
        [centre - left, centre, centre + right].map(|rate| rate.clamp(-self.greatest, self.greatest))
    }
}
