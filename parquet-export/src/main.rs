//! `parquet-export`: topics of a recording as Parquet tables.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use common::topic::Topic;
use parquet_export::Parquet;
use recorder::commands;

/// Write topics of a recording as Parquet tables; `recorder export --format parquet` starts this program
///
/// Example: parquet-export recordings/FILE.mcap --topics plots,tracks --out tables
#[derive(Parser)]
#[command(version, verbatim_doc_comment)]
struct Arguments {
    /// The recording
    file: PathBuf,
    /// Topics, separated by commas
    #[arg(long, value_delimiter = ',', default_value = commands::TABLE_TOPICS, value_parser = commands::parse_topic)]
    topics: Vec<Topic>,
    /// Folder of the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let args = Arguments::parse();
    common::process::run("parquet-export", || commands::export(&args.file, &args.topics, &Parquet, &args.out))
}
