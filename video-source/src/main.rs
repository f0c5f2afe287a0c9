//! `video-source` as a process of its own.

use std::process::ExitCode;

use clap::Parser;
use common::process::StageArgs;
use video_source::process;

/// Publishes the cells of recorded radar video: ASTERIX category 240, spokes of a HALO radar
///
/// Example: video-source --config config/halo.toml --set video_source.file=halo.pcap
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
