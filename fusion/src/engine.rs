//! The fusion of tracks: reports in, system tracks out, cycle by cycle.
//!
//! ```text
//!  reports of all sites, in order of time ─▶ without bias, in the axes of the centre
//!      attached:   what the update has brought is absorbed by the system track (F3), (F6)
//!  every cycle:
//!      not attached: χ² with near system tracks, cheapest assignment; attached after several equal decisions (F5)
//!      system tracks that are one target merge; a local track that no longer fits is released
//!      targets that several sites see ─▶ biases of the radars (F7)
//! ```
//!
//! Reports of a cycle are worked in order of time, site and number, whatever the order of their coming, so the same reports give the
//! same system tracks.

use std::collections::HashMap;

use common::geodesy::Position;
use common::units::seconds_between;
use nalgebra::{Matrix3, Vector3};

use crate::association::{Candidate, assign};
use crate::comparison::{chi_squared, gate};
use crate::gaussian::{Gaussian, Matrix, STATE, Vector};
use crate::grid::Grid;
use crate::local::{Report, SiteFrame};
use crate::measurement::Measurement;
use crate::motion::{Motion, Moving};
use crate::registration::{Bias, BiasJacobian, Observation, Registration};
use crate::system::{CONTRIBUTORS, Contributor, System, SystemTrack};

/// System tracks that registration learns from in a cycle.
const REGISTERED: usize = 250;
/// Radars whose biases can be solved for in every cycle; of more, every other, third… cycle.
const SITES_A_CYCLE: usize = 8;
/// Share of the standard deviation of a bias below which a change of it moves no track.
const NOTABLE: f64 = 0.01;
/// Of all system tracks, those that are looked at in a cycle for others that are the same target: every n-th.
const TWINS_EVERY: usize = 4;

/// Tuning of the fusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How targets move.
    pub motion: Motion,
    /// Probability that local and system track of one target are within the gate.
    pub gate_probability: f64,
    /// Equal decisions in a row before a local track is attached, or two system tracks merge.
    pub attach_after: u32,
    /// Equal decisions in a row before local tracks of a formation change places.
    pub exchange_after: u32,
    /// Reports in a row outside the gate before a local track is released.
    pub release_after: u32,
    /// Time that a system track lives without contributors where a site should see it, s.
    pub coast_s: f64,
    /// The same where no site can see it, s.
    pub hidden_s: f64,
    /// Reports that are made later than this after the last cycle are refused, s.
    pub patience_s: f64,
    /// Periods without a report after which a local track has ended.
    pub silent_periods: f64,
    /// Share of what a cycle says of biases that counts: the errors of a track's states are alike from scan to scan.
    pub registration_share: f64,
    /// Time after which that is forgotten to 1/e, s.
    pub registration_memory_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            motion: Motion { noise: [0.5, 300.0], stay_s: [1000.0, 30.0] },
            gate_probability: 0.999,
            attach_after: 3,
            exchange_after: 5,
            release_after: 4,
            coast_s: 15.0,
            hidden_s: 60.0,
            patience_s: 60.0,
            silent_periods: 3.5,
            registration_share: 0.2,
            registration_memory_s: 600.0,
        }
    }
}

/// A site as the fusion knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Where its antenna stands.
    pub position: Position,
    /// Greatest range, m.
    pub range_m: f64,
    /// Time of a turn, s.
    pub period_s: f64,
    /// Standard deviations of its biases; 0 for what has none.
    pub bias: Bias,
}

/// What has become of reports, by site.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Absorbed as what an update has brought.
    pub absorbed: u64,
    /// Absorbed by covariance intersection: the update was not that of a Kalman filter.
    pub intersected: u64,
    /// Of a track that is part of no system track yet.
    pub waiting: u64,
    /// Older than the last of the same track, or the same again.
    pub repeated: u64,
    /// With numbers that are no estimate, or far ahead of time.
    pub unusable: u64,
    /// Local tracks released because they no longer fitted.
    pub released: u64,
}

struct SiteState {
    site: Site,
    frame: SiteFrame,
    by_id: HashMap<u64, u32>,
    counts: Counts,
}

/// A local track: the last that its site has said of it.
struct Local {
    site: u16,
    id: u64,
    time_ns: u64,
    /// In the axes of the centre, without bias.
    estimate: Gaussian,
    system: Option<u32>,
    confirmed: bool,
    /// The system track that the last decision was for, and how many in a row were.
    choice: Option<(u32, u32)>,
    /// Decisions in a row for none of those within the gate.
    alone: u32,
    /// Reports in a row outside the gate of its system track, and the last χ².
    doubts: u32,
    misfit: f64,
    alive: bool,
}

struct Waiting {
    made_ns: u64,
    site: u16,
    report: Report,
}

/// The fusion of the tracks of several sites.
pub struct Fusion {
    settings: Settings,
    gate: f64,
    sites: Vec<SiteState>,
    locals: Vec<Local>,
    free_locals: Vec<u32>,
    systems: Vec<System>,
    free_systems: Vec<u32>,
    next_id: u64,
    waiting: Vec<Waiting>,
    order: Vec<u32>,
    registration: Registration,
    grid: Grid,
    candidates: Vec<Candidate>,
    /// Local tracks that are part of no system track: site, number, place.
    open: Vec<(u16, u64, u32)>,
    observations: Vec<Observation>,
    cycles: u64,
    /// Time of the last cycle.
    now_ns: Option<u64>,
}

impl Fusion {
    /// No track yet of these sites; the axes are east, north, up of `centre`.
    pub fn new(centre: &Position, sites: &[Site], settings: Settings) -> Self {
        let of = |site: &Site| SiteState {
            site: *site,
            frame: SiteFrame::new(&site.position, centre),
            by_id: HashMap::new(),
            counts: Counts::default(),
        };
        let biases: Vec<Bias> = sites.iter().map(|site| site.bias).collect();
        Self {
            gate: gate(STATE, settings.gate_probability),
            settings,
            sites: sites.iter().map(of).collect(),
            locals: Vec::new(),
            free_locals: Vec::new(),
            systems: Vec::new(),
            free_systems: Vec::new(),
            next_id: 1,
            waiting: Vec::new(),
            order: Vec::new(),
            registration: Registration::new(&biases),
            grid: Grid::default(),
            candidates: Vec::new(),
            open: Vec::new(),
            observations: Vec::new(),
            cycles: 0,
            now_ns: None,
        }
    }

    /// The same with numbers from `first_id` on.
    #[must_use]
    pub fn numbered_from(self, first_id: u64) -> Self {
        Self { next_id: first_id, ..self }
    }

    /// Takes a report that a site has made at `made_ns`, measurement time: it is worked in the first cycle that ends then or later.
    pub fn take(&mut self, site: usize, report: &Report, made_ns: u64) {
        // A clock that is far ahead would have its reports wait for ever.
        let is_timely = self.now_ns.is_none_or(|now_ns| seconds_between(now_ns, made_ns) < self.settings.patience_s);
        if report.posterior.is_sound() && is_timely {
            self.waiting.push(Waiting { made_ns, site: site as u16, report: *report });
        } else {
            self.sites[site].counts.unusable += 1;
        }
    }

    /// What is known of the biases of the radars.
    pub fn registration(&self) -> &Registration {
        &self.registration
    }

    /// What has become of the reports of a site.
    pub fn counts(&self, site: usize) -> Counts {
        self.sites[site].counts
    }

    /// Works the reports that have come, and decides; [`Fusion::system_tracks`] are those at `now_ns` from then on.
    pub fn cycle(&mut self, now_ns: u64) {
        self.free_ended();
        self.absorb_reports(now_ns);
        let step_s = seconds_between(self.now_ns.unwrap_or(now_ns), now_ns);
        self.now_ns = Some(now_ns);
        self.end_silent(now_ns);
        self.release_misfits();
        self.attach(now_ns);
        self.reconsider(now_ns);
        self.merge_twins(now_ns);
        self.register(now_ns, step_s);
        self.cycles += 1;
        for index in 0..self.systems.len() {
            self.systems[index].ended = self.systems[index].alive && self.has_ended(index, now_ns);
        }
    }

    /// The system tracks of the last cycle, those that it has ended among them.
    pub fn system_tracks(&self) -> impl Iterator<Item = SystemTrack<'_>> {
        let now_ns = self.now_ns.unwrap_or_default();
        self.systems.iter().filter(|system| system.alive).map(move |system| self.told(system, now_ns))
    }

    fn free_ended(&mut self) {
        for (index, system) in self.systems.iter_mut().enumerate().filter(|(_, system)| system.alive && system.ended) {
            system.alive = false;
            self.free_systems.push(index as u32);
        }
    }

    fn absorb_reports(&mut self, now_ns: u64) {
        let mut waiting = std::mem::take(&mut self.waiting);
        self.order.clear();
        self.order.extend((0..waiting.len() as u32).filter(|&index| waiting[index as usize].made_ns <= now_ns));
        self.order.sort_unstable_by_key(|&index| {
            let of = &waiting[index as usize];
            (of.report.time_ns, of.site, of.report.id)
        });
        let order = std::mem::take(&mut self.order);
        for &index in &order {
            let of = &waiting[index as usize];
            self.absorb(of.site, &of.report);
        }
        self.order = order;
        waiting.retain(|of| of.made_ns > now_ns);
        self.waiting = waiting;
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
        let posterior = of_site.frame.to_centre(&report.posterior, &bias);
        local.time_ns = report.time_ns;
        local.estimate = posterior;
        local.confirmed = report.confirmed;
        if let Some(system) = local.system {
            let system = &mut self.systems[system as usize];
            let prediction = report.prediction.map(|prediction| of_site.frame.to_centre(&prediction, &bias));
            let age_s = seconds_between(report.time_ns, system.time_ns);
            if age_s < 0.0 {
                system.state.predict(-age_s, &self.settings.motion);
                system.time_ns = report.time_ns;
            }
            if system.contributors.len() > 1 {
                let here = system.state.moments();
                let then =
                    if age_s > 0.0 { posterior.predicted(age_s, self.settings.motion.noise[0]) } else { posterior };
                local.misfit = chi_squared(&(then.mean - here.mean), then.covariance + here.covariance);
                local.doubts = if local.misfit > self.gate { local.doubts + 1 } else { 0 };
            }
            let gained = prediction.and_then(|prediction| Measurement::of_position(&posterior, &prediction));
            if let Some(measurement) = gained {
                let late = age_s > 0.0;
                let measurement =
                    if late { measurement.aged(age_s, self.settings.motion.noise[0]) } else { measurement };
                system.state.absorb(&measurement);
                of_site.counts.absorbed += 1;
            } else {
                system.state.intersect(&posterior.predicted(age_s.max(0.0), self.settings.motion.noise[1]));
                of_site.counts.intersected += 1;
            }
        } else {
            of_site.counts.waiting += 1;
        }
        if report.ended {
            self.end_local(place);
        }
    }

    fn local_of(&mut self, site: u16, id: u64) -> u32 {
        if let Some(&place) = self.sites[site as usize].by_id.get(&id) {
            return place;
        }
        let local = Local {
            site,
            id,
            time_ns: 0,
            estimate: Gaussian { mean: Vector::zeros(), covariance: Matrix::identity() },
            system: None,
            confirmed: false,
            choice: None,
            alone: 0,
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

    fn end_local(&mut self, place: u32) {
        self.detach(place);
        let local = &mut self.locals[place as usize];
        local.alive = false;
        self.sites[local.site as usize].by_id.remove(&local.id);
        self.free_locals.push(place);
    }

    fn detach(&mut self, place: u32) {
        let local = &mut self.locals[place as usize];
        (local.choice, local.alone, local.doubts) = (None, 0, 0);
        if let Some(system) = local.system.take() {
            let system = &mut self.systems[system as usize];
            system.contributors.retain(|of| of.local != place);
            if system.contributors.is_empty() {
                system.alone_since_ns = Some(local.time_ns);
            }
        }
    }

    /// Takes a local track out of a system track that has no other, which ends with that.
    fn leave(&mut self, place: u32) {
        if let Some(system) = self.locals[place as usize].system {
            self.detach(place);
            self.systems[system as usize].alone_since_ns = Some(0);
        }
    }

    fn attach_to(&mut self, place: u32, system: u32) {
        let local = &mut self.locals[place as usize];
        local.system = Some(system);
        (local.choice, local.alone, local.doubts) = (None, 0, 0);
        let system = &mut self.systems[system as usize];
        system.contributors.push(Contributor { site: local.site, local: place, id: local.id });
        system.alone_since_ns = None;
    }

    fn end_silent(&mut self, now_ns: u64) {
        for place in 0..self.locals.len() {
            let local = &self.locals[place];
            let patience_s = self.settings.silent_periods * self.sites[local.site as usize].site.period_s;
            if local.alive && seconds_between(local.time_ns, now_ns) > patience_s {
                self.end_local(place as u32);
            }
        }
    }

    /// Of the contributors of a system track that no longer fit, the one that fits least goes.
    fn release_misfits(&mut self) {
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            if !system.alive || system.contributors.len() < 2 {
                continue;
            }
            let doubtful = system
                .contributors
                .iter()
                .map(|of| of.local)
                .filter(|&place| self.locals[place as usize].doubts >= self.settings.release_after);
            let misfit = |place: u32| self.locals[place as usize].misfit;
            if let Some(worst) = doubtful.max_by(|&a, &b| misfit(a).total_cmp(&misfit(b))) {
                self.detach(worst);
                let site = self.locals[worst as usize].site;
                self.sites[site as usize].counts.released += 1;
            }
        }
    }

    fn fill_grid(&mut self, now_ns: u64) {
        let alive = self.systems.iter().enumerate().filter(|(_, system)| system.alive);
        self.grid.fill(alive.map(|(index, system)| {
            let mean = system.state.moments().mean;
            let age_s = seconds_between(system.time_ns, now_ns);
            (index as u32, [mean[0] + age_s * mean[3], mean[1] + age_s * mean[4]])
        }));
    }

    fn attach(&mut self, now_ns: u64) {
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        let locals = self.locals.iter().enumerate();
        // One that nobody else has joined may belong to an older system track.
        let is_open = |local: &Local| local.system.is_none_or(|own| self.systems[own as usize].contributors.len() == 1);
        let alone = locals.filter(|(_, local)| local.alive && local.confirmed && is_open(local));
        open.extend(alone.map(|(place, local)| (local.site, local.id, place as u32)));
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

    /// Decisions for the local tracks `rows` of one site.
    fn decide(&mut self, rows: &[(u16, u64, u32)], now_ns: u64) {
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        for (row, &(_, _, place)) in rows.iter().enumerate() {
            let local = &self.locals[place as usize];
            let own = self.at(&local.estimate, local.time_ns, now_ns);
            let jacobian = self.jacobian(local.site, &own);
            let alone = own.position_covariance() + self.bias_spread(local.site, &jacobian);
            let reach_m = 2.0 * (self.gate * alone.trace()).sqrt();
            for column in self.grid.near([own.mean[0], own.mean[1]], reach_m) {
                let system = &self.systems[column as usize];
                let is_older = local.system.is_none_or(|own| system.id < self.systems[own as usize].id);
                if !is_older || system.contributes(local.site) || system.contributors.len() == CONTRIBUTORS {
                    continue;
                }
                let other = self.at(&system.state.moments(), system.time_ns, now_ns);
                let mut spread = own.covariance + other.covariance;
                let bias = self.relative_bias_spread(local.site, &jacobian, system, &other);
                let mut corner = spread.fixed_view_mut::<3, 3>(0, 0);
                corner += bias;
                let cost = chi_squared(&(own.mean - other.mean), spread);
                if cost <= self.gate {
                    candidates.push(Candidate { row: row as u32, column, cost });
                }
            }
        }
        let assigned = assign(rows.len(), &candidates, self.gate);
        for (row, (&(_, _, place), column)) in rows.iter().zip(assigned).enumerate() {
            let local = &mut self.locals[place as usize];
            if let Some(column) = column {
                local.alone = 0;
                let before = local.choice.filter(|choice| choice.0 == column).map_or(0, |choice| choice.1);
                local.choice = Some((column, before + 1));
                if before + 1 >= self.settings.attach_after {
                    self.leave(place);
                    self.attach_to(place, column);
                }
            } else if local.system.is_none() {
                let contested = candidates.iter().any(|of| of.row == row as u32);
                local.choice = None;
                local.alone += 1;
                if !contested || local.alone >= self.settings.attach_after {
                    self.start(place);
                }
            }
        }
        self.candidates = candidates;
    }

    /// Where several system tracks are within the gate of a local track that is part of one of them: members of a formation may have
    /// been confused while little was known of them.
    fn reconsider(&mut self, now_ns: u64) {
        self.fill_grid(now_ns);
        let crowded: Vec<u32> =
            (0..self.systems.len() as u32).filter(|&index| self.is_crowded(index, now_ns)).collect();
        let mut open = std::mem::take(&mut self.open);
        for site in 0..self.sites.len() as u16 {
            open.clear();
            let mut candidates = std::mem::take(&mut self.candidates);
            candidates.clear();
            for &index in &crowded {
                let system = &self.systems[index as usize];
                let Some(of) = system.contributors.iter().find(|of| of.site == site) else { continue };
                let row = open.len() as u32;
                let before = candidates.len();
                self.alternatives(of.local, index, row, now_ns, &mut candidates);
                if candidates.len() > before {
                    open.push((site, of.id, of.local));
                }
            }
            if !candidates.is_empty() {
                let assigned = assign(open.len(), &candidates, f64::MAX);
                self.exchange(&open, &assigned);
            }
            self.candidates = candidates;
        }
        self.open = open;
    }

    /// Whether a local track of a system track of several could be another one's.
    fn is_crowded(&self, index: u32, now_ns: u64) -> bool {
        let system = &self.systems[index as usize];
        if !system.alive || system.contributors.len() < 2 {
            return false;
        }
        let here = self.at(&system.state.moments(), system.time_ns, now_ns);
        // What all know is little more than their number times what one knows.
        let alone = system.contributors.len() as f64 * here.position_covariance().trace();
        let near = self.grid.near([here.mean[0], here.mean[1]], 2.0 * (self.gate * alone).sqrt());
        near.count() > 1
    }

    /// Candidates of a local track that is part of `own`: that one and others within the gate; none if there are no others.
    fn alternatives(&self, place: u32, own: u32, row: u32, now_ns: u64, candidates: &mut Vec<Candidate>) {
        let local = &self.locals[place as usize];
        let here = self.at(&local.estimate, local.time_ns, now_ns);
        let reach_m = 2.0 * (self.gate * here.position_covariance().trace()).sqrt();
        let first = candidates.len();
        for column in self.grid.near([here.mean[0], here.mean[1]], reach_m) {
            let system = &self.systems[column as usize];
            let there = self.at(&system.state.moments(), system.time_ns, now_ns);
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
            let before = local.choice.filter(|choice| Some(choice.0) == better).map_or(0, |choice| choice.1);
            local.choice = better.map(|column| (column, before + 1));
            if let Some(column) = better
                && before + 1 >= self.settings.exchange_after
            {
                moves.push((place, column));
            }
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

    /// A system track of one local track.
    fn start(&mut self, place: u32) {
        let local = &self.locals[place as usize];
        let system = System {
            id: self.next_id,
            time_ns: local.time_ns,
            state: Moving::new(local.estimate, &self.settings.motion),
            contributors: Vec::new(),
            alone_since_ns: None,
            coasting: 0,
            twin: None,
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
        self.systems[index as usize].contributors.clear();
        self.attach_to(place, index);
    }

    /// System tracks of one target become one: the older number stays.
    fn merge_twins(&mut self, now_ns: u64) {
        let first = self.cycles as usize % TWINS_EVERY;
        for index in (first..self.systems.len()).step_by(TWINS_EVERY).map(|index| index as u32) {
            let system = &self.systems[index as usize];
            if !system.alive || system.contributors.is_empty() {
                continue;
            }
            let twin = self.nearest_twin(index, now_ns);
            let system = &mut self.systems[index as usize];
            let before = system.twin.filter(|was| Some(was.0) == twin).map_or(0, |was| was.1);
            system.twin = twin.map(|twin| (twin, before + 1));
        }
        for index in 0..self.systems.len() as u32 {
            let Some((twin, decisions)) = self.systems[index as usize].twin else { continue };
            if !self.systems[index as usize].alive || !self.systems[twin as usize].alive {
                self.systems[index as usize].twin = None;
                continue;
            }
            let mutual = self.systems[twin as usize].twin.is_some_and(|other| other.0 == index);
            if mutual
                && decisions >= self.settings.attach_after
                && self.systems[index as usize].id < self.systems[twin as usize].id
            {
                self.merge(index, twin);
            }
        }
    }

    fn nearest_twin(&self, index: u32, now_ns: u64) -> Option<u32> {
        let system = &self.systems[index as usize];
        let own = self.at(&system.state.moments(), system.time_ns, now_ns);
        let first = system.contributors.first()?;
        let jacobian = self.jacobian(first.site, &own);
        let alone = own.position_covariance() + self.bias_spread(first.site, &jacobian);
        let reach_m = 2.0 * (self.gate * alone.trace()).sqrt();
        let cost = |&other: &u32| {
            let system_b = &self.systems[other as usize];
            if other == index || !system_b.alive || system_b.contributors.iter().any(|of| system.contributes(of.site)) {
                return None;
            }
            let there = self.at(&system_b.state.moments(), system_b.time_ns, now_ns);
            let mut spread = own.covariance + there.covariance;
            let bias = self.relative_bias_spread(first.site, &jacobian, system_b, &there);
            let mut corner = spread.fixed_view_mut::<3, 3>(0, 0);
            corner += bias;
            let cost = chi_squared(&(own.mean - there.mean), spread);
            (cost <= self.gate).then_some(cost)
        };
        let near = self.grid.near([own.mean[0], own.mean[1]], reach_m);
        near.filter_map(|other| Some((other, cost(&other)?))).min_by(|a, b| a.1.total_cmp(&b.1)).map(|of| of.0)
    }

    fn merge(&mut self, into: u32, from: u32) {
        let mut contributors = std::mem::take(&mut self.systems[from as usize].contributors);
        for of in &contributors {
            self.attach_to(of.local, into);
        }
        contributors.clear();
        let ended = &mut self.systems[from as usize];
        ended.contributors = contributors;
        ended.twin = None;
        // It is told once more as ended.
        ended.alone_since_ns = Some(0);
        self.systems[into as usize].twin = None;
    }

    /// Learns biases from targets that several sites see, a part of them in each cycle.
    fn register(&mut self, now_ns: u64, step_s: f64) {
        if (0..self.sites.len()).all(|site| self.sites[site].site.bias == Bias::zeros()) {
            return;
        }
        self.registration.forget(1.0 - (-step_s / self.settings.registration_memory_s).exp());
        let mut observations = std::mem::take(&mut self.observations);
        let parts = self.systems.len().div_ceil(REGISTERED);
        for index in ((self.cycles as usize % parts.max(1))..self.systems.len()).step_by(parts.max(1)) {
            let system = &self.systems[index];
            if !system.alive || system.contributors.len() < 2 {
                continue;
            }
            observations.clear();
            for of in &system.contributors {
                let local = &self.locals[of.local as usize];
                let here = self.at(&local.estimate, local.time_ns, now_ns);
                let jacobian = self.jacobian(of.site, &here);
                if let Some(weight) = here.position_covariance().try_inverse() {
                    let position_m = here.position() + jacobian * self.registration.bias(of.site.into());
                    observations.push(Observation { site: of.site.into(), position_m, weight, jacobian });
                }
            }
            self.registration.observe(&observations, (self.settings.registration_share * parts as f64).min(1.0));
        }
        self.observations = observations;
        if !self.cycles.is_multiple_of(self.sites.len().div_ceil(SITES_A_CYCLE) as u64) {
            return;
        }
        let before: Vec<Bias> = (0..self.sites.len()).map(|site| self.registration.bias(site)).collect();
        self.registration.solve();
        let change: Vec<Bias> =
            before.iter().enumerate().map(|(site, before)| self.registration.bias(site) - before).collect();
        // The next reports bring small changes by themselves.
        let matters = |(change, site): (&Bias, &SiteState)| {
            change.iter().zip(site.site.bias.iter()).any(|(change, sigma)| change.abs() > NOTABLE * sigma)
        };
        if change.iter().zip(&self.sites).any(matters) {
            self.shift(&change);
        }
    }

    /// Moves all tracks by what has been learned of biases.
    fn shift(&mut self, change: &[Bias]) {
        for place in 0..self.locals.len() {
            if self.locals[place].alive {
                let local = &self.locals[place];
                let moved = self.jacobian(local.site, &local.estimate) * change[local.site as usize];
                let mut position = self.locals[place].estimate.mean.fixed_rows_mut::<3>(0);
                position -= moved;
            }
        }
        for index in 0..self.systems.len() {
            let system = &self.systems[index];
            if system.alive && !system.contributors.is_empty() {
                let here = system.state.moments();
                let moved: Vector3<f64> = system
                    .contributors
                    .iter()
                    .map(|of| self.jacobian(of.site, &here) * change[of.site as usize])
                    .sum::<Vector3<f64>>()
                    / system.contributors.len() as f64;
                let mut by = Vector::zeros();
                by.fixed_rows_mut::<3>(0).copy_from(&-moved);
                self.systems[index].state.shift(&by);
            }
        }
    }

    /// An estimate at another time (F3).
    fn at(&self, estimate: &Gaussian, time_ns: u64, now_ns: u64) -> Gaussian {
        estimate.predicted(seconds_between(time_ns, now_ns), self.settings.motion.noise[0])
    }

    fn jacobian(&self, site: u16, estimate: &Gaussian) -> BiasJacobian {
        self.sites[site as usize].frame.jacobian(&estimate.position(), &estimate.velocity())
    }

    fn bias_spread(&self, site: u16, jacobian: &BiasJacobian) -> Matrix3<f64> {
        jacobian * self.registration.covariance(site.into(), site.into()) * jacobian.transpose()
    }

    /// What is not known of the bias of a site against that of the first contributor of a system track.
    fn relative_bias_spread(
        &self,
        site: u16,
        jacobian: &BiasJacobian,
        system: &System,
        estimate: &Gaussian,
    ) -> Matrix3<f64> {
        let own = self.bias_spread(site, jacobian);
        let Some(first) = system.contributors.first() else { return own };
        let other = self.jacobian(first.site, estimate);
        let common = jacobian * self.registration.covariance(site.into(), first.site.into()) * other.transpose();
        own + self.bias_spread(first.site, &other) - common - common.transpose()
    }

    fn has_ended(&mut self, index: usize, now_ns: u64) -> bool {
        let system = &self.systems[index];
        let Some(since_ns) = system.alone_since_ns else {
            self.systems[index].coasting = 0;
            return false;
        };
        let here = self.at(&system.state.moments(), system.time_ns, now_ns).position();
        let seen = self.sites.iter().any(|of| (here - of.frame.place_m()).norm() < of.site.range_m);
        let patience_s = if seen { self.settings.coast_s } else { self.settings.hidden_s };
        self.systems[index].coasting += 1;
        seconds_between(since_ns, now_ns) > patience_s
    }

    fn told<'a>(&self, system: &'a System, now_ns: u64) -> SystemTrack<'a> {
        let mut state = system.state;
        state.predict(seconds_between(system.time_ns, now_ns), &self.settings.motion);
        let mut estimate = state.moments();
        // Of several radars the biases are averaged: about that of one over their number.
        if let Some(of) = system.contributors.first() {
            let count = system.contributors.len() as f64;
            let spread = self.bias_spread(of.site, &self.jacobian(of.site, &estimate)) / count;
            let mut corner = estimate.covariance.fixed_view_mut::<3, 3>(0, 0);
            corner += spread;
        }
        SystemTrack {
            id: system.id,
            time_ns: now_ns,
            estimate,
            manoeuvre: state.probability()[1],
            contributors: &system.contributors,
            coasting: system.coasting,
            ended: system.ended,
        }
    }
}
