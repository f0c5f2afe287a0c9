//! The process `plot-source`: paces the scans of a recording and publishes plots and truth.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::{ChainConfig, Speed};
use common::ipc::Station;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::process::{BadInput, HealthReporter, StageArgs, new_session, stop_requested};
use common::services::{Consumer, MAX_PLOTS, MAX_TARGETS, Plots, Truth};
use common::time::monotonic_ns;
use common::units::seconds_between;

use crate::Source;

/// Name of the process.
pub const NAME: &str = "plot-source";

/// Runs the process until the recording ends or it is asked to stop.
///
/// # Errors
/// Configuration, recordings or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let mut source = Source::open(&chain).map_err(|error| BadInput(error.to_string()))?;
    source.skip_to(chain.run.first_scan);
    let station = Station::enter(NAME, &chain)?;
    let plots = station.publisher::<Plots>(MAX_PLOTS, &[Consumer::Tracker, Consumer::Recorder])?;
    let truth = station.publisher::<Truth>(MAX_TARGETS, &[Consumer::Recorder])?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, NAME, session)?;
    reporter.health.rejected = source.rejected().0;
    reporter.publish()?;
    plots.wait_for_consumers()?;
    truth.wait_for_consumers()?;

    let mut pace = Pace::new(&chain);
    for scan in source {
        let mut truth_of_scan = scan.truth;
        for (mut header, elements) in scan.plots {
            pace.wait_until(header.time_ns);
            header.session = session;
            if stop_requested() {
                header.flags |= END_OF_STREAM;
            }
            let last = header.flags & END_OF_STREAM;
            if last | header.flags & END_OF_SCAN != 0
                && let Some((mut truth_header, targets)) = truth_of_scan.take()
            {
                truth_header.session = session;
                truth_header.flags |= last;
                let published = truth.publish(&truth_header, &targets, |header| header.source_out_ns = monotonic_ns());
                published.context("publishing truth")?;
                reporter.health.tracks = targets.len() as u32;
            }
            let published = plots.publish(&header, &elements, |header| {
                // Without dwells the source and the extractor are one.
                header.stamps.source_out_ns = monotonic_ns();
                header.stamps.plots_out_ns = header.stamps.source_out_ns;
            });
            published.context("publishing plots")?;

            let health = &mut reporter.health;
            health.scan = header.scan;
            health.messages_out += 1;
            health.elements_out += elements.len() as u64;
            health.ended = u32::from(last != 0);
            if last != 0 || reporter.is_due() {
                reporter.publish()?;
            }
            if last != 0 {
                plots.linger();
                return Ok(ExitCode::SUCCESS);
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Publishes each sector when the antenna would have finished it.
struct Pace {
    factor: Option<f64>,
    /// Measurement time and the moment at which it was due.
    start: Option<(u64, Instant)>,
}

impl Pace {
    fn new(chain: &ChainConfig) -> Self {
        let factor = match chain.run.speed {
            Speed::Max => None,
            Speed::Times(factor) => Some(factor),
        };
        Self { factor, start: None }
    }

    /// Sleeps until `time_ns` is due. What is late goes out at once; after a second of
    /// delay the schedule starts anew instead of hurrying after it.
    fn wait_until(&mut self, time_ns: u64) {
        let Some(factor) = self.factor else { return };
        let now = Instant::now();
        let (start_ns, start) = *self.start.get_or_insert((time_ns, now));
        let due = start + Duration::from_secs_f64((seconds_between(start_ns, time_ns) / factor).max(0.0));
        if let Some(early) = due.checked_duration_since(now) {
            std::thread::sleep(early);
        } else if now.duration_since(due) > Duration::from_secs(1) {
            self.start = Some((time_ns, now));
        }
    }
}
