//! The latest health of every process.

use std::collections::BTreeMap;

use common::health::Health;
use common::services::Topic;

/// Latest and previous health report of each process, by name.
#[derive(Debug, Default)]
pub(crate) struct Board {
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
    /// Notes a report.
    pub(crate) fn take(&mut self, health: &Health) {
        let now = (health.heartbeat_ns, health.cpu_ns);
        let entry = self.latest.entry(health.process().to_string()).or_insert(Entry {
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

    /// Whether nothing has been reported.
    pub(crate) fn is_empty(&self) -> bool {
        self.latest.is_empty()
    }

    /// Messages missed on all topics by all consumers.
    pub(crate) fn lost(&self) -> u64 {
        let of_process = |entry: &Entry| {
            let topics = [Topic::Dwells, Topic::Plots, Topic::Tracks, Topic::Truth];
            topics.iter().map(|&topic| entry.health.intake[topic as usize].lost).sum::<u64>()
        };
        self.latest.values().map(of_process).sum()
    }
}
