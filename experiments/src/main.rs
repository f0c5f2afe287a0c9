//! `experiments NAME`: runs an experiment, prints its table, writes JSON and figures.

use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser};
use common::process::print;
use experiments::catalogue::{ALL, EXPERIMENTS, named};
use experiments::{Options, Progress, page, results, table};

const EXAMPLES: &str = "\
Examples:
  experiments cfar                                    table on standard output
  experiments initiation --runs 200 --seed 7          more or fewer runs, other draws
  experiments plot-accuracy --json plots.json --figures figures
  experiments crossing --page docs/results/crossing.md   run it again and renew its tables in the page
  experiments all --quick                             every experiment with few runs, in seconds: one verdict each

The same seed and number of runs give the same figures on any number of threads, and on machines of the same
vector instructions.";

/// Monte Carlo experiments on the chain's own code, every figure with its 95 % interval.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Args {
    /// Which experiment
    #[arg(value_parser = names())]
    name: String,
    /// Runs of each case [default: as many as give useful intervals in a minute or two]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    runs: Option<u32>,
    /// Seed of every random draw
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Threads [default: one per processor]
    #[arg(long, value_name = "K")]
    threads: Option<NonZeroUsize>,
    /// Write the results as one JSON object
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write figures as SVG into this directory
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Rewrite the tables of the experiment in this Markdown page
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Few runs of few cases
    #[arg(long)]
    quick: bool,
    /// accuracy: through cells and the plot extractor instead of drawn plots
    #[arg(long)]
    cells: bool,
    /// real-recordings: folder of the airport's recordings
    #[arg(long, value_name = "DIR")]
    recordings: Option<PathBuf>,
}

fn renew(file: &Path, blocks: &[page::Block]) -> anyhow::Result<()> {
    let renewed = page::renew(&fs::read_to_string(file)?, blocks)?;
    Ok(fs::write(file, renewed)?)
}

fn names() -> PossibleValuesParser {
    let each = EXPERIMENTS.iter().map(|experiment| PossibleValue::new(experiment.name).help(experiment.about));
    PossibleValuesParser::new(each.chain([PossibleValue::new(ALL).help("all of them, in this order")]))
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let threads = args.threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let options = Options {
        runs: args.runs,
        seed: args.seed,
        threads,
        quick: args.quick,
        cells: args.cells,
        recordings: args.recordings,
    };
    let mut all = Vec::new();
    for experiment in named(&args.name) {
        let progress = Progress::new(experiment.name);
        let outcome = (experiment.run)(&options, &progress);
        progress.finish();
        let outcome = outcome.with_context(|| format!("running {}", experiment.name))?;
        if args.name != ALL {
            print(&format!("{}: {} runs, seed {}\n\n", experiment.name, outcome.runs, options.seed));
            print(&format!("{}\n", table::text(&outcome.rows)));
            for remark in &outcome.remarks {
                print(&format!("{remark}\n\n"));
            }
        }
        if let Some(directory) = &args.figures {
            fs::create_dir_all(directory).with_context(|| format!("creating {}", directory.display()))?;
            for figure in &outcome.figures {
                let file = directory.join(format!("{}.svg", figure.name));
                fs::write(&file, figure.to_svg()?).with_context(|| format!("writing {}", file.display()))?;
                print(&format!("{}\n", file.display()));
            }
        }
        if let Some(file) = &args.page {
            renew(file, &outcome.blocks).with_context(|| format!("renewing {}", file.display()))?;
        }
        all.push((experiment.name, outcome));
    }
    if args.name == ALL {
        print(&table::verdicts(&all, options.seed));
    }
    if let Some(file) = &args.json {
        fs::write(file, results::to_json(&args.name, &options, &all)?)
            .with_context(|| format!("writing {}", file.display()))?;
    }
    Ok(())
}
