//! `plot-extractor` as a process of its own.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;
use plot_extractor::process;

/// Cells in, plots out: CFAR, clustering, interpolation, decision statistics
///
/// Example: plot-extractor --config config/uav.toml --set extractor.pfa=1e-4
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Args {
    #[command(flatten)]
    stage: StageArgs,
}

fn main() -> ExitCode {
    let args = Args::parse();
    common::process::run(process::NAME, || process::run(&args.stage))
}
