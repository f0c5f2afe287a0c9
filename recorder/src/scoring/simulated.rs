//! Tracks against the simulator's truth, scan by scan, in three dimensions.
//!
//! A track stands for itself by its report nearest in time to the moment at which the beam
//! passed the target, if that is within 0.6 scans; truth is moved to the time of the report
//! by its velocity and acceleration. A track follows a target if it is confirmed or
//! coasting, within `target_gate_m`, and the cheapest one-to-one pairing of the scan gives
//! it to the target; a target changes its track only for one that is nearer by a quarter of
//! the gate, so that two targets side by side do not swap tracks at every scan.
//!
//! - *confirmation*: scans from the first in which the target is visible to the first in which
//!   it is followed, both included. Only targets visible for `confirm_scans` count.
//! - *lost*: a visible target that was followed in its last visible scan and is not now.
//! - *false*: a confirmed track that was never within the gate of a target, visible or not.
//! - NEES: ν' P⁻¹ ν over its dimension, of confirmed tracks that follow a target.

use std::collections::{BTreeMap, HashMap, VecDeque};

use common::config::ScoringConfig;
use common::report::Tracking;
use common::tracks::{Track, TracksHeader, pack};
use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, TruthHeader, TruthTarget, VISIBLE};
use common::units::seconds_between;
use evaluation::assignment::cheapest;
use evaluation::consistency;
use evaluation::gospa::gospa;
use nalgebra::{SMatrix, SVector};

use super::path::ns;

/// A report counts for a target if it is not farther than this from it in time, scans.
const TIME_GATE_SCANS: f64 = 0.6;
/// Truth waits for tracks no longer than this, scans.
const LONGEST_WAIT_SCANS: usize = 60;
/// Reports wait for truth no longer than this, s.
const LONGEST_WAIT_S: f64 = 60.0;
/// Indices of position in the state.
const POSITION: [usize; 3] = [0, 3, 6];
/// Indices of position and velocity in the state.
const POSITION_AND_VELOCITY: [usize; 6] = [0, 1, 3, 4, 6, 7];
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
    false_tracks: u64,
    lost: u64,
    changes: u64,
    points: u64,
    followed: u64,
    position: Mean,
    velocity: Mean,
    nees: Mean,
    nees_position: Mean,
    gospa: Mean,
    modes: [Mean; 3],
}

/// The last confirmed reports of a track.
#[derive(Debug, Default)]
struct Reports {
    last: VecDeque<Track>,
    near: bool,
}

/// What has happened to a target.
#[derive(Debug, Default)]
struct Life {
    visible_scans: u64,
    /// Scans from first sight to confirmation.
    confirmation: Option<u64>,
    holder: Option<u64>,
    followed: bool,
}

#[derive(Debug, Default, Clone, Copy)]
struct Mean {
    sum: f64,
    n: u64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.n += 1;
    }

    fn value(self) -> Option<f64> {
        (self.n > 0).then(|| self.sum / self.n as f64)
    }
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
            false_tracks: 0,
            lost: 0,
            changes: 0,
            points: 0,
            followed: 0,
            position: Mean::default(),
            velocity: Mean::default(),
            nees: Mean::default(),
            nees_position: Mean::default(),
            gospa: Mean::default(),
            modes: [Mean::default(); 3],
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
        let never_near = self.tracks.values().filter(|track| !track.near && !track.last.is_empty()).count() as u64;
        let mode_probability = MODES.iter().zip(self.modes);
        let confirmation_scans =
            self.targets.iter().filter_map(|(id, life)| Some((id.to_string(), life.confirmation?)));
        Tracking {
            targets: Some(counted.len() as u64),
            confirmed: Some(counted.iter().filter(|life| life.confirmation.is_some()).count() as u64),
            false_tracks: Some(self.false_tracks + never_near),
            lost: Some(self.lost),
            position_rmse_m: self.position.value().map(f64::sqrt),
            velocity_rmse_mps: self.velocity.value().map(f64::sqrt),
            nees: self.nees.value(),
            nees_position: self.nees_position.value(),
            gospa_m: self.gospa.value(),
            gospa_parameters: Some([self.config.gospa_cutoff_m, self.config.gospa_order]),
            mode_probability: mode_probability
                .filter_map(|(&(_, name), mean)| Some((name.to_string(), mean.value()?)))
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
        let reports: Vec<Vec<(usize, Error)>> = truth
            .iter()
            .map(|target| {
                let compare = |(index, id): (usize, &u64)| {
                    let track = self.tracks[id].nearest(target.time_ns)?;
                    let error = Error::new(track, target)?;
                    (track.time_ns.abs_diff(target.time_ns) <= time_gate_ns).then_some((index, error))
                };
                ids.iter().enumerate().filter_map(compare).collect()
            })
            .collect();
        self.score_distance(&truth, &reports, ids.len());
        self.score_following(&truth, &reports, &ids);
        self.forget(header.time_ns.saturating_sub(period_ns));
        self.scans += 1;
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
    fn score_distance(&mut self, truth: &[TruthTarget], reports: &[Vec<(usize, Error)>], tracks: usize) {
        let cutoff = self.config.gospa_cutoff_m;
        let hidden = |target: &TruthTarget| !target.has(VISIBLE);
        let near_hidden = |track: usize| {
            let near = |(index, error): &(usize, Error)| *index == track && error.distance_m < cutoff;
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
        self.gospa.add(gospa(visible.len(), counted, &distances, cutoff, self.config.gospa_order).distance);
    }

    fn score_following(&mut self, truth: &[TruthTarget], reports: &[Vec<(usize, Error)>], ids: &[u64]) {
        let gate_m = self.config.target_gate_m;
        let mut pairs = Vec::new();
        for (row, (target, reports)) in truth.iter().zip(reports).enumerate() {
            let holder = self.targets.get(&target.target_id).and_then(|life| life.holder);
            for &(column, ref error) in reports.iter().filter(|(_, error)| error.distance_m <= gate_m) {
                let favour_m = if holder == Some(ids[column]) { gate_m / 4.0 } else { 0.0 };
                pairs.push((row, column, error.distance_m - favour_m));
                if let Some(track) = self.tracks.get_mut(&ids[column]) {
                    track.near = true;
                }
            }
        }
        let given = cheapest(truth.len(), ids.len(), &pairs, 2.0 * gate_m);
        for ((target, reports), column) in truth.iter().zip(reports).zip(given) {
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
            if life.holder.replace(ids[*column]).is_some_and(|last| last != ids[*column]) {
                self.changes += 1;
            }
            if visible {
                self.position.add(error.distance_m.powi(2));
                self.velocity.add(error.speed_mps.powi(2));
                error.nees.into_iter().for_each(|value| self.nees.add(value));
                error.nees_position.into_iter().for_each(|value| self.nees_position.add(value));
                if let (Some(mean), Some(&probability)) =
                    (self.modes.get_mut(target.mode as usize), error.mode_probability.get(target.mode as usize))
                {
                    mean.add(probability);
                }
            }
        }
    }

    /// Forgets reports that no later scan needs, and tracks that have ended.
    fn forget(&mut self, before_ns: u64) {
        let false_tracks = &mut self.false_tracks;
        self.tracks.retain(|_, track| {
            track.last.retain(|report| report.time_ns > before_ns);
            *false_tracks += u64::from(track.last.is_empty() && !track.near);
            !track.last.is_empty()
        });
    }
}

impl Reports {
    fn nearest(&self, time_ns: u64) -> Option<&Track> {
        self.last.iter().min_by_key(|report| report.time_ns.abs_diff(time_ns))
    }
}

/// A track report minus truth at its time.
#[derive(Debug, Clone)]
struct Error {
    distance_m: f64,
    speed_mps: f64,
    nees: Option<f64>,
    nees_position: Option<f64>,
    mode_probability: [f64; 3],
}

impl Error {
    /// `None` for states that are no numbers.
    fn new(track: &Track, target: &TruthTarget) -> Option<Self> {
        let dt_s = seconds_between(target.time_ns, track.time_ns);
        let mut truth = target.state;
        for axis in POSITION {
            let [x, v, a] = [target.state[axis], target.state[axis + 1], target.state[axis + 2]];
            truth[axis] = x + v * dt_s + 0.5 * a * dt_s * dt_s;
            truth[axis + 1] = v + a * dt_s;
        }
        let error: [f64; 9] = std::array::from_fn(|index| track.state[index] - truth[index]);
        let length = |axes: [usize; 3]| axes.iter().map(|&axis| error[axis] * error[axis]).sum::<f64>().sqrt();
        let (distance_m, speed_mps) = (length(POSITION), length(POSITION.map(|axis| axis + 1)));
        distance_m.is_finite().then(|| Self {
            distance_m,
            speed_mps,
            nees: normalised_square(&error, track, POSITION_AND_VELOCITY),
            nees_position: normalised_square(&error, track, POSITION),
            mode_probability: track.mode_probability,
        })
    }
}

/// NEES of some components over their number; `None` if P has no Cholesky factor.
fn normalised_square<const N: usize>(error: &[f64; 9], track: &Track, components: [usize; N]) -> Option<f64> {
    let covariance =
        SMatrix::<f64, N, N>::from_fn(|row, column| track.covariance[pack(components[row], components[column])]);
    let error = SVector::from(components.map(|component| error[component]));
    Some(consistency::normalised_square(&error, &covariance)? / N as f64)
}
