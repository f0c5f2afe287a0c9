//! The process `video-source`: publishes the dwells of a recording at its pace.

use std::process::ExitCode;

use anyhow::Context;
use common::ipc::Station;
use common::message::END_OF_STREAM;
use common::messages::Dwells;
use common::pace::Pace;
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::time::monotonic_ns;

use crate::VideoRecording;

/// Name of the process.
pub const NAME: &str = "video-source";

/// Runs the process until the recording ends or it is asked to stop; a recording that cannot be read to its end ends it with 1, after
/// everything readable has been published.
///
/// # Errors
/// Configuration, recording or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let recording = VideoRecording::open(&chain).map_err(|error| BadInput(error.to_string()))?;
    if chain.run.first_scan == 0 && !recording.is_sound() {
        let (file, parts) = (&chain.video_source.file, recording.unread());
        say(&format!("{file}: parts that could not be read, cut off or with fragments missing: {parts}"));
    }
    let code = if recording.is_sound() { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) };
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let dwells = station.publisher::<Dwells>(recording.most_cells())?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    if chain.run.first_scan == 0 {
        reporter.health.set_rejected(recording.rejected());
    }
    reporter.publish()?;
    dwells.wait_for_consumers()?;

    let mut pace = Pace::new(chain.run.speed);
    for (header, spoke) in recording.dwells() {
        let mut header = *header;
        header.session = session;
        pace.wait_until(header.time_ns, || reporter.publish())?;
        if stop_requested() {
            header.flags |= END_OF_STREAM;
        }
        let ended = header.flags & END_OF_STREAM != 0;
        let published = dwells.publish_with(spoke.cells, |amplitudes| {
            spoke.fill(amplitudes);
            header.source_out_ns = monotonic_ns();
            header
        });
        published.context("publishing a dwell")?;

        let health = &mut reporter.health;
        health.scan = header.scan;
        health.messages_out += 1;
        health.elements_out += spoke.cells as u64;
        health.ended = u32::from(ended);
        if ended || reporter.is_due() {
            reporter.publish()?;
        }
        if ended {
            dwells.linger();
            return Ok(code);
        }
    }
    // Started again after the last dwell: nothing is left to send.
    reporter.health.ended = 1;
    reporter.publish()?;
    Ok(code)
}
