//! The bare hop beside the chain: pairs of processes that send as often as the chain's hops and do nothing else.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::{Args, ValueEnum};
use common::config::{ChainConfig, Sites, Source, Speed};
use common::ipc::{HopReceiver, HopSender, Station};
use common::latency::{LATENCY_NAMES, Latency};
use common::latency_log::LatencyLog;
use common::plots::{Plot, PlotsHeader};
use common::process::{BadInput, StageArgs, stop_requested};
use rustix::process::{Pid, Signal, kill_process, set_parent_process_death_signal};

/// The latencies that are one event-driven hop.
pub(super) const LATENCIES_OF_HOPS: [Latency; 2] = [Latency::HopDwells, Latency::HopPlots];
/// The bare hop runs for so long out of every [`CYCLE`], so that it takes little from the chain.
const ACTIVE: Duration = Duration::from_secs(2);
const CYCLE: Duration = Duration::from_secs(10);
/// The receiver's log has an interval this long.
const INTERVAL: Duration = Duration::from_secs(10);

/// One end of a bare hop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum End {
    Send,
    Receive,
}

/// Options of one end of a bare hop.
#[derive(Args)]
pub(crate) struct HopArgs {
    /// Which end
    end: End,
    /// The latency that it is compared with
    latency: String,
    /// Between two messages, µs
    #[arg(long)]
    period_us: u64,
    /// Numbers of 4 bytes in a message
    #[arg(long)]
    length: usize,
    /// Where the receiver writes its histograms
    #[arg(long)]
    log: PathBuf,
    #[command(flatten)]
    stage: StageArgs,
}

/// Name of the log of a bare hop in the folder of the soak.
pub(super) fn log_name(latency: Latency) -> String {
    format!("{}-bare.hlog", LATENCY_NAMES[latency as usize])
}

/// The processes of the bare hops.
pub(super) struct Reference {
    /// The site that the bare hops are compared with: the first one.
    chain: ChainConfig,
    /// Whether there are others.
    several: bool,
    out: PathBuf,
    children: Vec<Child>,
}

impl Reference {
    pub(super) fn new(sites: &Sites, out: &Path) -> Self {
        for latency in LATENCIES_OF_HOPS {
            let _ = std::fs::remove_file(out.join(log_name(latency))); // of an earlier soak
        }
        let several = sites.only().is_none();
        Self { chain: sites.first().clone(), several, out: out.to_path_buf(), children: Vec::new() }
    }

    /// Starts the processes.
    pub(super) fn start(&mut self) -> anyhow::Result<()> {
        let program = std::env::current_exe().context("finding this program's file")?;
        let configuration = common::ipc::Domain::root(&self.chain.ipc).join("chain.toml");
        for latency in LATENCIES_OF_HOPS {
            let Some(period) = period(&self.chain, latency) else { continue };
            for end in ["receive", "send"] {
                let mut command = Command::new(&program);
                command.args(["hop", end, LATENCY_NAMES[latency as usize], "--period-us"]);
                command.arg(period.as_micros().to_string());
                command
                    .arg("--length")
                    .arg(length(&self.chain, latency).to_string())
                    .arg("--log")
                    .arg(self.out.join(log_name(latency)));
                command.arg("--config").arg(&configuration).stdin(Stdio::null());
                if self.several {
                    command.arg("--site").arg(&self.chain.site.name);
                }
                self.children.push(command.spawn().context("starting the bare hop")?);
            }
        }
        Ok(())
    }

    /// Ends them and waits until their logs are written.
    pub(super) fn stop(&mut self) {
        for child in &self.children {
            if let Some(pid) = Pid::from_raw(child.id().cast_signed()) {
                let _ = kill_process(pid, Signal::TERM);
            }
        }
        for mut child in self.children.drain(..) {
            // Said, not fatal: the soak goes on without what it is compared with.
            match child.wait() {
                Ok(status) if status.success() => {}
                Ok(status) => common::process::say(&format!("a process of the bare hop has failed: {status}")),
                Err(error) => common::process::say(&format!("waiting for a process of the bare hop: {error}")),
            }
        }
    }
}

impl Drop for Reference {
    fn drop(&mut self) {
        self.stop();
    }
}

/// How often the chain sends over a hop; at full speed as often as in real time.
fn period(chain: &ChainConfig, latency: Latency) -> Option<Duration> {
    let speed = match chain.run.speed {
        Speed::Times(speed) => speed,
        Speed::Max => 1.0,
    };
    let per_scan = match latency {
        Latency::HopDwells if chain.run.source != Source::RadarSim => return None,
        Latency::HopDwells => chain.radar.dwells_per_scan,
        _ => chain.sectors_per_scan(),
    };
    Some(Duration::from_secs_f64(chain.scan_period_s() / speed / f64::from(per_scan)))
}

/// How long the chain's messages are, numbers of 4 bytes: the cells of a dwell, about ten plots.
fn length(chain: &ChainConfig, latency: Latency) -> usize {
    match latency {
        Latency::HopDwells => chain.radar.grid().cells(),
        _ => (size_of::<PlotsHeader>() + 10 * size_of::<Plot>()) / 4,
    }
}

/// Runs one end of a bare hop until it is asked to stop.
pub(crate) fn hop(args: &HopArgs) -> anyhow::Result<ExitCode> {
    // A soak that is killed takes its bare hops with it.
    set_parent_process_death_signal(Some(Signal::TERM)).context("asking to end with the soak")?;
    let known = |latency: &Latency| LATENCY_NAMES[*latency as usize] == args.latency;
    let latency = LATENCIES_OF_HOPS.into_iter().find(known);
    let latency = latency.ok_or_else(|| BadInput(format!("{} is no hop", args.latency)))?;
    let station = Station::enter("bare-hop", &args.stage.load()?)?;
    match args.end {
        End::Send => {
            let sender = HopSender::open(&station, &args.latency, args.length)?;
            let (period, begun) = (Duration::from_micros(args.period_us), Instant::now());
            let mut next = begun;
            while !stop_requested() {
                let phase = Duration::from_nanos((begun.elapsed().as_nanos() % CYCLE.as_nanos()) as u64);
                next = if phase < ACTIVE { next + period } else { Instant::now() + Duration::from_millis(100) };
                std::thread::sleep(next.saturating_duration_since(Instant::now()));
                if phase < ACTIVE {
                    sender.send(args.length)?;
                }
            }
        }
        End::Receive => {
            let file = File::options().create(true).append(true).open(&args.log)?;
            let log = std::cell::RefCell::new(LatencyLog::begin(file)?);
            let receiver = HopReceiver::open(&station, &args.latency)?;
            let mut arrived = |sent_ns, received_ns| log.borrow_mut().record(latency, sent_ns, received_ns);
            receiver.attend(&mut arrived, &mut || {
                if log.borrow().interval() >= INTERVAL {
                    let _ = log.borrow_mut().close_interval(); // a full disk ends the comparison, not the soak
                }
                !stop_requested()
            })?;
            log.borrow_mut().close_interval()?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
