//! The plot extractor as a process, and as a batch run without shared memory.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::{Parser, Subcommand};
use common::process::{BadInput, StageArgs};
use common::recording::{self, jsonl::Writer};
use plot_extractor::replay::replay;
use plot_extractor::{PlotExtractor, process};

/// Cells in, plots out: CFAR, clustering, interpolation, decision statistics
///
/// Example: plot-extractor --config config/uav.toml --set extractor.pfa=1e-4
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
    /// Extract plots from recorded dwells in one go, without shared memory
    ///
    /// Example: plot-extractor replay --dwells FILE.mcap --plots plots.jsonl
    #[command(verbatim_doc_comment)]
    Replay {
        /// Recording with dwells (made with --set recorder.dwells=true)
        #[arg(long, value_name = "FILE")]
        dwells: PathBuf,
        /// Output file of the plots, JSON lines
        #[arg(long, value_name = "FILE")]
        plots: PathBuf,
        #[command(flatten)]
        stage: StageArgs,
    },
}

fn main() -> ExitCode {
    let args = Args::parse();
    common::process::run(process::NAME, || match args.command {
        Some(Command::Replay { stage, dwells, plots }) => replay_file(&stage, &dwells, &plots),
        None => process::run(&args.stage),
    })
}

/// Replays a file and says on standard output what was in it.
fn replay_file(stage: &StageArgs, dwells: &Path, plots: &Path) -> anyhow::Result<ExitCode> {
    let chain = stage.load()?;
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let messages = recording::open(dwells).map_err(|error| BadInput(error.to_string()))?;
    let file = File::create(plots).map_err(|error| BadInput(format!("cannot write {}: {error}", plots.display())))?;
    let mut out = Writer::new(BufWriter::with_capacity(1 << 20, file));
    let summary =
        replay(messages, &mut extractor, &mut out).with_context(|| format!("replaying {}", dwells.display()))?;
    out.finish().with_context(|| format!("writing {}", plots.display()))?;
    if summary.dwells == 0 {
        let (file, name) = (dwells.display(), plots.display());
        let hint = "dwells are recorded with --set recorder.dwells=true";
        return Err(BadInput(format!("{file} holds no dwells, {name} no plots: {hint}")).into());
    }
    writeln!(std::io::stdout(), "{} dwells, {} rejected, {} plots", summary.dwells, summary.rejected, summary.plots)?;
    Ok(ExitCode::SUCCESS)
}
