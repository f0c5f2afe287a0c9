//! The process `plot-source`: publishes plots of a recording, at its pace, or of a radar that it listens to.

use std::process::ExitCode;
use std::thread;
use std::time::Duration;

use anyhow::Context;
use common::config::ChainConfig;
use common::ipc::{Publisher, Station};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::messages::{Message, Plots, Truth};
use common::pace::Pace;
use common::plots::{Plot, PlotsHeader};
use common::process::{BadInput, HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::time::monotonic_ns;
use common::truth::{TruthHeader, TruthTarget};

use crate::{Source, listening};

/// How often work that takes long is looked after.
const LOOK: Duration = Duration::from_millis(2);

/// Name of the process.
pub const NAME: &str = "plot-source";

/// Runs the process until the recording ends or it is asked to stop; a recording that is not sound ends it with 1, after
/// everything readable has been published.
///
/// # Errors
/// Configuration, recordings, network or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    if !chain.plot_source.listen.is_empty() {
        return listening::run(&chain);
    }
    let mut outlet = Outlet::open(&chain)?;
    let mut source = outlet.while_it_lasts(|| Source::open(&chain))?.map_err(|error| BadInput(error.to_string()))?;
    let code = source.exit_code();
    if chain.run.first_scan == 0 {
        source.notes().iter().for_each(|note| say(note)); // of the whole file: said once, not at every restart
    }
    source.skip_to(chain.run.first_scan);
    if chain.run.first_scan == 0 {
        outlet.reporter.health.set_rejected(source.rejected());
    }
    outlet.begin()?;

    let mut pace = Pace::new(chain.run.speed);
    for scan in source {
        let mut truth_of_scan = scan.truth;
        for (mut header, elements) in scan.plots {
            pace.wait_until(header.time_ns, || outlet.reporter.publish())?;
            if stop_requested() {
                header.flags |= END_OF_STREAM;
            }
            let last = header.flags & END_OF_STREAM;
            if last | header.flags & END_OF_SCAN != 0
                && let Some((mut truth_header, targets)) = truth_of_scan.take()
            {
                truth_header.flags |= last;
                outlet.publish_truth(truth_header, &targets)?;
            }
            outlet.publish(header, &elements)?;
            if last != 0 {
                return Ok(code);
            }
        }
    }
    // Started again after the last scan: nothing is left to send.
    outlet.reporter.health.ended = 1;
    outlet.reporter.publish()?;
    Ok(code)
}

/// Where plots and truth leave the process.
pub(crate) struct Outlet {
    plots: Publisher<Plots>,
    truth: Publisher<Truth>,
    pub(crate) reporter: HealthReporter,
    session: u64,
}

impl Outlet {
    /// Opens the topics of a chain.
    pub(crate) fn open(chain: &ChainConfig) -> anyhow::Result<Self> {
        let refused = realtime::apply(chain.realtime.of(NAME));
        let station = Station::enter(NAME, chain)?;
        let plots = station.publisher::<Plots>(Plots::MOST)?;
        let truth = station.publisher::<Truth>(Truth::MOST)?;
        let session = new_session();
        let reporter = HealthReporter::new(&station, chain, session, refused)?;
        Ok(Self { plots, truth, reporter, session })
    }

    /// Does what takes long, and reports health meanwhile.
    fn while_it_lasts<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
        thread::scope(|scope| {
            let worker = scope.spawn(work);
            while !worker.is_finished() {
                if self.reporter.is_due() {
                    self.reporter.publish()?;
                }
                thread::sleep(LOOK);
            }
            worker.join().map_err(|_| anyhow::anyhow!("reading recordings: it panicked"))
        })
    }

    /// Waits for those who must receive plots and truth.
    pub(crate) fn begin(&mut self) -> anyhow::Result<()> {
        self.reporter.publish()?;
        self.plots.wait_for_consumers()?;
        Ok(self.truth.wait_for_consumers()?)
    }

    /// Publishes where the targets of a scan were.
    pub(crate) fn publish_truth(&mut self, mut header: TruthHeader, targets: &[TruthTarget]) -> anyhow::Result<()> {
        header.session = self.session;
        let published = self.truth.publish(&header, targets, |header| header.source_out_ns = monotonic_ns());
        published.context("publishing truth")?;
        self.reporter.health.tracks = targets.len() as u32;
        Ok(())
    }

    /// Publishes the plots of a sector; at the end of the stream, waits until they have been taken.
    pub(crate) fn publish(&mut self, mut header: PlotsHeader, elements: &[Plot]) -> anyhow::Result<()> {
        header.session = self.session;
        header.lineage.published_before = self.reporter.health.messages_out;
        let published = self.plots.publish(&header, elements, |header| {
            // Without dwells the source and the extractor are one.
            header.stamps.source_out_ns = monotonic_ns();
            header.stamps.plots_out_ns = header.stamps.source_out_ns;
        });
        published.context("publishing plots")?;
        let ended = header.flags & END_OF_STREAM != 0;
        let health = &mut self.reporter.health;
        health.scan = header.scan;
        health.messages_out += 1;
        health.elements_out += elements.len() as u64;
        health.ended = u32::from(ended);
        if ended || self.reporter.is_due() {
            self.reporter.publish()?;
        }
        if ended {
            self.plots.linger();
        }
        Ok(())
    }
}
