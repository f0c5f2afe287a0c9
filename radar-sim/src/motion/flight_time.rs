//! The times of a recorded flight: numbers or text, with or without a date.

use jiff::civil::{DateTime, Time};
use jiff::tz::TimeZone;
use jiff::{Timestamp, Unit};

/// Seconds in a day.
const DAY_S: f64 = 86_400.0;

/// Reads the times of successive rows as seconds that go on over midnight.
#[derive(Debug, Default)]
pub(super) struct FlightClock {
    days: f64,
    /// Of the row before, if it may have been one of the day.
    last_of_day_s: Option<f64>,
}

impl FlightClock {
    /// Seconds of a row: a number of seconds (since any moment, or of the day), `2024-05-05T10:00:00Z`,
    /// `2024-05-05 10:00:00` or `10:00:00`, with fractions. Nothing if the text is none of these.
    ///
    /// A time of day that is half a day before the one of the row before is of the next day.
    pub(super) fn read(&mut self, text: &str) -> Option<f64> {
        let (seconds, is_of_day) = parse(text)?;
        let time_s = seconds + self.days * DAY_S;
        let is_next_day = is_of_day && self.last_of_day_s.is_some_and(|last_s| time_s < last_s - DAY_S / 2.0);
        self.days += f64::from(u8::from(is_next_day));
        let time_s = if is_next_day { time_s + DAY_S } else { time_s };
        self.last_of_day_s = is_of_day.then_some(time_s);
        Some(time_s)
    }
}

/// Seconds, and whether they may count from midnight.
fn parse(text: &str) -> Option<(f64, bool)> {
    if let Ok(seconds) = text.parse::<f64>() {
        return seconds.is_finite().then_some((seconds, (0.0..=DAY_S + 1.0).contains(&seconds)));
    }
    let of_date = |time: Timestamp| (time.as_nanosecond() as f64 * 1e-9, false);
    let date = || text.parse::<DateTime>().ok()?.to_zoned(TimeZone::UTC).ok();
    let time = text.parse::<Timestamp>().ok().or_else(|| Some(date()?.timestamp()));
    time.map(of_date).or_else(|| {
        let since_midnight = text.parse::<Time>().ok()?.since(Time::midnight()).ok()?;
        Some((since_midnight.total(Unit::Second).ok()?, true))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(texts: &[&str]) -> Vec<f64> {
        let mut clock = FlightClock::default();
        let times: Vec<f64> = texts.iter().map(|text| clock.read(text).expect(text)).collect();
        times.iter().map(|time| ((time - times[0]) * 1e3).round() / 1e3).collect()
    }

    #[test]
    fn seconds_of_the_day_go_on_over_midnight() {
        assert_eq!(read(&["86398.5", "86399.5", "0.5", "1.5"]), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(
            read(&["23:59:59.25", "00:00:00.25", "12:00:00", "23:59:59", "00:00:01"]),
            [0.0, 1.0, 43_200.75, 86_399.75, 86_401.75]
        );
        assert_eq!(read(&["100", "99.5", "101"]), [0.0, -0.5, 1.0]); // out of order, not a day later
        assert_eq!(read(&["90000", "3000"]), [0.0, -87_000.0]); // not of a day
    }

    #[test]
    fn dates_in_any_form_are_read() {
        assert_eq!(read(&["1575888575.5", "1575888577"]), [0.0, 1.5]);
        assert_eq!(read(&["2019-12-31T23:59:59Z", "2020-01-01T01:00:00.5+01:00"]), [0.0, 1.5]);
        assert_eq!(read(&["2019-12-31 23:59:59", "2020-01-01T00:00:00.125"]), [0.0, 1.125]);
        for text in ["", "noon", "NaN", "inf", "2019-13-01", "25:00:00"] {
            assert_eq!(FlightClock::default().read(text), None, "{text}");
        }
    }
}
