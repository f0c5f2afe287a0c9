//! Biases of the radars, as the fusion learns and uses them (F7).

use nalgebra::{Matrix3, Vector3};

use super::{Fusion, SiteState};
use crate::comparison::chi_squared;
use crate::gaussian::{Gaussian, Vector};
use crate::registration::{Bias, BiasJacobian, Observation};
use crate::system::System;

/// System tracks that registration learns from in a cycle.
const REGISTERED: usize = 250;
/// Radars whose biases can be solved for in every cycle; of more, every other, third… cycle.
const SITES_A_CYCLE: usize = 8;
/// Share of the standard deviation of a bias below which a change of it moves no track: the next reports bring it by themselves.
const NOTABLE: f64 = 0.01;
/// Farther than this no candidate is looked for, m.
const FARTHEST_M: f64 = 50_000.0;

impl Fusion {
    /// Learns biases from targets that several sites see, a part of them in each cycle.
    pub(super) fn register(&mut self, now_ns: u64, step_s: f64) {
        if self.sites.iter().all(|of| of.site.bias == Bias::zeros()) {
            return;
        }
        self.registration.forget(1.0 - (-step_s / self.settings.registration_memory_s).exp());
        let mut observations = std::mem::take(&mut self.observations);
        let parts = self.systems.len().div_ceil(REGISTERED).max(1);
        let share = (self.settings.registration_share * parts as f64).min(1.0);
        for index in (self.cycles as usize % parts..self.systems.len()).step_by(parts) {
            let system = &self.systems[index];
            if !system.alive || system.contributors.len() < 2 {
                continue;
            }
            observations.clear();
            for of in &system.contributors {
                let local = &self.locals[of.local as usize];
                if self.sites[of.site as usize].alignment.is_off() {
                    continue;
                }
                let here = self.at(&local.estimate, local.time_ns, now_ns);
                let jacobian = self.jacobian(of.site, &here);
                if let Some(weight) = here.position_covariance().try_inverse() {
                    let estimated =
                        self.registration.bias(of.site.into()) - self.registration.known_bias(of.site.into());
                    let position_m = here.position() + jacobian * estimated;
                    observations.push(Observation { site: of.site.into(), position_m, weight, jacobian });
                }
            }
            self.registration.observe(&observations, share);
        }
        self.observations = observations;
        if self.cycles.is_multiple_of(self.sites.len().div_ceil(SITES_A_CYCLE) as u64) {
            self.solve();
        }
    }

    fn solve(&mut self) {
        let before: Vec<Bias> = (0..self.sites.len()).map(|site| self.registration.bias(site)).collect();
        self.registration.solve();
        let change: Vec<Bias> =
            before.iter().enumerate().map(|(site, before)| self.registration.bias(site) - before).collect();
        let is_notable = |(change, of): (&Bias, &SiteState)| {
            change.iter().zip(of.site.bias.iter()).any(|(change, sigma)| change.abs() > NOTABLE * sigma)
        };
        if change.iter().zip(&self.sites).any(is_notable) {
            self.shift(&change);
        }
    }

    /// Moves all tracks by what has been learned of biases.
    fn shift(&mut self, change: &[Bias]) {
        for place in 0..self.locals.len() {
            let local = &self.locals[place];
            if local.alive {
                let moved = self.jacobian(local.site, &local.estimate) * change[local.site as usize];
                let mut position = self.locals[place].estimate.mean.fixed_rows_mut::<3>(0);
                position -= moved;
            }
        }
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            if system.alive && !system.contributors.is_empty() {
                let here = system.state.moments();
                let moved = |of: &crate::system::Contributor| self.jacobian(of.site, &here) * change[of.site as usize];
                let sum: Vector3<f64> = system.contributors.iter().map(moved).sum();
                let mut by = Vector::zeros();
                by.fixed_rows_mut::<3>(0).copy_from(&(-sum / system.contributors.len() as f64));
                self.systems[index].state.shift(&by);
            }
        }
    }

    pub(super) fn jacobian(&self, site: u16, estimate: &Gaussian) -> BiasJacobian {
        self.sites[site as usize].frame.jacobian(&estimate.position(), &estimate.velocity())
    }

    /// What is not known of the bias of a site, as a covariance of positions, m².
    pub(super) fn bias_spread(&self, site: u16, jacobian: &BiasJacobian) -> Matrix3<f64> {
        jacobian * self.registration.covariance(site.into(), site.into()) * jacobian.transpose()
    }

    /// χ² of an estimate of a site and that of a system track at the same time (F5). What is not known of the bias of the site counts
    /// against that of the first contributor.
    pub(super) fn misfit(&self, site: u16, own: &Gaussian, system: &System, other: &Gaussian) -> f64 {
        let jacobian = self.jacobian(site, own);
        let mut bias = self.bias_spread(site, &jacobian);
        if let Some(first) = system.contributors.first() {
            let theirs = self.jacobian(first.site, other);
            let common = jacobian * self.registration.covariance(site.into(), first.site.into()) * theirs.transpose();
            bias += self.bias_spread(first.site, &theirs) - common - common.transpose();
        }
        let mut spread = own.covariance + other.covariance;
        let mut corner = spread.fixed_view_mut::<3, 3>(0, 0);
        corner += bias;
        chi_squared(&(own.mean - other.mean), spread)
    }

    /// On the ground, how far system tracks within the gate of an estimate can be, m.
    pub(super) fn reach_m(&self, site: u16, own: &Gaussian) -> f64 {
        let bias = self.bias_spread(site, &self.jacobian(site, own));
        let variance = own.ground_variance() + bias[(0, 0)] + bias[(1, 1)];
        (2.0 * (self.gate * variance).sqrt()).min(FARTHEST_M)
    }
}
