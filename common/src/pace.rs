//! Keeps a source's messages apart as the radar would.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::units::seconds_between;

/// Pace of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// Times real time.
    Times(f64),
    /// As fast as the chain accepts.
    Max,
}

impl std::fmt::Display for Speed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Speed::Times(factor) => write!(formatter, "{factor}×"),
            Speed::Max => formatter.write_str("max"),
        }
    }
}

impl Serialize for Speed {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Speed::Times(factor) => serializer.serialize_f64(*factor),
            Speed::Max => serializer.serialize_str("max"),
        }
    }
}

impl<'de> Deserialize<'de> for Speed {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged, expecting = "expected a number above 0 (times real time) or \"max\"")]
        enum Raw {
            Float(f64),
            Text(String),
        }
        let text = match Raw::deserialize(deserializer)? {
            Raw::Float(factor) => return Ok(Speed::Times(factor)),
            Raw::Text(text) => text,
        };
        text.parse().map_err(serde::de::Error::custom)
    }
}

impl std::str::FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "max" => Ok(Speed::Max),
            number => match number.parse() {
                Ok(factor) if (1e-6..=1e6).contains(&factor) => Ok(Speed::Times(factor)),
                _ => Err(format!("`{number}` is neither a number from 1e-6 to 1e6 (times real time) nor `max`")),
            },
        }
    }
}

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
