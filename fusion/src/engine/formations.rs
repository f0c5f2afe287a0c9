//! Members of formations that were confused while little was known of them.

use super::Fusion;
use super::decision::Decision;
use crate::association::{Candidate, assign};
use crate::comparison::chi_squared;

impl Fusion {
    /// Assigns the local tracks of each site anew where several system tracks are within the gate of one that is part of one of them.
    pub(super) fn reconsider(&mut self, now_ns: u64) {
        self.fill_grid(now_ns);
        let all = 0..self.systems.len() as u32;
        let crowded: Vec<u32> = all.filter(|&index| self.is_crowded(index, now_ns)).collect();
        let (mut open, mut candidates) = (std::mem::take(&mut self.open), std::mem::take(&mut self.candidates));
        for site in 0..self.sites.len() as u16 {
            open.clear();
            candidates.clear();
            for &index in &crowded {
                let contributors = &self.systems[index as usize].contributors;
                let Some(of) = contributors.iter().find(|of| of.site == site) else { continue };
                let before = candidates.len();
                self.alternatives(of.local, index, open.len() as u32, now_ns, &mut candidates);
                if candidates.len() > before {
                    open.push((site, of.id, of.local));
                }
            }
            if !candidates.is_empty() {
                let assigned = assign(open.len(), &candidates, f64::MAX);
                self.exchange(&open, &assigned);
            }
        }
        (self.open, self.candidates) = (open, candidates);
    }

    /// Whether a local track of a system track of several could be another one's.
    fn is_crowded(&self, index: u32, now_ns: u64) -> bool {
        let system = &self.systems[index as usize];
        if !system.alive || system.contributors.len() < 2 {
            return false;
        }
        let here = self.system_at(system, now_ns);
        // One knows about as much as all over their number.
        let alone = system.contributors.len() as f64 * here.ground_variance();
        self.grid.near([here.mean[0], here.mean[1]], 2.0 * (self.gate * alone).sqrt()).count() > 1
    }

    /// Candidates of a local track that is part of `own`: that one and others within the gate; none if there are no others. By position
    /// alone, since members of a formation have one velocity; what is not known of biases is common to them.
    fn alternatives(&self, place: u32, own: u32, row: u32, now_ns: u64, candidates: &mut Vec<Candidate>) {
        let local = &self.locals[place as usize];
        let here = self.at(&local.estimate, local.time_ns, now_ns);
        let reach_m = 2.0 * (self.gate * here.ground_variance()).sqrt();
        let first = candidates.len();
        for column in self.grid.near([here.mean[0], here.mean[1]], reach_m) {
            let there = self.system_at(&self.systems[column as usize], now_ns);
            let apart = here.position() - there.position();
            // The same spread for all: that of the own one is less, which is a reason to stay.
            let cost = chi_squared(&apart, here.position_covariance() + there.position_covariance());
            if column == own || cost <= self.gate {
                candidates.push(Candidate { row, column, cost });
            }
        }
        if candidates.len() < first + 2 {
            candidates.truncate(first);
        }
    }

    /// Moves local tracks of one site to the system tracks that they have been assigned to several times in a row, where those are free
    /// or become so.
    fn exchange(&mut self, open: &[(u16, u64, u32)], assigned: &[Option<u32>]) {
        let mut moves: Vec<(u32, u32)> = Vec::new();
        for (&(_, _, place), column) in open.iter().zip(assigned) {
            let local = &mut self.locals[place as usize];
            let better = column.filter(|&column| local.system != Some(column));
            local.choice = better.map(|column| {
                let system = self.systems[column as usize].id;
                Decision::again(local.choice, Some(system), self.cycles, 1, local.time_ns)
            });
            let sure = local.choice.is_some_and(|choice| choice.count >= self.settings.exchange_after);
            moves.extend(better.filter(|_| sure).map(|column| (place, column)));
        }
        loop {
            let count = moves.len();
            let leaving: Vec<u32> = moves.iter().map(|of| of.0).collect();
            moves.retain(|&(place, column)| {
                let site = self.locals[place as usize].site;
                let holder = self.systems[column as usize].contributors.iter().find(|of| of.site == site);
                holder.is_none_or(|of| leaving.contains(&of.local))
            });
            if moves.len() == count {
                break;
            }
        }
        for &(place, _) in &moves {
            self.detach(place);
        }
        for (place, column) in moves {
            self.attach_to(place, column);
        }
    }
}
