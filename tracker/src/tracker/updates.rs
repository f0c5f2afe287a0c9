//! Association and update at each detection opportunity: which plots each track is offered, what they are worth to it, and what becomes of it.
//!
//! All tracks that a message brings up to date are taken together, the confirmed ones first: what these explain is no evidence for tentative
//! ones. All of a kind are offered their plots before any is updated, so what they know of each other is from before the message.

use std::f64::consts::TAU;
use std::ops::Range;

use common::tracks::{TERMINATED, Track};
use common::units::seconds_between;

use super::Tracker;
use super::forecast::next_detection;
use crate::association::GateLoad;
use crate::association::hypotheses::{Means, Room};
use crate::association::joint::{LEAST_SHARE, Sharing};
use crate::association::rivals::{MOST_NEAR, Plots, Rivals};
use crate::association::scan::{Member, Scan};
use crate::beam::opportunity::DetectionTime;
use crate::constants::{APART, EXPLAINED, MISS_WEIGHT, TIMING_S};
use crate::environment::Environment;
use crate::filter::{LANES, Layout, Machine, Mixture, Moments};
use crate::plots::index::{PlotIndex, Window};
use crate::plots::measurement::Measurement;
use crate::tracks::handle::Handle;
use crate::tracks::message;
use crate::tracks::states::Of;
use crate::tracks::track::{LastScan, LiveTrack};

/// Room for the updates of a message, reused.
#[derive(Debug)]
pub(super) struct Updates {
    pub(super) rivals: Rivals,
    handles: Vec<Handle>,
    /// The tracks due.
    due: Vec<Due>,
    /// Those that the beam has not reached before the stream ended.
    unreached: Vec<Handle>,
    pending: Vec<Pending>,
    index: PlotIndex,
    /// Plots of the index that lie in a window.
    found: Vec<u32>,
    near: Vec<usize>,
    /// The rivals of the track at hand.
    rivals_near: Vec<(usize, Of)>,
    offered: Offered,
    sharing: Sharing,
    /// Up to eight of the pending updates.
    scan: Scan,
    /// Of their posteriors and of their predictions.
    moments: [Moments; 2],
    times: Vec<DetectionTime>,
    /// Plots that the track at hand takes.
    shares: Vec<PlotShare>,
    room: Room,
}

impl Updates {
    pub(super) fn new(layout: &Layout, inflation: f64) -> Self {
        Self {
            rivals: Rivals::default(),
            handles: Vec::with_capacity(256),
            due: Vec::new(),
            unreached: Vec::with_capacity(256),
            pending: Vec::new(),
            index: PlotIndex::default(),
            found: Vec::new(),
            near: Vec::with_capacity(256),
            rivals_near: Vec::with_capacity(MOST_NEAR),
            offered: Offered::default(),
            sharing: Sharing::new(layout, Machine::default(), inflation),
            scan: Scan::new(layout),
            moments: Default::default(),
            times: Vec::with_capacity(LANES),
            shares: Vec::with_capacity(256),
            room: Room::new(layout),
        }
    }

    /// Computes with other instructions.
    pub(super) fn on(&mut self, machine: Machine) {
        self.sharing.on(machine);
    }
}

/// A track whose gates the beam has passed, and what it is sorted by.
#[derive(Debug, Clone, Copy)]
struct Due {
    is_confirmed: bool,
    angle_rad: f64,
    handle: Handle,
}

/// The update of a track at its detection opportunity [`next`](crate::tracks::track::LiveTrack::next).
#[derive(Debug, Clone)]
struct Pending {
    /// The track.
    place: usize,
    /// Turn of the beam, for the clutter map.
    turn: u32,
    /// Plots before this angle have been offered to the track.
    from_rad: f64,
    /// Its plots among those offered; the last of them are common to two tracks.
    offered: Range<usize>,
    common: usize,
    /// See [`crate::association::joint::Shared`].
    evidence: f64,
    is_apart: bool,
}

/// A stored plot that a track takes.
#[derive(Debug, Clone, Copy)]
struct PlotShare {
    plot: usize,
    weight: f64,
    /// The components in whose gates it lies, a bit each.
    gates: u32,
}

/// The plots that the tracks of a message are offered.
#[derive(Debug, Default)]
struct Offered {
    measurements: Vec<Measurement>,
    /// What each is worth among several tracks.
    shares: Vec<f64>,
    /// Where each is stored.
    origins: Vec<usize>,
}

impl Offered {
    /// Forgets all. Where that was more than half of the room, there is four times as much from now on: how many are offered varies by chance,
    /// and room should not grow for ever.
    fn clear(&mut self) {
        let room =
            if 2 * self.measurements.len() > self.measurements.capacity() { 4 * self.measurements.len() } else { 0 };
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
    /// Updates the tracks whose gates the beam has passed, in the order in which it did. At the end of the
    /// stream those follow whose target was passed, as nothing more will come.
    pub(super) fn update_due(
        &mut self,
        covered_rad: f64,
        ended: bool,
        environment: &Environment,
        messages: &mut Vec<Track>,
    ) {
        let Self { agenda, tracks, updates, .. } = self;
        let Updates { handles, due, unreached, .. } = updates;
        due.clear();
        handles.clear();
        while let Some(handle) = agenda.pop_due(if ended { f64::INFINITY } else { covered_rad }) {
            handles.push(handle);
        }
        for &handle in handles.iter() {
            let Some(place) = tracks.find(handle) else { continue };
            let track = &tracks[place];
            if ended && track.next.angle_rad > covered_rad {
                unreached.push(handle);
            } else {
                due.push(Due { is_confirmed: track.life.is_confirmed(), angle_rad: track.next.due_rad(), handle });
            }
        }
        for handle in unreached.drain(..) {
            agenda.add(handle, &tracks[handle.place as usize].next);
        }
        due.sort_unstable_by(|a, b| {
            let by_beam = a.angle_rad.total_cmp(&b.angle_rad).then(a.handle.cmp(&b.handle));
            b.is_confirmed.cmp(&a.is_confirmed).then(by_beam)
        });
        let confirmed = due.partition_point(|due| due.is_confirmed);
        for range in [0..confirmed, confirmed..due.len()] {
            if !range.is_empty() {
                self.prepare(range, covered_rad, environment);
                self.offer_plots(environment);
                self.update_all(environment, messages);
            }
        }
    }

    /// Prepares the updates of a range of the tracks due.
    fn prepare(&mut self, due: Range<usize>, covered_rad: f64, environment: &Environment) {
        let Self { config, rules, sweep, tracks, updates, forecast, .. } = self;
        updates.pending.clear();
        for place in updates.due[due].iter().map(|due| due.handle.place as usize) {
            let track = &mut tracks[place];
            // Whole turns may have been lost: the opportunity that counts is the last one covered.
            let lost_turns = ((covered_rad - track.next.due_rad()) / TAU).floor();
            if lost_turns >= 1.0 {
                track.next.angle_rad += lost_turns * TAU;
            }
            let to_ns = sweep.time_at(track.next.angle_rad);
            if seconds_between(track.next.time_ns, to_ns).abs() > TIMING_S {
                let time = DetectionTime { from_ns: track.time_ns, to_ns, angle_rad: track.next.angle_rad };
                if forecast.predict_one(environment, rules.alpha, tracks, place, time, sweep) {
                    updates.rivals.record(place, &tracks[place]);
                }
            }
            let track = &mut tracks[place];
            track.amplitude.renew_statistics(config, &environment.detector);
            updates.pending.push(Pending {
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

    /// Finds the plots of each track, and what they are worth among several tracks.
    fn offer_plots(&mut self, environment: &Environment) {
        let Self { config, rules, sweep, plots, tracks, updates, .. } = self;
        let Updates { rivals, pending, index, found, near, rivals_near, offered, sharing, .. } = updates;
        offered.clear();
        rivals_near.clear();
        let due = |pending: &Pending| tracks[pending.place].next.due_rad();
        let from_rad = pending.iter().map(|pending| pending.from_rad).fold(f64::INFINITY, f64::min);
        let stored = plots.between(from_rad, pending.iter().map(due).fold(f64::NEG_INFINITY, f64::max));
        let mut variance = environment.radar.variance[0];
        let mut some_are_flat = false;
        let all = plots.measurements(stored.clone());
        index.build(all.iter().inspect(|plot| {
            variance = variance.max(plot.variance[0]);
            some_are_flat |= !plot.measured[2];
        }));
        // √(p + σ²) grows by less than σ does.
        let margin_m = rules.alpha * (variance.sqrt() - environment.radar.variance[0].sqrt());
        let shares_plots = config.joint_association && !rules.association.decides();
        if shares_plots {
            rivals.review(tracks);
        }
        for pending in pending {
            let track = &tracks[pending.place];
            if shares_plots {
                rivals.find(pending.place, tracks, Plots { margin_m, some_are_flat }, rivals_near);
            }
            let mut range_m = track.next.range_m;
            for &(rival, of) in rivals_near.iter() {
                let expects = tracks[rival].opportunity(of);
                range_m = [range_m[0].min(expects.range_m[0]), range_m[1].max(expects.range_m[1])];
            }
            let window = Window {
                azimuth_rad: sweep.azimuth_at(track.next.angle_rad, track.next.position_m),
                half_azimuth_rad: track.next.half_width_rad,
                range_m: [range_m[0] - margin_m, range_m[1] + margin_m],
                elevation_rad: Window::ANY_ELEVATION,
            };
            index.find(&window, found);
            near.clear();
            near.extend(found.iter().map(|&plot| stored.start + plot as usize));
            near.retain(|&plot| (pending.from_rad..=track.next.due_rad()).contains(&plots.entry(plot).angle_rad));
            near.sort_unstable();
            let first = offered.measurements.len();
            let expected_mps = || {
                let prediction = tracks.states.prediction_words(pending.place, Of::NextScan);
                Mixture::new(environment.filter.layout(), prediction).range_rate_mps()
            };
            let expected_mps = if environment.radar.range_rate_interval_mps > 0.0 { expected_mps() } else { 0.0 };
            for &plot in near.iter() {
                let explained =
                    !track.life.is_confirmed() && config.joint_association && plots.entry(plot).explained > EXPLAINED;
                let share = if explained { LEAST_SHARE } else { 1.0 };
                let mut measurement = *plots.measurement(plot);
                measurement.polar[3] = environment.radar.unfold(measurement.polar[3], expected_mps);
                offered.push(measurement, share, plot);
            }
            pending.common = offered.measurements.len();
            pending.offered = first..offered.measurements.len();
            if rivals_near.is_empty() {
                continue;
            }
            let states = &tracks.states;
            let own = states.prediction_words(pending.place, Of::NextScan);
            let own = environment.claimant(config, track, own, track.next.time_ns);
            let rivals = rivals_near.iter().map(|&(place, of)| {
                let (rival, prediction) = (&tracks[place], states.prediction_words(place, of));
                environment.claimant(config, rival, prediction, rival.opportunity(of).time_ns)
            });
            let clutter = environment.clutter.in_scan(pending.turn, track.own_plots);
            let shared = sharing.share(&own, rivals, &offered.measurements[first..], clutter, &environment.radar);
            for (share, &other) in offered.shares[first..].iter_mut().zip(shared.shares) {
                *share = share.min(other);
            }
            for common in shared.common {
                offered.push(common.measurement, common.share, offered.origins[first + common.plot]);
            }
            pending.evidence = shared.evidence;
            pending.is_apart = shared.unresolved < APART;
            pending.offered = first..offered.measurements.len();
        }
    }

    /// Updates all pending tracks in groups, and merges those that turn out to be one.
    fn update_all(&mut self, environment: &Environment, messages: &mut Vec<Track>) {
        for first in (0..self.updates.pending.len()).step_by(LANES) {
            let group = first..self.updates.pending.len().min(first + LANES);
            self.update_group(group.clone(), environment);
            for (lane, position) in group.clone().enumerate() {
                let pending = self.updates.pending[position].clone();
                if !self.tracks.is_alive(pending.place) {
                    continue;
                }
                let best = self.conclude(&pending, lane, environment);
                let Updates { moments: [posterior, prediction], .. } = &self.updates;
                let (track, state) = (&self.tracks[pending.place], self.tracks.states.posterior(pending.place));
                message::push(messages, track, environment.filter.as_ref(), state, [posterior, prediction], lane);
                if let Some(weaker) = best.and_then(|plot| self.assign_owner(plot, pending.place)) {
                    self.merge_duplicate(weaker, environment, messages);
                }
            }
            self.predict_group(group, environment, messages);
        }
    }

    /// The posteriors of up to [`LANES`] tracks, in the lanes and in the store.
    fn update_group(&mut self, group: Range<usize>, environment: &Environment) {
        let Self { config, rules, sweep, tracks, updates, .. } = self;
        let Updates { pending, offered, scan, moments, room, .. } = updates;
        let (pending, lanes) = (&pending[group.clone()], group.len());
        let Environment { filter, machine, radar, .. } = environment;
        for (lane, pending) in pending.iter().enumerate() {
            scan.prediction.load(lane, tracks.states.prediction_words(pending.place, Of::NextScan));
        }
        let member = |pending: &Pending| {
            let track = &tracks[pending.place];
            let shares = &offered.shares[pending.offered.clone()];
            Member {
                time_ns: track.next.time_ns,
                plots: &offered.measurements[pending.offered.clone()],
                surroundings: environment.surroundings(config, &track.amplitude, track.own_plots, shares, pending.turn),
            }
        };
        if rules.association == common::config::Association::Mht {
            scan.outcomes.clear();
            let means = Means { filter: filter.as_ref(), machine: *machine, rules };
            for (lane, pending) in pending.iter().enumerate() {
                let LiveTrack { hypotheses: Some(hypotheses), amplitude, own_plots, time_ns, next, .. } =
                    &mut tracks[pending.place]
                else {
                    unreachable!("a track of several hypotheses has some");
                };
                let shares = &offered.shares[pending.offered.clone()];
                let surroundings = environment.surroundings(config, amplitude, *own_plots, shares, pending.turn);
                let plots = &offered.measurements[pending.offered.clone()];
                hypotheses.predict(means, seconds_between(*time_ns, next.time_ns).max(0.0), room);
                let choice = &mut scan.choices[lane];
                let outcome = hypotheses.update(means, next.time_ns, plots, &surroundings, room, choice);
                scan.update.posterior.load(lane, room.posterior());
                scan.outcomes.push(outcome);
            }
        } else {
            scan.update(filter.as_ref(), *machine, pending.iter().map(member), radar, rules);
        }
        for (lane, pending) in pending.iter().enumerate() {
            if !(sweep.has_seen(tracks[pending.place].next.angle_rad) || scan.outcomes[lane].plots_in_gate > 0) {
                scan.update.posterior.copy_lane(lane, &scan.prediction);
            }
            scan.update.posterior.store(lane, tracks.states.posterior_mut(pending.place));
        }
        moments[0].evaluate(*machine, lanes, &scan.update.posterior);
        moments[1].evaluate(*machine, lanes, &scan.prediction);
    }

    /// Takes over what the scan made of the track in `lane`. Returns the stored plot that the track is
    /// sure of, or would be without other tracks.
    fn conclude(&mut self, pending: &Pending, lane: usize, environment: &Environment) -> Option<usize> {
        let Self { config, sweep, plots, tracks, updates, .. } = self;
        let Updates { offered, scan, shares, moments, .. } = updates;
        let (choice, outcome) = (&scan.choices[lane], &scan.outcomes[lane]);
        tracks.states.turn_over(pending.place);
        let track = &mut tracks[pending.place];
        let was_confirmed = track.life.is_confirmed();
        let spread = moments[0].spread(lane, &environment.radar);
        let offer = &offered.measurements[pending.offered.clone()];
        let false_plots = environment.clutter.in_scan(pending.turn, track.own_plots);
        let is_adrift = choice.best().is_some_and(|(plot, _)| {
            let gate = || GateLoad::new(&choice.candidates, offer, outcome.selection.volume);
            // A cell never holds more than one false plot on average.
            spread.volume > environment.clutter.cell_volume(&offer[plot])
                && spread.is_adrift(false_plots(&offer[plot]).crowded(gate()).density)
        });
        let turns = ((track.next.angle_rad - track.angle_rad) / TAU).round().max(1.0) as u32;
        if turns > 1 {
            track.life.pass(turns - 1, config);
        }
        track.time_ns = track.next.time_ns;
        track.angle_rad = track.next.angle_rad;
        track.searched_to_rad = track.next.due_rad();
        if sweep.has_seen(track.next.angle_rad) || outcome.plots_in_gate > 0 {
            let evidence = track.evidence(outcome, pending.evidence);
            let missed = outcome.selection.missed[outcome.selection.component];
            let evidence = if is_adrift { evidence.min(missed) } else { evidence };
            track.life.observe(evidence, outcome.weight_none < MISS_WEIGHT && !is_adrift, config);
        } else {
            track.life.pass(1, config);
        }
        let range_m = track.next.range_m[0].midpoint(track.next.range_m[1]);
        if spread.is_lost(&environment.radar, range_m, environment.limits.speed_mps, sweep.period_s()) {
            track.life.state = TERMINATED;
        }
        // The plots that are its own come before those that it has in common with another.
        shares.clear();
        let threshold = outcome.selection.threshold.max(environment.detector.threshold);
        let mut alone: Option<(usize, f64)> = None;
        let (mut surest_own, mut common) = (0.0_f64, 0);
        for (candidate, &weight) in choice.candidates.iter().zip(&choice.weights) {
            let offer = pending.offered.start + candidate.plot;
            let plot = offered.origins[offer];
            let is_common = offer >= pending.common;
            match shares.iter_mut().find(|share| is_common && share.plot == plot) {
                Some(share) => share.weight += weight,
                None if is_common => {
                    let gates = choice.gates_about(plots.measurement(plot), track.time_ns);
                    shares.push(PlotShare { plot, weight, gates });
                }
                None => shares.push(PlotShare { plot, weight, gates: candidate.gates }),
            }
            if is_common {
                common += 1;
                continue;
            }
            surest_own = surest_own.max(weight);
            let measurement = &offered.measurements[offer];
            // Of several hypotheses each has its own threshold; that of the best one is taken.
            if measurement.has_power && measurement.power >= threshold {
                track.amplitude.learn(measurement.power, weight, threshold);
            }
            let weight = if candidate.gain > 0.0 { weight * (candidate.alone / candidate.gain) } else { 0.0 };
            if alone.is_none_or(|(_, most)| weight > most) {
                alone = Some((plot, weight));
            }
        }
        if track.life.is_confirmed() && pending.is_apart && surest_own > MISS_WEIGHT {
            track.scans_apart = track.scans_apart.saturating_add(1);
        }
        track.last_scan = LastScan::new(outcome);
        track.last_scan.plots_in_gate -= common;
        let mut best: Option<(usize, f64)> = None;
        for share in shares.iter() {
            let entry = plots.entry_mut(share.plot);
            track.last_scan.add(entry.seq, entry.index, share.weight, share.gates);
            entry.claimed += (1.0 - entry.claimed) * share.weight * track.life.existence;
            if track.life.is_confirmed() {
                entry.explained = entry.explained.max(share.weight);
            }
            if best.is_none_or(|(_, most)| share.weight > most) {
                best = Some((share.plot, share.weight));
            }
        }
        environment.clutter.fade(&mut track.own_plots, turns);
        if let Some((plot, weight)) = best.filter(|(_, weight)| *weight > MISS_WEIGHT) {
            let unclaimed = 1.0 - weight * track.life.existence;
            environment.clutter.add_own(&mut track.own_plots, plots.measurement(plot), unclaimed);
        }
        track.last = track.next;
        let ends = track.life.state == TERMINATED;
        let ratio_alone = outcome.ratio_alone;
        self.confirmed = self.confirmed + u32::from(track.life.is_confirmed()) - u32::from(was_confirmed);
        if ends {
            self.end(pending.place);
        }
        let own = best.filter(|(_, weight)| *weight > MISS_WEIGHT);
        own.or_else(|| alone.filter(|_| ratio_alone > 1.0)).map(|(plot, _)| plot)
    }

    /// Predicts the tracks of a group that are still alive to their next detection opportunities.
    fn predict_group(&mut self, group: Range<usize>, environment: &Environment, messages: &mut Vec<Track>) {
        let Self { rules, sweep, agenda, tracks, updates, forecast, .. } = self;
        let Updates { rivals, pending, scan, moments, times, .. } = updates;
        let (first, pending) = (group.start, &pending[group]);
        times.clear();
        for (lane, pending) in pending.iter().enumerate() {
            let track = &tracks[pending.place];
            times.push(next_detection(&moments[0], lane, track.time_ns, track.angle_rad, sweep));
        }
        let mut unsound = [false; LANES];
        let posterior = &scan.update.posterior;
        forecast.predict(environment, rules.alpha, posterior, times, sweep, |lane, next, prediction| {
            let place = pending[lane].place;
            if !tracks.is_alive(place) {
                return;
            }
            let Some(prediction) = prediction else {
                unsound[lane] = true;
                return;
            };
            prediction.store(lane, tracks.states.prediction_mut(place, Of::NextScan));
            tracks[place].next = next;
            rivals.record(place, &tracks[place]);
            agenda.add(tracks.handle(place), &tracks[place].next);
        });
        for lane in (0..LANES).filter(|&lane| unsound[lane]) {
            self.end_and_tell(self.updates.pending[first + lane].place, environment, messages);
        }
    }
}
