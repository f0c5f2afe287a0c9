//! The process `plot-extractor`: takes dwells, publishes the plots of each sector.

use std::process::ExitCode;

use anyhow::Context;
use common::health::{Reject, Rejected};
use common::ipc::{Flow, Station, Turn, attend};
use common::message::END_OF_STREAM;
use common::messages::{Dwells, Message, Plots};
use common::process::{HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::time::monotonic_ns;
use common::topic::Topic;

use crate::PlotExtractor;

/// Name of the process.
pub const NAME: &str = "plot-extractor";

/// Runs the process until the stream ends or it is asked to stop.
///
/// # Errors
/// Configuration or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let publisher = station.publisher::<Plots>(Plots::MOST)?;
    let wake = station.wake(Topic::Dwells)?;
    let dwells = station.subscriber::<Dwells>()?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    let mut rejected = Rejected::default();
    let mut plots_of_scan = 0;

    attend(&[&wake], &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let turn = Turn::begin();
        while !turn.is_over()
            && let Some(dwell) = dwells.receive()?
        {
            let received_ns = monotonic_ns();
            let header = dwell.header();
            let reject = extractor.take(header, dwell.elements(), received_ns, |header, plots| {
                let health = &mut reporter.health;
                health.messages_out += 1;
                health.elements_out += plots.len() as u64;
                plots_of_scan += plots.len() as u32;
                rejected.count_many(Reject::Full, header.left_out.into());
                health.ended = u32::from(header.has(END_OF_STREAM));
                publisher.publish(header, plots, |header| {
                    header.session = session;
                    header.stamps.plots_out_ns = monotonic_ns();
                })
            });
            if let Some(reason) = reject.context("publishing plots")? {
                rejected.count(reason);
            }
            let health = &mut reporter.health;
            if header.scan != health.scan {
                health.scan = header.scan;
                health.plots = std::mem::take(&mut plots_of_scan);
            }
            if reporter.health.ended == 1 {
                break;
            }
        }
        let ended = reporter.health.ended == 1;
        if ended || reporter.is_due() {
            reporter.health.set_intake(Topic::Dwells, dwells.intake());
            reporter.health.set_waiting(Topic::Dwells, dwells.take_most_waiting());
            reporter.health.set_rejected(&rejected);
            reporter.publish()?;
        }
        // Asked to stop, it still works off what the source sends until its last dwell.
        let abandoned = !turn.is_over() && stop_requested() && dwells.publishers() == 0;
        Ok(if ended || abandoned { Flow::End } else { turn.flow() })
    })?;
    publisher.linger();
    Ok(ExitCode::SUCCESS)
}
