//! The process `plot-source`: paces the scans of a recording and publishes plots and truth.

use std::process::ExitCode;

use anyhow::Context;
use common::ipc::Station;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::messages::{Message, Plots, Truth};
use common::pace::Pace;
use common::process::{BadInput, HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::time::monotonic_ns;

use crate::Source;

/// Name of the process.
pub const NAME: &str = "plot-source";

/// Runs the process until the recording ends or it is asked to stop; a recording that is not sound ends it with 1, after
/// everything readable has been published.
///
/// # Errors
/// Configuration, recordings or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let mut source = Source::open(&chain).map_err(|error| BadInput(error.to_string()))?;
    let code = source.exit_code();
    if chain.run.first_scan == 0 {
        source.notes().iter().for_each(|note| say(note)); // of the whole file: said once, not at every restart
    }
    source.skip_to(chain.run.first_scan);
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let plots = station.publisher::<Plots>(Plots::MOST)?;
    let truth = station.publisher::<Truth>(Truth::MOST)?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    if chain.run.first_scan == 0 {
        reporter.health.set_rejected(source.rejected());
    }
    reporter.publish()?;
    plots.wait_for_consumers()?;
    truth.wait_for_consumers()?;

    let mut pace = Pace::new(chain.run.speed);
    for scan in source {
        let mut truth_of_scan = scan.truth;
        for (mut header, elements) in scan.plots {
            pace.wait_until(header.time_ns, || reporter.publish())?;
            header.session = session;
            header.lineage.published_before = reporter.health.messages_out;
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
                return Ok(code);
            }
        }
    }
    // Started again after the last scan: nothing is left to send.
    reporter.health.ended = 1;
    reporter.publish()?;
    Ok(code)
}
