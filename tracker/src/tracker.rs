//! The tracker: one call per `plots` message, the tracks brought up to date by it.
//!
//! ```text
//!  plots of a sector ─▶ store, ordered by beam angle
//!  every track whose gates the beam has passed: gate ─▶ associate ─▶ update ─▶ existence ─▶ predict its next passage
//!                                               └─ up to eight at once ─┘
//!  every plot that no confirmed track can still claim: clutter map, pair with last turn ─▶ tentative track
//! ```
//!
//! A track is processed once per passage of the beam, as soon as the upper azimuth edge of its gates is
//! covered. All angles are unwrapped ([`crate::sweep`]), so north is no special place. Nothing here
//! depends on the time of day, on threads or on the order of plots in a message.

use std::f64::consts::TAU;
use std::ops::Range;

use common::config::{Association, ConfigError, TrackerConfig};
use common::health::{Reject, Rejected};
use common::message::END_OF_STREAM;
use common::plots::{Plot, PlotsHeader};
use common::tracks::{TERMINATED, Track};
use common::units::seconds_between;

use crate::amplitude::Amplitude;
use crate::association::Rules;
use crate::batch::LANES;
use crate::group::{Group, Member};
use crate::hypotheses::{Hypotheses, Room};
use crate::imm::transition;
use crate::initiation::Reach;
use crate::joint::{LEAST_SHARE, Rivals, Sharing};
use crate::life::Life;
use crate::measurement::{COORDINATES, Measurement};
use crate::motion::MODES;
use crate::plot_store::{Entry, PlotStore};
use crate::site::{self, Site};
use crate::start::two_plots;
use crate::sweep::{Continuation, Sweep};
use crate::track::{LastScan, LiveTrack, Passage, Twin};
use crate::update::{Outcome, Workspace, update};

/// Mode probabilities of a new track.
const START_PROBABILITY: [f64; MODES] = [0.33, 0.34, 0.33];
/// Weight of "none" above which a scan counts as one without a plot.
const MISS_WEIGHT: f64 = 0.5;
/// Association weight with a confirmed track from which a plot starts no new one and is no evidence for a tentative one.
const EXPLAINED: f64 = 0.2;
/// Existence below which two plots start no track.
const LEAST_EXISTENCE: f64 = 1e-5;
/// Scans in which two tracks share their best plot before one of them goes: if one is tentative, and if both are
/// confirmed. Drones that cross in one cell share it for some scans, and their velocities come near each other.
const SHARED_SCANS: [u32; 2] = [2, 12];
/// Squared distance of two tracks' velocities, in standard deviations, below which they may be one.
const SAME_VELOCITY: f64 = 9.0;
/// A plot this far behind what has been processed may still be used, cells of azimuth: interpolation moves plots a little.
const LATE_CELLS: f64 = 2.0;
/// A prediction is renewed if the beam will pass this much earlier or later than it was made for, s.
const TIMING_S: f64 = 0.02;
/// Tracks due at once from which updating them as a group costs less than one by one.
const LEAST_GROUP: usize = 3;

/// What became of one message.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Taken {
    /// Input that was not used, by reason.
    pub rejected: Rejected,
    /// Tracks alive, of any state.
    pub alive: u32,
    /// Of these confirmed or coasting.
    pub confirmed: u32,
}

/// The tracker of one radar.
#[derive(Debug)]
pub struct Tracker {
    config: TrackerConfig,
    rules: Rules,
    reach: Reach,
    sweep: Sweep,
    plots: PlotStore,
    site: Option<Site>,
    /// By ascending id.
    tracks: Vec<LiveTrack>,
    next_id: u64,
    /// Indices of the tracks due, reused.
    due: Vec<usize>,
    /// The passages of those tracks, reused.
    visits: Vec<Visit>,
    /// What the plots of the visits are worth among several tracks, reused.
    shares: Vec<f64>,
    sharing: Sharing,
    rivals: Rivals,
    /// Whether tracks are updated in groups where that is possible.
    in_groups: bool,
    group: Group,
    /// Candidates and weights of the visits at hand, reused.
    workspaces: [Workspace; LANES],
    /// What became of them, reused.
    outcomes: Vec<Outcome>,
    /// Plots and weights of the track at hand, reused.
    claims: Vec<(usize, f64)>,
    room: Room,
}

/// A passage of the beam over a track that is being processed: [`LiveTrack::next`].
#[derive(Debug, Clone)]
struct Visit {
    /// Index of the track.
    track: usize,
    /// Turn of the beam, for the clutter map.
    turn: u32,
    /// Indices of the plots that are offered.
    plots: Range<usize>,
    /// Where their shares are; empty where no other track wants them.
    shares: Range<usize>,
}

impl Tracker {
    /// An empty tracker; track numbers count from `first_id`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn new(config: &TrackerConfig, first_id: u64) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            config: config.clone(),
            rules: Rules::new(config),
            reach: Reach { speed_mps: config.start_speed_mps, acceleration_mps2: config.manoeuvre_noise_mps3 },
            sweep: Sweep::default(),
            plots: PlotStore::default(),
            site: None,
            tracks: Vec::new(),
            next_id: first_id,
            due: Vec::new(),
            visits: Vec::new(),
            shares: Vec::new(),
            sharing: Sharing::default(),
            rivals: Rivals::default(),
            in_groups: true,
            group: Group::default(),
            workspaces: Default::default(),
            outcomes: Vec::new(),
            claims: Vec::new(),
            room: Room::default(),
        })
    }

    /// Updates tracks one by one, never in groups, to compare.
    #[must_use]
    pub fn one_by_one(self) -> Self {
        Self { in_groups: false, ..self }
    }

    /// Takes the plots of one sector and replaces `tracks` by the tracks that it brought up to date:
    /// processed, started, or ended (once, as `TERMINATED`).
    pub fn take(&mut self, header: &PlotsHeader, plots: &[Plot], tracks: &mut Vec<Track>) -> Taken {
        let mut taken = Taken::default();
        tracks.clear();
        if !site::is_possible(header) {
            taken.rejected.count(Reject::BadHeader);
            return self.counted(taken);
        }
        match self.sweep.advance(header) {
            Continuation::Onwards => {}
            Continuation::Late => {
                for _ in plots {
                    taken.rejected.count(Reject::Late);
                }
                return self.counted(taken);
            }
            Continuation::Anew => {
                self.plots.clear();
                self.end_all(tracks);
            }
        }
        // Taken out, so that tracks and site can be borrowed side by side.
        let mut site = match self.site.take() {
            Some(site) if site.is_described_by(header) => site,
            _ => Site::new(header, &self.config),
        };
        let covered_rad = self.sweep.covered_to_rad();
        for (index, plot) in plots.iter().enumerate() {
            match Measurement::from_plot(plot) {
                Some(measurement) => {
                    let angle_rad = self.sweep.unwrap(header, plot.azimuth_rad);
                    let Some(angle_rad) = self.plots.admit(angle_rad, LATE_CELLS * header.cell_azimuth_rad) else {
                        taken.rejected.count(Reject::Late);
                        continue;
                    };
                    let entry = Entry {
                        angle_rad,
                        seq: header.seq,
                        index: index as u32,
                        explained: 0.0,
                        claimed: 0.0,
                        owner: None,
                    };
                    self.plots.insert(entry, measurement);
                }
                None => taken.rejected.count(Reject::BadPlot),
            }
        }
        let ended = header.has(END_OF_STREAM);
        self.process_due(covered_rad, ended, &mut site, tracks);
        self.start_tracks(covered_rad, &mut site, tracks);
        self.plots.drop_before(covered_rad);
        self.tracks.retain(|track| track.life.state != TERMINATED);
        self.site = Some(site);
        self.counted(taken)
    }

    /// Tracks alive.
    pub fn alive(&self) -> &[LiveTrack] {
        &self.tracks
    }

    fn counted(&self, mut taken: Taken) -> Taken {
        taken.alive = self.tracks.len() as u32;
        taken.confirmed = self.tracks.iter().filter(|track| track.life.is_confirmed()).count() as u32;
        taken
    }

    /// Ends every track: measurement time went back.
    fn end_all(&mut self, tracks: &mut Vec<Track>) {
        for mut track in self.tracks.drain(..) {
            track.life.state = TERMINATED;
            tracks.push(track.message());
        }
    }

    /// Processes the tracks whose gates the beam has passed, in the order in which it did. At the end of the
    /// stream those follow whose target was passed, as nothing more will come.
    ///
    /// The confirmed come first: what they explain is no evidence for tentative ones. All of a kind are prepared before any is
    /// settled: what they know of each other is from before the message.
    fn process_due(&mut self, covered_rad: f64, ended: bool, site: &mut Site, tracks: &mut Vec<Track>) {
        self.due.clear();
        for (index, track) in self.tracks.iter().enumerate() {
            let reached = if ended { track.next.angle_rad } else { track.next.due_rad() };
            if reached <= covered_rad {
                self.due.push(index);
            }
        }
        let (due, all) = (&mut self.due, &self.tracks);
        due.sort_unstable_by(|&a, &b| {
            let (a, b) = (&all[a], &all[b]);
            let by_passage = a.next.due_rad().total_cmp(&b.next.due_rad()).then(a.id.cmp(&b.id));
            b.life.is_confirmed().cmp(&a.life.is_confirmed()).then(by_passage)
        });
        let confirmed = due.partition_point(|&index| all[index].life.is_confirmed());
        for range in [0..confirmed, confirmed..self.due.len()] {
            self.visits.clear();
            for position in range {
                let visit = self.prepare(self.due[position], covered_rad, site);
                self.visits.push(visit);
            }
            self.share_out(site);
            self.settle_all(site, tracks);
        }
    }

    /// Updates the tracks of all visits, in groups, and merges those that turn out to be one.
    fn settle_all(&mut self, site: &Site, tracks: &mut Vec<Track>) {
        for first in (0..self.visits.len()).step_by(LANES) {
            let group = first..self.visits.len().min(first + LANES);
            self.update(group.clone(), site);
            for (lane, position) in group.enumerate() {
                let visit = self.visits[position].clone();
                if self.tracks[visit.track].life.state == TERMINATED {
                    continue;
                }
                let best = self.settle(&visit, lane, site);
                tracks.push(self.tracks[visit.track].message());
                if let Some(weaker) = best.and_then(|plot| self.own(plot, visit.track)) {
                    self.merge_duplicate(weaker, tracks);
                }
            }
        }
    }

    /// One passage of one track, up to the plots that are offered to it.
    fn prepare(&mut self, index: usize, covered_rad: f64, site: &Site) -> Visit {
        let Self { config, sweep, plots, tracks, .. } = self;
        let track = &mut tracks[index];
        // Whole turns may have been lost: the passage that counts is the last one covered.
        let lost_turns = ((covered_rad - track.next.due_rad()) / TAU).floor();
        if lost_turns >= 1.0 {
            track.next.angle_rad += lost_turns * TAU;
        }
        let beam_ns = sweep.time_at(track.next.angle_rad);
        if seconds_between(track.next.time_ns, beam_ns).abs() > TIMING_S {
            let angle_rad = track.next.angle_rad;
            track.next = site.kinematics.at(&track.posterior, track.time_ns, beam_ns, angle_rad, &site.radar);
        }
        track.amplitude.look(config, &site.detector);
        let passage = &track.next;
        let from_rad = (passage.angle_rad - passage.half_width_rad).max(track.searched_to_rad);
        Visit {
            track: index,
            turn: (passage.angle_rad / TAU).max(0.0) as u32,
            plots: plots.between(from_rad, passage.due_rad()),
            shares: 0..0,
        }
    }

    /// What the plots of each visit are worth among several tracks.
    fn share_out(&mut self, site: &Site) {
        let Self { config, rules, plots, tracks, visits, shares, sharing, rivals: index, .. } = self;
        shares.clear();
        if !config.joint_association || visits.is_empty() {
            return;
        }
        index.build(tracks, &site.radar);
        for visit in visits {
            let track = &tracks[visit.track];
            let own = site.claimant(config, track, &track.next);
            let rivals = index
                .of(visit.track, tracks, &site.radar)
                .map(|(rival, expects)| site.claimant(config, rival, expects));
            let clutter = |polar: &[f64; COORDINATES]| site.clutter.at(polar, visit.turn, None);
            let first = shares.len();
            let offered = plots.measurements(visit.plots.clone());
            sharing.share(&own, rivals, offered, clutter, rules.inflation, shares);
            if !track.life.is_confirmed() {
                for (offered, plot) in visit.plots.clone().enumerate() {
                    if plots.entry(plot).explained > EXPLAINED {
                        shares.resize(first + visit.plots.len(), 1.0);
                        shares[first + offered] = LEAST_SHARE;
                    }
                }
            }
            visit.shares = first..shares.len();
        }
    }

    /// The outcomes of up to [`LANES`] visits.
    fn update(&mut self, visits: Range<usize>, site: &Site) {
        let Self { config, rules, plots, tracks, shares, room, group, workspaces, outcomes, .. } = self;
        let visits = &self.visits[visits];
        let plain = !self.in_groups || visits.len() < LEAST_GROUP || !Group::takes(rules.association);
        outcomes.clear();
        if !plain {
            let members = visits.iter().map(|visit| {
                let track = &tracks[visit.track];
                Member {
                    prediction: &track.next.prediction,
                    time_ns: track.next.time_ns,
                    plots: plots.measurements(visit.plots.clone()),
                    surroundings: site.surroundings(
                        config,
                        &track.amplitude,
                        &shares[visit.shares.clone()],
                        visit.turn,
                    ),
                }
            });
            group.update(&site.kernel, members, rules, workspaces, outcomes);
            return;
        }
        for (visit, workspace) in visits.iter().zip(workspaces) {
            let LiveTrack { hypotheses, next: passage, amplitude, time_ns, .. } = &mut tracks[visit.track];
            let surroundings = site.surroundings(config, amplitude, &shares[visit.shares.clone()], visit.turn);
            let offered = plots.measurements(visit.plots.clone());
            outcomes.push(match hypotheses {
                Some(hypotheses) => {
                    let step_s = seconds_between(*time_ns, passage.time_ns).max(0.0);
                    hypotheses.predict(&transition(site.kinematics.stay, step_s), &site.kinematics.motion, step_s);
                    hypotheses.update(passage.time_ns, offered, &surroundings, rules, workspace, room)
                }
                None => update(&passage.prediction, passage.time_ns, offered, &surroundings, rules, workspace),
            });
        }
    }

    /// Takes over what the update in `lane` made of a visit, and predicts the next. Returns the index of the plot that the track is
    /// sure of, or would be without other tracks.
    fn settle(&mut self, visit: &Visit, lane: usize, site: &Site) -> Option<usize> {
        let Self { config, sweep, plots, tracks, workspaces, outcomes, claims, .. } = self;
        let (track, workspace, outcome) = (&mut tracks[visit.track], &workspaces[lane], &outcomes[lane]);
        let passage = track.next;
        let turns = ((passage.angle_rad - track.angle_rad) / TAU).round().max(1.0) as u32;
        if turns > 1 {
            track.life.pass(turns - 1, config);
        }
        track.time_ns = passage.time_ns;
        track.angle_rad = passage.angle_rad;
        track.searched_to_rad = passage.due_rad();
        if sweep.has_seen(passage.angle_rad) || outcome.plots_in_gate > 0 {
            track.posterior = outcome.posterior;
            track.life.observe(track.evidence(outcome), outcome.weight_none < MISS_WEIGHT, config);
        } else {
            track.posterior = passage.prediction;
            track.life.pass(1, config);
        }
        let offered = plots.measurements(visit.plots.clone());
        claims.clear();
        for (candidate, weights) in workspace.candidates.iter().zip(&workspace.weights) {
            let weight = track.posterior.average(weights);
            let plot = &offered[candidate.plot];
            if plot.has_power {
                track.amplitude.learn(plot.power, weight, &site.detector);
            }
            claims.push((candidate.plot, weight));
        }
        let first = visit.plots.start;
        let origin = |plot: usize| (plots.entry(first + plot).seq, plots.entry(first + plot).index);
        track.last_scan = LastScan::new(outcome, &passage, claims, offered, origin, &site.radar);
        for &(plot, weight) in claims.iter() {
            let entry = plots.entry_mut(first + plot);
            entry.claimed = entry.claimed.max(weight * track.life.existence);
            if track.life.is_confirmed() {
                entry.explained = entry.explained.max(weight);
            }
        }
        track.last = passage;
        let (time_ns, angle_rad) = (track.time_ns, track.angle_rad);
        track.next = site.kinematics.passage(&track.posterior, time_ns, angle_rad, 1.0, sweep, &site.radar);
        if !track.next.prediction.is_sound() {
            track.life.state = TERMINATED;
        }
        let own = outcome.best.filter(|(_, weight)| *weight > MISS_WEIGHT);
        let best = own.or_else(|| workspace.best_alone(claims).filter(|_| outcome.ratio_alone > 1.0));
        best.map(|(best, _)| first + best)
    }

    /// Gives `plot` to track `index`, or leaves it to a stronger one that took it before. Returns the index of the weaker of the two.
    fn own(&mut self, plot: usize, index: usize) -> Option<usize> {
        let entry = self.plots.entry_mut(plot);
        let before = entry.owner.and_then(|id| self.tracks.binary_search_by_key(&id, |track| track.id).ok());
        let Some(other) = before.filter(|&other| other != index && self.tracks[other].life.state != TERMINATED) else {
            entry.owner = Some(self.tracks[index].id);
            return None;
        };
        let index_is_weaker = self.tracks[index].rank() < self.tracks[other].rank();
        let (weaker, stronger) = if index_is_weaker { (index, other) } else { (other, index) };
        let id = self.tracks[stronger].id;
        entry.owner = Some(id);
        self.tracks[weaker].note_twin(id);
        Some(weaker)
    }

    /// Ends a track that has followed the same plots as stronger ones for some scans.
    fn merge_duplicate(&mut self, index: usize, tracks: &mut Vec<Track>) {
        let Some(Twin { id: other_id, scans, .. }) = self.tracks[index].twin else { return };
        let Ok(other) = self.tracks.binary_search_by_key(&other_id, |track| track.id) else { return };
        let (a, b) = (&self.tracks[index], &self.tracks[other]);
        if b.life.state == TERMINATED || a.life.state == TERMINATED {
            return;
        }
        let needed = SHARED_SCANS[usize::from(a.life.is_confirmed() && b.life.is_confirmed())];
        if scans < needed || a.velocity_distance(b) > SAME_VELOCITY {
            return;
        }
        self.tracks[index].life.state = TERMINATED;
        let message = self.tracks[index].message();
        match tracks.iter_mut().find(|track| track.id == message.id) {
            Some(track) => *track = message,
            None => tracks.push(message),
        }
    }

    /// Settles the plots that no confirmed track can still claim; those not explained feed the clutter map and,
    /// paired with one of the turn before, start tentative tracks.
    fn start_tracks(&mut self, covered_rad: f64, site: &mut Site, tracks: &mut Vec<Track>) {
        let claimed_from = self
            .tracks
            .iter()
            .map(|track| track.next.angle_rad - track.next.half_width_rad)
            .fold(covered_rad, f64::min);
        while let Some(index) = self.plots.settle(claimed_from) {
            let entry = *self.plots.entry(index);
            let last = self.plots.measurements(index..index + 1)[0];
            let turn = (entry.angle_rad / TAU).max(0.0) as u32;
            let mut claimed = entry.claimed;
            if entry.explained <= EXPLAINED
                && entry.owner.is_none()
                && let Some(track) = self.start(&last, &entry, turn, site)
            {
                claimed = claimed.max(track.life.existence);
                self.plots.entry_mut(index).owner = Some(track.id);
                tracks.push(track.message());
                self.tracks.push(track);
            }
            site.clutter.observe(&last, 1.0 - claimed, turn);
        }
    }

    /// A tentative track that ends at the plot `last`, if there is a plot of the turn before to begin it.
    fn start(&mut self, last: &Measurement, entry: &Entry, turn: u32, site: &Site) -> Option<LiveTrack> {
        let (previous, step_s) = self.partner(last, entry.angle_rad)?;
        let existence = site.start_existence(&previous, last, step_s, turn, &self.reach, &self.config);
        if existence < LEAST_EXISTENCE {
            return None;
        }
        let posterior = two_plots(&previous, last, step_s, &site.kinematics.motion, START_PROBABILITY);
        if !posterior.is_sound() {
            return None;
        }
        let mut amplitude = Amplitude::prior(&self.config, &site.detector);
        for plot in [&previous, last].into_iter().filter(|plot| plot.has_power) {
            amplitude.learn(plot.power, 1.0, &site.detector);
        }
        let id = self.next_id;
        self.next_id += 1;
        let (time_ns, angle_rad) = (last.time_ns, entry.angle_rad);
        Some(LiveTrack {
            id,
            posterior,
            hypotheses: (self.config.association == Association::Mht)
                .then(|| Hypotheses::new(&posterior, self.config.hypotheses as usize)),
            time_ns,
            angle_rad,
            searched_to_rad: angle_rad,
            next: site.kinematics.passage(&posterior, time_ns, angle_rad, 1.0, &self.sweep, &site.radar),
            last: Passage { prediction: posterior, time_ns, angle_rad, half_width_rad: 0.0 },
            life: Life::start(existence, &self.config),
            amplitude,
            last_scan: LastScan {
                weight_none: 0.0,
                weight_best: 1.0,
                plots_in_gate: 1,
                best_plot: (entry.seq, entry.index),
                ..LastScan::EMPTY
            },
            twin: None,
        })
    }

    /// The best plot of the turn before for a start, and the time between the two.
    fn partner(&self, last: &Measurement, angle_rad: f64) -> Option<(Measurement, f64)> {
        let reach_rad = self.reach.azimuth_rad(last, self.sweep.period_s() * 1.5);
        let range = self.plots.between(angle_rad - TAU - reach_rad, angle_rad - TAU + reach_rad);
        let mut best: Option<(f64, usize, f64)> = None;
        for (index, previous) in range.clone().zip(self.plots.measurements(range)) {
            let step_s = seconds_between(previous.time_ns, last.time_ns);
            if step_s < 0.25 * self.sweep.period_s() || self.plots.entry(index).explained > EXPLAINED {
                continue;
            }
            if let Some(misfit) = self.reach.misfit(previous, last, step_s)
                && best.is_none_or(|(least, ..)| misfit < least)
            {
                best = Some((misfit, index, step_s));
            }
        }
        best.map(|(_, index, step_s)| (self.plots.measurements(index..index + 1)[0], step_s))
    }
}
