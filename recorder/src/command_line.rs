//! The commands of `recorder` that work on recordings, which `radar-chain recorder` has too.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use common::config::{ChainConfig, Speed};
use common::process::{BadInput, StageArgs};
use common::topic::Topic;

use crate::commands::{self, parse_topic};
use crate::export::Format;
use crate::replay::replay_config;
use crate::window::Window;

/// What can be done with recordings.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Describe a recording: state, size, topics, sessions, gaps
    ///
    /// Example: recorder info recordings/FILE.mcap
    #[command(verbatim_doc_comment)]
    Info {
        /// The recording
        file: PathBuf,
    },
    /// Check chunks, checksums, gaps and times: exit code 0 if complete, 1 with findings
    ///
    /// Example: recorder verify recordings/*.mcap
    #[command(verbatim_doc_comment)]
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
        /// Print the configuration for stages that a replay drives; they write to the folder `replay`
        #[arg(long)]
        replay: bool,
    },
    /// Export topics as tables, JSON lines, MCAP for viewers, or as ways of targets on maps
    ///
    /// Example: recorder export FILE.mcap --topics plots,tracks --format csv --out tables
    #[command(verbatim_doc_comment)]
    Export {
        /// The recording
        file: PathBuf,
        /// Topics, separated by commas
        #[arg(long, value_delimiter = ',', default_value = commands::TABLE_TOPICS, value_parser = parse_topic)]
        topics: Vec<Topic>,
        /// Form of the files
        #[arg(long, default_value = "csv")]
        format: FormatArgument,
        /// Folder of the files
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// Publish recorded topics, for stages that are started by hand
    ///
    /// Waits for the stages after the topics and for the recorder. They need the configuration of the replay: that of the
    /// recording (recorder config FILE --replay) or --config.
    ///
    /// Example: recorder replay FILE.mcap --speed max --topics plots
    #[command(verbatim_doc_comment)]
    Replay(ReplayArgs),
    /// Compare two recordings in everything but stamps: exit code 0 if equal, 1 with the first difference
    ///
    /// Example: recorder diff A.mcap B.mcap
    #[command(verbatim_doc_comment)]
    Diff {
        /// One recording
        a: PathBuf,
        /// The other
        b: PathBuf,
    },
    /// Score tracks against truth
    ///
    /// Example: recorder score --config config/uav.toml --tracks FILE.mcap --truth FILE.mcap
    #[command(verbatim_doc_comment)]
    Score {
        /// Tracks: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        tracks: PathBuf,
        /// Truth: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        truth: PathBuf,
        /// Plots: a recording or JSON lines
        #[arg(long, value_name = "FILE")]
        plots: Option<PathBuf>,
        /// Configuration of the chain
        #[command(flatten)]
        stage: StageArgs,
    },
}

/// Options of `replay`.
#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// The recording; later parts of its run in the same folder follow it
    file: PathBuf,
    /// Speed as a multiple of real time, or max
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
    /// Prefix of the shared memory, to separate this chain from others on the machine
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

/// Form of the files of an export.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum FormatArgument {
    /// Comma-separated values
    Csv,
    /// JSON lines
    Jsonl,
    /// MCAP with JSON and its schemas, for viewers: one file for all topics
    McapJson,
    /// Parquet, by the program parquet-export
    Parquet,
    /// GeoJSON: ways of tracks and true targets
    Geojson,
    /// KML: ways of tracks and true targets, in time
    Kml,
    /// JSON of a counter-drone test (COURAGEOUS): tracks
    Courageous,
}

impl Command {
    /// Does it.
    ///
    /// # Errors
    /// Those of the command; [`BadInput`] for recordings that cannot be read.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self {
            Self::Info { file } => commands::info(&file),
            Self::Verify { files } => commands::verify(&files),
            Self::Config { file, replay } => commands::config(&file, replay),
            Self::Export { file, topics, format, out } => {
                let form = match format {
                    FormatArgument::Csv => Format::Csv,
                    FormatArgument::Jsonl => Format::JsonLines,
                    FormatArgument::McapJson => Format::McapJson,
                    FormatArgument::Geojson => Format::GeoJson,
                    FormatArgument::Kml => Format::Kml,
                    FormatArgument::Courageous => Format::Courageous,
                    FormatArgument::Parquet => return export_as_parquet(&file, &topics, &out),
                };
                commands::export(&file, &topics, &form, &out)
            }
            Self::Replay(args) => commands::replay(&args.load()?),
            Self::Diff { a, b } => commands::diff(&a, &b),
            Self::Score { stage, tracks, truth, plots } => {
                commands::score(&stage.load()?, &tracks, &truth, plots.as_deref())
            }
        }
    }
}

/// Runs `parquet-export`, which stands beside this program, and ends with its exit code.
fn export_as_parquet(file: &Path, topics: &[Topic], out: &Path) -> anyhow::Result<ExitCode> {
    let program = std::env::current_exe().context("finding this program")?.with_file_name("parquet-export");
    if !program.exists() {
        let missing = format!(
            "--format parquet: expected the program parquet-export as {}: cargo build --release -p parquet-export makes it",
            program.display()
        );
        return Err(BadInput(missing).into());
    }
    let topics: Vec<&str> = topics.iter().map(|topic| topic.name()).collect();
    let mut export = std::process::Command::new(&program);
    export.arg(file).args(["--topics", &topics.join(",")]).arg("--out").arg(out);
    let status = export.status().with_context(|| format!("starting {}", program.display()))?;
    let code = status.code().with_context(|| format!("{} was ended: {status}", program.display()))?;
    Ok(ExitCode::from(u8::try_from(code).unwrap_or(u8::MAX)))
}
