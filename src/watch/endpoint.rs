//! The supervisor's endpoint in a domain, for launcher and keeper: services held open, health read, metrics served.

use std::time::{Duration, Instant};

use common::config::Sites;
use common::ipc::{Domain, Flow, IpcError, Keeper, Station, Subscriber, Wake, attend};
use common::messages::HealthReports;
use common::process::{HealthReporter, new_session};
use common::status::Board;
use common::topic::Topic;

use super::metrics::Metrics;

/// The files of the domain are marked as used this often.
const MARK: Duration = Duration::from_secs(3600);

/// A place in the domain from which the stages of all sites are seen.
pub(crate) struct Endpoint {
    station: Station,
    _services: Vec<Keeper>,
    health: Vec<Subscriber<HealthReports>>,
    reporter: HealthReporter,
    metrics: Metrics,
    /// What the stages have said last.
    pub(crate) board: Board,
}

/// What a look at the stages asks for.
pub(crate) struct Look {
    /// Whether to look again.
    pub(crate) flow: Flow,
    /// Restarts of stages so far.
    pub(crate) restarts: u32,
}

impl Endpoint {
    /// Opens the endpoint as the process `name`; also what wakes it.
    ///
    /// # Errors
    /// The metrics cannot be served, or the domain cannot be entered.
    pub(crate) fn open(name: &str, sites: &Sites) -> anyhow::Result<(Self, Vec<Wake>)> {
        let metrics = Metrics::serve(&sites.first().metrics)?;
        let station = Station::enter(name, sites.first())?;
        let (mut services, mut health, mut wakes) = (Vec::new(), Vec::new(), Vec::new());
        for site in sites.all() {
            let there = station.at(site);
            services.push(there.keep_services()?);
            health.push(there.subscriber::<HealthReports>()?);
            wakes.push(there.wake(Topic::HealthReports)?);
        }
        let reporter = HealthReporter::new(&station, sites.first(), new_session(), 0)?;
        let board = Board::new(sites);
        Ok((Self { station, _services: services, health, reporter, metrics, board }, wakes))
    }

    /// The domain.
    pub(crate) fn domain(&self) -> &Domain {
        self.station.domain()
    }

    /// Calls `look` about ten times a second, with the latest health on the board, until it ends.
    ///
    /// # Errors
    /// [`IpcError`], and the errors of `look`.
    pub(crate) fn watch(
        &mut self,
        wakes: &[Wake],
        mut look: impl FnMut(&mut Self) -> anyhow::Result<Look>,
    ) -> anyhow::Result<()> {
        let wakes: Vec<&Wake> = wakes.iter().collect();
        let mut marked = Instant::now();
        attend(&wakes, &self.reporter.watchdog(), || {
            self.read_health()?;
            let Look { flow, restarts } = look(self)?;
            self.domain().clean_dead_nodes();
            if marked.elapsed() > MARK {
                marked = Instant::now();
                self.domain().keep_fresh();
            }
            self.reporter.health.restarts = restarts;
            self.reporter.health.ended = u32::from(flow == Flow::End);
            if flow == Flow::End || self.reporter.is_due() {
                self.reporter.publish()?;
                self.metrics.publish(&self.board);
            }
            anyhow::Ok(flow)
        })
    }

    fn read_health(&mut self) -> Result<(), IpcError> {
        for site in &self.health {
            while let Some(report) = site.receive()? {
                report.elements().iter().for_each(|health| self.board.note(health));
            }
        }
        Ok(())
    }
}
