//! Tracks and plots of a running chain into other systems.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;

/// Sends tracks and plots of a running chain to other systems; the chain never waits for it
///
/// `radar-chain run` starts this stage where the configuration has a table [outputs.NAME]; by hand it joins a chain that runs already.
///
/// Example: outputs --config config/uav.toml --set outputs.asterix.to=udp://127.0.0.1:8600
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Args {
    #[command(flatten)]
    stage: StageArgs,
}

fn main() -> ExitCode {
    let Args { stage } = Args::parse();
    common::process::run(outputs::process::NAME, || outputs::process::run(&stage))
}
