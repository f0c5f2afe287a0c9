//! Time of day to ns UTC, across midnight.

/// Steps of I010/140 in a second.
const STEPS_PER_S: i64 = 128;
/// A step, ns.
pub const STEP_NS: i64 = 1_000_000_000 / STEPS_PER_S;
/// Steps in a day.
const DAY: i64 = 86_400 * STEPS_PER_S;

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

    /// The UTC time, ns since 1970, of a time of day in 1/128 s.
    pub fn time_ns(&mut self, time_of_day: u32) -> i64 {
        let time = i64::from(time_of_day);
        let last = self.last.unwrap_or(time);
        let forward = (time - last).rem_euclid(DAY);
        let step = if forward >= DAY / 2 { forward - DAY } else { forward };
        let steps = last + step;
        self.last = Some(steps);
        self.midnight_ns + steps * STEP_NS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_may_be_set_back_over_midnight() {
        let mut clock = DayClock::new(5_000_000_000);
        assert_eq!(clock.time_ns(128), 6_000_000_000);
        assert_eq!(clock.time_ns(86_399 * 128), 4_000_000_000);
    }

    #[test]
    fn midnight_is_passed_forwards_and_backwards() {
        let day_s = 86_400;
        let mut clock = DayClock::new(1_000_000_000);
        let mut seconds = |time_of_day_s: u32| clock.time_ns(time_of_day_s * 128) / 1_000_000_000 - 1;
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
