//! `[realtime.<stage>]`: real-time settings of a stage.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require, within};
use crate::topology::is_observer;

/// Scheduling class of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scheduling {
    /// The system's default class.
    #[default]
    Other,
    /// SCHED_FIFO: runs before every process of the default class, until it waits.
    Fifo,
}

/// How a stage waits for messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WaitStrategy {
    /// It sleeps until an event wakes it.
    #[default]
    Sleep,
    /// It looks all the time: about ten microseconds faster, and takes a whole processor.
    Poll,
}

/// Settings of one stage; a setting that the system refuses is reported once, and the stage goes on without it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StageRealtime {
    /// Processors it may run on; empty for all.
    pub cpus: Vec<usize>,
    /// `other` or `fifo`.
    pub scheduling: Scheduling,
    /// Priority among SCHED_FIFO processes, 1 to 98.
    pub priority: u8,
    /// Keeps all of its memory resident, touched before the first message.
    pub lock_memory: bool,
    /// `sleep` or `poll`; sources follow their clock and do not look at it.
    pub wait: WaitStrategy,
}

/// Nothing asked for.
static PLAIN: StageRealtime = StageRealtime {
    cpus: Vec::new(),
    scheduling: Scheduling::Other,
    priority: 50,
    lock_memory: false,
    wait: WaitStrategy::Sleep,
};

impl Default for StageRealtime {
    fn default() -> Self {
        PLAIN.clone()
    }
}

/// Settings of all stages.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RealtimeConfig {
    /// Of `radar-sim`, `plot-source` or a replay, whichever runs.
    pub source: StageRealtime,
    /// Of `plot-extractor`.
    pub plot_extractor: StageRealtime,
    /// Of `tracker`.
    pub tracker: StageRealtime,
    /// Of `recorder`.
    pub recorder: StageRealtime,
}

impl RealtimeConfig {
    /// The settings of the process with this name.
    pub fn of(&self, process: &str) -> &StageRealtime {
        match process {
            "plot-extractor" => &self.plot_extractor,
            "tracker" => &self.tracker,
            "recorder" => &self.recorder,
            // The chain does not wait for it: it must never run before a stage.
            observer if is_observer(observer) => &PLAIN,
            _ => &self.source,
        }
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let stages = [
            ("source", &self.source),
            ("plot_extractor", &self.plot_extractor),
            ("tracker", &self.tracker),
            ("recorder", &self.recorder),
        ];
        for (name, stage) in stages {
            within(&format!("realtime.{name}.priority"), stage.priority.into(), 1..=98)?;
            let key = format!("realtime.{name}.cpus");
            let valid = stage.cpus.iter().all(|&cpu| cpu < 1024);
            require(&key, format!("{:?}", stage.cpus), valid, "numbers of processors below 1024")?;
        }
        Ok(())
    }
}
