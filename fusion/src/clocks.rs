//! In real time, which time it is, and which site's clock is wrong.
//!
//! What a site told last, moved on by the time since, is what its clock says now. Messages may be late, so a clock that is behind may be
//! right; they are never early. Most sites are right, so the median of their clocks is.

use common::units::seconds_between;

/// What the clock of a site that is heard says now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clock {
    /// Measurement time, ns UTC.
    pub(crate) time_ns: u64,
    /// How far it may be from the others, s.
    pub(crate) within_s: f64,
}

/// The clocks of all sites together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Common {
    /// The median; of an even number, the later of the two.
    pub(crate) time_ns: u64,
    /// Whether most clocks agree with it.
    pub(crate) is_majority: bool,
}

impl Common {
    /// Of the clocks of sites that are heard; `None` without one.
    pub(crate) fn of(clocks: &[Clock]) -> Option<Self> {
        let mut times: Vec<u64> = clocks.iter().map(|of| of.time_ns).collect();
        times.sort_unstable();
        let time_ns = *times.get(times.len() / 2)?;
        let agreeing = clocks.iter().filter(|of| seconds_between(time_ns, of.time_ns).abs() <= of.within_s).count();
        Some(Self { time_ns, is_majority: 2 * agreeing > clocks.len() })
    }

    /// How far a clock is ahead of what is right, s; 0 for one that may be right. Where no majority says what is right, only one that is
    /// `hopeless_s` away is wrong.
    pub(crate) fn wrong_by_s(&self, clock: &Clock, hopeless_s: f64) -> f64 {
        let ahead_s = seconds_between(self.time_ns, clock.time_ns);
        let allowed_s = if self.is_majority { clock.within_s } else { hopeless_s };
        if ahead_s.abs() > allowed_s { ahead_s } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOON_NS: u64 = 1_700_000_000_000_000_000;

    /// What is said of clocks that are so far ahead, each allowed 3 s: how far the common time is ahead, and how wrong each is.
    fn judged(ahead_s: &[i64]) -> (f64, Vec<f64>) {
        let clock =
            |ahead_s: &i64| Clock { time_ns: NOON_NS.saturating_add_signed(ahead_s * 1_000_000_000), within_s: 3.0 };
        let clocks: Vec<Clock> = ahead_s.iter().map(clock).collect();
        let common = Common::of(&clocks).expect("a clock");
        let wrong = clocks.iter().map(|clock| common.wrong_by_s(clock, 60.0));
        (seconds_between(NOON_NS, common.time_ns), wrong.collect())
    }

    #[test]
    fn the_one_clock_that_is_wrong_is_named_and_drives_nobody() {
        for ahead_s in [-59, -20, -5, 5, 20, 59, 100_000] {
            for wrong in 0..3 {
                let mut clocks = [0; 3];
                clocks[wrong] = ahead_s;
                let expected: Vec<f64> = clocks.iter().map(|&of| of as f64).collect();
                assert_eq!(judged(&clocks), (0.0, expected));
            }
        }
        assert_eq!(judged(&[0, 2, -2]), (0.0, vec![0.0; 3]));
        assert_eq!(judged(&[0, 5, 5, 0, 1]), (1.0, vec![0.0, 4.0, 4.0, 0.0, 0.0]));
    }

    #[test]
    fn of_two_clocks_nobody_knows_which_is_right() {
        assert_eq!(judged(&[0, 5]), (5.0, vec![0.0; 2]));
        assert_eq!(judged(&[0, 70]), (70.0, vec![-70.0, 0.0]));
        assert_eq!(judged(&[0, 5, 10]), (5.0, vec![0.0; 3]));
        assert_eq!(judged(&[7]), (7.0, vec![0.0]));
        assert_eq!(Common::of(&[]), None);
    }
}
