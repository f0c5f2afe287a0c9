//! Which local track is part of which system track (F5).

use super::Fusion;
use super::decision::Decision;
use crate::association::{Candidate, assign};
use crate::system::CONTRIBUTORS;

impl Fusion {
    /// Decides on the local tracks that are part of no system track, and on those that nobody else has joined: they may belong to an
    /// older one.
    pub(super) fn attach(&mut self, now_ns: u64) {
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        let places = 0..self.locals.len() as u32;
        let to_decide = places.filter(|&place| {
            let local = &self.locals[place as usize];
            local.alive && local.looks > 0 && self.is_alone(place)
        });
        open.extend(to_decide.map(|place| {
            let local = &self.locals[place as usize];
            (local.site, local.id, place)
        }));
        open.sort_unstable();
        self.fill_grid(now_ns);
        for rows in open.chunk_by(|a, b| a.0 == b.0) {
            let before = self.next_id;
            self.decide(rows, now_ns);
            if self.next_id != before {
                self.fill_grid(now_ns);
            }
        }
        self.open = open;
    }

    /// Whether a local track is part of no system track, or the only part of one.
    pub(super) fn is_alone(&self, place: u32) -> bool {
        let own = self.locals[place as usize].system;
        own.is_none_or(|own| self.systems[own as usize].contributors.len() == 1)
    }

    /// Decisions for the local tracks `rows` of one site.
    fn decide(&mut self, rows: &[(u16, u64, u32)], now_ns: u64) {
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        for (row, &(_, _, place)) in rows.iter().enumerate() {
            self.candidates_of(place, row as u32, now_ns, &mut candidates);
        }
        let assigned = assign(rows.len(), &candidates, self.gate);
        for (row, (&(_, _, place), column)) in rows.iter().zip(assigned).enumerate() {
            // Another site's track may have joined it in this cycle.
            if !self.is_alone(place) {
                continue;
            }
            let contested = candidates.iter().any(|of| of.row == row as u32);
            let local = &mut self.locals[place as usize];
            if let Some(column) = column {
                let system = self.systems[column as usize].id;
                let choice = Decision::again(local.choice, Some(system), self.cycles, 1, local.time_ns);
                local.choice = Some(choice);
                let eager = self.sites[self.locals[place as usize].site as usize].alignment.is_eager(self.cycles);
                if choice.count >= self.settings.attach_after || eager {
                    self.move_to(place, column);
                }
            } else if local.system.is_none() {
                let choice = Decision::again(local.choice, None, self.cycles, 1, local.time_ns);
                local.choice = Some(choice);
                let is_sure = !contested || choice.count >= self.settings.attach_after;
                if is_sure && !self.is_held_back(place) {
                    self.start(place);
                }
            }
        }
        self.candidates = candidates;
    }

    /// The system tracks within the gate of a local track that it may become part of.
    fn candidates_of(&self, place: u32, row: u32, now_ns: u64, candidates: &mut Vec<Candidate>) {
        let local = &self.locals[place as usize];
        let own = self.at(&local.estimate, local.time_ns, now_ns);
        let reach_m = self.reach_m(local.site, &own);
        for column in self.grid.near([own.mean[0], own.mean[1]], reach_m) {
            let system = &self.systems[column as usize];
            let is_older = local.system.is_none_or(|own| system.id < self.systems[own as usize].id);
            let has_room = !system.contributes(local.site) && system.contributors.len() < CONTRIBUTORS;
            if !(is_older && has_room && system.is_open()) {
                continue;
            }
            let cost = self.misfit(local.site, &own, system, &self.system_at(system, now_ns));
            if cost <= self.gate {
                candidates.push(Candidate { row, column, cost });
            }
        }
    }

    /// Makes a local track part of another system track; the one that it was alone in ends.
    fn move_to(&mut self, place: u32, system: u32) {
        let before = self.locals[place as usize].system;
        self.detach(place);
        if let Some(before) = before {
            self.systems[before as usize].merged = true;
        }
        self.attach_to(place, system);
    }

    /// Of the contributors of a system track that no longer fit, the one that fits least goes.
    pub(super) fn release_misfits(&mut self) {
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            if !system.alive || system.contributors.len() < 2 {
                continue;
            }
            let places = system.contributors.iter().map(|of| of.local);
            let doubtful = places.filter(|&place| self.locals[place as usize].doubts >= self.settings.release_after);
            let misfit = |place: u32| self.locals[place as usize].misfit;
            if let Some(worst) = doubtful.max_by(|&a, &b| misfit(a).total_cmp(&misfit(b))) {
                self.detach(worst);
                let site = self.locals[worst as usize].site;
                self.sites[site as usize].counts.released += 1;
            }
        }
    }
}
