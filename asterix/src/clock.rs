//! Time of day to ns UTC, across midnight.

use crate::report::TimeOfDay;

/// A step of the time of day, ns.
pub const STEP_NS: i64 = 1_000_000_000 / TimeOfDay::STEPS_PER_S as i64;

/// Continues the time of day over midnight: of all days, the one is meant that brings a time
/// of day closest to the one before. Reports out of order are therefore taken right, and a leap second
/// (86 400 s of the day and more) is the last of its day.
#[derive(Debug, Clone)]
pub struct DayClock {
    midnight_ns: i64,
    last: Option<i64>,
}

impl DayClock {
    /// A clock whose first time of day belongs to the day that begins at `midnight_ns`.
    pub fn new(midnight_ns: u64) -> Self {
        Self { midnight_ns: midnight_ns as i64, last: None }
    }

    /// A clock whose first time of day is within half a day of `time_ns`.
    pub fn near(midnight_ns: u64, time_ns: i64) -> Self {
        let midnight_ns = midnight_ns as i64;
        Self { midnight_ns, last: Some((time_ns - midnight_ns) / STEP_NS) }
    }

    /// The UTC time, ns since 1970, of a time of day, of which only the lower bits may be known.
    pub fn time_ns(&mut self, time_of_day: TimeOfDay) -> i64 {
        let (time, period) = (i64::from(time_of_day.steps), i64::from(time_of_day.period));
        let last = self.last.unwrap_or(time);
        let forward = (time - last).rem_euclid(period);
        let step = if forward >= period / 2 { forward - period } else { forward };
        let steps = last + step;
        self.last = Some(steps);
        self.midnight_ns + steps * STEP_NS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(seconds: u32) -> TimeOfDay {
        TimeOfDay { steps: seconds * 128, period: TimeOfDay::DAY }
    }

    #[test]
    fn a_clock_may_be_set_back_over_midnight() {
        let mut clock = DayClock::new(5_000_000_000);
        assert_eq!(clock.time_ns(time(1)), 6_000_000_000);
        assert_eq!(clock.time_ns(time(86_399)), 4_000_000_000);
    }

    /// Category 001 sends the lower 16 bits: they begin again every 512 s.
    #[test]
    fn truncated_times_continue_those_before() {
        let mut clock = DayClock::new(0);
        let truncated = |seconds: u32| TimeOfDay { steps: seconds % 512 * 128, period: 1 << 16 };
        assert_eq!(clock.time_ns(time(40_000)), 40_000_000_000_000);
        for seconds in [40_001, 40_100, 40_099, 40_350, 40_600, 40_400] {
            assert_eq!(clock.time_ns(truncated(seconds)), i64::from(seconds) * 1_000_000_000);
        }
    }

    #[test]
    fn midnight_is_passed_forwards_and_backwards() {
        let day_s = 86_400;
        let mut clock = DayClock::new(1_000_000_000);
        let mut seconds = |time_of_day_s: u32| clock.time_ns(time(time_of_day_s)) / 1_000_000_000 - 1;
        assert_eq!(seconds(day_s - 1), 86_399);
        assert_eq!(seconds(1), 86_401); // the next day
        assert_eq!(seconds(day_s - 2), 86_398); // late, from before midnight
        assert_eq!(seconds(3), 86_403);
        assert_eq!(seconds(day_s / 3), 86_400 + 28_800);
        assert_eq!(seconds(2 * day_s / 3), 86_400 + 57_600);
        assert_eq!(seconds(day_s - 1), 86_400 + 86_399);
        assert_eq!(seconds(0), 2 * 86_400);
        assert_eq!(seconds(day_s), 2 * 86_400); // a leap second, should the day have one
        assert_eq!(seconds(0), 2 * 86_400);
    }
}
