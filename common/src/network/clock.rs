//! The clock beside which a live source is.

use std::time::{Duration, Instant};

use crate::pace::Speed;
use crate::process::new_session;

/// The time of this computer, or one that runs at a multiple of it: for recordings that are sent faster.
#[derive(Debug, Clone, Copy)]
pub struct LiveClock {
    start: Instant,
    start_ns: u64,
    factor: f64,
}

impl LiveClock {
    /// Starts now; [`Speed::Max`] is that of this computer.
    pub fn start(speed: Speed) -> Self {
        let factor = match speed {
            Speed::Times(factor) => factor,
            Speed::Max => 1.0,
        };
        Self { start: Instant::now(), start_ns: new_session(), factor }
    }

    /// ns UTC.
    pub fn now_ns(&self) -> u64 {
        self.start_ns + (self.start.elapsed().as_nanos() as f64 * self.factor) as u64
    }

    /// How long until a time of this clock has come.
    pub fn until(&self, time_ns: u64) -> Duration {
        Duration::from_nanos((time_ns.saturating_sub(self.now_ns()) as f64 / self.factor) as u64)
    }
}
