//! The processes of the chain as this program starts them: it is all of them, by its arguments.

use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::ValueEnum;
use common::config::{ChainConfig, SupervisionConfig};
use common::process::StageArgs;
use rustix::process::{Pid, Signal, kill_process};

/// Processes that the launcher can start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum StageName {
    RadarSim,
    PlotSource,
    Replay,
    PlotExtractor,
    Tracker,
    Recorder,
}

impl StageName {
    /// Name of the process.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::RadarSim => radar_sim::process::NAME,
            Self::PlotSource => plot_source::process::NAME,
            Self::Replay => recorder::replay_process::NAME,
            Self::PlotExtractor => plot_extractor::process::NAME,
            Self::Tracker => tracker::process::NAME,
            Self::Recorder => recorder::process::NAME,
        }
    }

    /// Runs the process in this one.
    pub(crate) fn run(self, args: &StageArgs) -> anyhow::Result<ExitCode> {
        match self {
            Self::RadarSim => radar_sim::process::run(args),
            Self::PlotSource => plot_source::process::run(args),
            Self::Replay => recorder::replay_process::run(args),
            Self::PlotExtractor => plot_extractor::process::run(args),
            Self::Tracker => tracker::process::run(args),
            Self::Recorder => recorder::process::run(args),
        }
    }

    /// Whether it drives the chain: its end is the end of the run.
    pub(crate) fn is_source(self) -> bool {
        matches!(self, Self::RadarSim | Self::PlotSource | Self::Replay)
    }

    /// The processes of `chain`, downstream first, so that consumers are there early.
    pub(crate) fn of(chain: &ChainConfig) -> Vec<Self> {
        let upstream = chain.upstream_of_recorder();
        let all = [Self::Tracker, Self::PlotExtractor, Self::RadarSim, Self::PlotSource, Self::Replay];
        let upstream = all.into_iter().filter(|stage| upstream.contains(&stage.name()));
        std::iter::once(Self::Recorder).chain(upstream).collect()
    }
}

/// Longest pause before a restart.
const LONGEST_BACKOFF: Duration = Duration::from_secs(5);
/// A stage that lives this long has recovered: the next restart is quick again.
const RECOVERED: Duration = Duration::from_secs(10);

/// One supervised process.
#[derive(Debug)]
pub(crate) struct Stage {
    pub(crate) name: StageName,
    pub(crate) restarts: u32,
    state: State,
    backoff: Duration,
}

#[derive(Debug)]
enum State {
    Running {
        child: Child,
        since: Instant,
    },
    Ended(ExitStatus),
    /// Died and is not wanted any more.
    GivenUp,
    Waiting {
        until: Instant,
    },
}

/// What has become of a stage since it was last looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Event {
    /// Running, waiting for its restart, or ended before.
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
    pub(crate) fn start(
        name: StageName,
        file: &Path,
        overrides: &[String],
        config: &SupervisionConfig,
    ) -> anyhow::Result<Self> {
        let backoff = Duration::from_secs_f64(config.backoff_s);
        Ok(Self { name, restarts: 0, state: spawn(name, file, overrides)?, backoff })
    }

    /// Starts it again.
    pub(crate) fn restart(&mut self, file: &Path, overrides: &[String]) -> anyhow::Result<()> {
        self.restarts += 1;
        self.state = spawn(self.name, file, overrides)?;
        Ok(())
    }

    /// Looks what has become of the process. After [`Event::Died`], [`Event::Due`] follows when its pause is over.
    pub(crate) fn look(&mut self, config: &SupervisionConfig) -> anyhow::Result<Event> {
        match &mut self.state {
            State::Ended(_) | State::GivenUp => Ok(Event::Nothing),
            State::Waiting { until } => Ok(if Instant::now() >= *until { Event::Due } else { Event::Nothing }),
            State::Running { child, since } => {
                let Some(status) = child.try_wait().context("waiting for a process")? else {
                    return Ok(Event::Nothing);
                };
                let lived = since.elapsed();
                if status.success() || status.code() == Some(i32::from(common::process::EXIT_CHECK_BROKEN)) {
                    self.state = State::Ended(status);
                    return Ok(Event::Ended);
                }
                if status.code() == Some(i32::from(common::process::EXIT_BAD_USAGE)) {
                    self.state = State::Ended(status);
                    return Ok(Event::Refused);
                }
                self.backoff = if lived > RECOVERED {
                    Duration::from_secs_f64(config.backoff_s)
                } else {
                    (self.backoff * 2).min(LONGEST_BACKOFF)
                };
                self.state = State::Waiting { until: Instant::now() + self.backoff / 2 };
                Ok(Event::Died(std::os::unix::process::ExitStatusExt::signal(&status)))
            }
        }
    }

    /// Whether it has ended and found something broken, or died at the end.
    pub(crate) fn found_broken(&self) -> bool {
        match &self.state {
            State::Ended(status) => !status.success(),
            State::GivenUp => !self.name.is_source(),
            _ => false,
        }
    }

    /// Does not start it again.
    pub(crate) fn give_up(&mut self) {
        self.state = State::GivenUp;
    }

    /// Whether it has ended for good.
    pub(crate) fn has_ended(&self) -> bool {
        matches!(self.state, State::Ended(_) | State::GivenUp)
    }

    /// Sends a signal, if it is running.
    pub(crate) fn signal(&self, signal: Signal) {
        if let State::Running { child, .. } = &self.state
            && let Some(pid) = Pid::from_raw(child.id().cast_signed())
        {
            let _ = kill_process(pid, signal);
        }
    }

    /// Ends it at once and waits for it.
    pub(crate) fn kill(&mut self) {
        if let State::Running { child, .. } = &mut self.state {
            let _ = child.kill();
            if let Ok(status) = child.wait() {
                self.state = State::Ended(status);
            }
        }
    }
}

/// Starts this program as `name`. It gets a process group of its own: Ctrl-C in the
/// terminal must reach the launcher alone, which then ends the source first.
fn spawn(name: StageName, file: &Path, overrides: &[String]) -> anyhow::Result<State> {
    let program = std::env::current_exe().context("finding this program's file")?;
    let mut command = Command::new(program);
    command.arg0(name.name()).arg("stage").arg(name.name()).arg("--config").arg(file);
    for argument in overrides {
        command.arg("--set").arg(argument);
    }
    let child =
        command.stdin(Stdio::null()).process_group(0).spawn().with_context(|| format!("starting {}", name.name()))?;
    Ok(State::Running { child, since: Instant::now() })
}
