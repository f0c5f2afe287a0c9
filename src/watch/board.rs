//! The latest health of every process, site by site.

use std::collections::BTreeMap;

use common::config::Sites;
use common::health::{Health, ObserverLoss};
use common::topic::Topic;
use common::topology::Stage;

use crate::stages::name::{LAUNCHER, StageId, label};

/// The latest health reports of a chain.
#[derive(Debug)]
pub(crate) struct Board {
    sites: Vec<(String, SiteBoard)>,
}

/// Latest and previous health report of each process of a site, by name.
#[derive(Debug, Default)]
pub(crate) struct SiteBoard {
    latest: BTreeMap<String, Entry>,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    health: Health,
    /// Share of one processor between the last two reports at least half a second apart.
    cpu_share: f64,
    since: (u64, u64),
    /// Sessions seen.
    starts: u32,
}

impl Board {
    /// Nothing reported yet by any process of these sites.
    pub(crate) fn new(sites: &Sites) -> Self {
        Self { sites: sites.names().into_iter().map(|name| (name.to_string(), SiteBoard::default())).collect() }
    }

    /// Notes a report; one of a site that is not known counts for the first.
    pub(crate) fn note(&mut self, health: &Health) {
        let site = self.sites.iter().position(|(name, _)| name == health.site.as_str()).unwrap_or(0);
        self.sites[site].1.note(health);
    }

    /// The sites with their names.
    pub(crate) fn sites(&self) -> impl Iterator<Item = (&str, &SiteBoard)> {
        self.sites.iter().map(|(name, board)| (name.as_str(), board))
    }

    /// The first site: what is common to the chain is reported there.
    pub(crate) fn first(&self) -> &SiteBoard {
        &self.sites[0].1
    }

    /// The site of a stage.
    pub(crate) fn site_of(&self, id: &StageId) -> &SiteBoard {
        &self.sites[id.site].1
    }

    /// Latest report of a stage.
    pub(crate) fn of(&self, id: &StageId) -> Option<&Health> {
        self.site_of(id).of(id.process())
    }

    /// All processes with their label and their share of one processor; one that serves all sites once.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &Health, f64)> {
        let several = self.sites.len() > 1;
        self.sites.iter().enumerate().flat_map(move |(index, (site, board))| {
            board.all().filter_map(move |(name, health, share)| {
                let of_site = Stage::from_name(name).is_some_and(|stage| !stage.is_of_chain());
                let shown = of_site || index == 0;
                shown.then(|| (label((several && of_site).then_some(site.as_str()), name), health, share))
            })
        })
    }

    /// Whether nothing has been reported.
    pub(crate) fn is_empty(&self) -> bool {
        self.sites.iter().all(|(_, board)| board.latest.is_empty())
    }

    /// Restarts of stages so far, as the launcher says.
    pub(crate) fn restarts(&self) -> u32 {
        self.first().of(LAUNCHER).map_or(0, |launcher| launcher.restarts)
    }
}

impl SiteBoard {
    /// Notes a report.
    pub(crate) fn note(&mut self, health: &Health) {
        let now = (health.heartbeat_ns, health.cpu_ns);
        let entry = self.latest.entry(health.process.to_string()).or_insert(Entry {
            health: *health,
            cpu_share: 0.0,
            since: now,
            starts: 1,
        });
        if entry.health.session != health.session {
            if health.heartbeat_ns < entry.health.heartbeat_ns {
                return; // a report that was overtaken by those of the next session
            }
            entry.since = now;
            entry.starts += 1;
        }
        let elapsed_ns = now.0.saturating_sub(entry.since.0);
        if elapsed_ns >= 500_000_000 {
            entry.cpu_share = now.1.saturating_sub(entry.since.1) as f64 / elapsed_ns as f64;
            entry.since = now;
        }
        entry.health = *health;
    }

    /// Latest report of a process.
    pub(crate) fn of(&self, process: &str) -> Option<&Health> {
        self.latest.get(process).map(|entry| &entry.health)
    }

    /// All processes with their share of one processor.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&str, &Health, f64)> {
        self.latest.iter().map(|(name, entry)| (name.as_str(), &entry.health, entry.cpu_share))
    }

    /// All processes with their starts that have been seen.
    pub(crate) fn starts(&self) -> impl Iterator<Item = (&str, u32)> {
        self.latest.iter().map(|(name, entry)| (name.as_str(), entry.starts))
    }

    /// The latest report of the process that sets the pace.
    pub(crate) fn source(&self) -> Option<&Health> {
        let is_source = |name: &str| Stage::from_name(name).is_some_and(Stage::is_source);
        self.latest.iter().find(|(name, _)| is_source(name)).map(|(_, entry)| &entry.health)
    }

    /// Messages missed by the stages, on all topics; what observers miss is no loss of the chain.
    pub(crate) fn lost(&self) -> u64 {
        let counts = |name| Stage::from_name(name).is_some_and(|stage| !stage.is_observer());
        let stages = self.all().filter(|&(name, ..)| counts(name));
        stages.flat_map(|(_, health, _)| data_inputs(health)).map(|(_, intake)| intake.lost).sum()
    }

    /// What full queues of observers have discarded.
    pub(crate) fn observers(&self) -> impl Iterator<Item = &ObserverLoss> {
        self.latest.values().flat_map(|entry| entry.health.observers())
    }
}

/// The topics that a process reads, health aside.
pub(crate) fn data_inputs(health: &Health) -> impl Iterator<Item = (&str, &common::health::Intake)> {
    health.inputs().filter(|(topic, _)| Topic::from_name(topic).is_none_or(Topic::is_data))
}
