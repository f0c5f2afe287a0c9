//! Resources of the processes, from their health.

use std::collections::BTreeMap;

use common::health::{Health, REJECT_NAMES, REJECTS, Wish};
use common::report::ProcessUse;
use common::units::{MIB, NS_PER_S};
use serde::{Deserialize, Serialize};

/// The fold of health reports, by process.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Processes {
    by_name: BTreeMap<String, Lives>,
}

/// All starts of one process. Counts of ended lives are kept apart from those of the present
/// one, whose reports repeat them.
#[derive(Debug, Serialize, Deserialize)]
struct Lives {
    now: Health,
    restarts: u64,
    cpu_ns_before: u64,
    rejected_before: [u64; REJECTS],
    silences_before: u64,
    slow_steps_before: u64,
    rss_first: u64,
    rss_max: u64,
}

impl Processes {
    pub(crate) fn take(&mut self, health: &Health) {
        let lives = self.by_name.entry(health.process().to_string()).or_insert_with(|| Lives {
            now: *health,
            restarts: 0,
            cpu_ns_before: 0,
            rejected_before: [0; REJECTS],
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
            add(&mut lives.rejected_before, &lives.now.rejected);
            lives.silences_before += u64::from(lives.now.silences);
            lives.slow_steps_before += u64::from(lives.now.slow_steps);
        }
        lives.now = *health;
        lives.rss_max = lives.rss_max.max(health.rss_bytes);
    }

    /// Whether all of these processes have said that they ended in order.
    pub(crate) fn have_ended(&self, names: &[&str]) -> bool {
        names.iter().all(|&name| self.by_name.get(name).is_some_and(|lives| lives.now.ended == 1))
    }

    /// Whether any process began anew.
    pub(crate) fn restarted(&self) -> bool {
        self.by_name.values().any(|lives| lives.restarts > 0)
    }

    pub(crate) fn report(&self) -> BTreeMap<String, ProcessUse> {
        let mib = |bytes: u64| bytes as f64 / MIB;
        let used = |lives: &Lives| {
            let mut rejected = lives.rejected_before;
            add(&mut rejected, &lives.now.rejected);
            let named = REJECT_NAMES.iter().zip(rejected).filter(|&(_, count)| count > 0);
            ProcessUse {
                pid: lives.now.pid,
                cpu_s: (lives.cpu_ns_before + lives.now.cpu_ns) as f64 / NS_PER_S,
                rss_mib_start: mib(lives.rss_first),
                rss_mib_end: mib(lives.now.rss_bytes),
                rss_mib_max: mib(lives.rss_max),
                restarts: lives.restarts,
                rejected: named.map(|(name, count)| ((*name).to_string(), count)).collect(),
                files: lives.now.files,
                silences: lives.silences_before + u64::from(lives.now.silences),
                slow_steps: lives.slow_steps_before + u64::from(lives.now.slow_steps),
                refused: Wish::names(lives.now.refused).into_iter().map(String::from).collect(),
            }
        };
        self.by_name.iter().map(|(name, lives)| (name.clone(), used(lives))).collect()
    }
}

fn add(sums: &mut [u64; REJECTS], more: &[u64; REJECTS]) {
    for (sum, count) in sums.iter_mut().zip(more) {
        *sum += count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_all_lives_add_up() {
        let mut processes = Processes::default();
        let mut report = |heartbeat_ns, session, cpu_s: u64, rss_mib: u64, late| {
            let (cpu_ns, rss_bytes) = (cpu_s * 1_000_000_000, rss_mib << 20);
            let mut health = Health { heartbeat_ns, session, cpu_ns, rss_bytes, ..Health::default() };
            health.set_process("tracker");
            health.rejected[4] = late;
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
