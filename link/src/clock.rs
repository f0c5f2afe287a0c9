//! By how much the monotonic clocks of two hosts differ, and how well that is known.
//!
//! Every answer tells four times: sent (t₀) and answered to (t₃) by the clock of the sender, received (t₁) and answered (t₂) by that
//! of the receiver. Whatever each way took, the offset is ((t₁ − t₀) + (t₂ − t₃))/2 to within half of the time that both ways took
//! together, (t₃ − t₀) − (t₂ − t₁). The answer of the shortest way bounds it best; while it ages the clocks drift apart.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// How far two clocks may drift apart, ns in a ns.
const DRIFT: f64 = 100e-6;
/// Answers that are kept to choose from.
const KEPT: usize = 64;

/// What must be added to times of one clock to get those of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Offset {
    /// Difference, ns.
    pub offset_ns: i64,
    /// It is not farther from the truth, ns.
    pub uncertainty_ns: u64,
}

/// What is known of the clock of the other side.
#[derive(Debug, Default)]
pub struct OtherClock {
    answers: VecDeque<(u64, Offset)>,
}

impl OtherClock {
    /// Takes the four times of an answer, ns; those that cannot be are not used.
    pub fn note(&mut self, [sent, received, answered, came]: [u64; 4]) {
        let difference = |a: u64, b: u64| i128::from(a) - i128::from(b);
        let both_ways = difference(came, sent) - difference(answered, received);
        if came < sent || answered < received || both_ways < 0 {
            return;
        }
        let twice = difference(received, sent) + difference(answered, came);
        let Ok(offset_ns) = i64::try_from(twice / 2) else { return };
        let uncertainty_ns = u64::try_from(both_ways / 2 + 1).unwrap_or(u64::MAX);
        if self.answers.len() == KEPT {
            self.answers.pop_front();
        }
        self.answers.push_back((came, Offset { offset_ns, uncertainty_ns }));
    }

    /// The best offset at `now_ns` of the own clock.
    pub fn offset(&self, now_ns: u64) -> Option<Offset> {
        let aged = |&(came, offset): &(u64, Offset)| {
            let drift_ns = (now_ns.saturating_sub(came) as f64 * DRIFT) as u64;
            Offset { uncertainty_ns: offset.uncertainty_ns.saturating_add(drift_ns), ..offset }
        };
        self.answers.iter().map(aged).min_by_key(|offset| offset.uncertainty_ns)
    }

    /// The other side has been started again, maybe on a host that was, too.
    pub fn forget(&mut self) {
        self.answers.clear();
    }
}

impl Offset {
    /// A time of the one clock by the other; 0 stays 0, a stamp that has not been set.
    pub fn translate(&self, time_ns: &mut u64) {
        if *time_ns != 0 {
            *time_ns = time_ns.saturating_add_signed(self.offset_ns).max(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_truth_lies_within_the_uncertainty(
            offset in -1_000_000_000_000_i64..1_000_000_000_000,
            drift in -50e-6..50e-6_f64,
            ways in proptest::collection::vec((1_u64..5_000_000, 1_u64..5_000_000, 0_u64..1_000_000), 1..200),
        ) {
            let mut clock = OtherClock::default();
            let mut now: u64 = 2_000_000_000_000;
            let other = |now: u64| {
                let drifted = (drift * (now - 2_000_000_000_000) as f64) as i64;
                now.checked_add_signed(offset + drifted).expect("a time")
            };
            for (there, back, busy) in ways {
                let (sent, received) = (now, other(now + there));
                let answered = other(now + there + busy);
                now += there + busy + back;
                clock.note([sent, received, answered, now]);
                now += 100_000_000;
                let known = clock.offset(now).expect("an offset");
                let truth = i128::from(other(now)) - i128::from(now);
                let error = (i128::from(known.offset_ns) - truth).unsigned_abs();
                prop_assert!(error <= u128::from(known.uncertainty_ns) + 2, "{error} {}", known.uncertainty_ns);
            }
        }
    }

    #[test]
    fn times_that_cannot_be_are_not_used() {
        let mut clock = OtherClock::default();
        clock.note([10, 5, 4, 20]);
        clock.note([10, 5, 50, 20]);
        clock.note([10, 0, u64::MAX, 5]);
        assert_eq!(clock.offset(100), None);
        clock.note([10, 1_010, 1_020, 40]);
        assert_eq!(clock.offset(40), Some(Offset { offset_ns: 990, uncertainty_ns: 11 }));
        let mut unset = 0;
        Offset { offset_ns: 990, uncertainty_ns: 11 }.translate(&mut unset);
        assert_eq!(unset, 0);
    }
}
