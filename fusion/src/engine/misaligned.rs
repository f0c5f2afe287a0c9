//! Sites whose tracks fit nobody else's: found, kept from the system tracks, and brought back where one bias explains them.

use nalgebra::SMatrix;

use super::{Fusion, Waiting};
use crate::comparison::{chi_squared, gate};
use crate::gross_bias::{Pair, explain, votes_without};
use crate::registration::Bias;

/// Tracks of a site that say nothing about it.
const FEWEST: usize = 4;
/// Reports of a site in a cycle that are compared with the system tracks before any is absorbed.
const SAMPLE: usize = 24;
/// Local tracks of a site that a bias is looked for with.
const SOUGHT: usize = 60;
/// Local and system tracks farther apart than this are no pair, m.
const REACH_M: f64 = 6000.0;
/// Probability that velocities of one target are within the gate.
const WITHIN: f64 = 0.999;
/// Of the tracks that fit nobody, the share that a bias must explain.
const MOST: f64 = 0.6;
/// Standard deviations by which a bias must be beyond what registration expects.
const BEYOND: f64 = 5.0;
/// Cycles after a site was brought back in which one decision attaches.
const EAGER: u64 = 12;
/// Reports in a row outside the gate that make a track one of those that fit nobody.
const DOUBTS: u32 = 2;
/// Most cycles until a search is tried again that has found nothing.
const LONGEST_WAIT: u64 = 64;

/// What is known of how a site fits the others.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Alignment {
    /// Whether its reports of this cycle do not fit the system tracks that they are part of.
    pub(super) is_off: bool,
    /// Cycle in which it was last brought back.
    brought_back: Option<u64>,
    /// Cycle before which nothing is looked for, and how long the next wait is.
    search_from: u64,
    wait: u64,
}

impl Alignment {
    /// Whether it was brought back just now, so that its tracks only wait for being attached again.
    pub(super) fn is_eager(&self, cycle: u64) -> bool {
        self.brought_back.is_some_and(|then| cycle < then + EAGER)
    }
}

impl Fusion {
    /// Notes the sites most of whose reports do not fit the system tracks that they are part of: those reports would spoil them. Where that
    /// is so with most sites, nobody knows who is right.
    pub(super) fn find_off(&mut self, waiting: &[Waiting], order: &[u32]) {
        let mut sampled = [0_usize; 2];
        for site in 0..self.sites.len() {
            let of_site = || order.iter().map(|&index| &waiting[index as usize]).filter(|of| of.site as usize == site);
            let every = of_site().count().div_ceil(SAMPLE).max(1);
            let fits = || of_site().step_by(every).filter_map(|of| self.fits(of));
            let (compared, off) = (fits().count(), fits().filter(|fits| !fits).count());
            let is_off = compared >= FEWEST && 2 * off > compared;
            self.sites[site].alignment.is_off = is_off;
            sampled[usize::from(is_off)] += usize::from(compared >= FEWEST);
        }
        if sampled[1] > sampled[0] {
            self.sites.iter_mut().for_each(|of| of.alignment.is_off = false);
        }
    }

    /// Whether a report fits the system track that its local track is part of with others.
    fn fits(&self, of: &Waiting) -> Option<bool> {
        let (site, report) = (&self.sites[of.site as usize], &of.report);
        let local = &self.locals[*site.by_id.get(&report.id)? as usize];
        let system = &self.systems[local.system? as usize];
        if system.contributors.len() < 2 || report.time_ns <= local.time_ns {
            return None;
        }
        let own = site.frame.to_centre(&report.posterior, &self.registration.bias(of.site.into()));
        let here = self.system_at(system, report.time_ns);
        let misfit = chi_squared(&(own.mean - here.mean), own.covariance + here.covariance);
        Some(misfit <= self.gate || self.misfit(of.site, &own, system, &here) <= self.gate)
    }

    /// Of the sites whose tracks mostly fit nobody where others see too, looks for a bias that explains it.
    pub(super) fn bring_back(&mut self, now_ns: u64) {
        let mut lonely = std::mem::take(&mut self.lonely);
        let mut is_filled = false;
        for site in 0..self.sites.len() {
            if self.cycles < self.sites[site].alignment.search_from || !self.find_lonely(site as u16, &mut lonely) {
                continue;
            }
            if !is_filled {
                self.fill_grid(now_ns);
                is_filled = true;
            }
            let alignment = &mut self.sites[site].alignment;
            alignment.wait = (2 * alignment.wait).clamp(1, LONGEST_WAIT);
            alignment.search_from = self.cycles + alignment.wait;
            if let Some(bias) = self.gross_bias(site as u16, &lonely, now_ns) {
                self.realign(site, &bias);
                break; // the others are compared with what it is now
            }
        }
        self.lonely = lonely;
    }

    /// The confirmed tracks of a site that fit nobody, though another site sees there; whether they are most of its tracks.
    fn find_lonely(&self, site: u16, lonely: &mut Vec<u32>) -> bool {
        lonely.clear();
        let mut shared = 0;
        for &place in self.sites[site as usize].by_id.values() {
            let local = &self.locals[place as usize];
            let others = || self.sites.iter().enumerate().filter(|(other, _)| *other != site as usize);
            let sees = |at_m| others().any(|(_, of)| !of.by_id.is_empty() && of.sees(at_m));
            if !local.confirmed {
                continue;
            }
            if self.is_alone(place) || local.doubts >= DOUBTS {
                if sees(&local.estimate.position()) {
                    lonely.push(place);
                }
            } else {
                shared += 1;
            }
        }
        lonely.sort_unstable(); // in an order that does not depend on the hash
        lonely.len() >= FEWEST && lonely.len() > shared
    }

    /// A bias beyond what registration expects that explains most of the `lonely` tracks of a site.
    fn gross_bias(&self, site: u16, lonely: &[u32], now_ns: u64) -> Option<Bias> {
        let velocity_gate = gate(3, WITHIN);
        let mut pairs = Vec::new();
        let every = lonely.len().div_ceil(SOUGHT);
        let sought = lonely.iter().step_by(every);
        let count = sought.len();
        for &place in sought {
            let local = &self.locals[place as usize];
            let own = self.at(&local.estimate, local.time_ns, now_ns);
            let jacobian = self.jacobian(site, &own);
            for index in self.grid.near([own.mean[0], own.mean[1]], REACH_M) {
                let system = &self.systems[index as usize];
                let of_others = system.contributors.iter().any(|of| of.site != site);
                if !system.is_open() || !of_others || system.contributes(site) && local.system != Some(index) {
                    continue;
                }
                let other = self.system_at(system, now_ns);
                let covariance = own.covariance + other.covariance;
                let of_velocity = covariance.fixed_view::<3, 3>(3, 3).into_owned();
                let difference_m = own.position() - other.position();
                if difference_m.norm() <= REACH_M
                    && chi_squared(&(own.velocity() - other.velocity()), of_velocity) <= velocity_gate
                {
                    let spread = covariance.fixed_view::<3, 3>(0, 0).into_owned();
                    pairs.push(Pair { local: place, difference_m, spread, jacobian });
                }
            }
        }
        let expected = self.registration.covariance(site.into(), site.into());
        let most = ((MOST * count as f64).ceil() as usize).max(FEWEST);
        if votes_without(&pairs, &expected) >= most {
            return None;
        }
        let found = explain(&pairs).filter(|found| found.votes >= most)?;
        let sigma = |of: &SMatrix<f64, 4, 4>, i: usize| of[(i, i)].max(0.0);
        let is_gross =
            |i: usize| found.bias[i].abs() > BEYOND * (sigma(&expected, i) + sigma(&found.covariance, i)).sqrt();
        (0..4).any(is_gross).then_some(found.bias)
    }

    /// Takes a bias for known, and moves the tracks of the site by it.
    fn realign(&mut self, site: usize, bias: &Bias) {
        self.registration.begin_anew(site, bias);
        for place in 0..self.locals.len() {
            let local = &self.locals[place];
            if local.alive && local.site as usize == site {
                let moved = self.jacobian(local.site, &local.estimate) * bias;
                let local = &mut self.locals[place];
                let mut position = local.estimate.mean.fixed_rows_mut::<3>(0);
                position -= moved;
                local.doubts = 0;
            }
        }
        let cycles = self.cycles;
        let of = &mut self.sites[site];
        of.counts.realigned += 1;
        of.alignment.brought_back = Some(cycles);
        of.alignment.wait = 0;
    }
}
