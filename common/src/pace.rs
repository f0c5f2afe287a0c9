//! Keeps a source's messages apart as the radar would.

use std::time::{Duration, Instant};

use crate::config::Speed;
use crate::units::seconds_between;

/// Lets measurement time pass at a multiple of processing time.
#[derive(Debug)]
pub struct Pace {
    factor: Option<f64>,
    /// Measurement time and the moment at which it was due.
    start: Option<(u64, Instant)>,
}

impl Pace {
    /// A pace of `speed`; it begins with the first message.
    pub fn new(speed: Speed) -> Self {
        let factor = match speed {
            Speed::Max => None,
            Speed::Times(factor) => Some(factor),
        };
        Self { factor, start: None }
    }

    /// Sleeps until measurement time `time_ns` is due, and calls `meanwhile` every half second. What is late goes out
    /// at once; after a second of delay the schedule starts anew instead of hurrying after it.
    ///
    /// # Errors
    /// Those of `meanwhile`.
    pub fn wait_until<E>(&mut self, time_ns: u64, mut meanwhile: impl FnMut() -> Result<(), E>) -> Result<(), E> {
        let Some(factor) = self.factor else { return Ok(()) };
        let now = Instant::now();
        let (start_ns, start) = *self.start.get_or_insert((time_ns, now));
        let due = start + Duration::from_secs_f64((seconds_between(start_ns, time_ns) / factor).max(0.0));
        if now.saturating_duration_since(due) > Duration::from_secs(1) {
            self.start = Some((time_ns, now));
        }
        while let Some(early) = due.checked_duration_since(Instant::now()).filter(|early| !early.is_zero()) {
            std::thread::sleep(early.min(Duration::from_millis(500)));
            if early > Duration::from_millis(500) {
                meanwhile()?;
            }
        }
        Ok(())
    }
}
