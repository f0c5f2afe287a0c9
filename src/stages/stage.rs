//! One supervised process: started, started again after a pause that grows, ended.

use std::path::Path;
use std::time::{Duration, Instant};

use common::config::SupervisionConfig;
use common::process::{EXIT_BAD_USAGE, EXIT_CHECK_BROKEN};
use rustix::process::Signal;

use super::child::Process;
use super::name::StageId;

/// Longest pause before a restart: a stage is back within a scan or two even if it died often.
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);
/// A stage that lives this long has recovered: the next restart is quick again.
const RECOVERED: Duration = Duration::from_secs(2);
/// After this time every living process has said where it stands.
const HEARD_ALL: Duration = Duration::from_millis(1500);

/// One supervised process.
#[derive(Debug)]
pub(crate) struct Stage {
    pub(crate) id: StageId,
    /// Since when it may hang: it is silent, and none of its consumers is.
    pub(crate) suspected: Option<Instant>,
    pub(crate) restarts: u32,
    state: State,
    backoff: Duration,
}

#[derive(Debug)]
enum State {
    Running {
        process: Process,
        since: Instant,
    },
    /// Died; it is started again at this time.
    Waiting {
        until: Instant,
    },
    /// Ended, and whether it found something broken.
    Ended {
        broken: bool,
    },
    /// Died when it could not be started again any more.
    GivenUp,
}

/// What has become of a stage since the last look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Event {
    /// Nothing new.
    Nothing,
    /// Ended with success.
    Ended,
    /// Ended because its input or configuration cannot be used.
    Refused,
    /// Died: by a signal (`Some`) or with an error.
    Died(Option<i32>),
    /// Is to be started again now.
    Due,
}

impl Stage {
    /// Starts a process with the configuration in `file` and `overrides`.
    pub(crate) fn start(id: StageId, file: &Path, config: &SupervisionConfig) -> anyhow::Result<Self> {
        let state = State::Running { process: Process::start(&id, file, &[])?, since: Instant::now() };
        Ok(Self::new(id, state, config))
    }

    /// Takes over a process that another launcher has started; one that is no more (`None`) is
    /// started again when everybody has had time to say where the run stands.
    pub(crate) fn adopt(id: StageId, pid: Option<u32>, config: &SupervisionConfig) -> Self {
        let found = pid.and_then(Process::adopt);
        let state = match found {
            Some(process) => State::Running { process, since: Instant::now() },
            None => State::Waiting { until: Instant::now() + HEARD_ALL },
        };
        Self::new(id, state, config)
    }

    fn new(id: StageId, state: State, config: &SupervisionConfig) -> Self {
        Self { id, suspected: None, restarts: 0, state, backoff: first_pause(config) }
    }

    /// Takes over a process that another launcher has started, and that was not seen before.
    pub(crate) fn take_over(&mut self, pid: u32) -> bool {
        let Some(process) = Process::adopt(pid) else { return false };
        self.state = State::Running { process, since: Instant::now() };
        true
    }

    /// Starts it again. Where that fails the next attempt is due after a pause.
    pub(crate) fn restart(&mut self, file: &Path, overrides: &[String]) -> anyhow::Result<()> {
        self.restarts += 1;
        match Process::start(&self.id, file, overrides) {
            Ok(process) => self.state = State::Running { process, since: Instant::now() },
            Err(error) => {
                self.pause();
                return Err(error);
            }
        }
        Ok(())
    }

    /// Waits before the next start, twice as long as before the last one.
    fn pause(&mut self) {
        self.state = State::Waiting { until: Instant::now() + self.backoff };
        self.backoff = (self.backoff * 2).min(LONGEST_BACKOFF);
    }

    /// Looks what has become of the process; `said_end` tells whether its last words were that it ends.
    /// After [`Event::Died`], [`Event::Due`] follows when its pause is over.
    pub(crate) fn look(&mut self, config: &SupervisionConfig, said_end: bool) -> anyhow::Result<Event> {
        match &mut self.state {
            State::Ended { .. } | State::GivenUp => Ok(Event::Nothing),
            State::Waiting { until } => Ok(if Instant::now() >= *until { Event::Due } else { Event::Nothing }),
            State::Running { process, since } => {
                let lived = since.elapsed();
                let Some((code, signal)) = process.exit(said_end)? else { return Ok(Event::Nothing) };
                match code.map(u8::try_from) {
                    Some(Ok(0)) => self.state = State::Ended { broken: false },
                    Some(Ok(EXIT_CHECK_BROKEN)) => self.state = State::Ended { broken: true },
                    // One that worked before will again when what it misses is back.
                    Some(Ok(EXIT_BAD_USAGE)) if self.restarts == 0 => {
                        self.state = State::Ended { broken: true };
                        return Ok(Event::Refused);
                    }
                    _ => {
                        if lived > RECOVERED {
                            self.backoff = first_pause(config);
                        }
                        self.pause();
                        return Ok(Event::Died(signal));
                    }
                }
                Ok(Event::Ended)
            }
        }
    }

    /// Its process and how long that has been running, if it is.
    pub(crate) fn running(&self) -> Option<(u32, Duration)> {
        match &self.state {
            State::Running { process, since } => Some((process.id(), since.elapsed())),
            _ => None,
        }
    }

    /// Whether the run neither waits for it nor depends on it.
    pub(crate) fn is_observer(&self) -> bool {
        self.id.stage.is_observer()
    }

    /// Whether it has ended and found something broken, or died at the end.
    pub(crate) fn found_broken(&self) -> bool {
        match &self.state {
            _ if self.is_observer() => false,
            State::Ended { broken } => *broken,
            State::GivenUp => !self.id.stage.is_source(),
            _ => false,
        }
    }

    /// Does not start it again.
    pub(crate) fn give_up(&mut self) {
        self.state = State::GivenUp;
    }

    /// Whether it has ended for good.
    pub(crate) fn has_ended(&self) -> bool {
        matches!(self.state, State::Ended { .. } | State::GivenUp)
    }

    /// Sends a signal, if it is running.
    pub(crate) fn signal(&self, signal: Signal) {
        if let State::Running { process, .. } = &self.state {
            process.signal(signal);
        }
    }

    /// Ends it at once and waits for it.
    pub(crate) fn kill(&mut self) {
        if let State::Running { process, .. } = &mut self.state {
            process.kill();
            self.state = State::Ended { broken: true };
        }
    }
}

/// The pause before the first restart.
fn first_pause(config: &SupervisionConfig) -> Duration {
    Duration::try_from_secs_f64(config.backoff_s).map_or(LONGEST_BACKOFF, |pause| pause.min(LONGEST_BACKOFF))
}
