//! The clock of a radar that is listened to, beside that of this computer.
//!
//! Times of day become measurement times, ns UTC. A clock that is set, by any amount, is noticed by how long messages seem to be on
//! their way; measurement time then goes on as if it had not been set. A single wrong time is refused.

use asterix::clock::DayClock;
use asterix::report::TimeOfDay;
use common::health::Reject;
use common::units::DAY_NS;

/// A clock that differs by more than this from what it did is set, if it stays so, ns.
const CLOCK_SET_NS: f64 = 1e9;
/// Messages in a row that agree about it, after which it has been set.
const CLOCK_SET_MESSAGES: u32 = 3;
/// Share by which the delay of messages grows towards that of the latest: the least of the last ones counts.
const DELAY_GROWTH: f64 = 1e-3;

/// The radar's clock, as far as its messages have told.
#[derive(Debug, Default)]
pub struct RadarClock {
    /// How long messages are on their way, ns; may be negative: clocks differ. None before the first message.
    delay_ns: Option<f64>,
    /// Added to the radar's clock, ns: what it has been set by.
    offset_ns: i64,
    /// Another delay, ns, and the messages in a row that had it.
    other: Option<(f64, u32)>,
    times_set: u64,
}

impl RadarClock {
    /// How long messages are on their way, ns; 0 before the first one.
    pub fn delay_ns(&self) -> i64 {
        self.delay_ns.unwrap_or(0.0) as i64
    }

    /// How often the clock was set.
    pub fn times_set(&self) -> u64 {
        self.times_set
    }

    /// Measurement time at `now_ns` of this computer, ns.
    pub fn present_ns(&self, now_ns: u64) -> i64 {
        now_ns as i64 - self.delay_ns()
    }

    /// Measurement time of a time of day that is said at `now_ns`, by the clock as it is set at present, ns.
    pub fn time_ns(&self, time: TimeOfDay, now_ns: u64) -> i64 {
        let expected_ns = self.present_ns(now_ns) - self.offset_ns;
        DayClock::near(now_ns - now_ns % DAY_NS, expected_ns).time_ns(time) + self.offset_ns
    }

    /// The same of a message of the radar, which tells whether its clock has been set.
    ///
    /// # Errors
    /// [`Reject::NoTime`]: the time fits no message before; it may be a single wrong one.
    pub fn take(&mut self, time: TimeOfDay, now_ns: u64) -> Result<i64, Reject> {
        let time_ns = self.time_ns(time, now_ns);
        let delay_ns = (now_ns as i64 - time_ns) as f64;
        let usual_ns = *self.delay_ns.get_or_insert(delay_ns);
        let agrees = |other_ns: f64| (delay_ns - other_ns).abs() <= CLOCK_SET_NS;
        if agrees(usual_ns) {
            self.other = None;
            self.delay_ns = Some(delay_ns.min(usual_ns + DELAY_GROWTH * (delay_ns - usual_ns).max(0.0)));
            return Ok(time_ns);
        }
        let messages = self.other.filter(|&(other_ns, _)| agrees(other_ns)).map_or(1, |(_, messages)| messages + 1);
        if messages < CLOCK_SET_MESSAGES {
            self.other = Some((delay_ns, messages));
            return Err(Reject::NoTime);
        }
        let by_ns = (delay_ns - usual_ns) as i64;
        self.times_set += 1;
        self.offset_ns += by_ns;
        self.other = None;
        Ok(time_ns + by_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 1_000_000_000;
    const MIDNIGHT_NS: u64 = 20_000 * DAY_NS;

    fn of_day(seconds: u32) -> TimeOfDay {
        TimeOfDay { steps: seconds * TimeOfDay::STEPS_PER_S, period: TimeOfDay::DAY }
    }

    /// Measurement times since midnight, s, of messages that say `said` (s) and arrive 2 s later by `now` (s).
    fn taken(clock: &mut RadarClock, messages: &[(u32, u64)]) -> Vec<Option<i64>> {
        let take = |&(said, now): &(u32, u64)| {
            let time_ns = clock.take(of_day(said), MIDNIGHT_NS + now * SECOND).ok()?;
            Some((time_ns - MIDNIGHT_NS as i64) / SECOND as i64)
        };
        messages.iter().map(take).collect()
    }

    #[test]
    fn a_wrong_time_is_refused_and_a_clock_that_is_set_is_followed() {
        let mut clock = RadarClock::default();
        let times = taken(&mut clock, &[(100, 102), (500, 103), (102, 104)]);
        assert_eq!((times, clock.times_set()), (vec![Some(100), None, Some(102)], 0));
        // Set back by 50 s: the third message is believed, and measurement time has gone on.
        let times = taken(&mut clock, &[(53, 105), (54, 106), (55, 107), (56, 108)]);
        assert_eq!((times, clock.times_set()), (vec![None, None, Some(105), Some(106)], 1));
        assert_eq!(clock.time_ns(of_day(57), MIDNIGHT_NS + 109 * SECOND), (MIDNIGHT_NS + 107 * SECOND) as i64);
        assert_eq!((clock.delay_ns(), clock.present_ns(10 * SECOND)), (2 * SECOND as i64, 8 * SECOND as i64));
    }
}
