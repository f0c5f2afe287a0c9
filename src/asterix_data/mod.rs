//! `radar-chain asterix`: what can be done with ASTERIX data.

mod dump;
mod play;
mod schedule;

use std::path::Path;
use std::process::ExitCode;

use asterix::editions::Editions;
use clap::Subcommand;
use common::pace::Speed;
use common::process::BadInput;
use plot_source::unlike::what_is;

/// What can be done with ASTERIX data.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Print records as JSON lines: exit code 1 if bytes could not be read
    ///
    /// SOURCE is a file (blocks back to back, frames of the recorder FINAL, pcap or pcapng) or udp://ADDRESS:PORT,
    /// which ends with Ctrl-C.
    ///
    /// Examples:
    ///   radar-chain asterix dump radar.pcap | jq '.items."040"'
    ///   radar-chain asterix dump 'udp://239.192.86.68:8668?interface=eth0'
    #[command(verbatim_doc_comment)]
    Dump {
        /// File or udp://ADDRESS:PORT[?interface=NAME]
        source: String,
        #[command(flatten)]
        spoken: Spoken,
    },
    /// Send recordings over UDP as their radars did, paced by the times of day in them
    ///
    /// Each FILE goes to the endpoint that follows it: a block in each datagram, or, from a capture, the datagrams as they
    /// were. Several recordings keep their time with each other. Exit code 1 if bytes of a recording could not be read.
    ///
    /// Examples:
    ///   radar-chain asterix play radar.ast udp://127.0.0.1:8600
    ///   radar-chain asterix play radar.ast 'udp://239.1.1.1:8600?interface=lo' mlat.ast udp://127.0.0.1:8601 --speed 20
    #[command(verbatim_doc_comment)]
    Play {
        /// Recordings, each with udp://ADDRESS:PORT[?interface=NAME] after it
        #[arg(required = true, num_args = 2.., value_names = ["FILE", "ENDPOINT"])]
        plan: Vec<String>,
        /// Times real time, or max
        #[arg(long, default_value = "1")]
        speed: Speed,
        #[command(flatten)]
        spoken: Spoken,
    },
}

/// Which editions of the categories a source speaks.
#[derive(Debug, clap::Args)]
pub(crate) struct Spoken {
    /// Edition of a category, where not the newest is spoken, for example --edition 048=1.32
    #[arg(long = "edition", value_name = "CATEGORY=EDITION")]
    editions: Vec<String>,
}

impl Spoken {
    fn editions(&self) -> Result<Editions, BadInput> {
        let named = Editions::default().with_named(self.editions.iter().map(String::as_str));
        named.map_err(|error| BadInput(format!("--edition: {error}")))
    }
}

impl Command {
    /// Runs it.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        match self {
            Self::Dump { source, spoken } => dump::run(source, &spoken.editions()?),
            Self::Play { plan, speed, spoken } => play::run(plan, *speed, &spoken.editions()?),
        }
    }
}

fn bad_input(error: impl std::fmt::Display) -> BadInput {
    BadInput(error.to_string())
}

/// The bytes of a file that may be a recording.
fn read(path: &Path) -> Result<Vec<u8>, BadInput> {
    let bytes = std::fs::read(path).map_err(|error| BadInput(format!("cannot read {}: {error}", path.display())))?;
    match what_is(&bytes) {
        Some(found) => Err(no_recording(path, &format!("it is {found}"))),
        None => Ok(bytes),
    }
}

fn no_recording(path: &Path, found: &str) -> BadInput {
    BadInput(format!("{} is not an ASTERIX recording: {found}", path.display()))
}
