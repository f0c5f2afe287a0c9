//! The post of whoever looks after a chain, launcher or keeper: services held open, health read, metrics served.

use common::config::ChainConfig;
use common::ipc::{Domain, Flow, IpcError, Keeper, Station, Subscriber, Wake, attend};
use common::process::{HealthReporter, new_session};
use common::services::{HealthReports, Topic};

use crate::board::Board;
use crate::metrics::Metrics;

/// A place in the domain from which the stages are seen.
pub(crate) struct Post {
    station: Station,
    _services: Keeper,
    health: Subscriber<HealthReports>,
    reporter: HealthReporter,
    metrics: Metrics,
    /// What the stages have said last.
    pub(crate) board: Board,
}

/// What a look from the post asks for.
pub(crate) struct Look {
    /// Whether to look again.
    pub(crate) flow: Flow,
    /// Restarts of stages so far.
    pub(crate) restarts: u32,
}

impl Post {
    /// Takes the post as the process `name`; also what wakes it.
    ///
    /// # Errors
    /// The metrics cannot be served, or the domain cannot be entered.
    pub(crate) fn take(name: &str, chain: &ChainConfig) -> anyhow::Result<(Self, Wake)> {
        let metrics = Metrics::serve(&chain.metrics)?;
        let station = Station::enter(name, chain)?;
        let (services, health) = (station.keep_services()?, station.subscriber::<HealthReports>()?);
        let wake = station.wake(Topic::Health)?;
        let reporter = HealthReporter::new(&station, chain, new_session(), 0)?;
        Ok((Self { station, _services: services, health, reporter, metrics, board: Board::default() }, wake))
    }

    /// The domain.
    pub(crate) fn domain(&self) -> &Domain {
        self.station.domain()
    }

    /// Calls `look` some ten times a second, with the latest health on the board, until it ends.
    ///
    /// # Errors
    /// [`IpcError`], and the errors of `look`.
    pub(crate) fn hold(
        &mut self,
        wake: &Wake,
        mut look: impl FnMut(&mut Self) -> anyhow::Result<Look>,
    ) -> anyhow::Result<()> {
        attend(&[wake], &self.reporter.watchdog(), || {
            self.read_health()?;
            let Look { flow, restarts } = look(self)?;
            self.domain().clean_dead_nodes();
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
        while let Some(report) = self.health.receive()? {
            report.elements().iter().for_each(|health| self.board.take(health));
        }
        Ok(())
    }
}
