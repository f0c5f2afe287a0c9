//! The process `video-source`: publishes the dwells of a recording, at its pace, or of a radar that it listens to.

use std::process::ExitCode;

use anyhow::Context;
use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::ipc::{Publisher, Station};
use common::message::END_OF_STREAM;
use common::messages::Dwells;
use common::pace::Pace;
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::time::monotonic_ns;

use crate::{Spoke, VideoRecording, listening};

/// Name of the process.
pub const NAME: &str = "video-source";

/// Runs the process until the recording ends or it is asked to stop; a recording that cannot be read to its end ends it with 1, after
/// everything readable has been published.
///
/// # Errors
/// Configuration, recording, network or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    if !chain.video_source.listen.is_empty() {
        return listening::run(&chain);
    }
    let recording = VideoRecording::open(&chain).map_err(|error| BadInput(error.to_string()))?;
    if chain.run.first_scan == 0 && !recording.is_sound() {
        let (file, parts) = (&chain.video_source.file, recording.unread());
        say(&format!("{file}: parts that could not be read, cut off or with fragments missing: {parts}"));
    }
    let code = if recording.is_sound() { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) };
    let mut outlet = Outlet::open(&chain, recording.most_cells())?;
    if chain.run.first_scan == 0 {
        outlet.reporter.health.set_rejected(recording.rejected());
    }
    outlet.begin()?;

    let mut pace = Pace::new(chain.run.speed);
    for (header, spoke) in recording.dwells() {
        let mut header = *header;
        pace.wait_until(header.time_ns, || outlet.reporter.publish())?;
        if stop_requested() {
            header.flags |= END_OF_STREAM;
        }
        outlet.publish(header, spoke)?;
        if header.has(END_OF_STREAM) {
            return Ok(code);
        }
    }
    // Started again after the last dwell: nothing is left to send.
    outlet.end()?;
    Ok(code)
}

/// Where dwells leave the process.
pub(crate) struct Outlet {
    dwells: Publisher<Dwells>,
    pub(crate) reporter: HealthReporter,
    session: u64,
}

impl Outlet {
    /// Opens the topic of a chain for dwells of so many cells.
    pub(crate) fn open(chain: &ChainConfig, most_cells: usize) -> anyhow::Result<Self> {
        let refused = realtime::apply(chain.realtime.of(NAME));
        let station = Station::enter(NAME, chain)?;
        let dwells = station.publisher::<Dwells>(most_cells)?;
        let session = new_session();
        let reporter = HealthReporter::new(&station, chain, session, refused)?;
        Ok(Self { dwells, reporter, session })
    }

    /// Waits for those who must receive dwells.
    pub(crate) fn begin(&mut self) -> anyhow::Result<()> {
        self.reporter.publish()?;
        Ok(self.dwells.wait_for_consumers()?)
    }

    /// Publishes a dwell; at the end of the stream, waits until it has been taken.
    pub(crate) fn publish(&mut self, mut header: DwellHeader, spoke: &Spoke) -> anyhow::Result<()> {
        header.session = self.session;
        let ended = header.has(END_OF_STREAM);
        let published = self.dwells.publish_with(spoke.cells, |amplitudes| {
            spoke.fill(amplitudes);
            header.source_out_ns = monotonic_ns();
            header
        });
        published.context("publishing a dwell")?;
        let health = &mut self.reporter.health;
        health.scan = header.scan;
        health.messages_out += 1;
        health.elements_out += spoke.cells as u64;
        health.ended = u32::from(ended);
        if ended || self.reporter.is_due() {
            self.reporter.publish()?;
        }
        if ended {
            self.dwells.linger();
        }
        Ok(())
    }

    /// Says that nothing will come any more.
    pub(crate) fn end(&mut self) -> anyhow::Result<()> {
        self.reporter.health.ended = 1;
        Ok(self.reporter.publish()?)
    }
}
