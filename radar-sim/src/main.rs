//! `radar-sim` as a process of its own.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;
use radar_sim::process;

/// Simulated scanning 3-D radar: publishes the amplitude of every resolution cell
///
/// Example: radar-sim --config config/uav.toml --set run.speed=max
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
