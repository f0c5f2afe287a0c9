//! Resources of the processes, from their health.

use std::collections::BTreeMap;

use common::health::{Health, RealtimeSetting};
use common::report::ProcessUse;
use common::topology::{Stage, is_observer};
use common::units::{MIB, NS_PER_S};
use serde::{Deserialize, Serialize};

/// The fold of health reports, by process.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Processes {
    by_name: BTreeMap<String, Lives>,
}

/// Messages lost, by topic and observer.
pub(crate) type Observers = BTreeMap<String, BTreeMap<String, u64>>;

/// All starts of one process. Counts of ended lives are kept apart from those of the present
/// one, whose reports repeat them.
#[derive(Debug, Serialize, Deserialize)]
struct Lives {
    now: Health,
    restarts: u64,
    cpu_ns_before: u64,
    rejected_before: BTreeMap<String, u64>,
    /// What observers have lost, by topic and observer.
    observers_before: Observers,
    silences_before: u64,
    slow_steps_before: u64,
    rss_first: u64,
    rss_max: u64,
}

impl Processes {
    pub(crate) fn take(&mut self, health: &Health) {
        let lives = self.by_name.entry(health.process.to_string()).or_insert_with(|| Lives {
            now: *health,
            restarts: 0,
            cpu_ns_before: 0,
            rejected_before: BTreeMap::new(),
            observers_before: Observers::new(),
            silences_before: 0,
            slow_steps_before: 0,
            rss_first: health.rss_bytes,
            rss_max: 0,
        });
        if health.session != lives.now.session {
            // Sessions do not tell which life is later: the wall clock they come from may have been stepped.
            if health.heartbeat_ns < lives.now.heartbeat_ns {
                return; // a report that was overtaken: an old life has nothing new to say
            }
            lives.restarts += 1;
            lives.cpu_ns_before += lives.now.cpu_ns;
            add_rejected(&mut lives.rejected_before, &lives.now);
            add_observers(&mut lives.observers_before, &lives.now);
            lives.silences_before += u64::from(lives.now.silences);
            lives.slow_steps_before += u64::from(lives.now.slow_steps);
        }
        lives.now = *health;
        lives.rss_max = lives.rss_max.max(health.rss_bytes);
    }

    /// Whether all of these processes have said that they ended in order.
    pub(crate) fn have_ended(&self, mut names: impl Iterator<Item = &'static str>) -> bool {
        names.all(|name| self.by_name.get(name).is_some_and(|lives| lives.now.ended == 1))
    }

    /// Whether any process began anew on which the results depend.
    pub(crate) fn restarted(&self) -> bool {
        self.by_name.iter().any(|(name, lives)| lives.restarts > 0 && !is_observer(name))
    }

    /// Messages that observers have lost, by topic and observer: what publishers have counted, and what observers that
    /// publish their health say where a publisher does not know, as in real-time mode.
    pub(crate) fn observers(&self) -> Observers {
        let mut observers = Observers::new();
        for lives in self.by_name.values() {
            add_observers(&mut observers, &lives.now);
            for (topic, by_observer) in &lives.observers_before {
                for (observer, lost) in by_observer {
                    *observers.entry(topic.clone()).or_default().entry(observer.clone()).or_default() += lost;
                }
            }
        }
        let looks_on = |name: &str| Stage::from_name(name).is_none_or(Stage::is_observer);
        for (name, lives) in self.by_name.iter().filter(|(name, _)| looks_on(name)) {
            for (topic, intake) in lives.now.inputs().filter(|(_, intake)| intake.lost > 0) {
                let lost = observers.entry(topic.to_string()).or_default().entry(name.clone()).or_default();
                *lost = intake.lost.max(*lost);
            }
        }
        observers
    }

    pub(crate) fn report(&self) -> BTreeMap<String, ProcessUse> {
        let mib = |bytes: u64| bytes as f64 / MIB;
        let used = |lives: &Lives| {
            let mut rejected = lives.rejected_before.clone();
            add_rejected(&mut rejected, &lives.now);
            ProcessUse {
                pid: lives.now.pid,
                cpu_s: (lives.cpu_ns_before + lives.now.cpu_ns) as f64 / NS_PER_S,
                rss_mib_start: mib(lives.rss_first),
                rss_mib_end: mib(lives.now.rss_bytes),
                rss_mib_max: mib(lives.rss_max),
                restarts: lives.restarts,
                rejected,
                files: lives.now.files,
                silences: lives.silences_before + u64::from(lives.now.silences),
                slow_steps: lives.slow_steps_before + u64::from(lives.now.slow_steps),
                refused: RealtimeSetting::names(lives.now.refused).into_iter().map(String::from).collect(),
                false_alarms: lives.now.false_alarms.known(),
            }
        };
        self.by_name.iter().map(|(name, lives)| (name.clone(), used(lives))).collect()
    }
}

fn add_rejected(sums: &mut BTreeMap<String, u64>, health: &Health) {
    for (reason, count) in health.rejected() {
        *sums.entry(reason.to_string()).or_default() += count;
    }
}

fn add_observers(sums: &mut Observers, health: &Health) {
    for of in health.observers() {
        *sums.entry(of.topic.to_string()).or_default().entry(of.observer.to_string()).or_default() += of.lost;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::health::{Reject, Rejected};

    #[test]
    fn counts_of_all_lives_add_up() {
        let mut processes = Processes::default();
        let mut report = |heartbeat_ns, session, cpu_s: u64, rss_mib: u64, late| {
            let (cpu_ns, rss_bytes) = (cpu_s * 1_000_000_000, rss_mib << 20);
            let mut health = Health { heartbeat_ns, session, cpu_ns, rss_bytes, ..Health::default() };
            health.process = "tracker".into();
            let mut rejected = Rejected::default();
            rejected.count_many(Reject::Late, late);
            health.set_rejected(&rejected);
            processes.take(&health);
        };
        // The wall clock, and with it the session, has been set back between the lives.
        report(1, 6, 1, 10, 1);
        report(2, 6, 3, 30, 2);
        report(3, 5, 1, 20, 1);
        report(2, 6, 3, 30, 2); // overtaken
        let used = &processes.report()["tracker"];
        assert_eq!((used.restarts, used.rejected["late"]), (1, 3));
        assert!((used.cpu_s - 4.0).abs() < 1e-9);
        assert_eq!([used.rss_mib_start, used.rss_mib_end, used.rss_mib_max].map(|mib| mib as u64), [10, 20, 30]);
    }
}
