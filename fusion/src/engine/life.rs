//! How local and system tracks begin and end, and who is part of what.

use common::units::seconds_between;

use super::{Fusion, Local};
use crate::gaussian::{Gaussian, Matrix, Vector};
use crate::motion::Moving;
use crate::system::{Contributor, System};

impl Fusion {
    /// The place of a site's track, which begins if there is none of this number.
    pub(super) fn local_of(&mut self, site: u16, id: u64) -> u32 {
        if let Some(&place) = self.sites[site as usize].by_id.get(&id) {
            return place;
        }
        let local = Local {
            site,
            id,
            time_ns: 0,
            estimate: Gaussian { mean: Vector::zeros(), covariance: Matrix::identity() },
            system: None,
            looks: 0,
            heard: 0,
            choice: None,
            doubts: 0,
            misfit: 0.0,
            alive: true,
        };
        let place = if let Some(place) = self.free_locals.pop() {
            self.locals[place as usize] = local;
            place
        } else {
            self.locals.push(local);
            self.locals.len() as u32 - 1
        };
        self.sites[site as usize].by_id.insert(id, place);
        place
    }

    pub(super) fn end_local(&mut self, place: u32) {
        self.detach(place);
        let local = &mut self.locals[place as usize];
        local.alive = false;
        self.sites[local.site as usize].by_id.remove(&local.id);
        self.free_locals.push(place);
    }

    /// Ends all tracks of a site, those too whose reports still wait: its tracker has begun anew, with other tracks.
    pub fn forget(&mut self, site: usize) {
        self.waiting.retain(|of| usize::from(of.site) != site);
        (self.sites[site].told_ns, self.sites[site].known_ns) = (0, 0);
        let mut places: Vec<u32> = self.sites[site].by_id.values().copied().collect();
        places.sort_unstable(); // so that places are free in an order that does not depend on the hash
        for place in places {
            self.end_local(place);
        }
    }

    /// Ends the local tracks of which nothing has been heard for long by the clock of their site, which may be wrong.
    pub(super) fn end_silent(&mut self, now_ns: u64) {
        for place in 0..self.locals.len() {
            let local = &self.locals[place];
            let of = &self.sites[local.site as usize];
            if local.alive && of.age_s(local.time_ns, now_ns) > self.settings.silent_periods * of.site.period_s {
                self.end_local(place as u32);
            }
        }
    }

    pub(super) fn attach_to(&mut self, place: u32, system: u32) {
        let local = &mut self.locals[place as usize];
        local.system = Some(system);
        (local.choice, local.doubts) = (None, 0);
        let system = &mut self.systems[system as usize];
        system.contributors.push(Contributor { site: local.site, local: place, id: local.id });
        system.alone_since_ns = None;
    }

    pub(super) fn detach(&mut self, place: u32) {
        let local = &mut self.locals[place as usize];
        (local.choice, local.doubts) = (None, 0);
        if let Some(system) = local.system.take() {
            let system = &mut self.systems[system as usize];
            system.contributors.retain(|of| of.local != place);
            if system.contributors.is_empty() {
                system.alone_since_ns = Some(local.time_ns);
            }
        }
    }

    /// A system track of one local track.
    pub(super) fn start(&mut self, place: u32) {
        let local = &self.locals[place as usize];
        let system = System {
            id: self.next_id,
            time_ns: local.time_ns,
            state: Moving::new(local.estimate, &self.motion),
            contributors: Vec::new(),
            alone_since_ns: None,
            coasting: 0,
            twin: None,
            merged: false,
            ended: false,
            alive: true,
        };
        self.next_id += 1;
        let index = if let Some(index) = self.free_systems.pop() {
            let contributors = std::mem::take(&mut self.systems[index as usize].contributors);
            self.systems[index as usize] = System { contributors, ..system };
            index
        } else {
            self.systems.push(system);
            self.systems.len() as u32 - 1
        };
        self.attach_to(place, index);
    }

    /// Ends the system tracks that nobody contributes to any more: at once those that have become part of another, the others after
    /// the time that they may coast.
    pub(super) fn end_forgotten(&mut self, now_ns: u64) {
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            let (coasting, ended) = match system.alone_since_ns.filter(|_| system.alive) {
                None => (0, false),
                Some(since_ns) => {
                    let here = self.system_at(system, now_ns).position();
                    let seen = self.sites.iter().any(|of| {
                        let is_heard = of.silent_s(now_ns) <= self.settings.silent_periods * of.site.period_s;
                        is_heard && of.sees(&here)
                    });
                    let patience_s = if seen { self.settings.coast_s } else { self.settings.hidden_s };
                    (system.coasting + 1, system.merged || seconds_between(since_ns, now_ns) > patience_s)
                }
            };
            let system = &mut self.systems[index];
            (system.coasting, system.ended) = (coasting, ended);
        }
    }

    /// Makes room of what the last cycle has ended, and told so.
    pub(super) fn free_ended(&mut self) {
        for (index, system) in self.systems.iter_mut().enumerate().filter(|(_, system)| system.alive && system.ended) {
            debug_assert!(system.contributors.is_empty(), "nobody contributes to a system track that has ended");
            system.alive = false;
            self.free_systems.push(index as u32);
        }
    }
}
