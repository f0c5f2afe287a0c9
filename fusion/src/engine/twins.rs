//! System tracks of several sites each that are one target.

use super::Fusion;
use super::decision::Decision;

/// Of all system tracks, those that are looked at in a cycle: every n-th.
const EVERY: u64 = 4;

impl Fusion {
    /// System tracks that are each other's nearest several times in a row become one: the older number stays.
    pub(super) fn merge_twins(&mut self, now_ns: u64) {
        for index in ((self.cycles % EVERY) as usize..self.systems.len()).step_by(EVERY as usize) {
            let twin = self.nearest_twin(index as u32, now_ns);
            let other = twin.map(|twin| &self.systems[twin as usize]);
            let system = &self.systems[index];
            let decision = other.map(|other| {
                let data_ns = system.time_ns.max(other.time_ns);
                Decision::again(system.twin, Some(other.id), self.cycles, EVERY, data_ns)
            });
            let system = &mut self.systems[index];
            system.twin = decision;
            let sure = system.twin.is_some_and(|of| of.count >= self.settings.attach_after);
            let own = system.id;
            if let Some(twin) = twin.filter(|_| sure) {
                let other = &self.systems[twin as usize];
                if own < other.id && other.twin.is_some_and(|of| of.system == Some(own)) {
                    self.merge(index as u32, twin);
                }
            }
        }
    }

    fn nearest_twin(&self, index: u32, now_ns: u64) -> Option<u32> {
        let system = &self.systems[index as usize];
        let first = system.contributors.first().filter(|_| system.is_open())?;
        let own = self.system_at(system, now_ns);
        let misfit = |other: u32| {
            let twin = &self.systems[other as usize];
            let in_common = twin.contributors.iter().any(|of| system.contributes(of.site));
            // The grid was filled before some of them ended.
            let is_possible = other != index && twin.is_open() && !in_common;
            is_possible.then(|| self.misfit(first.site, &own, twin, &self.system_at(twin, now_ns)))
        };
        let near = self.grid.near([own.mean[0], own.mean[1]], self.reach_m(first.site, &own));
        let candidates = near.filter_map(|other| Some((other, misfit(other).filter(|&misfit| misfit <= self.gate)?)));
        candidates.min_by(|a, b| a.1.total_cmp(&b.1)).map(|of| of.0)
    }

    fn merge(&mut self, into: u32, from: u32) {
        let places: Vec<u32> = self.systems[from as usize].contributors.iter().map(|of| of.local).collect();
        for place in places {
            self.detach(place);
            self.attach_to(place, into);
        }
        self.systems[from as usize].merged = true;
    }
}
