//! A window of three neighbours that steps through known rates: SGMM (V4).

use super::grid::{CENTRE, Carry, LEFT, RIGHT};

/// The window and what moves it.
///
/// ```text
/// μ_L > t: one step left;  else μ_C > t: none;  else μ_R > t: one step right;  else none        (V4)
/// ```
/// It stays within the known rates.
#[derive(Debug, Clone, PartialEq)]
pub struct SwitchingGrid {
    /// The known rates, ascending, rad/s; three or more.
    pub rates: Vec<f64>,
    /// t.
    pub threshold: f64,
    /// What the models begin with after a step.
    pub carry: Carry,
    /// The rule as printed, which steps right where no model exceeds t; to compare.
    pub undecided_steps_right: bool,
}

impl SwitchingGrid {
    /// The window of a new track: about the rate nearest to zero.
    pub(super) fn first(&self) -> &[f64] {
        let inner = 1..self.rates.len() - 1;
        let centre = inner.min_by(|&a, &b| self.rates[a].abs().total_cmp(&self.rates[b].abs())).unwrap_or(1);
        &self.rates[centre - 1..=centre + 1]
    }

    /// The window of the next scan, rad/s, from that of the last and its probabilities; and the step to the right.
    pub fn switch(&self, rates: [f64; 3], mu: [f64; 3]) -> ([f64; 3], i8) {
        let left = mu[LEFT] > self.threshold;
        let stay = mu[CENTRE] > self.threshold;
        let right = mu[RIGHT] > self.threshold || self.undecided_steps_right;
        let step = if left { -1 } else { i8::from(!stay && right) };
        let centre = self.rates.partition_point(|rate| *rate < rates[CENTRE]);
        let to = centre.saturating_add_signed(step.into()).clamp(1, self.rates.len() - 2);
        let window = [self.rates[to - 1], self.rates[to], self.rates[to + 1]];
        (window, if to == centre { 0 } else { step })
    }
}
