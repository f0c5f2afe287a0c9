//! The fusion as a process.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;
use fusion::process;

/// Tracks of several sites to one set of system tracks
///
/// Example: fusion --config config/fusion.toml --site centre
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
