//! The stages `link-out` and `link-in` of a chain.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use common::process::{StageArgs, run};

/// Carries topics of a site to another host; radar-chain starts it where the configuration has a table [link]
///
/// Example: radar-link stage link-out --config radar.toml
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a stage
    #[command(subcommand)]
    Stage(Stage),
}

#[derive(Subcommand)]
enum Stage {
    /// Send what `link.send` names to other hosts
    LinkOut(StageArgs),
    /// Publish what the same site says on another host
    LinkIn(StageArgs),
}

fn main() -> ExitCode {
    let Command::Stage(stage) = Args::parse().command;
    match stage {
        Stage::LinkOut(args) => run(link::outgoing::NAME, || link::outgoing::run(&args)),
        Stage::LinkIn(args) => run(link::incoming::NAME, || link::incoming::run(&args)),
    }
}
