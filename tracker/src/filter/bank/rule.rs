//! How the hypotheses of a coordinate make one output (M3).

use pulp::Simd;

use crate::filter::lanes::{Lanes, V};

/// Most hypotheses on a coordinate.
pub(super) const MOST: usize = 9;

/// With L_i(n) the sum of the last n log-densities of innovations of hypothesis i:
/// ```text
/// Bayes: softmax L_i(∞)      standard: argmax L_i(∞)
/// sliding Bayes: softmax L_i(n)   sliding: argmax L_i(n)            (M3)
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// All hypotheses, by all scans.
    Bayes,
    /// The likeliest, by all scans.
    Standard,
    /// All hypotheses, by the last scans.
    SlidingBayes,
    /// The likeliest, by the last scans.
    Sliding,
}

impl Rule {
    /// Whether only the last scans count.
    pub(super) fn is_sliding(self) -> bool {
        matches!(self, Self::SlidingBayes | Self::Sliding)
    }

    /// Shares of hypotheses of these scores; they sum to 1. Of equals the first is the likeliest.
    #[inline(always)]
    pub(super) fn shares<S: Simd>(self, lanes: Lanes<S>, scores: &[V<S>]) -> [V<S>; MOST] {
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let mut largest = scores[0];
        for score in scores {
            largest = largest.max(*score);
        }
        let (mut shares, mut total) = ([zero; MOST], zero);
        for (share, score) in shares.iter_mut().zip(scores) {
            *share = if matches!(self, Self::Bayes | Self::SlidingBayes) {
                (*score - largest).exp()
            } else {
                // 1 where none before was the largest.
                score.less(largest).pick(zero, one - total)
            };
            total += *share;
        }
        for share in &mut shares[..scores.len()] {
            *share = *share / total;
        }
        shares
    }
}
