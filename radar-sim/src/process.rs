//! The process `radar-sim`: paces the beam and publishes dwells and truth.

use std::process::ExitCode;

use anyhow::Context;
use common::ipc::{Publisher, Station};
use common::message::{END_OF_SCAN, END_OF_SECTOR, END_OF_STREAM};
use common::messages::{Dwells, Message, Truth};
use common::pace::Pace;
use common::process::{HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::time::monotonic_ns;
use common::truth::TruthHeader;

use crate::DwellSimulator;

/// Name of the process.
pub const NAME: &str = "radar-sim";

/// Runs the process until its scans are done or it is asked to stop.
///
/// # Errors
/// Configuration, scenario or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let mut simulator = DwellSimulator::new(&chain).map_err(|error| common::process::BadInput(error.to_string()))?;
    if chain.run.first_scan == 0 {
        simulator.notes().iter().for_each(|note| say(note)); // once, not at every restart
    }
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let dwells = station.publisher::<Dwells>(simulator.cells())?;
    let truth = station.publisher::<Truth>(Truth::MOST)?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    reporter.health.tracks = chain.sim.targets.len() as u32;
    reporter.publish()?;
    dwells.wait_for_consumers()?;
    truth.wait_for_consumers()?;

    let (first_scan, scans) = (chain.run.first_scan, chain.run.scans);
    let mut pace = Pace::new(chain.run.speed);
    let mut targets = Vec::with_capacity(chain.sim.targets.len());
    let left = if scans > 0 { first_scan..scans } else { first_scan..u32::MAX };
    for scan in left {
        for dwell in 0..chain.radar.dwells_per_scan {
            let mut header = simulator.header(scan, dwell);
            header.session = session;
            pace.wait_until(header.time_ns, || reporter.publish())?;
            let last_of_scan = header.flags & END_OF_SCAN != 0;
            let done = last_of_scan && scan + 1 == scans;
            if done || (header.flags & END_OF_SECTOR != 0 && stop_requested()) {
                header.flags |= END_OF_STREAM;
            }
            if last_of_scan || header.flags & END_OF_STREAM != 0 {
                simulator.truth(scan, &mut targets);
                publish_truth(&truth, &header, &targets).context("publishing truth")?;
            }
            let published = dwells.publish_with(simulator.cells(), |amplitudes| {
                simulator.fill(scan, dwell, amplitudes);
                header.source_out_ns = monotonic_ns();
                header
            });
            published.context("publishing a dwell")?;

            let health = &mut reporter.health;
            health.scan = scan;
            health.messages_out += 1;
            health.elements_out += simulator.cells() as u64;
            health.ended = u32::from(header.flags & END_OF_STREAM != 0);
            if health.ended == 1 || reporter.is_due() {
                reporter.publish()?;
            }
            if header.flags & END_OF_STREAM != 0 {
                dwells.linger();
                return Ok(ExitCode::SUCCESS);
            }
        }
    }
    // Started again after its last scan: the launcher sees that nothing is left to send.
    reporter.health.ended = 1;
    reporter.publish()?;
    Ok(ExitCode::SUCCESS)
}

/// Truth goes out before the last dwell of its scan, so that no score waits for it.
fn publish_truth(
    publisher: &Publisher<Truth>,
    dwell: &common::dwell::DwellHeader,
    targets: &[common::truth::TruthTarget],
) -> Result<(), common::ipc::IpcError> {
    let header = TruthHeader {
        seq: u64::from(dwell.scan),
        session: dwell.session,
        time_ns: dwell.time_ns,
        scan_period_s: dwell.scan_period_s,
        scan: dwell.scan,
        flags: END_OF_SCAN | dwell.flags & END_OF_STREAM,
        ..TruthHeader::default()
    };
    publisher.publish(&header, targets, |header| header.source_out_ns = monotonic_ns())
}
