//! `recorder` as a process of its own, and what can be done with recordings.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;
use recorder::command_line::Command;
use recorder::process;

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

fn main() -> ExitCode {
    let args = Arguments::parse();
    common::process::run(process::NAME, || match args.command {
        None => process::run(&args.stage),
        Some(command) => command.run(),
    })
}
