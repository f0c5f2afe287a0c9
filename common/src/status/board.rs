//! The latest health of every process, site by site.

use std::collections::BTreeMap;

use crate::config::Sites;
use crate::health::{Health, ObserverLoss};
use crate::topic::Topic;
use crate::topology::{self, Stage};

/// Name of the launcher among the processes.
pub const LAUNCHER: &str = "radar-chain";

/// The latest health reports of a chain.
#[derive(Debug)]
pub struct Board {
    sites: Vec<(String, SiteBoard)>,
}

/// Latest and previous health report of each process of a site, by name.
#[derive(Debug, Default)]
pub struct SiteBoard {
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
    pub fn new(sites: &Sites) -> Self {
        Self { sites: sites.names().into_iter().map(|name| (name.to_string(), SiteBoard::default())).collect() }
    }

    /// Notes a report; one of a site that is not known counts for the first.
    pub fn note(&mut self, health: &Health) {
        let site = self.place_of(health.site.as_str());
        self.sites[site].1.note(health);
    }

    fn place_of(&self, site: &str) -> usize {
        self.sites.iter().position(|(name, _)| name == site).unwrap_or(0)
    }

    /// The sites with their names.
    pub fn sites(&self) -> impl Iterator<Item = (&str, &SiteBoard)> {
        self.sites.iter().map(|(name, board)| (name.as_str(), board))
    }

    /// The first site: what is common to the chain is reported there.
    pub fn first(&self) -> &SiteBoard {
        &self.sites[0].1
    }

    /// The site at a place among the sites.
    pub fn at(&self, site: usize) -> &SiteBoard {
        &self.sites[site].1
    }

    /// The site of this name; one that is not known counts for the first.
    pub fn named(&self, site: &str) -> &SiteBoard {
        self.at(self.place_of(site))
    }

    /// All processes with their label and their share of one processor; one that serves all sites once.
    pub fn all(&self) -> impl Iterator<Item = (String, &Health, f64)> {
        let several = self.sites.len() > 1;
        self.sites.iter().enumerate().flat_map(move |(index, (site, board))| {
            board.all().filter_map(move |(name, health, share)| {
                let of_site = Stage::from_name(name).is_some_and(|stage| !stage.is_of_chain());
                let shown = of_site || index == 0;
                shown.then(|| (topology::label((several && of_site).then_some(site.as_str()), name), health, share))
            })
        })
    }

    /// Whether nothing has been reported.
    pub fn is_empty(&self) -> bool {
        self.sites.iter().all(|(_, board)| board.latest.is_empty())
    }

    /// Restarts of stages so far, as the launcher says.
    pub fn restarts(&self) -> u32 {
        self.first().of(LAUNCHER).map_or(0, |launcher| launcher.restarts)
    }
}

impl SiteBoard {
    /// Notes a report.
    pub fn note(&mut self, health: &Health) {
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
    pub fn of(&self, process: &str) -> Option<&Health> {
        self.latest.get(process).map(|entry| &entry.health)
    }

    /// All processes with their share of one processor.
    pub fn all(&self) -> impl Iterator<Item = (&str, &Health, f64)> {
        self.latest.iter().map(|(name, entry)| (name.as_str(), &entry.health, entry.cpu_share))
    }

    /// All processes with their starts that have been seen.
    pub fn starts(&self) -> impl Iterator<Item = (&str, u32)> {
        self.latest.iter().map(|(name, entry)| (name.as_str(), entry.starts))
    }

    /// The latest report of the process that sets the pace.
    pub fn source(&self) -> Option<&Health> {
        let is_source = |name: &str| Stage::from_name(name).is_some_and(Stage::is_source);
        self.latest.iter().find(|(name, _)| is_source(name)).map(|(_, entry)| &entry.health)
    }

    /// Messages missed by the stages, on all topics; what observers miss is no loss of the chain.
    pub fn lost(&self) -> u64 {
        let counts = |name| Stage::from_name(name).is_some_and(|stage| !stage.is_observer());
        let stages = self.all().filter(|&(name, ..)| counts(name));
        stages.flat_map(|(_, health, _)| counted_inputs(health)).map(|(_, intake)| intake.lost).sum()
    }

    /// What full queues of observers have discarded.
    pub fn observers(&self) -> impl Iterator<Item = &ObserverLoss> {
        self.latest.values().flat_map(|entry| entry.health.observers())
    }
}

/// The topics that a process reads and of which a missing message is lost.
pub fn counted_inputs(health: &Health) -> impl Iterator<Item = (&str, &crate::health::Intake)> {
    health.inputs().filter(|(topic, _)| Topic::from_name(topic).is_none_or(Topic::is_counted))
}
