//! Sites whose tracks match no other site's: found, kept out of the system tracks, and brought back where one bias explains it (F7a).

use common::units::seconds_between;
use nalgebra::{SMatrix, Vector3};

use super::{Fusion, Local, SiteState, Waiting};
use crate::comparison::{chi_squared, gate};
use crate::gaussian::Vector;
use crate::gross_bias::{ANY, Pair, explain, votes_without};
use crate::registration::{BIASES, Bias};

/// Fewest tracks that a site is judged by.
const FEWEST: usize = 3;
/// Reports of a site in a cycle that are compared with the system tracks before any is absorbed.
const SAMPLE: usize = 24;
/// Local tracks of a site that a bias is looked for with.
const SOUGHT: usize = 60;
/// System tracks near each of them.
const NEAR: usize = 20;
/// Local and system tracks farther apart than this are no pair, m.
const REACH_M: f64 = 6000.0;
/// Probability that velocities of one target are within the gate.
const WITHIN: f64 = 0.999;
/// Of the tracks that match nobody, the share that a bias must explain.
const MOST: f64 = 0.6;
/// Standard deviations by which a bias must be beyond what registration expects.
const BEYOND: f64 = 5.0;
/// A site is not wrong as a whole if more of its tracks match than one for so many that do not.
const MATCHING: usize = 3;
/// Cycles after a site was brought back in which one decision attaches.
const EAGER: u64 = 12;
/// Reports in a row outside the gate that make a track one of those that match nobody.
const DOUBTS: u32 = 2;
/// Most cycles until a search is tried again that has found nothing; with fewer tracks, which are soon gone through, as many as there are.
const LONGEST_WAIT: u64 = 64;

/// What is known of how a site matches the others.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Alignment {
    /// Reports of the last turn that were compared with the system tracks that they are part of, and those that do not fit.
    compared: f64,
    misfits: f64,
    /// Whether most do not fit, unlike those of other sites.
    is_off: bool,
    /// Whether most of its tracks match nobody.
    pub(super) matches_nobody: bool,
    /// Whether its tracks begin no system tracks where other sites see: it alone matches nobody, and they miss it.
    is_held_back: bool,
    /// Cycle in which it was last brought back.
    brought_back: Option<u64>,
    /// Cycle before which no bias is looked for.
    search_from: u64,
    /// Cycles of the last wait for a search.
    wait: u64,
    /// Reports of this cycle, and those gone through.
    reports: usize,
    seen: usize,
}

impl Alignment {
    /// Whether its reports are kept out.
    pub(super) fn is_off(&self) -> bool {
        self.is_off
    }

    /// Whether it was brought back just now, so that its tracks only wait for being attached again.
    pub(super) fn is_eager(&self, cycle: u64) -> bool {
        self.brought_back.is_some_and(|then| cycle < then + EAGER)
    }

    fn is_judged(&self) -> bool {
        self.compared >= FEWEST as f64
    }

    fn misfits_mostly(&self) -> bool {
        self.is_judged() && 2.0 * self.misfits > self.compared
    }
}

impl Fusion {
    /// Whether most tracks of a site match no other site's.
    pub fn matches_nobody(&self, site: usize) -> bool {
        self.sites[site].alignment.matches_nobody
    }

    /// Notes the sites most of whose reports do not fit the system tracks that they are part of: those reports would spoil them. Where that
    /// is so with most sites, nobody knows who is right.
    pub(super) fn find_off(&mut self, waiting: &[Waiting], order: &[u32], now_ns: u64) {
        let step_s = self.now_ns.map_or(0.0, |before_ns| seconds_between(before_ns, now_ns));
        for SiteState { alignment, site, .. } in &mut self.sites {
            let keep = (-2.0 * step_s / site.period_s).exp();
            (alignment.compared, alignment.misfits) = (alignment.compared * keep, alignment.misfits * keep);
            (alignment.reports, alignment.seen) = (0, 0);
        }
        let reports = || order.iter().map(|&index| &waiting[index as usize]);
        for of in reports() {
            self.sites[of.site as usize].alignment.reports += 1;
        }
        for of in reports() {
            let alignment = &mut self.sites[of.site as usize].alignment;
            alignment.seen += 1;
            if alignment.seen.is_multiple_of(alignment.reports.div_ceil(SAMPLE))
                && let Some(fits) = self.fits(of)
            {
                let alignment = &mut self.sites[of.site as usize].alignment;
                alignment.compared += 1.0;
                alignment.misfits += f64::from(u8::from(!fits));
            }
        }
        let of_sites = || self.sites.iter().map(|of| of.alignment);
        let (judged, off) =
            (of_sites().filter(Alignment::is_judged).count(), of_sites().filter(Alignment::misfits_mostly).count());
        for SiteState { alignment, .. } in &mut self.sites {
            alignment.is_off = 2 * off <= judged && alignment.misfits_mostly();
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

    /// Of the sites whose tracks mostly match nobody where others see too, looks for a bias that explains it.
    pub(super) fn bring_back(&mut self, now_ns: u64) {
        let mut lonely = std::mem::take(&mut self.lonely);
        let mut is_filled = false;
        for site in 0..self.sites.len() {
            let (matches_nobody, shared) = self.find_lonely(site as u16, &mut lonely);
            let alignment = &mut self.sites[site].alignment;
            alignment.matches_nobody = matches_nobody;
            if !matches_nobody {
                (alignment.wait, alignment.search_from, alignment.is_held_back) = (0, 0, false);
                continue;
            }
            self.hold_back(site as u16, &lonely, shared, now_ns);
            let alignment = &mut self.sites[site].alignment;
            if self.cycles < alignment.search_from {
                continue;
            }
            alignment.wait = (2 * alignment.wait).clamp(1, LONGEST_WAIT.min(lonely.len() as u64));
            alignment.search_from = self.cycles + alignment.wait;
            if !is_filled {
                self.fill_grid(now_ns);
                is_filled = true;
            }
            if let Some(bias) = self.gross_bias(site as u16, &lonely, now_ns) {
                self.realign(site as u16, &bias);
                break; // the others are compared with what it is now
            }
        }
        self.lonely = lonely;
    }

    /// The tracks of a site that match nobody, though another site sees there and there was time to find each other; whether they are at
    /// least half of its tracks, and how many others match.
    fn find_lonely(&self, site: u16, lonely: &mut Vec<u32>) -> (bool, usize) {
        lonely.clear();
        let mut shared = 0;
        for &place in self.sites[site as usize].by_id.values() {
            let local = &self.locals[place as usize];
            if local.looks <= self.settings.attach_after + 1 {
                continue;
            }
            if self.is_alone(place) || local.doubts >= DOUBTS {
                if self.others_that_see(site, local).next().is_some() {
                    lonely.push(place);
                }
            } else {
                shared += 1;
            }
        }
        lonely.sort_unstable(); // in an order that does not depend on the hash
        (lonely.len() >= FEWEST && lonely.len() >= shared, shared)
    }

    /// Ends the system tracks that a site has made alone of `lonely` tracks, where it is the one that is wrong: hardly any of its tracks match,
    /// most sites match each other, and about as many system tracks of theirs that the site should see have no track of it. One that sees
    /// what others miss and shares the rest with them is right.
    fn hold_back(&mut self, site: u16, lonely: &[u32], shared: usize, now_ns: u64) {
        let with_tracks = self.sites.iter().filter(|of| !of.by_id.is_empty()).count();
        let wrong = self.sites.iter().filter(|of| of.alignment.matches_nobody).count();
        let missed = self.systems.iter().filter(|system| {
            let is_theirs = system.is_open() && system.contributors.len() > 1 && !system.contributes(site);
            is_theirs && self.sites[site as usize].sees(&self.system_at(system, now_ns).position())
        });
        let is_wrong = MATCHING * shared <= lonely.len()
            && 2 * wrong < with_tracks
            && missed.count() as f64 >= MOST * lonely.len() as f64;
        self.sites[site as usize].alignment.is_held_back = is_wrong;
        for &place in lonely.iter().filter(|_| is_wrong) {
            if let Some(system) = self.locals[place as usize].system.filter(|_| self.is_alone(place)) {
                self.detach(place);
                self.systems[system as usize].merged = true;
            }
        }
    }

    /// Whether a local track must not begin a system track: those of its site are wrong, and another site sees there.
    pub(super) fn is_held_back(&self, place: u32) -> bool {
        let local = &self.locals[place as usize];
        let is_held_back = self.sites[local.site as usize].alignment.is_held_back;
        is_held_back && self.others_that_see(local.site, local).next().is_some()
    }

    /// Other sites with tracks in whose reach a local track is.
    fn others_that_see<'a>(&'a self, site: u16, local: &'a Local) -> impl Iterator<Item = &'a SiteState> {
        let others = self.sites.iter().enumerate().filter(move |(other, _)| *other != site as usize);
        others.map(|(_, of)| of).filter(|of| !of.by_id.is_empty() && of.sees(&local.estimate.position()))
    }

    /// A bias beyond what registration expects that explains most of the `lonely` tracks of a site.
    fn gross_bias(&self, site: u16, lonely: &[u32], now_ns: u64) -> Option<Bias> {
        let mut pairs = Vec::new();
        let sought = lonely.iter().step_by(lonely.len().div_ceil(SOUGHT));
        let most = ((MOST * sought.len() as f64).ceil() as usize).max(FEWEST);
        for &place in sought {
            self.pairs_of(site, place, now_ns, &mut pairs);
        }
        let expected = self.registration.covariance(site.into(), site.into());
        if votes_without(&pairs, &expected) >= most {
            return None;
        }
        let found = explain(&pairs).filter(|found| found.votes >= most)?;
        let variance = |of: &SMatrix<f64, BIASES, BIASES>, i: usize| of[(i, i)].max(0.0);
        let sigma = |i: usize| (variance(&expected, i) + variance(&found.covariance, i)).sqrt();
        (0..BIASES).any(|i| found.bias[i].abs() > BEYOND * sigma(i)).then_some(found.bias)
    }

    /// Appends the pairs of a local track: nearest system tracks first, of like velocity, that are not the site's own. Where several other sites
    /// see, only what two of them agree on is believed.
    fn pairs_of(&self, site: u16, place: u32, now_ns: u64, pairs: &mut Vec<Pair>) {
        let local = &self.locals[place as usize];
        let own = self.at(&local.estimate, local.time_ns, now_ns);
        let (jacobian, first) = (self.jacobian(site, &own), pairs.len());
        let witnesses = self.others_that_see(site, local).take(2).count();
        let velocity_gate = gate(3, WITHIN);
        for index in self.grid.near([own.mean[0], own.mean[1]], REACH_M) {
            let system = &self.systems[index as usize];
            let others = system.contributors.iter().filter(|of| of.site != site).count();
            let is_own = system.contributes(site) && local.system != Some(index);
            if !system.is_open() || others < witnesses || is_own {
                continue;
            }
            let other = self.system_at(system, now_ns);
            let covariance = own.covariance + other.covariance;
            let difference_m = own.position() - other.position();
            // An azimuth that is wrong turns the velocity.
            let turned = Vector3::repeat((ANY[1] * own.velocity().norm()).powi(2));
            let of_velocity = covariance.fixed_view::<3, 3>(3, 3) + SMatrix::<f64, 3, 3>::from_diagonal(&turned);
            if difference_m.norm() <= REACH_M
                && chi_squared(&(own.velocity() - other.velocity()), of_velocity) <= velocity_gate
            {
                let spread = covariance.fixed_view::<3, 3>(0, 0).into_owned();
                pairs.push(Pair { local: place, difference_m, spread, jacobian });
            }
        }
        pairs[first..].sort_by(|a, b| a.difference_m.norm_squared().total_cmp(&b.difference_m.norm_squared()));
        pairs.truncate(first + NEAR);
    }

    /// Takes a bias for known, and moves by it the tracks of the site and the system tracks that it has made alone.
    fn realign(&mut self, site: u16, bias: &Bias) {
        self.registration.begin_anew(site.into(), bias);
        for place in 0..self.locals.len() {
            let local = &self.locals[place];
            if local.alive && local.site == site {
                let moved = self.jacobian(site, &local.estimate) * bias;
                let local = &mut self.locals[place];
                let mut position = local.estimate.mean.fixed_rows_mut::<3>(0);
                position -= moved;
                local.doubts = 0;
            }
        }
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            if system.alive && matches!(system.contributors[..], [only] if only.site == site) {
                let mut by = Vector::zeros();
                by.fixed_rows_mut::<3>(0).copy_from(&(-(self.jacobian(site, &system.state.moments()) * bias)));
                self.systems[index].state.shift(&by);
            }
        }
        let of = &mut self.sites[site as usize];
        of.counts.realigned += 1;
        of.alignment = Alignment { brought_back: Some(self.cycles), ..Alignment::default() };
    }
}
