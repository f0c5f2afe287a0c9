//! Passages of the beam over tracks: which plots each is offered, what they are worth to it, and what becomes of it.
//!
//! All passages of a message are taken together, the confirmed tracks' first: what these explain is no evidence for tentative ones. All of a
//! kind are offered their plots before any is updated, so what they know of each other is from before the message.

use std::f64::consts::TAU;
use std::ops::Range;

use common::angle;
use common::config::Association;
use common::tracks::{TERMINATED, Track};
use common::units::seconds_between;

use super::{EXPLAINED, Tracker};
use crate::association::hypotheses::Room;
use crate::association::joint::{LEAST_SHARE, Sharing};
use crate::association::rivals::Rivals;
use crate::environment::Site;
use crate::filter::uav::batch::LANES;
use crate::filter::uav::group::{Group, Member};
use crate::filter::uav::imm::transition;
use crate::filter::uav::update::{Outcome, Workspace, update};
use crate::plots::index::{PlotIndex, Window};
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::tracks::handle::Handle;
use crate::tracks::track::{LastScan, LiveTrack, MISS_WEIGHT, Meeting};

/// A prediction is renewed if the beam will pass this much earlier or later than it was made for, s.
const TIMING_S: f64 = 0.02;
/// Tracks due at once from which updating them as a group costs less than one by one.
const LEAST_GROUP: usize = 3;
/// Probability of not being resolved below which two tracks are apart.
const APART: f64 = 0.5;

/// Room for the passages of a message, reused.
#[derive(Debug)]
pub(super) struct Passages {
    /// Whether tracks are updated in groups where that is possible.
    pub(super) in_groups: bool,
    pub(super) rivals: Rivals,
    /// Places of the tracks due.
    due: Vec<usize>,
    /// Those that the beam has not reached before the stream ended.
    unreached: Vec<Handle>,
    visits: Vec<Visit>,
    index: PlotIndex,
    /// Plots of the index that lie in a window.
    found: Vec<u32>,
    near: Vec<usize>,
    offers: Offers,
    sharing: Sharing,
    group: Group,
    /// Candidates and weights of the visits at hand.
    workspaces: [Workspace; LANES],
    /// What became of them.
    outcomes: Vec<Outcome>,
    meetings: Vec<(usize, Meeting)>,
    /// Stored plots and weights of the track at hand.
    claims: Vec<(usize, f64)>,
    room: Room,
}

impl Default for Passages {
    fn default() -> Self {
        Self {
            in_groups: true,
            rivals: Rivals::default(),
            due: Vec::new(),
            unreached: Vec::with_capacity(256),
            visits: Vec::new(),
            index: PlotIndex::default(),
            found: Vec::new(),
            near: Vec::new(),
            offers: Offers::default(),
            sharing: Sharing::default(),
            group: Group::default(),
            workspaces: Default::default(),
            outcomes: Vec::new(),
            meetings: Vec::new(),
            claims: Vec::with_capacity(256),
            room: Room::default(),
        }
    }
}

/// The passage of the beam over a track: [`LiveTrack::next`].
#[derive(Debug, Clone)]
struct Visit {
    /// The track.
    place: usize,
    /// Turn of the beam, for the clutter map.
    turn: u32,
    /// Plots before this angle have been offered to the track.
    from_rad: f64,
    /// Its plots among the offers; the last of them are common to two tracks.
    offered: Range<usize>,
    common: usize,
    /// See [`crate::association::joint::Shared`].
    evidence: f64,
    is_apart: bool,
}

/// The plots that the tracks of a message are offered.
#[derive(Debug, Default)]
struct Offers {
    measurements: Vec<Measurement>,
    /// What each is worth among several tracks.
    shares: Vec<f64>,
    /// Where each is stored.
    origins: Vec<usize>,
}

impl Offers {
    /// Forgets all, and makes room for twice as many: that of a message varies by chance, and should not grow for ever.
    fn clear(&mut self) {
        let room = 2 * self.measurements.len();
        self.measurements.clear();
        self.measurements.reserve(room);
        self.shares.clear();
        self.shares.reserve(room);
        self.origins.clear();
        self.origins.reserve(room);
    }

    fn push(&mut self, measurement: Measurement, share: f64, origin: usize) {
        self.measurements.push(measurement);
        self.shares.push(share);
        self.origins.push(origin);
    }
}

impl Tracker {
    /// Processes the tracks whose gates the beam has passed, in the order in which it did. At the end of the
    /// stream those follow whose target was passed, as nothing more will come.
    pub(super) fn process_due(&mut self, covered_rad: f64, ended: bool, site: &Site, tracks: &mut Vec<Track>) {
        let Self { agenda, tracks: roster, passages, .. } = self;
        let Passages { rivals, due, unreached, .. } = passages;
        rivals.suit(&site.radar, roster);
        due.clear();
        while let Some(handle) = agenda.take_due(if ended { f64::INFINITY } else { covered_rad }) {
            match roster.find(handle) {
                Some(place) if ended && roster[place].next.angle_rad > covered_rad => unreached.push(handle),
                Some(place) => due.push(place),
                None => {}
            }
        }
        for handle in unreached.drain(..) {
            agenda.note(handle, &roster[handle.place as usize].next);
        }
        due.sort_unstable_by(|&a, &b| {
            let (a, b) = (&roster[a], &roster[b]);
            let by_passage = a.next.due_rad().total_cmp(&b.next.due_rad()).then(a.id.cmp(&b.id));
            b.life.is_confirmed().cmp(&a.life.is_confirmed()).then(by_passage)
        });
        let confirmed = due.partition_point(|&place| roster[place].life.is_confirmed());
        for range in [0..confirmed, confirmed..due.len()] {
            self.visit(range, covered_rad, site);
            self.offer(site);
            self.settle_all(site, tracks);
        }
    }

    /// Begins the visits to a range of the tracks due.
    fn visit(&mut self, due: Range<usize>, covered_rad: f64, site: &Site) {
        let Self { config, sweep, tracks, passages, .. } = self;
        passages.visits.clear();
        for &place in &passages.due[due] {
            let track = &mut tracks[place];
            // Whole turns may have been lost: the passage that counts is the last one covered.
            let lost_turns = ((covered_rad - track.next.due_rad()) / TAU).floor();
            if lost_turns >= 1.0 {
                track.next.angle_rad += lost_turns * TAU;
            }
            let to_ns = sweep.time_at(track.next.angle_rad);
            if seconds_between(track.next.time_ns, to_ns).abs() > TIMING_S {
                let meeting = Meeting { from_ns: track.time_ns, to_ns, angle_rad: track.next.angle_rad };
                track.next = site.kinematics.passage(&track.posterior, &meeting, sweep, &site.radar);
                passages.rivals.note(place, track);
            }
            track.amplitude.look(config, &site.detector);
            passages.visits.push(Visit {
                place,
                turn: (track.next.angle_rad / TAU).max(0.0) as u32,
                from_rad: track.next.begins_rad().max(track.searched_to_rad),
                offered: 0..0,
                common: 0,
                evidence: 1.0,
                is_apart: true,
            });
        }
    }

    /// Finds the plots of each visit, and what they are worth among several tracks.
    fn offer(&mut self, site: &Site) {
        let Self { config, rules, plots, tracks, passages, .. } = self;
        let Passages { rivals, visits, index, found, near, offers, sharing, .. } = passages;
        offers.clear();
        let due = |visit: &Visit| tracks[visit.place].next.due_rad();
        let from_rad = visits.iter().map(|visit| visit.from_rad).fold(f64::INFINITY, f64::min);
        let stored = plots.between(from_rad, visits.iter().map(due).fold(f64::NEG_INFINITY, f64::max));
        let mut variance = site.radar.variance[0];
        let all = plots.measurements(stored.clone());
        index.build(all.iter().inspect(|plot| variance = variance.max(plot.variance[0])));
        // √(p + σ²) grows by less than σ does.
        let margin_m = rules.alpha * (variance.sqrt() - site.radar.variance[0].sqrt());
        let shares_plots =
            config.joint_association && !matches!(rules.association, Association::Nearest | Association::Strongest);
        for visit in visits {
            let track = &tracks[visit.place];
            let rivals = shares_plots.then(|| rivals.of(visit.place, tracks)).into_iter().flatten();
            let mut range_m = track.next.range_m;
            for (_, expects) in rivals.clone() {
                range_m = [range_m[0].min(expects.range_m[0]), range_m[1].max(expects.range_m[1])];
            }
            let window = Window {
                azimuth_rad: angle::wrap(track.next.angle_rad),
                half_azimuth_rad: track.next.half_width_rad,
                range_m: [range_m[0] - margin_m, range_m[1] + margin_m],
                elevation_rad: Window::ANY_ELEVATION,
            };
            index.find(&window, found);
            near.clear();
            near.extend(found.iter().map(|&plot| stored.start + plot as usize));
            near.retain(|&plot| (visit.from_rad..=track.next.due_rad()).contains(&plots.entry(plot).angle_rad));
            near.sort_unstable();
            let first = offers.measurements.len();
            for &plot in near.iter() {
                let explained =
                    !track.life.is_confirmed() && config.joint_association && plots.entry(plot).explained > EXPLAINED;
                let share = if explained { LEAST_SHARE } else { 1.0 };
                offers.push(plots.measurements(plot..plot + 1)[0], share, plot);
            }
            visit.common = offers.measurements.len();
            let own = site.claimant(config, track, &track.next);
            let rivals = rivals.map(|(rival, expects)| site.claimant(config, rival, expects));
            let clutter = |polar: &[f64; COORDINATES]| site.clutter.at(polar, visit.turn, None);
            let shared =
                sharing.share(&own, rivals, &offers.measurements[first..], clutter, &site.radar, rules.inflation);
            for (share, &other) in offers.shares[first..].iter_mut().zip(shared.shares) {
                *share = share.min(other);
            }
            for common in shared.common {
                offers.push(common.measurement, common.share, offers.origins[first + common.plot]);
            }
            visit.evidence = shared.evidence;
            visit.is_apart = shared.unresolved < APART;
            visit.offered = first..offers.measurements.len();
        }
    }

    /// Updates the tracks of all visits, in groups, and merges those that turn out to be one.
    fn settle_all(&mut self, site: &Site, tracks: &mut Vec<Track>) {
        for first in (0..self.passages.visits.len()).step_by(LANES) {
            let group = first..self.passages.visits.len().min(first + LANES);
            self.update(group.clone(), site);
            for (lane, position) in group.clone().enumerate() {
                let visit = self.passages.visits[position].clone();
                if !self.tracks.is_alive(visit.place) {
                    continue;
                }
                let best = self.settle(&visit, lane, site);
                tracks.push(self.tracks[visit.place].message());
                if let Some(weaker) = best.and_then(|plot| self.own(plot, visit.place)) {
                    self.merge_duplicate(weaker, tracks);
                }
            }
            self.predict(group, site, tracks);
        }
    }

    /// The outcomes of up to [`LANES`] visits.
    fn update(&mut self, visits: Range<usize>, site: &Site) {
        let Self { config, rules, tracks, passages, .. } = self;
        let Passages { in_groups, offers, group, workspaces, outcomes, room, .. } = passages;
        let visits = &passages.visits[visits];
        outcomes.clear();
        if *in_groups && visits.len() >= LEAST_GROUP && Group::takes(rules.association) {
            let members = visits.iter().map(|visit| {
                let LiveTrack { next: passage, amplitude, .. } = &tracks[visit.place];
                Member {
                    prediction: &passage.prediction,
                    time_ns: passage.time_ns,
                    plots: &offers.measurements[visit.offered.clone()],
                    surroundings: site.surroundings(
                        config,
                        amplitude,
                        &offers.shares[visit.offered.clone()],
                        visit.turn,
                    ),
                }
            });
            group.update(&site.kernel, members, rules, workspaces, outcomes);
            return;
        }
        for (visit, workspace) in visits.iter().zip(workspaces) {
            let LiveTrack { hypotheses, next: passage, amplitude, time_ns, .. } = &mut tracks[visit.place];
            let surroundings = site.surroundings(config, amplitude, &offers.shares[visit.offered.clone()], visit.turn);
            let offered = &offers.measurements[visit.offered.clone()];
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

    /// Takes over what the update in `lane` made of a visit. Returns the stored plot that the track is
    /// sure of, or would be without other tracks.
    fn settle(&mut self, visit: &Visit, lane: usize, site: &Site) -> Option<usize> {
        let Self { config, sweep, plots, tracks, passages, .. } = self;
        let Passages { offers, workspaces, outcomes, claims, .. } = passages;
        let (track, workspace, outcome) = (&mut tracks[visit.place], &workspaces[lane], &outcomes[lane]);
        let was_confirmed = track.life.is_confirmed();
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
            let evidence = track.evidence(outcome, visit.evidence);
            track.life.observe(evidence, outcome.weight_none < MISS_WEIGHT, config);
        } else {
            track.posterior = passage.prediction;
            track.life.pass(1, config);
        }
        // The plots that are its own come before those that it has in common with another.
        claims.clear();
        let threshold = outcome.selection.threshold.max(site.detector.threshold);
        let mut alone: Option<(usize, f64)> = None;
        let mut surest_own = 0.0_f64;
        for (candidate, weights) in workspace.candidates.iter().zip(&workspace.weights) {
            let weight = track.posterior.average(weights);
            let offer = visit.offered.start + candidate.plot;
            let origin = offers.origins[offer];
            match claims.iter_mut().find(|(plot, _)| offer >= visit.common && *plot == origin) {
                Some((_, sum)) => *sum += weight,
                None => claims.push((origin, weight)),
            }
            if offer < visit.common {
                surest_own = surest_own.max(weight);
                let plot = &offers.measurements[offer];
                // Of several hypotheses each has its own threshold; that of the best one is taken.
                if plot.has_power && plot.power >= threshold {
                    track.amplitude.learn(plot.power, weight, threshold);
                }
                let weight = if candidate.ratio > 0.0 { weight * (candidate.alone / candidate.ratio) } else { 0.0 };
                if alone.is_none_or(|(_, most)| weight > most) {
                    alone = Some((origin, weight));
                }
            }
        }
        if track.life.is_confirmed() && visit.is_apart && surest_own > MISS_WEIGHT {
            track.scans_apart = track.scans_apart.saturating_add(1);
        }
        let origin = |plot: usize| {
            let entry = plots.entry(plot);
            (entry.seq, entry.index, &plots.measurements(plot..plot + 1)[0])
        };
        track.last_scan = LastScan::new(outcome, claims, origin, &workspace.gates, passage.time_ns);
        let in_common = |plot: usize| visit.offered.start + plot >= visit.common;
        let common = workspace.candidates.iter().filter(|candidate| in_common(candidate.plot)).count();
        track.last_scan.plots_in_gate -= common as u32;
        for &(plot, weight) in claims.iter() {
            let entry = plots.entry_mut(plot);
            entry.claimed = entry.claimed.max(weight * track.life.existence);
            if track.life.is_confirmed() {
                entry.explained = entry.explained.max(weight);
            }
        }
        track.last = passage;
        self.confirmed = self.confirmed + u32::from(track.life.is_confirmed()) - u32::from(was_confirmed);
        if track.life.state == TERMINATED {
            self.end(visit.place);
        }
        let claims = &self.passages.claims;
        let best = claims.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        let ratio_alone = self.passages.outcomes[lane].ratio_alone;
        let own = best.filter(|(_, weight)| *weight > MISS_WEIGHT);
        own.or_else(|| alone.filter(|_| ratio_alone > 1.0)).map(|(plot, _)| plot)
    }

    /// Predicts the next passages of the tracks of up to [`LANES`] visits that are still alive.
    fn predict(&mut self, visits: Range<usize>, site: &Site, messages: &mut Vec<Track>) {
        let Self { sweep, tracks, passages, .. } = self;
        let Passages { in_groups, visits: all, group, meetings, .. } = passages;
        meetings.clear();
        for visit in all[visits].iter().filter(|visit| tracks.is_alive(visit.place)) {
            let LiveTrack { posterior, time_ns, angle_rad, .. } = &tracks[visit.place];
            let meeting = site.kinematics.meeting(posterior, *time_ns, *angle_rad, 1.0, sweep);
            meetings.push((visit.place, meeting));
        }
        if *in_groups && meetings.len() >= LEAST_GROUP {
            let posteriors = meetings.iter().map(|&(place, meeting)| (&tracks[place].posterior, meeting));
            let mut passages = [None; LANES];
            let stay = site.kinematics.stay;
            group.predict(&site.kernel, stay, sweep.period_s(), posteriors, |lane, next| passages[lane] = Some(next));
            for (&(place, _), next) in meetings.iter().zip(passages) {
                if let Some(next) = next {
                    tracks[place].next = next;
                }
            }
        } else {
            for (place, meeting) in meetings.iter() {
                let track = &mut tracks[*place];
                track.next = site.kinematics.passage(&track.posterior, meeting, sweep, &site.radar);
            }
        }
        for index in 0..self.passages.meetings.len() {
            let place = self.passages.meetings[index].0;
            let track = &self.tracks[place];
            if track.next.prediction.is_sound() {
                self.passages.rivals.note(place, track);
                self.agenda.note(self.tracks.handle(place), &track.next);
            } else {
                self.end_and_tell(place, messages);
            }
        }
    }
}
