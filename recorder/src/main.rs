//! `recorder` as a process of its own, and what can be done with recordings.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use common::config::{ChainConfig, Speed};
use common::process::StageArgs;
use common::topic::Topic;
use recorder::process;
use recorder::replay::replay_config;
use recorder::window::Window;

mod commands;

/// Records the chain and reports on it; reads, compares and scores recordings
///
/// Example: recorder --config config/uav.toml
#[derive(Parser)]
#[command(version, verbatim_doc_comment, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(flatten)]
    stage: StageArgs,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Say what is in a recording
    Info {
        /// The recording
        file: PathBuf,
    },
    /// Check chunks, checksums, missing messages and times: exit code 0 if whole, 1 with findings
    Verify {
        /// The recordings; parts of one run in their order
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Print the configuration of the recorded run
    #[command(
        after_help = "Examples:\n  recorder config FILE > run.toml\n  recorder config FILE --replay > replay.toml"
    )]
    Config {
        /// The recording
        file: PathBuf,
        /// Turn it into one for stages that a replay of the recording drives; they write to the folder `replay`
        #[arg(long)]
        replay: bool,
    },
    /// Write topics of a recording as tables, JSON lines or for viewers
    Export {
        /// The recording
        file: PathBuf,
        /// Topics, separated by commas
        #[arg(long, value_delimiter = ',', default_value = "plots,tracks,truth", value_parser = parse_topic)]
        topics: Vec<Topic>,
        /// Form of the files
        #[arg(long, default_value = "csv")]
        format: FormatArgument,
        /// Folder of the files
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// Put recorded topics onto the services, for stages that are started by hand
    ///
    /// Waits for the stages after the topics and for the recorder. They need the configuration of the replay: that of the
    /// recording (recorder config FILE --replay) or --config.
    Replay(ReplayArgs),
    /// Compare two recordings in everything but stamps: exit code 0 if equal, 1 with the first difference
    Diff {
        /// One recording
        a: PathBuf,
        /// The other
        b: PathBuf,
    },
    /// Score tracks against truth
    Score {
        #[command(flatten)]
        stage: StageArgs,
        /// Tracks: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        tracks: PathBuf,
        /// Truth: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        truth: PathBuf,
        /// Plots: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        plots: Option<PathBuf>,
    },
}

/// Options of `replay`.
#[derive(Args)]
struct ReplayArgs {
    /// The recording; later parts of its run in the same folder follow it
    file: PathBuf,
    /// Times real time, or max
    #[arg(long, value_name = "X|max")]
    speed: Option<Speed>,
    #[command(flatten)]
    window: Window,
    /// Topics, separated by commas: dwells, plots, tracks, truth [default: dwells if recorded, or else plots, and truth]
    #[arg(long, value_delimiter = ',', value_parser = parse_topic)]
    topics: Vec<Topic>,
    /// Configuration of the chain instead of that in the recording
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Override one key
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Keep this chain's shared memory apart from others'
    #[arg(long, value_name = "PREFIX")]
    ipc_prefix: Option<String>,
}

impl ReplayArgs {
    fn load(&self) -> anyhow::Result<ChainConfig> {
        let mut overrides = self.overrides.clone();
        overrides.extend(self.ipc_prefix.iter().map(|prefix| format!("ipc.prefix={prefix}")));
        overrides.extend(self.speed.map(|speed| match speed {
            Speed::Max => "run.speed=\"max\"".to_string(),
            Speed::Times(factor) => format!("run.speed={factor:?}"),
        }));
        if !self.topics.is_empty() {
            let names: Vec<&str> = self.topics.iter().map(|topic| topic.name()).collect();
            overrides.push(format!("replay.topics={names:?}"));
        }
        let mut config = replay_config(&self.file, self.config.as_deref(), overrides)?;
        self.window.narrow(&mut config)?;
        Ok(config)
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum FormatArgument {
    /// Comma-separated values
    Csv,
    /// JSON lines
    Jsonl,
    /// MCAP with JSON and its schemas, for viewers: one file for all topics
    McapJson,
    /// Parquet
    Parquet,
}

fn parse_topic(name: &str) -> Result<Topic, String> {
    let names = Topic::ALL.map(Topic::name).join(", ");
    Topic::from_name(name).ok_or_else(|| format!("expected one of {names}"))
}

fn main() -> ExitCode {
    let args = Arguments::parse();
    common::process::run(process::NAME, || match args.command {
        None => process::run(&args.stage),
        Some(Command::Info { file }) => commands::info(&file),
        Some(Command::Verify { files }) => commands::verify(&files),
        Some(Command::Config { file, replay }) => commands::config(&file, replay),
        Some(Command::Export { file, topics, format, out }) => {
            let format = match format {
                FormatArgument::Csv => recorder::export::Format::Csv,
                FormatArgument::Jsonl => recorder::export::Format::JsonLines,
                FormatArgument::McapJson => recorder::export::Format::McapJson,
                FormatArgument::Parquet => recorder::export::Format::Parquet,
            };
            commands::export(&file, &topics, format, &out)
        }
        Some(Command::Replay(args)) => commands::replay(&args.load()?),
        Some(Command::Diff { a, b }) => commands::diff(&a, &b),
        Some(Command::Score { stage, tracks, truth, plots }) => {
            commands::score(&stage.load()?, &tracks, &truth, plots.as_deref())
        }
    })
}
