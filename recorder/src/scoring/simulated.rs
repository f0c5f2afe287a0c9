//! Tracks against the simulator's truth, scan by scan, in three dimensions.
//!
//! A track stands for itself by its report nearest in time to the moment at which the beam
//! passed the target, if that is within 0.6 scans; truth is moved to the time of the report
//! by its velocity and acceleration. A track follows a target if it is confirmed or
//! coasting, within `target_gate_m`, and the one-to-one pairing of the scan gives it to the target
//! ([`evaluation::following`]).
//!
//! - *confirmation*: scans from the first in which the target is visible to the first in which
//!   it is followed, both included. Only targets visible for `confirm_scans` count.
//! - *lost*: a visible target that was followed in its last visible scan and is not now.
//! - *false*: a confirmed track that was never within the gate of a target, visible or not.
//! - *redundant*: a confirmed track that in some scan was within the gate of a target while other tracks
//!   followed all such targets: a duplicate. None of these is false too.
//! - NEES: ν' P⁻¹ ν over its dimension, of confirmed tracks that follow a target.

use std::collections::{BTreeMap, HashMap, VecDeque};

use common::config::ScoringConfig;
use common::report::Tracking;
use common::tracks::{Track, TracksHeader};
use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, TruthHeader, TruthTarget, VISIBLE};
use evaluation::following::{Standing, pair};
use evaluation::gospa::{MeanGospa, gospa};
use evaluation::identity::Holder;
use evaluation::mean::Moments;
use evaluation::poisson;

use super::path::ns;
use super::state_error::StateError;

/// A report counts for a target if it is not farther than this from it in time, scans.
const TIME_GATE_SCANS: f64 = 0.6;
/// Truth waits for tracks no longer than this, scans.
const LONGEST_WAIT_SCANS: usize = 60;
/// Reports wait for truth no longer than this, s.
const LONGEST_WAIT_S: f64 = 60.0;
/// Modes of motion with their names in the report.
const MODES: [(u32, &str); 3] = [(HOVER, "hover"), (CONSTANT_VELOCITY, "constant_velocity"), (MANOEUVRE, "manoeuvre")];

/// The fold of truth and tracks.
#[derive(Debug)]
pub struct Simulated {
    config: ScoringConfig,
    /// Truth not scored yet, by scan.
    pending: VecDeque<(TruthHeader, Vec<TruthTarget>)>,
    tracks: HashMap<u64, Reports>,
    targets: BTreeMap<u32, Life>,
    tracks_ns: u64,
    scans: u64,
    truth_s: f64,
    ended: Extra,
    lost: u64,
    changes: u64,
    points: u64,
    followed: u64,
    position: Moments,
    velocity: Moments,
    nees: Moments,
    nees_position: Moments,
    gospa: MeanGospa,
    modes: [Moments; 3],
}

/// Tracks that should not have been.
#[derive(Debug, Default, Clone, Copy)]
struct Extra {
    spurious: u64,
    redundant: u64,
}

impl Extra {
    fn count(&mut self, standing: Standing) {
        self.spurious += u64::from(standing.is_false());
        self.redundant += u64::from(standing.is_redundant());
    }
}

/// The last confirmed reports of a track.
#[derive(Debug, Default)]
struct Reports {
    last: VecDeque<Track>,
    standing: Standing,
}

/// What has happened to a target.
#[derive(Debug, Default)]
struct Life {
    visible_scans: u64,
    /// Scans from first sight to confirmation.
    confirmation: Option<u64>,
    holder: Holder<u64>,
    followed: bool,
}

/// The mean, if there is one.
fn mean(moments: &Moments) -> Option<f64> {
    (moments.n() > 0).then(|| moments.mean())
}

impl Simulated {
    /// Nothing seen yet.
    pub fn new(config: &ScoringConfig) -> Self {
        Self {
            config: config.clone(),
            pending: VecDeque::new(),
            tracks: HashMap::new(),
            targets: BTreeMap::new(),
            tracks_ns: 0,
            scans: 0,
            truth_s: 0.0,
            ended: Extra::default(),
            lost: 0,
            changes: 0,
            points: 0,
            followed: 0,
            position: Moments::default(),
            velocity: Moments::default(),
            nees: Moments::default(),
            nees_position: Moments::default(),
            gospa: MeanGospa::default(),
            modes: [Moments::default(); 3],
        }
    }

    /// Takes the tracks of a sector.
    pub fn tracks(&mut self, header: &TracksHeader, tracks: &[Track]) {
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            self.tracks.entry(track.id).or_default().last.push_back(*track);
        }
        self.tracks_ns = self.tracks_ns.max(header.time_ns);
        while let Some((truth, _)) = self.pending.front() {
            let settled_ns = truth.time_ns + ns(truth.scan_period_s * TIME_GATE_SCANS);
            if self.tracks_ns < settled_ns && self.pending.len() <= LONGEST_WAIT_SCANS {
                break;
            }
            self.score_next();
        }
        if self.pending.is_empty() {
            self.forget(self.tracks_ns.saturating_sub(ns(LONGEST_WAIT_S))); // there may be no truth at all
        }
    }

    /// Takes the truth of a scan.
    pub fn truth(&mut self, header: &TruthHeader, targets: &[TruthTarget]) {
        self.pending.push_back((*header, targets.to_vec()));
    }

    /// Scores what is left, and the result.
    pub fn finish(&mut self) -> Tracking {
        while !self.pending.is_empty() {
            self.score_next();
        }
        if self.scans == 0 {
            return Tracking::default();
        }
        let long_enough = |life: &&Life| life.visible_scans >= u64::from(self.config.confirm_scans);
        let counted: Vec<&Life> = self.targets.values().filter(long_enough).collect();
        let mut extra = self.ended;
        self.tracks.values().filter(|track| !track.last.is_empty()).for_each(|track| extra.count(track.standing));
        let per_hour = |tracks| poisson::per_hour(tracks, self.truth_s, 0.95);
        let spurious = per_hour(extra.spurious);
        let mode_probability = MODES.iter().zip(&self.modes);
        let confirmation_scans =
            self.targets.iter().filter_map(|(id, life)| Some((id.to_string(), life.confirmation?)));
        Tracking {
            targets: Some(counted.len() as u64),
            confirmed: Some(counted.iter().filter(|life| life.confirmation.is_some()).count() as u64),
            false_tracks: Some(extra.spurious),
            redundant_tracks: Some(extra.redundant),
            false_tracks_per_hour: Some(spurious.value),
            false_tracks_per_hour_interval: Some([spurious.lo, spurious.hi]),
            redundant_tracks_per_hour: Some(per_hour(extra.redundant).value),
            truth_hours: Some(self.truth_s / 3600.0),
            lost: Some(self.lost),
            position_rmse_m: mean(&self.position).map(f64::sqrt),
            velocity_rmse_mps: mean(&self.velocity).map(f64::sqrt),
            nees: mean(&self.nees),
            nees_position: mean(&self.nees_position),
            gospa_m: mean(&self.gospa.distance),
            gospa_localisation_m: mean(&self.gospa.localisation),
            gospa_missed_m: mean(&self.gospa.missed),
            gospa_false_m: mean(&self.gospa.spurious),
            gospa_parameters: Some([self.config.gospa_cutoff_m, self.config.gospa_order]),
            mode_probability: mode_probability
                .filter_map(|(&(_, name), moments)| Some((name.to_string(), mean(moments)?)))
                .collect(),
            confirmation_scans: confirmation_scans.collect(),
            truth_points: Some(self.points),
            truth_share: (self.points > 0).then(|| self.followed as f64 / self.points as f64),
            id_changes: Some(self.changes),
            ..Tracking::default()
        }
    }

    fn score_next(&mut self) {
        let Some((header, truth)) = self.pending.pop_front() else { return };
        let period_ns = ns(header.scan_period_s);
        let time_gate_ns = ns(header.scan_period_s * TIME_GATE_SCANS);
        let ids = self.active(header.time_ns.saturating_sub(period_ns), header.time_ns);
        let reports: Vec<Vec<(usize, StateError)>> = truth
            .iter()
            .map(|target| {
                let compare = |(index, id): (usize, &u64)| {
                    let track = self.tracks[id].nearest(target.time_ns)?;
                    let error = StateError::new(track, target)?;
                    (track.time_ns.abs_diff(target.time_ns) <= time_gate_ns).then_some((index, error))
                };
                ids.iter().enumerate().filter_map(compare).collect()
            })
            .collect();
        self.score_distance(&truth, &reports, ids.len());
        self.score_following(&truth, &reports, &ids);
        self.forget(header.time_ns.saturating_sub(period_ns));
        self.scans += 1;
        self.truth_s += header.scan_period_s;
    }

    /// Tracks with a report between the two times, in the order of their numbers.
    fn active(&self, from_ns: u64, to_ns: u64) -> Vec<u64> {
        let reported = |reports: &Reports| reports.last.iter().any(|r| r.time_ns > from_ns && r.time_ns <= to_ns);
        let mut ids: Vec<u64> =
            self.tracks.iter().filter(|(_, reports)| reported(reports)).map(|(&id, _)| id).collect();
        ids.sort_unstable();
        ids
    }

    /// GOSPA of the visible targets and the confirmed tracks; tracks that follow a target out of sight are not false.
    fn score_distance(&mut self, truth: &[TruthTarget], reports: &[Vec<(usize, StateError)>], tracks: usize) {
        let cutoff = self.config.gospa_cutoff_m;
        let hidden = |target: &TruthTarget| !target.has(VISIBLE);
        let near_hidden = |track: usize| {
            let near = |(index, error): &(usize, StateError)| *index == track && error.distance_m < cutoff;
            truth.iter().zip(reports).any(|(target, reports)| hidden(target) && reports.iter().any(near))
        };
        let mut number = vec![None; tracks];
        let mut counted = 0;
        for (track, number) in number.iter_mut().enumerate() {
            if !near_hidden(track) {
                *number = Some(counted);
                counted += 1;
            }
        }
        let visible = truth.iter().zip(reports).filter(|(target, _)| !hidden(target)).map(|(_, reports)| reports);
        let visible: Vec<_> = visible.collect();
        let mut distances = Vec::new();
        for (target, reports) in visible.iter().enumerate() {
            for (track, error) in reports.iter().filter(|(_, error)| error.distance_m < cutoff) {
                if let Some(track) = number[*track] {
                    distances.push((target, track, error.distance_m));
                }
            }
        }
        self.gospa.add(&gospa(visible.len(), counted, &distances, cutoff, self.config.gospa_order));
    }

    fn score_following(&mut self, truth: &[TruthTarget], reports: &[Vec<(usize, StateError)>], ids: &[u64]) {
        let distances: Vec<_> = (reports.iter().enumerate())
            .flat_map(|(row, reports)| reports.iter().map(move |(column, error)| (row, *column, error.distance_m)))
            .collect();
        let holds = |row: usize, column: usize| {
            self.targets.get(&truth[row].target_id).is_some_and(|life| life.holder.is(&ids[column]))
        };
        let pairing = pair(truth.len(), ids.len(), &distances, self.config.target_gate_m, holds);
        for (id, role) in ids.iter().zip(pairing.roles) {
            if let Some(track) = self.tracks.get_mut(id) {
                track.standing.note(role);
            }
        }
        for ((target, reports), column) in truth.iter().zip(reports).zip(pairing.track_of) {
            let pair = column.and_then(|column| reports.iter().find(|&&(index, _)| index == column));
            let life = self.targets.entry(target.target_id).or_default();
            let visible = target.has(VISIBLE);
            if visible {
                life.visible_scans += 1;
                self.points += 1;
                self.followed += u64::from(pair.is_some());
                self.lost += u64::from(life.followed && pair.is_none());
            }
            life.followed = visible && pair.is_some();
            let Some((column, error)) = pair else { continue };
            if visible && life.confirmation.is_none() {
                life.confirmation = Some(life.visible_scans);
            }
            self.changes += u64::from(life.holder.follow(ids[*column]));
            if visible {
                self.position.add(error.distance_m.powi(2));
                self.velocity.add(error.speed_mps.powi(2));
                error.nees.into_iter().for_each(|value| self.nees.add(value));
                error.nees_position.into_iter().for_each(|value| self.nees_position.add(value));
                if let (Some(mean), Some(probability)) = (self.modes.get_mut(target.mode as usize), error.true_kind) {
                    mean.add(probability);
                }
            }
        }
    }

    /// Forgets reports that no later scan needs, and tracks that have ended.
    fn forget(&mut self, before_ns: u64) {
        let ended = &mut self.ended;
        self.tracks.retain(|_, track| {
            track.last.retain(|report| report.time_ns > before_ns);
            let ends = track.last.is_empty();
            if ends {
                ended.count(track.standing);
            }
            !ends
        });
    }
}

impl Reports {
    fn nearest(&self, time_ns: u64) -> Option<&Track> {
        self.last.iter().min_by_key(|report| report.time_ns.abs_diff(time_ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::CONFIRMED;

    const PERIOD_NS: u64 = 1_000_000_000;

    fn track(id: u64, time_ns: u64, x_m: f64) -> Track {
        let mut track = Track { id, time_ns, state_code: CONFIRMED, ..Track::default() };
        track.state[0] = x_m;
        track
    }

    /// Scores `scans` scans of one hovering target; `places` are those of the confirmed tracks 1, 2, … east of it, m.
    fn score(scans: u64, places: impl Fn(u64) -> Vec<f64>) -> Tracking {
        let mut simulated = Simulated::new(&ScoringConfig::default());
        for scan in 1..=scans {
            let time_ns = scan * PERIOD_NS;
            let target = TruthTarget { target_id: 1, time_ns, flags: VISIBLE, ..TruthTarget::default() };
            let header = TruthHeader { time_ns, scan_period_s: 1.0, ..TruthHeader::default() };
            simulated.truth(&header, &[target]);
            let tracks: Vec<Track> = (1..).zip(places(scan)).map(|(id, x_m)| track(id, time_ns, x_m)).collect();
            simulated.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &tracks);
        }
        simulated.finish()
    }

    #[test]
    fn a_second_track_of_a_target_is_redundant_and_not_false() {
        let alone = score(10, |_| vec![5.0]);
        assert_eq!((alone.false_tracks, alone.redundant_tracks, alone.lost), (Some(0), Some(0), Some(0)));
        let twice = score(10, |_| vec![5.0, 30.0]);
        assert_eq!((twice.false_tracks, twice.redundant_tracks, twice.id_changes), (Some(0), Some(1), Some(0)));
        assert_eq!(twice.redundant_tracks_per_hour, Some(360.0));
        // One track too many costs c²/2.
        assert!((twice.gospa_m.expect("scans") - (25.0 + 5000.0_f64).sqrt()).abs() < 1e-9, "{twice:?}");
        assert!((twice.gospa_false_m.expect("scans") - 5000.0_f64.sqrt()).abs() < 1e-9, "{twice:?}");
        assert_eq!((twice.gospa_localisation_m, twice.gospa_missed_m), (Some(5.0), Some(0.0)));
        // Also one that was a duplicate for a while and has ended.
        let before = score(10, |scan| if scan < 4 { vec![5.0, 30.0] } else { vec![5.0] });
        assert_eq!((before.false_tracks, before.redundant_tracks), (Some(0), Some(1)));
        let far = score(10, |_| vec![5.0, 3000.0]);
        assert_eq!((far.false_tracks, far.redundant_tracks), (Some(1), Some(0)));
    }

    #[test]
    fn a_target_whose_track_is_replaced_has_changed_it_once() {
        let replaced = score(10, |scan| if scan < 6 { vec![5.0] } else { vec![9000.0, 5.0] });
        assert_eq!(
            (replaced.id_changes, replaced.false_tracks, replaced.redundant_tracks),
            (Some(1), Some(0), Some(0))
        );
    }
}
