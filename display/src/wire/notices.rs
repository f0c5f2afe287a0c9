//! Messages of a few words: how a viewer is served, what the processes say, where a recording stands.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

/// `pong`: the answer to a `ping`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Pong<'a> {
    r#type: &'static str,
    /// What came with the question.
    ping: &'a Value,
    /// The server's monotonic clock, µs.
    server_us: f64,
}

impl<'a> Pong<'a> {
    /// The answer at a time of that clock.
    pub fn new(ping: &'a Value, server_us: f64) -> Self {
        Self { r#type: "pong", ping, server_us }
    }
}

/// `error`: what was wrong with a message of the viewer.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Failure<'a> {
    r#type: &'static str,
    /// In one line.
    error: &'a str,
}

impl<'a> Failure<'a> {
    /// In these words.
    pub fn new(error: &'a str) -> Self {
        Self { r#type: "error", error }
    }
}

/// `dropped`: how many messages the viewer was not sent because it was slow.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Dropped {
    r#type: &'static str,
    /// Since it has come.
    messages: u64,
}

impl Dropped {
    /// So many.
    pub fn new(messages: u64) -> Self {
        Self { r#type: "dropped", messages }
    }
}

/// `reset`: what the viewer knows is of a picture that is no more.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Reset {
    r#type: &'static str,
}

impl Default for Reset {
    fn default() -> Self {
        Self { r#type: "reset" }
    }
}

/// `health`: what the processes say.
#[derive(Debug, Serialize, JsonSchema)]
pub struct HealthMessage {
    r#type: &'static str,
    /// Latest measurement time, s UTC.
    time_s: f64,
    /// What `radar-chain status --json` prints.
    #[schemars(with = "Map<String, Value>")]
    status: Value,
}

impl HealthMessage {
    /// What they have said by then.
    pub fn new(time_s: f64, status: Value) -> Self {
        Self { r#type: "health", time_s, status }
    }
}

/// `time`: where a recording stands.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TimeMessage {
    r#type: &'static str,
    /// Measurement time, s UTC.
    at_s: f64,
    playing: bool,
    /// Times recorded time.
    rate: f64,
}

impl TimeMessage {
    /// At a time, playing or not.
    pub fn new(at_s: f64, playing: bool, rate: f64) -> Self {
        Self { r#type: "time", at_s, playing, rate }
    }
}
