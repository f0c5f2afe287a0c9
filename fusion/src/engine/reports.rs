//! Reports of sites: refused, waiting, absorbed.

use common::units::seconds_between;

use super::Fusion;
use crate::comparison::chi_squared;
use crate::local::Report;
use crate::measurement::Measurement;

/// A report that waits for the cycle that it belongs to.
#[derive(Debug)]
pub(super) struct Waiting {
    made_ns: u64,
    pub(super) site: u16,
    pub(super) report: Report,
}

impl Fusion {
    /// Notes that a site has told all that it sees up to `time_ns`, measurement time, be it nothing.
    pub fn hear(&mut self, site: usize, time_ns: u64) {
        // A time that is far from this one is a clock that is wrong.
        if self.now_ns.is_none_or(|now_ns| seconds_between(now_ns, time_ns).abs() <= self.settings.patience_s) {
            let of = &mut self.sites[site];
            of.told_ns = of.told_ns.max(time_ns);
        }
    }

    /// Counts reports of a site that are not taken, since its clock is wrong.
    pub fn refuse(&mut self, site: usize, reports: usize) {
        self.sites[site].counts.untimely += reports as u64;
    }

    /// Takes a report that a site has made at `made_ns`, measurement time: it is worked in the first cycle that ends then or later.
    pub fn take(&mut self, site: usize, report: &Report, made_ns: u64) {
        // A clock that is wrong would have reports wait for ever, and a system track predicted to a time that is not yet.
        let patience_s = self.settings.patience_s;
        let within = |from_ns: u64, to_ns: u64| seconds_between(from_ns, to_ns).abs() <= patience_s;
        let is_timely = self.now_ns.is_none_or(|now_ns| within(now_ns, made_ns))
            && seconds_between(made_ns, report.time_ns) <= self.sites[site].site.period_s
            && within(made_ns, report.time_ns);
        if !report.posterior.is_sound() {
            self.sites[site].counts.unsound += 1;
        } else if is_timely {
            self.hear(site, made_ns);
            self.waiting.push(Waiting { made_ns, site: site as u16, report: *report });
        } else {
            self.sites[site].counts.untimely += 1;
        }
    }

    /// Works the reports that have been made by `now_ns`.
    pub(super) fn absorb_reports(&mut self, now_ns: u64) {
        let (mut waiting, mut order) = (std::mem::take(&mut self.waiting), std::mem::take(&mut self.order));
        order.clear();
        order.extend((0..waiting.len() as u32).filter(|&index| waiting[index as usize].made_ns <= now_ns));
        order.sort_unstable_by_key(|&index| {
            let of = &waiting[index as usize];
            (of.report.time_ns, of.site, of.report.id)
        });
        self.find_off(&waiting, &order, now_ns);
        for &index in &order {
            let of = &waiting[index as usize];
            self.absorb(of.site, &of.report);
        }
        waiting.retain(|of| of.made_ns > now_ns);
        (self.waiting, self.order) = (waiting, order);
    }

    fn absorb(&mut self, site: u16, report: &Report) {
        let place = self.local_of(site, report.id);
        let of_site = &mut self.sites[site as usize];
        let local = &mut self.locals[place as usize];
        if report.time_ns <= local.time_ns {
            of_site.counts.repeated += 1;
            return;
        }
        let bias = self.registration.bias(site.into());
        let frame = of_site.frame;
        let posterior = frame.to_centre(&report.posterior, &bias);
        (local.time_ns, local.estimate) = (report.time_ns, posterior);
        let is_new = local.looks == 0 || local.heard != self.cycles;
        local.looks = if report.confirmed { local.looks + u32::from(is_new) } else { 0 };
        local.heard = self.cycles;
        if let Some(index) = local.system {
            let motion = self.motion;
            let system = &mut self.systems[index as usize];
            // How much older the report is than the system track.
            let age_s = seconds_between(report.time_ns, system.time_ns).max(0.0);
            if report.time_ns > system.time_ns {
                system.state.predict(seconds_between(system.time_ns, report.time_ns), &motion);
                system.time_ns = report.time_ns;
            }
            self.compare(place, index);
            let prediction = report.prediction.map(|prediction| frame.to_centre(&prediction, &bias));
            let gained = prediction.and_then(|prediction| Measurement::of_position(&posterior, &prediction));
            let (system, of_site) = (&mut self.systems[index as usize], &mut self.sites[site as usize]);
            let (is_shared, state, counts) = (system.contributors.len() > 1, &mut system.state, &mut of_site.counts);
            if is_shared && of_site.alignment.is_off() {
                counts.kept_out += 1;
            } else if let Some(measurement) = gained {
                state.absorb(&if age_s > 0.0 { measurement.aged(age_s, motion.noise[0]) } else { measurement });
                counts.absorbed += 1;
            } else {
                state.intersect(&posterior.predicted(age_s, motion.noise[1]));
                counts.intersected += 1;
            }
        } else {
            of_site.counts.waiting += 1;
        }
        if report.ended {
            self.end_local(place);
        }
    }

    /// Notes how well a local track fits the system track that it is part of with others.
    fn compare(&mut self, place: u32, index: u32) {
        let (local, system) = (&self.locals[place as usize], &self.systems[index as usize]);
        if system.contributors.len() < 2 {
            return;
        }
        let (then, here) = (self.at(&local.estimate, local.time_ns, system.time_ns), system.state.moments());
        let mut misfit = chi_squared(&(then.mean - here.mean), then.covariance + here.covariance);
        if misfit > self.gate {
            misfit = self.misfit(local.site, &then, system, &here);
        }
        let doubts = if misfit > self.gate { local.doubts + 1 } else { 0 };
        let local = &mut self.locals[place as usize];
        (local.misfit, local.doubts) = (misfit, doubts);
    }
}
