//! When the datagrams of a recording were sent, by the times of day in them.

use asterix::clock::DayClock;
use asterix::report::TimeOfDay;
use common::units::{DAY_NS, NS_PER_S};

/// Times that differ by more from those around them are wrong, or the clock was set, or the recording paused.
const JUMP_NS: i64 = 10 * NS_PER_S as i64;

/// What a datagram says of its time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Said {
    /// The last time of day in it.
    pub(super) time_of_day: Option<TimeOfDay>,
    /// When it was captured, ns since 1970.
    pub(super) captured_ns: Option<u64>,
}

/// Times of datagrams, one recording after the other, on one clock: the day of the first one is the second of all.
#[derive(Debug, Default)]
pub(super) struct Schedule {
    first_ns: Option<i64>,
}

impl Schedule {
    /// Times of a recording, ns, that never go back; none if nothing tells them. Without any time of day those of capture count. A
    /// single wrong time is passed over, a clock that is set back stands still; a pause stays.
    pub(super) fn of(&mut self, said: &[Said]) -> Option<Vec<u64>> {
        let times = self.of_day(said).or_else(|| self.of_capture(said))?;
        let (mut now_ns, mut offset_ns) = (*times.iter().flatten().next()?, 0);
        let mut schedule = Vec::with_capacity(times.len());
        for (index, time_ns) in times.iter().enumerate() {
            if let Some(time_ns) = time_ns.map(|time_ns| time_ns + offset_ns) {
                let is_near = |other_ns: i64| (other_ns - now_ns).abs() <= JUMP_NS;
                let next_ns = times[index + 1..].iter().flatten().next().map(|next_ns| next_ns + offset_ns);
                if !is_near(time_ns) && next_ns.is_some_and(is_near) {
                    // wrong
                } else if time_ns < now_ns - JUMP_NS {
                    offset_ns += now_ns - time_ns;
                } else {
                    now_ns = now_ns.max(time_ns); // what is late in the recording was late on the line
                }
            }
            schedule.push(now_ns.max(0) as u64);
        }
        Some(schedule)
    }

    fn of_day(&mut self, said: &[Said]) -> Option<Vec<Option<i64>>> {
        // Truncated times need a full one near them.
        let first = said.iter().filter_map(|of| of.time_of_day).min_by_key(|time| time.period != TimeOfDay::DAY)?;
        let from_midnight_ns = DayClock::new(0).time_ns(first);
        let near_ns = *self.first_ns.get_or_insert(DAY_NS as i64 + from_midnight_ns);
        let mut clock = DayClock::near(DAY_NS, near_ns);
        if first.period == TimeOfDay::DAY {
            clock.time_ns(first);
        }
        Some(said.iter().map(|of| of.time_of_day.map(|time| clock.time_ns(time))).collect())
    }

    fn of_capture(&mut self, said: &[Said]) -> Option<Vec<Option<i64>>> {
        let first = said.iter().find_map(|of| of.captured_ns)?;
        let of_day_ns = (first % DAY_NS) as i64;
        let near_ns = *self.first_ns.get_or_insert(DAY_NS as i64 + of_day_ns);
        let days = ((near_ns - of_day_ns) as f64 / DAY_NS as f64).round() as i64;
        let begin_ns = of_day_ns + days * DAY_NS as i64;
        Some(said.iter().map(|of| of.captured_ns.map(|at_ns| begin_ns + (at_ns as i64 - first as i64))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = NS_PER_S as u64;

    fn said(seconds: f64) -> Said {
        let steps = (seconds * 128.0) as u32;
        Said { time_of_day: Some(TimeOfDay { steps, period: TimeOfDay::DAY }), captured_ns: None }
    }

    /// Times since the first, s.
    fn since(times: &[u64]) -> Vec<f64> {
        times.iter().map(|time| (time - times[0]) as f64 * 1e-9).collect()
    }

    fn of(times_s: &[f64]) -> Vec<f64> {
        let all: Vec<Said> = times_s.iter().map(|&seconds| said(seconds)).collect();
        since(&Schedule::default().of(&all).expect("times"))
    }

    #[test]
    fn wrong_times_cost_nothing_and_pauses_stay() {
        assert_eq!(of(&[10.0, 11.0, 10.5, 12.0]), [0.0, 1.0, 1.0, 2.0], "late");
        assert_eq!(of(&[10.0, 11.0, 3700.0, 12.0]), [0.0, 1.0, 1.0, 2.0], "ahead");
        assert_eq!(of(&[36_000.0, 36_001.0, 11.0, 36_002.0]), [0.0, 1.0, 1.0, 2.0], "behind");
        assert_eq!(of(&[1000.0, 1001.0, 401.0, 402.0]), [0.0, 1.0, 1.0, 2.0], "set back");
        assert_eq!(of(&[1000.0, 1001.0, 1901.0, 1902.0]), [0.0, 1.0, 901.0, 902.0], "paused");
        assert_eq!(of(&[86_399.0, 0.5, 1.0]), [0.0, 1.5, 2.0], "midnight");
    }

    #[test]
    fn recordings_keep_their_time_with_each_other_over_midnight() {
        for (one, other) in [(86_398.0, 1.0), (1.0, 86_398.0)] {
            let mut schedule = Schedule::default();
            let first = schedule.of(&[said(one)]).expect("a time")[0];
            let second = schedule.of(&[said(other)]).expect("a time")[0];
            assert_eq!(first.abs_diff(second), 3 * SECOND, "{one} {other}");
        }
    }

    #[test]
    fn truncated_times_are_those_near_a_full_one() {
        let truncated = |seconds: u32| Said {
            time_of_day: Some(TimeOfDay { steps: seconds % 512 * 128, period: 1 << 16 }),
            captured_ns: None,
        };
        for hour in [3, 10, 17, 23] {
            let second = 3600 * hour;
            let all = [truncated(second), said(f64::from(second + 1)), truncated(second + 2)];
            assert_eq!(since(&Schedule::default().of(&all).expect("times")), [0.0, 1.0, 2.0], "{hour} h");
        }
    }

    #[test]
    fn times_of_capture_count_where_no_time_of_day_is_said() {
        let captured = |seconds: u64| Said { captured_ns: Some(seconds * SECOND), ..Said::default() };
        let all = [captured(86_399), captured(86_401), Said::default()];
        assert_eq!(since(&Schedule::default().of(&all).expect("times")), [0.0, 2.0, 2.0]);
        assert!(Schedule::default().of(&[Said::default()]).is_none());
    }
}
