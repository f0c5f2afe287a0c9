//! Common parts of all process shells: arguments, signals, logging, health, exit codes.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use sd_notify::NotifyState;

pub use crate::bad_input::BadInput;
pub use crate::stop::{signals, stop_requested};

use crate::config::{self, ChainConfig, ConfigError, Sites};
use crate::health::{Condition, Health, HealthHeader};
use crate::ipc::{Domain, IpcError, ObserverLosses, Publisher, Station, Watchdog};
use crate::logging;
use crate::messages::HealthReports;
use crate::printable::printable;
use crate::recording::RecordingError;
use crate::stop::{self, Asked};
use crate::time::{monotonic_ns, open_files, process_cpu_ns, resident_bytes};

/// Exit code: the chain ran, but a budget, loss limit or check was broken.
pub const EXIT_CHECK_BROKEN: u8 = 1;
/// Exit code: bad usage or configuration.
pub const EXIT_BAD_USAGE: u8 = 2;
/// Exit code: a process failed.
pub const EXIT_FAILED: u8 = 3;

/// Arguments that every process of the chain takes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct StageArgs {
    /// Configuration of the chain (TOML); defaults alone without it
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Override one key, for example --set extractor.pfa=1e-4
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    /// Prefix of the shared memory, to separate this chain from others on the machine
    #[arg(long, value_name = "PREFIX")]
    pub ipc_prefix: Option<String>,
    /// Which site, of a configuration that has several
    #[arg(long, value_name = "NAME")]
    pub site: Option<String>,
    /// Resume the run of this domain where its keeper has recorded it
    #[arg(long, value_name = "WHAT")]
    pub resume: Option<Resume>,
}

/// What a stage that is started again goes on with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Resume {
    /// A source: the scan after the last one that anybody has seen
    Scan,
    /// A tracker: track numbers that no track has had
    Tracks,
    /// A recorder: the same run
    Run,
}

impl Resume {
    /// The key of the configuration that says it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Scan => "run.first_scan",
            Self::Tracks => "run.first_track",
            Self::Run => "run.id",
        }
    }
}

/// Where the keeper of a domain writes down what a stage that is started again goes on with; `site` is the one that
/// `--site` names.
pub fn resume_file(site: Option<&str>) -> String {
    site.map_or("resume".to_string(), |site| format!("resume-{site}"))
}

impl StageArgs {
    /// The effective configuration of the site that the process works for.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn load(&self) -> Result<ChainConfig, ConfigError> {
        let sites = self.load_sites()?;
        match (&self.site, sites.only()) {
            (Some(name), _) => Ok(sites.named(name)?.clone()),
            (None, Some(only)) => Ok(only.clone()),
            (None, None) => sites.named("not given (--site)").cloned(),
        }
    }

    /// The effective configuration of all sites, for a process that serves all of them.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn load_sites(&self) -> Result<Sites, ConfigError> {
        let mut overrides = self.overrides.clone();
        if let Some(prefix) = &self.ipc_prefix {
            overrides.push(format!("ipc.prefix={prefix}"));
        }
        let sites = config::load_sites(self.config.as_deref(), &overrides)?;
        let Some(resume) = self.resume else { return Ok(sites) };
        let file = Domain::root(&sites.first().ipc).join(resume_file(self.site.as_deref()));
        let place = std::fs::read_to_string(file).unwrap_or_default(); // none: the run begins
        overrides.extend(place.lines().filter(|line| line.starts_with(resume.key())).map(String::from));
        config::load_sites(self.config.as_deref(), &overrides)
    }
}

/// Runs the body of a process: logging, signals (the second ends it at once), and one line for an error.
pub fn run(name: &str, body: impl FnOnce() -> anyhow::Result<ExitCode>) -> ExitCode {
    stop::catch_signals(Asked::Worker);
    conclude(name, body)
}

/// As [`run`], for a process that ends others: it must live on at the second signal and looks at [`signals`].
pub fn supervise(name: &str, body: impl FnOnce() -> anyhow::Result<ExitCode>) -> ExitCode {
    stop::catch_signals(Asked::Supervisor);
    conclude(name, body)
}

fn conclude(name: &str, body: impl FnOnce() -> anyhow::Result<ExitCode>) -> ExitCode {
    let logging = logging::start();
    // As what `ps` and `top` show it: a stage is started from the launcher's open file, whose name says nothing.
    let _ = std::ffi::CString::new(name).map(|name| rustix::thread::set_name(&name));
    // Several processes may write to one terminal: each line says whose it is.
    let _process = tracing::error_span!("process", name).entered();
    let done = logging.map_err(anyhow::Error::from).and_then(|()| body());
    done.unwrap_or_else(|error| exit_code_of(name, &error))
}

/// Tells the user what has gone wrong in the process `name`; the exit code that says the same.
fn exit_code_of(name: &str, error: &anyhow::Error) -> ExitCode {
    if error.chain().any(|cause| matches!(cause.downcast_ref(), Some(IpcError::Stopped { .. }))) {
        return ExitCode::SUCCESS;
    }
    if logging::is_for_programs() {
        tracing::error!("{error:#}");
    } else {
        say(&format!("{name}: {error:#}"));
    }
    let usage = error.chain().any(|cause| {
        let unreadable = cause.downcast_ref().is_some_and(RecordingError::is_of_input);
        cause.is::<ConfigError>() || cause.is::<BadInput>() || unreadable
    });
    let memory = |cause: &IpcError| matches!(cause, IpcError::SharedMemoryTooSmall { .. } | IpcError::OtherUser { .. });
    let usage = usage || error.chain().any(|cause| cause.downcast_ref().is_some_and(memory));
    ExitCode::from(if usage { EXIT_BAD_USAGE } else { EXIT_FAILED })
}

/// Writes a line for the user to standard error, or a warning to a log that a program reads. Whoever read it may be
/// gone: that is no reason to end.
pub fn say(line: &str) {
    if logging::is_for_programs() {
        tracing::warn!("{line}");
        return;
    }
    write_line(line);
}

/// As [`say`], for what is worth no warning: how far the work has come.
pub fn tell(line: &str) {
    if logging::is_for_programs() {
        tracing::info!("{line}");
    } else {
        write_line(line);
    }
}

/// Writes results to standard output. Whoever reads them may have seen enough.
pub fn print(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

fn write_line(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(line));
}

/// A number that no earlier start of a process has had: ns since 1970.
pub fn new_session() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |elapsed| elapsed.as_nanos() as u64)
}

/// Publishes the health of a process: at every scan and at least once a second. A service manager that
/// watches over the process (`NOTIFY_SOCKET`) hears of it at the same times.
pub struct HealthReporter {
    publisher: Publisher<HealthReports>,
    losses: ObserverLosses,
    /// The report, to be kept up to date by the process.
    pub health: Health,
    watchdog: Watchdog,
    last: Option<Instant>,
    last_scan: u32,
}

impl HealthReporter {
    /// A reporter for the process of `station` in this `session`. `refused` are the real-time settings
    /// that [`crate::realtime::apply`] could not fulfil.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn new(station: &Station, chain: &ChainConfig, session: u64, refused: u32) -> Result<Self, IpcError> {
        let mut health = Health { session, pid: std::process::id(), refused, ..Health::default() };
        (health.process, health.site) = (station.process().into(), station.site().into());
        tracing::info!(process = station.process(), version = env!("CARGO_PKG_VERSION"), session, "started");
        let watchdog = Watchdog::new(chain, station.process());
        Ok(Self {
            publisher: station.publisher(1)?,
            losses: station.observer_losses(),
            health,
            watchdog,
            last: None,
            last_scan: u32::MAX,
        })
    }

    /// The watchdog of the process, for [`crate::ipc::attend`].
    pub fn watchdog(&self) -> Watchdog {
        self.watchdog.clone()
    }

    /// Whether a report is due: a new scan or a second has passed, or a tenth of one while the process is young.
    pub fn is_due(&self) -> bool {
        let pause = Duration::from_millis(if self.health.seq < 8 { 100 } else { 1000 });
        self.last.is_none_or(|last| {
            let elapsed = last.elapsed();
            elapsed >= pause || (self.health.scan != self.last_scan && elapsed >= Duration::from_millis(50))
        })
    }

    /// Publishes the report now.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn publish(&mut self) -> Result<(), IpcError> {
        self.health.heartbeat_ns = monotonic_ns();
        self.health.cpu_ns = process_cpu_ns();
        let (resident, private) = resident_bytes();
        self.health.rss_bytes = resident;
        self.health.private_kib = (private >> 10) as u32;
        self.health.files = open_files();
        self.watchdog.describe(&mut self.health);
        self.health.set_observers(&self.losses.counts());
        let header = HealthHeader { session: self.health.session, seq: self.health.seq };
        self.publisher.publish(&header, std::slice::from_ref(&self.health), |_| {})?;
        self.tell_service_manager();
        self.health.seq += 1;
        self.last = Some(Instant::now());
        self.last_scan = self.health.scan;
        Ok(())
    }

    /// Tells a service manager how the process does.
    fn tell_service_manager(&self) {
        let status = format!("scan {}, {}", self.health.scan, Condition::of(self.health.condition).text());
        let news = match (self.health.seq, self.health.ended) {
            (_, 1) => NotifyState::Stopping,
            (0, _) => NotifyState::Ready,
            _ => NotifyState::Watchdog,
        };
        // Without a service manager this does nothing.
        let _ = sd_notify::notify(&[news, NotifyState::Status(&status)]);
    }
}
