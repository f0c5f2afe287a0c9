//! The tracker as a process, and as a batch run without shared memory.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::{Parser, Subcommand};
use common::process::{BadInput, StageArgs};
use common::recording::{self, jsonl::Writer};
use tracker::orders::Orders;
use tracker::replay::replay;
use tracker::{Tracker, process};

/// IMM-PDA tracking with plot statistics: plots in, tracks out
///
/// Example: tracker --config config/uav.toml
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Args {
    #[command(flatten)]
    stage: StageArgs,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Track recorded plots in one go, without shared memory
    ///
    /// Example: tracker replay --plots plots.jsonl --tracks tracks.jsonl --set tracker.snr_db=12
    #[command(verbatim_doc_comment)]
    Replay {
        /// Recording or JSON lines with plots
        #[arg(long, value_name = "FILE")]
        plots: PathBuf,
        /// Output file of the tracks, JSON lines
        #[arg(long, value_name = "FILE")]
        tracks: PathBuf,
        #[command(flatten)]
        stage: StageArgs,
    },
}

fn main() -> ExitCode {
    let args = Args::parse();
    common::process::run(process::NAME, || match args.command {
        Some(Command::Replay { stage, plots, tracks }) => replay_file(&stage, &plots, &tracks),
        None => process::run(&args.stage),
    })
}

/// Replays a file and says on standard output what was in it.
fn replay_file(stage: &StageArgs, plots: &Path, tracks: &Path) -> anyhow::Result<ExitCode> {
    let config = stage.load()?;
    let mut tracker = Tracker::new(&config.tracker, 1)?;
    let messages = recording::open(plots).map_err(|error| BadInput(error.to_string()))?;
    let mut orders = Orders::default();
    let commands = recording::commands_of(plots, 0, 1, || {}).map_err(|error| BadInput(error.to_string()))?;
    for command in commands {
        orders.take(command);
    }
    let file = File::create(tracks).map_err(|error| BadInput(format!("cannot write {}: {error}", tracks.display())))?;
    let mut out = Writer::new(BufWriter::with_capacity(1 << 20, file));
    let summary =
        replay(messages, &mut tracker, orders, &mut out).with_context(|| format!("replaying {}", plots.display()))?;
    out.finish().with_context(|| format!("writing {}", tracks.display()))?;
    writeln!(
        std::io::stdout(),
        "{} scans, {} plots, {} rejected, {} tracks started, {} alive; {:.3} s in the tracker",
        summary.scans,
        summary.plots,
        summary.rejected,
        summary.tracks,
        tracker.tracks().len(),
        summary.tracker_ns as f64 / 1e9,
    )?;
    Ok(ExitCode::SUCCESS)
}
