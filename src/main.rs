//! `radar-chain`: launches, supervises and shows a radar processing chain.

mod asterix_data;
mod checks;
mod claim;
mod dispatch;
mod keeper;
mod manual;
mod run;
mod stages;
mod tune;
mod watch;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context;
use clap::{Args, CommandFactory, Parser, Subcommand};
use common::config::{self, Sites, Speed};
use common::process::{BadInput, StageArgs};
use recorder::window::Window;

use crate::checks::{chaos, compare, doctor, soak, source};
use crate::stages::orphans::configuration_in;
use crate::watch::status;

/// Configuration of the default run, in the folder the command is given in.
const DEFAULT_CONFIG: &str = "config/uav.toml";

/// Radar processing chain: cells in, confirmed tracks out, as separate processes over shared memory
///
/// Examples:
///   radar-chain                                          the drone scenario, one minute
///   radar-chain run --scans 500 --speed max              as fast as the chain goes
///   radar-chain run --set extractor.pfa=1e-4 --seed 7
///   radar-chain run --config config/smr.toml --set plot_source.file=radar.ast
///   radar-chain run --replay recordings/FILE.mcap        replay recorded plots through the tracker
///   radar-chain status                                   show the processes of a running chain
///   radar-chain soak --duration 8h --reference           check latencies, losses and memory against limits
///   radar-chain compare soak-1/report.json soak-2/report.json
///   radar-chain chaos --kills 100                        kill stages at random, check that every loss is counted
///   radar-chain doctor                                   check this machine, say how to fix what is missing
///   radar-chain config --explain                         every key with its value and meaning
///   radar-chain recorder info recordings/FILE.mcap       what is in a recording
///   radar-chain tune recordings/FILE.mcap                parameters learnt from a recording
///   radar-chain asterix dump radar.pcap                  ASTERIX records as JSON lines
///   radar-chain asterix play radar.ast udp://127.0.0.1:8600   a recording onto the network
#[derive(Parser)]
#[command(name = "radar-chain", version, verbatim_doc_comment, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Without a command: `run`
    #[command(flatten)]
    run: RunArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Launch the processes and supervise them until the source ends or Ctrl-C
    ///
    /// Examples:
    ///   radar-chain run --scans 500 --speed max
    ///   radar-chain run --config config/smr.toml --set plot_source.file=radar.ast
    #[command(verbatim_doc_comment)]
    Run(RunArgs),
    /// Run the chain and check latencies, losses and memory against limits: exit code 1 if a limit is broken
    ///
    /// Example: radar-chain soak --duration 8h --reference --budget end_to_end=3000@99
    #[command(verbatim_doc_comment)]
    Soak(SoakArgs),
    /// Compare two soaks: exit code 1 if the later one is worse
    ///
    /// Example: radar-chain compare soak-1/report.json soak-2/report.json --tolerance 0.2
    #[command(verbatim_doc_comment)]
    Compare {
        /// Report of the earlier soak
        a: PathBuf,
        /// Report of the later one
        b: PathBuf,
        /// Largest acceptable relative increase of a latency
        #[arg(long, default_value_t = 0.1, value_name = "SHARE")]
        tolerance: f64,
    },
    /// Kill N stages of a chain at random times and check that every lost message is counted
    ///
    /// Example: radar-chain chaos --kills 100 --speed 1
    #[command(verbatim_doc_comment)]
    Chaos {
        /// Stages to kill, one after the other
        #[arg(long, default_value_t = 20, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
        kills: u32,
        #[command(flatten)]
        run: RunArgs,
    },
    /// Check this machine and say how to fix what is missing, or tell what radars on the network say
    ///
    /// Examples:
    ///   radar-chain doctor --config config/uav.toml
    ///   radar-chain doctor --source 'udp://239.192.86.68:8668?interface=eth0'
    #[command(verbatim_doc_comment)]
    Doctor {
        /// Listen there in place of checking the machine, and propose a configuration
        #[arg(long, value_name = "udp://ADDRESS:PORT")]
        source: Option<String>,
        /// How long to listen
        #[arg(long, default_value = "60s", requires = "source", value_parser = parse_duration)]
        duration: Duration,
        #[command(flatten)]
        status: StatusArgs,
    },
    /// Show the processes of a running chain
    ///
    /// Example: radar-chain status --ipc-prefix north --json
    #[command(verbatim_doc_comment)]
    Status(StatusArgs),
    /// Show recordings in a browser: the picture of a running chain, with a time line
    ///
    /// Examples:
    ///   radar-chain view recordings/uav-20261130T080000Z.000.mcap
    ///   radar-chain view west.mcap east.mcap --listen 127.0.0.1:9000
    #[command(verbatim_doc_comment)]
    View {
        /// Recordings of one run, one for each site; later parts beside them are found
        #[arg(required = true)]
        recordings: Vec<PathBuf>,
        /// Where the picture is served
        #[arg(long, value_name = "ADDRESS:PORT")]
        listen: Option<String>,
        /// File with the token that viewers must show, its first line; needed beyond loopback
        #[arg(long, value_name = "FILE", requires = "listen", default_value = "", hide_default_value = true)]
        token_file: String,
    },
    /// Draw the plan of recordings at one time
    ///
    /// Example: radar-chain picture recordings/uav-20261130T080000Z.000.mcap --at 30 --out plan.png
    #[command(verbatim_doc_comment)]
    Picture {
        /// Recordings of one run, one for each site; later parts beside them are found
        #[arg(required = true)]
        recordings: Vec<PathBuf>,
        /// Time from the begin of the recording, s; its end without it
        #[arg(long, value_name = "SECONDS")]
        at: Option<f64>,
        /// How much of a track's way is shown, s
        #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
        trail: f64,
        /// Range of the plan, m; what the radars cover without it
        #[arg(long, value_name = "METRES")]
        range: Option<f64>,
        /// Light on dark
        #[arg(long)]
        night: bool,
        /// File to write: SVG, or PNG, by its ending
        #[arg(long, default_value = "plan.svg")]
        out: PathBuf,
    },
    /// Learn parameters from recordings, without truth, and print them as a fragment of a configuration
    ///
    /// Errors of plots, motion of targets by maximum likelihood, detection probability and density of false plots, each
    /// with its standard error and what the configuration says. The same recordings give the same figures. Exit code 1 if
    /// the parameters do not settle.
    ///
    /// Examples:
    ///   radar-chain tune recordings/FILE.mcap > tuned.toml
    ///   radar-chain tune monday.mcap tuesday.mcap --set tracker.estimator=imm-turn
    #[command(verbatim_doc_comment)]
    Tune {
        /// Recordings of one radar; later parts beside them are found
        #[arg(required = true)]
        recordings: Vec<PathBuf>,
        /// Configuration to begin with [default: that of the first recording]
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
        /// Override one key, for example --set tracker.estimator=cv
        #[arg(long = "set", value_name = "KEY=VALUE")]
        overrides: Vec<String>,
    },
    /// Print the effective configuration
    ///
    /// Examples:
    ///   radar-chain config --set run.speed=max > my.toml
    ///   radar-chain config --config config/smr.toml --explain
    ///   radar-chain config --explain tracker.snr_db
    #[command(verbatim_doc_comment)]
    Config {
        /// A line of explanation above each key, or of one key or table alone
        #[arg(long, value_name = "KEY", num_args = 0..=1, default_missing_value = "")]
        explain: Option<String>,
        /// Every key with its unit, default, range and meaning, as Markdown
        #[arg(long, conflicts_with = "explain")]
        docs: bool,
        #[command(flatten)]
        chain: ChainArgs,
    },
    /// Print the completions of a shell
    ///
    /// Example: radar-chain completions bash > /usr/share/bash-completion/completions/radar-chain
    #[command(verbatim_doc_comment)]
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
    /// Write a man page for each command
    ///
    /// Example: radar-chain man /usr/local/share/man/man1
    #[command(verbatim_doc_comment)]
    Man {
        /// Folder of the pages
        folder: PathBuf,
    },
    /// Read, check, compare, export and replay recordings
    ///
    /// Example: radar-chain recorder info recordings/FILE.mcap
    #[command(verbatim_doc_comment)]
    Recorder {
        #[command(subcommand)]
        command: recorder::command_line::Command,
    },
    /// Look into ASTERIX data, and play recordings of it
    Asterix {
        #[command(subcommand)]
        command: asterix_data::Command,
    },
    /// Run one end of the bare hop with which a soak compares the chain's hops
    #[command(hide = true)]
    Hop(soak::HopArgs),
    /// Run one process of the chain, as a service manager does
    ///
    /// Example: radar-chain stage tracker --config config/uav.toml
    #[command(verbatim_doc_comment)]
    Stage {
        /// Which
        #[arg(value_parser = dispatch::names())]
        name: String,
        #[command(flatten)]
        args: StageArgs,
    },
}

/// Which chain.
#[derive(Args, Default)]
struct ChainArgs {
    /// Configuration of the chain [default: config/uav.toml]
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Override one key, for example --set extractor.pfa=1e-4
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Name of the radar; of a configuration with several sites, the one to run
    #[arg(long, value_name = "NAME")]
    site: Option<String>,
    /// Prefix of the shared memory, to separate this chain from others on the machine
    #[arg(long, value_name = "PREFIX")]
    ipc_prefix: Option<String>,
}

/// Options of `run`.
#[derive(Args, Default)]
struct RunArgs {
    /// Replay a recording through the stages of this build, with its recorded configuration unless --config is given
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    #[command(flatten)]
    window: Window,
    /// Scans to run; 0 until stopped or to the end of the recording
    #[arg(long, value_name = "N")]
    scans: Option<u32>,
    /// Speed as a multiple of real time, or max
    #[arg(long, value_name = "X|max")]
    speed: Option<Speed>,
    /// Seed of every random draw
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder of the recordings
    #[arg(long, value_name = "DIR", conflicts_with = "no_record")]
    record: Option<PathBuf>,
    /// Make no recording
    #[arg(long)]
    no_record: bool,
    /// Serve no picture for a browser
    #[arg(long)]
    no_display: bool,
    /// Where the report is written
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    chain: ChainArgs,
}

/// Options of `soak`.
#[derive(Args)]
struct SoakArgs {
    /// Duration, for example 8h or 30m [default: the number of scans that `run` would run]
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    duration: Option<Duration>,
    /// Latency limit, for example end_to_end=3000@99 (µs at a percentile: 50, 90, 99 or 99.9)
    #[arg(long = "budget", value_name = "NAME=US@PERCENTILE")]
    budgets: Vec<String>,
    /// Also measure the bare hop of the middleware, for comparison
    #[arg(long)]
    reference: bool,
    /// Serve the picture meanwhile; without this, nothing but the chain is measured
    #[arg(long)]
    display: bool,
    /// Folder of the results
    #[arg(long, value_name = "DIR", default_value = "soak")]
    out: PathBuf,
    #[command(flatten)]
    run: RunArgs,
}

impl SoakArgs {
    fn load(&self) -> anyhow::Result<Sites> {
        let mut overrides = Vec::new();
        for budget in &self.budgets {
            overrides.push(budget_override(budget)?);
        }
        if self.duration.is_some() && self.run.scans.is_none() {
            overrides.push("run.scans=0".into());
        }
        self.run.load_with(overrides)
    }
}

/// `NAME=US@PERCENTILE` as an override of the configuration.
fn budget_override(text: &str) -> Result<String, BadInput> {
    let refuse = || BadInput(format!("--budget {text}: expected NAME=US@PERCENTILE, for example end_to_end=3000@99"));
    let (name, rest) = text.split_once('=').ok_or_else(refuse)?;
    let (limit, percentile) = rest.split_once('@').ok_or_else(refuse)?;
    let limit: f64 = limit.parse().map_err(|_| refuse())?;
    if !["50", "90", "99", "99.9"].contains(&percentile) || !common::latency::LATENCY_NAMES.contains(&name) {
        return Err(refuse());
    }
    Ok(format!("budget.{name}.p{}_us={limit:?}", percentile.replace('.', "")))
}

/// A time such as `8h`, `1h 30m` or `90s`.
fn parse_duration(text: &str) -> Result<Duration, String> {
    let expected = |_| "expected a time such as 8h, 30m or 90s".to_string();
    let duration: jiff::SignedDuration = text.parse().map_err(expected)?;
    Duration::try_from(duration).map_err(|_| "expected a time above 0".to_string())
}

/// Options of `status`.
#[derive(Args)]
struct StatusArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    chain: ChainArgs,
}

impl ChainArgs {
    /// All overrides, `more` last.
    fn all_overrides(&self, more: Vec<String>) -> Vec<String> {
        let mut overrides = self.overrides.clone();
        overrides.extend(self.ipc_prefix.iter().map(|prefix| format!("ipc.prefix={prefix}")));
        overrides.extend(more);
        overrides
    }

    /// The configuration of the chain that runs in the domain, if none is given and there is one.
    fn load_running(&self) -> anyhow::Result<Sites> {
        let of_domain = config::load(None, &self.all_overrides(Vec::new())).unwrap_or_default();
        let running = Some(configuration_in(&of_domain.ipc)).filter(|file| file.exists());
        self.load_from(self.config.clone().or(running), Vec::new())
    }

    /// The effective configuration, `more` overrides applied last.
    fn load(&self, more: Vec<String>) -> anyhow::Result<Sites> {
        self.load_from(self.config.clone(), more)
    }

    fn load_from(&self, file: Option<PathBuf>, more: Vec<String>) -> anyhow::Result<Sites> {
        let overrides = self.all_overrides(more);
        let path = file.unwrap_or_else(|| PathBuf::from(DEFAULT_CONFIG));
        let loaded = config::load_sites(Some(&path), &overrides);
        if self.config.is_none() && !path.exists() {
            return loaded.context("run this in the folder of the project, or give a file with --config");
        }
        let sites = loaded?;
        match (&self.site, sites.only()) {
            (Some(name), None) => Ok(Sites::one(sites.named(name)?.clone())),
            (Some(name), Some(_)) => Ok(config::load_sites(Some(&path), &[overrides, vec![renamed(name)]].concat())?),
            (None, _) => Ok(sites),
        }
    }
}

impl RunArgs {
    fn load(&self) -> anyhow::Result<Sites> {
        self.load_with(Vec::new())
    }

    /// The effective configuration, `more` overrides applied last.
    fn load_with(&self, more: Vec<String>) -> anyhow::Result<Sites> {
        let text = |path: &PathBuf| toml_text(&path.display().to_string());
        let mut overrides = Vec::new();
        overrides.extend(self.scans.map(|scans| format!("run.scans={scans}")));
        overrides.extend(self.speed.map(|speed| match speed {
            Speed::Max => "run.speed=\"max\"".to_string(),
            Speed::Times(factor) => format!("run.speed={factor:?}"),
        }));
        overrides.extend(self.seed.map(|seed| format!("run.seed={seed}")));
        overrides.extend(self.record.as_ref().map(|folder| format!("recorder.directory={}", text(folder))));
        overrides.extend(self.no_record.then(|| "recorder.record=false".to_string()));
        overrides.extend(self.no_display.then(|| "display.enabled=false".to_string()));
        overrides.extend(self.report.as_ref().map(|file| format!("recorder.report={}", text(file))));
        overrides.extend(more);
        match &self.replay {
            None if self.window.is_set() => Err(BadInput("--from and --to: expected with --replay".into()).into()),
            None => self.chain.load(overrides),
            Some(file) => {
                let mut overrides = self.chain.all_overrides(overrides);
                overrides.extend(self.chain.site.iter().map(|name| renamed(name)));
                let mut config = recorder::replay::replay_config(file, self.chain.config.as_deref(), overrides)?;
                self.window.narrow(&mut config)?;
                Ok(Sites::one(config))
            }
        }
    }
}

/// The override that gives the site another name.
fn renamed(name: &str) -> String {
    format!("site.name={name}")
}

/// A TOML literal string.
fn toml_text(text: &str) -> String {
    format!("'''{text}'''")
}

/// The command line as clap has it, for its manual.
pub(crate) fn command_line() -> clap::Command {
    Arguments::command()
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match arguments.command.unwrap_or(Command::Run(arguments.run)) {
        Command::Run(args) => common::process::supervise("radar-chain", || run::run(args.load()?)),
        Command::Soak(args) => common::process::supervise("radar-chain", || {
            let SoakArgs { duration, reference, display, ref out, .. } = args;
            let plan = soak::Plan { duration, out: out.clone(), reference, display };
            soak::soak(args.load()?, &plan)
        }),
        Command::Chaos { run, kills } => common::process::supervise("radar-chain", || chaos::chaos(run.load()?, kills)),
        Command::Compare { a, b, tolerance } => {
            common::process::run("radar-chain", || compare::compare(&a, &b, tolerance))
        }
        Command::Doctor { source: Some(source), duration, .. } => {
            common::process::run("radar-chain", || source::hear(&source, duration))
        }
        Command::Doctor { status, .. } => {
            common::process::run("radar-chain", || doctor::doctor(&status.chain.load(Vec::new())?, status.json))
        }
        Command::Hop(args) => common::process::run("bare-hop", || soak::hop(&args)),
        Command::Status(args) => {
            common::process::run("radar-chain", || status::status(&args.chain.load_running()?, args.json))
        }
        Command::View { recordings, listen, token_file } => common::process::supervise("radar-chain", || {
            let listen = listen.as_deref().map(|address| (address, token_file.as_str()));
            display::view::run(&recordings, listen)
        }),
        Command::Picture { recordings, at, trail, range, night, out } => common::process::run("radar-chain", || {
            let request = display::plan::Request { at_s: at, trail_s: trail, range_m: range, night };
            display::plan::draw(&recordings, &request, &out)?;
            Ok(ExitCode::SUCCESS)
        }),
        Command::Tune { recordings, config, overrides } => {
            common::process::run("radar-chain", || tune::tune(&recordings, config.as_deref(), overrides))
        }
        Command::Config { explain, docs, chain } => common::process::run("radar-chain", || {
            let text = match (explain.as_deref(), docs) {
                (_, true) => config::reference(),
                (Some(""), _) => config::explained(&chain.load(Vec::new())?),
                (Some(key), _) => {
                    let unknown = || BadInput(format!("no key or table `{key}`; radar-chain config prints all"));
                    config::explained_key(&chain.load(Vec::new())?, key).ok_or_else(unknown)?
                }
                _ => chain.load(Vec::new())?.to_toml(),
            };
            common::process::print(&text);
            Ok(ExitCode::SUCCESS)
        }),
        Command::Completions { shell } => common::process::run("radar-chain", || manual::print_completions(shell)),
        Command::Man { folder } => common::process::run("radar-chain", || manual::write_man_pages(&folder)),
        Command::Recorder { command } => common::process::run(recorder::process::NAME, || command.run()),
        Command::Asterix { command } => common::process::run("radar-chain", || command.run()),
        Command::Stage { name, args } => common::process::run(&name, || dispatch::run_stage(&name, &args)),
    }
}
