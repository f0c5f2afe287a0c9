//! The plot source as a process, and as a batch conversion without shared memory.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::{Parser, Subcommand};
use common::process::{BadInput, StageArgs, say};
use common::recording::RecordedRef;
use common::recording::jsonl::Writer;
use plot_source::Source;

/// Publishes the plots of a recorded radar: ASTERIX category 010
///
/// Example: plot-source --config config/smr.toml --set plot_source.file=radar.ast
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
    /// Convert the recordings to JSON lines, without shared memory
    ///
    /// Example: plot-source convert --config config/smr.toml --plots plots.jsonl --truth truth.jsonl
    #[command(verbatim_doc_comment)]
    Convert {
        /// Output file of the plots, JSON lines
        #[arg(long, value_name = "FILE")]
        plots: PathBuf,
        /// Output file of the truth, JSON lines
        #[arg(long, value_name = "FILE")]
        truth: Option<PathBuf>,
        #[command(flatten)]
        stage: StageArgs,
    },
}

fn main() -> ExitCode {
    let args = Args::parse();
    common::process::run(plot_source::process::NAME, || match args.command {
        Some(Command::Convert { stage, plots, truth }) => convert(&stage, &plots, truth.as_deref()),
        None => plot_source::process::run(&args.stage),
    })
}

/// Converts everything in one go and says on standard output what was in it.
fn convert(stage: &StageArgs, plots: &Path, truth: Option<&Path>) -> anyhow::Result<ExitCode> {
    let config = stage.load()?;
    let source = Source::open(&config).map_err(|error| BadInput(error.to_string()))?;
    let (records, rejected, scans) = (source.records(), *source.rejected(), source.scans());
    source.notes().iter().for_each(|note| say(note));
    let code = source.exit_code();
    let mut plots_out = create(plots)?;
    let mut truth_out = truth.map(create).transpose()?;
    let (mut plot_count, mut truth_count) = (0, 0);
    for scan in source {
        for (header, elements) in &scan.plots {
            plot_count += elements.len();
            plots_out
                .write(RecordedRef::Plots(header, elements))
                .with_context(|| format!("writing {}", plots.display()))?;
        }
        if let (Some(out), Some((header, elements))) = (&mut truth_out, &scan.truth) {
            truth_count += elements.len();
            out.write(RecordedRef::Truth(header, elements)).context("writing truth")?;
        }
    }
    plots_out.finish().with_context(|| format!("writing {}", plots.display()))?;
    truth_out.map(Writer::finish).transpose().context("writing truth")?;

    let mut out = std::io::stdout().lock();
    writeln!(out, "records {records}  scans {scans}  plots {plot_count}  truth {truth_count}")?;
    for (name, count) in rejected.named() {
        writeln!(out, "rejected {name} {count}")?;
    }
    Ok(code)
}

fn create(path: &Path) -> anyhow::Result<Writer<BufWriter<File>>> {
    let file = File::create(path).map_err(|error| BadInput(format!("cannot create {}: {error}", path.display())))?;
    Ok(Writer::new(BufWriter::new(file)))
}
