//! The fusion of tracks: reports in, system tracks out, cycle by cycle.
//!
//! ```text
//!  reports of all sites, in order of time ─▶ without bias, in the axes of the centre          reports
//!      attached:   what the update has brought is absorbed by the system track (F3), (F6)
//!  every cycle:
//!      most tracks of a site fit nobody: one bias that explains them is taken for known       misaligned
//!      not attached: χ² with near system tracks, cheapest assignment; attached after several   attachment
//!                    equal decisions; what no longer fits is released (F5)
//!      members of a formation that were confused change places                                 formations
//!      system tracks that are one target merge                                                 twins
//!      targets that several sites see ─▶ biases of the radars (F7)                             biases
//!      how often targets manoeuvre                                                             manoeuvres
//!      system tracks that nobody has contributed to for long end                               life
//! ```
//!
//! Reports of a cycle are worked in order of time, site and number, whatever the order of their coming, so the same reports give the
//! same system tracks.

mod attachment;
mod biases;
mod decision;
mod formations;
mod life;
mod manoeuvres;
mod misaligned;
mod reports;
mod twins;

use std::collections::HashMap;

use common::geodesy::Position;
use common::geometry::Polar;
use common::units::seconds_between;
use nalgebra::Vector3;

use crate::association::Candidate;
use crate::comparison::gate;
use crate::gaussian::{Gaussian, STATE};
use crate::grid::Grid;
use crate::local::SiteFrame;
use crate::motion::{MODELS, Motion};
use crate::registration::{Bias, Observation, Registration};
use crate::settings::{Counts, Settings, Site};
use crate::system::{System, SystemTrack};
pub(crate) use decision::Decision;
use misaligned::Alignment;
use reports::Waiting;

/// The fusion of the tracks of several sites.
#[derive(Debug)]
pub struct Fusion {
    settings: Settings,
    /// How targets move, with what has been learned of it.
    motion: Motion,
    /// Time that targets have flown straight on and manoeuvring of late, s.
    flown_s: [f64; MODELS],
    /// χ² of position and velocity.
    gate: f64,
    sites: Vec<SiteState>,
    locals: Vec<Local>,
    free_locals: Vec<u32>,
    systems: Vec<System>,
    free_systems: Vec<u32>,
    next_id: u64,
    waiting: Vec<Waiting>,
    /// Places in `waiting` in the order of work.
    order: Vec<u32>,
    registration: Registration,
    grid: Grid,
    candidates: Vec<Candidate>,
    /// Local tracks to be decided on: site, number, place.
    open: Vec<(u16, u64, u32)>,
    observations: Vec<Observation>,
    /// Local tracks of a site that fit nobody.
    lonely: Vec<u32>,
    cycles: u64,
    /// Time of the last cycle.
    now_ns: Option<u64>,
}

#[derive(Debug)]
struct SiteState {
    site: Site,
    frame: SiteFrame,
    by_id: HashMap<u64, u32>,
    counts: Counts,
    alignment: Alignment,
    /// Latest time that it has told of, ns.
    told_ns: u64,
    /// The same, but none after the last cycle.
    known_ns: u64,
    /// Time of the last cycle in which it told of a later time than before.
    heard_ns: Option<u64>,
}

impl SiteState {
    /// Whether a place, in the axes of the centre, is in its reach and in its beams.
    fn sees(&self, at_m: &Vector3<f64>) -> bool {
        let polar = Polar::from_enu(&self.frame.from_centre(at_m));
        let is_within = |value: f64, [least, greatest]: [f64; 2]| (least..=greatest).contains(&value);
        is_within(polar.range_m, self.site.range_m) && is_within(polar.elevation_rad, self.site.elevation_rad)
    }

    /// Notes whether it has told of a later time by the cycle at `now_ns`.
    fn note_time(&mut self, now_ns: u64) {
        let known_ns = self.told_ns.min(now_ns);
        if known_ns > self.known_ns {
            (self.known_ns, self.heard_ns) = (known_ns, Some(now_ns));
        }
    }

    /// For how long it has not been heard, s; infinite if it never was.
    fn silent_s(&self, now_ns: u64) -> f64 {
        self.heard_ns.map_or(f64::INFINITY, |heard_ns| seconds_between(heard_ns, now_ns))
    }

    /// How old what it said at `time_ns` of its own clock is at `now_ns` of the centre's, s.
    fn age_s(&self, time_ns: u64, now_ns: u64) -> f64 {
        seconds_between(time_ns, self.known_ns) + self.silent_s(now_ns)
    }
}

/// A local track: the last that its site has said of it.
#[derive(Debug)]
struct Local {
    site: u16,
    id: u64,
    time_ns: u64,
    /// In the axes of the centre, without bias.
    estimate: Gaussian,
    system: Option<u32>,
    /// Cycles in which its site has told of it since it believes in it, 0 if it does not; and the last of them.
    looks: u32,
    heard: u64,
    /// For a system track, or for none of those within the gate.
    choice: Option<Decision>,
    /// Reports in a row outside the gate of its system track, and the last χ².
    doubts: u32,
    misfit: f64,
    alive: bool,
}

impl Fusion {
    /// No track yet of these sites; the axes are east, north, up of `centre`.
    pub fn new(centre: &Position, sites: &[Site], settings: Settings) -> Self {
        let of = |site: &Site| SiteState {
            site: *site,
            frame: SiteFrame::new(&site.position, centre),
            by_id: HashMap::new(),
            counts: Counts::default(),
            alignment: Alignment::default(),
            told_ns: 0,
            known_ns: 0,
            heard_ns: None,
        };
        let biases: Vec<Bias> = sites.iter().map(|site| site.bias).collect();
        Self {
            gate: gate(STATE, settings.gate_probability),
            motion: settings.motion,
            flown_s: [0.0; MODELS],
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
            lonely: Vec::new(),
            cycles: 0,
            now_ns: None,
        }
    }

    /// The same with numbers from `first_id` on.
    #[must_use]
    pub fn numbered_from(self, first_id: u64) -> Self {
        Self { next_id: first_id, ..self }
    }

    /// What is known of the biases of the radars.
    pub fn registration(&self) -> &Registration {
        &self.registration
    }

    /// What has become of the reports of a site.
    pub fn counts(&self, site: usize) -> Counts {
        self.sites[site].counts
    }

    /// How many tracks a site has.
    pub fn local_tracks(&self, site: usize) -> usize {
        self.sites[site].by_id.len()
    }

    /// Whether there is no system track.
    pub fn is_empty(&self) -> bool {
        self.systems.iter().all(|system| !system.alive)
    }

    /// Works the reports that have come, and decides; [`Fusion::system_tracks`] are those at `now_ns` from then on.
    pub fn cycle(&mut self, now_ns: u64) {
        self.free_ended();
        self.sites.iter_mut().for_each(|of| of.note_time(now_ns));
        self.absorb_reports(now_ns);
        let step_s = seconds_between(self.now_ns.unwrap_or(now_ns), now_ns);
        self.now_ns = Some(now_ns);
        self.cycles += 1;
        self.end_silent(now_ns);
        self.release_misfits();
        self.bring_back(now_ns);
        self.attach(now_ns);
        self.reconsider(now_ns);
        self.merge_twins(now_ns);
        self.register(now_ns, step_s);
        self.learn_manoeuvres(step_s);
        self.end_forgotten(now_ns);
    }

    /// The system tracks of the last cycle, those that it has ended among them.
    pub fn system_tracks(&self) -> impl Iterator<Item = SystemTrack<'_>> {
        let now_ns = self.now_ns.unwrap_or_default();
        self.systems.iter().filter(|system| system.alive).map(move |system| self.told(system, now_ns))
    }

    fn told<'a>(&self, system: &'a System, now_ns: u64) -> SystemTrack<'a> {
        let mut state = system.state;
        state.predict(seconds_between(system.time_ns, now_ns), &self.motion);
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

    /// An estimate at another time (F3).
    fn at(&self, estimate: &Gaussian, time_ns: u64, now_ns: u64) -> Gaussian {
        estimate.predicted(seconds_between(time_ns, now_ns), self.motion.noise[0])
    }

    /// A system track at another time.
    fn system_at(&self, system: &System, now_ns: u64) -> Gaussian {
        self.at(&system.state.moments(), system.time_ns, now_ns)
    }

    fn fill_grid(&mut self, now_ns: u64) {
        let alive = self.systems.iter().enumerate().filter(|(_, system)| system.is_open());
        self.grid.fill(alive.map(|(index, system)| {
            let mean = system.state.moments().mean;
            let age_s = seconds_between(system.time_ns, now_ns);
            (index as u32, [mean[0] + age_s * mean[3], mean[1] + age_s * mean[4]])
        }));
    }
}
