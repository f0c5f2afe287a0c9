//! Tracks of a running chain into other systems.

use std::net::SocketAddr;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use common::process::{BadInput, StageArgs};

/// Sends the tracks of a running chain to other systems; the chain never waits for it
///
/// Example: outputs asterix udp://127.0.0.1:8600 --config config/uav.toml
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Send ASTERIX over UDP: category 062 for tracks, category 065 once a scan
    Asterix {
        /// Where to, udp://ADDRESS:PORT
        to: String,
        /// Send tracks that are not confirmed, too
        #[arg(long)]
        tentative: bool,
        #[command(flatten)]
        stage: StageArgs,
    },
}

fn main() -> ExitCode {
    let Command::Asterix { to, tentative, stage } = Args::parse().command;
    common::process::run(outputs::process::NAME, || {
        let address: Option<SocketAddr> = to.strip_prefix("udp://").and_then(|address| address.parse().ok());
        let address = address.ok_or_else(|| BadInput(format!("`{to}` found, expected udp://ADDRESS:PORT")))?;
        outputs::process::send_tracks(&stage, address, tentative)
    })
}
