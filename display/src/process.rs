//! The process `display`: an observer of all sites.

use std::process::ExitCode;

use common::config::{ChainConfig, Sites};
use common::ipc::{Flow, IpcError, Station, Subscriber, Turn, attend};
use common::message::END_OF_STREAM;
use common::messages::Tracks;
use common::process::{HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::topic::Topic;
use common::topology::DISPLAY;

/// Name of the process.
pub const NAME: &str = DISPLAY;

/// Runs the process until the tracks of all sites have ended.
///
/// # Errors
/// Configuration or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let sites = args.load_sites()?;
    let chain = sites.first();
    let refused = realtime::apply(chain.realtime.of(NAME));
    let first = Station::enter(NAME, chain)?;
    let mut of_sites = site_feeds(&first, &sites)?;
    let wakes = of_sites.iter().map(|site| site.station.wake(Topic::Tracks)).collect::<Result<Vec<_>, _>>()?;
    let wakes: Vec<_> = wakes.iter().collect();
    let mut reporter = HealthReporter::new(&first, chain, new_session(), refused)?;
    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let turn = Turn::begin();
        for site in &mut of_sites {
            site.take_waiting(&turn)?;
        }
        let ended = stop_requested() || of_sites.iter().all(|site| site.ended);
        let flow = if ended { Flow::End } else { turn.flow() };
        if flow == Flow::End || reporter.is_due() {
            reporter.health.scan = of_sites.iter().map(|site| site.scan).max().unwrap_or(0);
            reporter.health.set_intake(Topic::Tracks, of_sites[0].tracks.intake());
            reporter.health.ended = u32::from(flow == Flow::End);
            reporter.publish()?;
        }
        Ok(flow)
    })?;
    Ok(ExitCode::SUCCESS)
}

/// What comes from a site.
struct SiteFeed {
    station: Station,
    tracks: Subscriber<Tracks>,
    scan: u32,
    ended: bool,
}

fn site_feeds(first: &Station, sites: &Sites) -> Result<Vec<SiteFeed>, IpcError> {
    let feed = |site: &ChainConfig| {
        let station = first.at(site);
        let tracks = station.subscriber::<Tracks>()?;
        Ok(SiteFeed { station, tracks, scan: 0, ended: false })
    };
    sites.all().iter().map(feed).collect()
}

impl SiteFeed {
    fn take_waiting(&mut self, turn: &Turn) -> Result<(), IpcError> {
        while !turn.is_over() {
            let Some(message) = self.tracks.receive()? else { break };
            self.scan = message.header().scan;
            self.ended = message.header().has(END_OF_STREAM);
        }
        Ok(())
    }
}
