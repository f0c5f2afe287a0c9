//! Two ways on the same runs: which errs less, and which states its errors better.
//!
//! | metric                       | of all scans of a segment, first way against second       |
//! |------------------------------|------------------------------------------------------------|
//! | `pred_position_rms_ratio`, … | rms error over rms error; below 1 the first errs less      |
//! | `p_correct_difference`       | above 0 the first finds the mode more often                |
//! | `nees_position_difference`   | NEES minus NEES                                            |
//! | `nees_position_excess`       | \|NEES − 3\| minus \|NEES − 3\|; below 0 the first is nearer to 3 |
//!
//! Intervals come from resampling runs, each with both of its ways.

use common::random::{Purpose, generator};
use evaluation::bootstrap;

use super::{RESAMPLES, Score, sums};
use crate::rows::LEVEL;
use crate::trajectory::Segment;
use crate::{Case, Row};

/// NEES of a consistent position.
const CONSISTENT: f64 = 3.0;

/// Mean of a value by way, of the runs drawn.
fn means(drawn: &[&[[f64; 2]; 2]]) -> [f64; 2] {
    [0, 1].map(|way: usize| {
        let [sum, n] = drawn.iter().fold([0.0, 0.0], |[sum, n], run| [sum + run[way][0], n + run[way][1]]);
        sum / n
    })
}

/// The rows of one segment; both have the scores of the same runs in the same order.
pub(super) fn rows(
    case: &Case,
    [first, second]: [&[Vec<Score>]; 2],
    segment: &Segment,
    [seed, place]: [u64; 2],
) -> [Row; 6] {
    let row = |metric: &'static str, of: fn(&Score) -> f64, contrast: fn([f64; 2]) -> f64| {
        let pairs: Vec<[[f64; 2]; 2]> =
            sums(first, segment, of).into_iter().zip(sums(second, segment, of)).map(|(a, b)| [a, b]).collect();
        let mut rng = generator(seed, Purpose::Resampling, place as u32, 1);
        let found = bootstrap::interval(&pairs, RESAMPLES, LEVEL, &mut rng, |drawn| contrast(means(drawn)));
        Row::new(case, metric, found)
    };
    let rms_ratio = |[a, b]: [f64; 2]| (a / b).sqrt();
    let difference = |[a, b]: [f64; 2]| a - b;
    let excess = |[a, b]: [f64; 2]| (a - CONSISTENT).abs() - (b - CONSISTENT).abs();
    [
        row("pred_position_rms_ratio", |score| score.predicted_m2, rms_ratio),
        row("est_position_rms_ratio", |score| score.position_m2, rms_ratio),
        row("est_velocity_rms_ratio", |score| score.velocity_m2ps2, rms_ratio),
        row("p_correct_difference", |score| f64::from(u8::from(score.correct)), difference),
        row("nees_position_difference", |score| score.nees, difference),
        row("nees_position_excess", |score| score.nees, excess),
    ]
}

/// What a comparison says of the first way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Better,
    Equal,
    Worse,
}

impl Verdict {
    /// By the interval: equal if it holds the value of no difference.
    pub(super) fn of(row: &Row) -> Self {
        let (none, more_is_better) = match row.metric {
            "p_correct_difference" => (0.0, true),
            "nees_position_difference" | "nees_position_excess" => (0.0, false),
            _ => (1.0, false),
        };
        match (row.lo > none, row.hi < none) {
            (false, false) => Self::Equal,
            (above, _) if above == more_is_better => Self::Better,
            _ => Self::Worse,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Better => "better",
            Self::Equal => "equal",
            Self::Worse => "worse",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 runs of a filter that errs 10 % less than another on the same draws: told apart, though each rms alone is not known to 10 %.
    #[test]
    fn pairs_tell_what_two_samples_would_not() {
        let score = |k: u32, run: u32, factor: f64| {
            let error2 = f64::from(1 + (7 * run + 3 * k) % 50) * factor * factor;
            Score {
                k,
                predicted_m2: error2,
                position_m2: error2,
                velocity_m2ps2: error2,
                nees: 3.0 * factor,
                correct: run.is_multiple_of(2),
            }
        };
        let runs = |factor: f64| -> Vec<Vec<Score>> {
            (0..200).map(|run| (1..=5).map(|k| score(k, run, factor)).collect()).collect()
        };
        let rows = rows(&Case::new(), [&runs(0.9), &runs(1.0)], &Segment::ALL, [1, 0]);
        let by_name = |metric: &str| rows.iter().find(|row| row.metric == metric).expect("a row");
        let ratio = by_name("est_position_rms_ratio");
        assert!((ratio.value - 0.9).abs() < 1e-9 && ratio.hi - ratio.lo < 1e-9 && ratio.n == 200, "{ratio:?}");
        assert_eq!(Verdict::of(ratio), Verdict::Better);
        assert_eq!(Verdict::of(by_name("p_correct_difference")), Verdict::Equal);
        assert_eq!(Verdict::of(by_name("nees_position_excess")), Verdict::Worse);
    }
}
