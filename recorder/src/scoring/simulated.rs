//! Tracks against the simulator's truth, passage by passage of the beam, in three dimensions or in the slant plane.
//!
//! A track stands for itself by its report nearest in time to the moment at which the beam
//! passed the target, if that is within 0.6 scans; truth is moved to the time of the report
//! by its velocity and acceleration. A track follows a target if it is confirmed or
//! coasting, within the gate, and the one-to-one pairing of the scan gives it to the target
//! ([`evaluation::following`]). The gate is `target_gate_m`, or else follows from the radar's cells (module `reach`).
//!
//! - *confirmation*: passages from the first in which the target is visible to the first in which
//!   it is followed, both included. Targets visible for fewer than `confirm_scans` count only if they are.
//! - *lost*: a visible target that was followed in its last visible passage and is not now.
//! - *false*: a confirmed track that was never within the gate of a target, visible or not.
//! - *redundant*: a confirmed track that in some scan was within the gate of a target while other tracks
//!   followed all such targets: a duplicate. None of these is false too.
//! - NEES: ν' P⁻¹ ν over its dimension, of confirmed tracks that follow a target.
//!
//! A look counts if the beam had passed the target wholly before the tracks end.

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::f64::consts::TAU;

use common::config::{ChainConfig, ScoringConfig};
use common::plots::PlotsHeader;
use common::report::Tracking;
use common::tracks::{Track, TracksHeader};
use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, TruthHeader, TruthTarget, VISIBLE};
use evaluation::following::{Role, Standing, pair};
use evaluation::gospa::{MeanGospa, gospa};
use evaluation::identity::Holder;
use evaluation::mean::Moments;
use evaluation::poisson;

use super::path::ns;
use super::reach::{Reach, beam_scans};
use super::state_error::StateError;

/// A report counts for a target if it is not farther than this from it in time, scans.
const TIME_GATE_SCANS: f64 = 0.6;
/// A report so near to the passage in time is of that passage, also if it belongs to another scan: north lies between, scans.
const SAME_PASSAGE_SCANS: f64 = 0.1;
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
    reach: Reach,
    /// Time in which the beam passes a target wholly, as a share of a scan.
    beam_scans: f64,
    /// Cut-off distance of GOSPA, m, once there was a target.
    cutoff_m: Option<f64>,
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
    /// Time of the last report that has stood for a target, ns UTC.
    used_ns: u64,
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

fn length(of: [f64; 3]) -> f64 {
    of.iter().map(|along| along * along).sum::<f64>().sqrt()
}

fn round_to_one_digit(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor());
    (value / unit).round() * unit
}

/// The mean, if there is one.
fn mean(moments: &Moments) -> Option<f64> {
    (moments.n() > 0).then(|| moments.mean())
}

impl Simulated {
    /// Nothing seen yet.
    pub fn new(config: &ChainConfig) -> Self {
        Self {
            config: config.recorder.scoring.clone(),
            reach: Reach::of_radar(&config.radar),
            beam_scans: beam_scans(&config.radar),
            cutoff_m: config.recorder.scoring.gospa_cutoff_m,
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

    /// Takes note of the radar's cells.
    pub fn see(&mut self, header: &PlotsHeader) {
        self.reach = Reach::of_plots(header).unwrap_or(self.reach);
        self.beam_scans = self.beam_scans.max(header.cell_azimuth_rad / TAU);
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
            self.score_next(u64::MAX);
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
        while let Some((header, _)) = self.pending.front() {
            // In the scan in which the tracks end, only what the beam has passed by then. Scans without any track are lost.
            let tracks_end = header.time_ns.saturating_sub(ns(header.scan_period_s)) < self.tracks_ns;
            self.score_next(if tracks_end { self.tracks_ns } else { u64::MAX });
        }
        if self.scans == 0 {
            return Tracking::default();
        }
        let long_enough =
            |life: &&Life| life.confirmation.is_some() || life.visible_scans >= u64::from(self.config.confirm_scans);
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
            nees_dimensions: Some(if self.reach.is_elevated() { [6, 3] } else { [4, 2] }),
            gospa_m: mean(&self.gospa.distance),
            gospa_localisation_m: mean(&self.gospa.localisation),
            gospa_missed_m: mean(&self.gospa.missed),
            gospa_false_m: mean(&self.gospa.spurious),
            gospa_parameters: self.cutoff_m.map(|cutoff_m| [cutoff_m, self.config.gospa_order]),
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

    /// Scores the next scan; passages of the beam that are not over at `end_ns` do not count.
    fn score_next(&mut self, end_ns: u64) {
        let Some((header, mut truth)) = self.pending.pop_front() else { return };
        let period_ns = ns(header.scan_period_s);
        let whole_ns = end_ns.saturating_sub(ns(header.scan_period_s * self.beam_scans));
        for target in truth.iter_mut().filter(|target| target.time_ns > whole_ns) {
            target.flags &= !VISIBLE;
        }
        let active = self.active(header.time_ns.saturating_sub(period_ns), header.time_ns);
        // A target that the beam has passed twice within the scan has two looks.
        let mut later = Vec::new();
        let mut seen = BTreeSet::new();
        truth.retain(|target| {
            let is_first = seen.insert(target.target_id);
            if !is_first {
                later.push(*target);
            }
            is_first
        });
        self.score_look(&header, &truth, &active, true);
        if !later.is_empty() {
            self.score_look(&header, &later, &[], false);
        }
        self.forget(header.time_ns.saturating_sub(period_ns));
        self.scans += 1;
        self.truth_s += header.scan_period_s;
    }

    /// Scores one passage of each of some targets, with the `active` tracks and those that have a report of that passage.
    fn score_look(&mut self, header: &TruthHeader, truth: &[TruthTarget], active: &[u64], distance: bool) {
        let [time_gate_ns, passage_ns] =
            [TIME_GATE_SCANS, SAME_PASSAGE_SCANS].map(|scans| ns(header.scan_period_s * scans));
        let mut ids = active.to_vec();
        for (&id, track) in &self.tracks {
            let is_of = |target: &TruthTarget| {
                track.nearest(target.time_ns).is_some_and(|report| {
                    report.time_ns > track.used_ns && report.time_ns.abs_diff(target.time_ns) <= passage_ns
                })
            };
            if truth.iter().any(is_of) {
                ids.push(id);
            }
        }
        ids.sort_unstable();
        ids.dedup();
        let gates: Vec<f64> = truth.iter().map(|target| self.gate_m(target, header.scan_period_s)).collect();
        let reports: Vec<Vec<(usize, StateError)>> = truth
            .iter()
            .map(|target| {
                let compare = |(index, id): (usize, &u64)| {
                    let track = self.tracks[id].nearest(target.time_ns)?;
                    let error = StateError::new(track, target, self.reach.is_elevated())?;
                    (track.time_ns.abs_diff(target.time_ns) <= time_gate_ns).then_some((index, error))
                };
                ids.iter().enumerate().filter_map(compare).collect()
            })
            .collect();
        if distance {
            self.score_distance(truth, &reports, &ids, &gates);
        }
        self.score_following(truth, &reports, &ids, &gates, active);
    }

    /// A track that follows `target` is not farther from it than this, m.
    fn gate_m(&self, target: &TruthTarget, scan_period_s: f64) -> f64 {
        let of_radar = || {
            let [range_m, speed_mps] = [target.position_m(), target.velocity_mps()].map(length);
            self.reach.gate_m(range_m, speed_mps, scan_period_s)
        };
        self.config.target_gate_m.unwrap_or_else(of_radar)
    }

    /// Tracks with a report between the two times that has not stood for a target yet, in the order of their numbers.
    fn active(&self, from_ns: u64, to_ns: u64) -> Vec<u64> {
        let reported =
            |track: &Reports| track.last.iter().any(|r| r.time_ns > from_ns.max(track.used_ns) && r.time_ns <= to_ns);
        let mut ids: Vec<u64> = self.tracks.iter().filter(|(_, track)| reported(track)).map(|(&id, _)| id).collect();
        ids.sort_unstable();
        ids
    }

    /// GOSPA of the visible targets and the confirmed tracks; tracks that follow a target out of sight are not false.
    fn score_distance(
        &mut self,
        truth: &[TruthTarget],
        reports: &[Vec<(usize, StateError)>],
        ids: &[u64],
        gates: &[f64],
    ) {
        // One distance for the whole run: half of the mean gate of the first targets, as a round number.
        let widest = gates.iter().sum::<f64>() / gates.len() as f64;
        let rounded = || (widest > 0.0).then(|| round_to_one_digit(0.5 * widest));
        self.cutoff_m = self.cutoff_m.or_else(rounded);
        let tracks = ids.len();
        let cutoff = self.cutoff_m.unwrap_or(f64::MIN_POSITIVE);
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

    fn score_following(
        &mut self,
        truth: &[TruthTarget],
        reports: &[Vec<(usize, StateError)>],
        ids: &[u64],
        gates: &[f64],
        active: &[u64],
    ) {
        let in_gates = |(row, reports): (usize, &Vec<(usize, StateError)>)| {
            let of = move |(column, error): &(usize, StateError)| (row, *column, error.distance_m / gates[row]);
            reports.iter().map(of).collect::<Vec<_>>()
        };
        let distances: Vec<_> = reports.iter().enumerate().flat_map(in_gates).collect();
        let holds = |row: usize, column: usize| {
            self.targets.get(&truth[row].target_id).is_some_and(|life| life.holder.is(&ids[column]))
        };
        let pairing = pair(truth.len(), ids.len(), &distances, 1.0, holds);
        // What a track of another scan is beside following is judged there.
        let judged = |(id, role): &(&u64, Role)| matches!(role, Role::Follows(_)) || active.contains(id);
        for (id, role) in ids.iter().zip(pairing.roles).filter(judged) {
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
            if let Some(track) = self.tracks.get_mut(&ids[*column]) {
                track.used_ns = track.nearest(target.time_ns).map_or(track.used_ns, |report| report.time_ns);
            }
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

    fn config() -> ChainConfig {
        let mut config = ChainConfig::default();
        config.recorder.scoring.target_gate_m = Some(200.0);
        config.recorder.scoring.gospa_cutoff_m = Some(100.0);
        config
    }

    /// Scores `scans` scans of one hovering target; `places` are those of the confirmed tracks 1, 2, … east of it, m.
    fn score(scans: u64, places: impl Fn(u64) -> Vec<f64>) -> Tracking {
        let mut simulated = Simulated::new(&config());
        for scan in 1..=scans {
            let time_ns = scan * PERIOD_NS;
            let target = TruthTarget { target_id: 1, time_ns, flags: VISIBLE, ..TruthTarget::default() };
            let header = TruthHeader { time_ns, scan_period_s: 1.0, ..TruthHeader::default() };
            simulated.truth(&header, &[target]);
            let tracks: Vec<Track> = (1..).zip(places(scan)).map(|(id, x_m)| track(id, time_ns, x_m)).collect();
            simulated.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &tracks);
        }
        let time_ns = scans * PERIOD_NS + PERIOD_NS / 10;
        simulated.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &[]);
        simulated.finish()
    }

    /// Of a target in the north, whose reports fall now before the end of a scan and now after it: no look is lost.
    #[test]
    fn a_report_belongs_to_its_passage_and_not_to_its_scan() {
        let mut simulated = Simulated::new(&config());
        // Until the fourth scan the beam passes it just before north, from the sixth on just after it: it has crossed with the beam.
        for scan in 1..=9_u64 {
            let end_ns = scan * PERIOD_NS;
            let time_ns = if scan < 5 { end_ns - 1000 } else { end_ns - PERIOD_NS + 1000 };
            let target = TruthTarget { target_id: 1, time_ns, flags: VISIBLE, ..TruthTarget::default() };
            let header = TruthHeader { time_ns: end_ns, scan_period_s: 1.0, ..TruthHeader::default() };
            simulated.truth(&header, if scan == 5 { &[] } else { std::slice::from_ref(&target) });
            let report_ns = if scan % 2 == 0 { time_ns + 3000 } else { time_ns - 3000 };
            let reports = if scan == 5 { vec![] } else { vec![track(1, report_ns, 5.0)] };
            simulated.tracks(&TracksHeader { time_ns: report_ns, ..TracksHeader::default() }, &reports);
        }
        let time_ns = 10 * PERIOD_NS;
        simulated.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &[]);
        let tracking = simulated.finish();
        assert_eq!((tracking.lost, tracking.false_tracks, tracking.truth_share), (Some(0), Some(0), Some(1.0)));
        assert_eq!(tracking.gospa_false_m, Some(0.0), "{tracking:?}");
    }

    /// The run ends in the middle of a scan: targets that the beam has not passed wholly are not lost.
    #[test]
    fn a_run_that_is_stopped_is_scored_to_its_last_whole_look() {
        let mut simulated = Simulated::new(&config());
        let place = |id: u32| f64::from(id) * 1000.0;
        for scan in 0..8_u64 {
            let at_ns = |id: u32| scan * PERIOD_NS + u64::from(id) * PERIOD_NS / 4;
            let target = |id: u32| {
                let mut target =
                    TruthTarget { target_id: id, time_ns: at_ns(id), flags: VISIBLE, ..TruthTarget::default() };
                target.state[0] = place(id);
                target
            };
            let end_ns = if scan == 7 { at_ns(2) } else { (scan + 1) * PERIOD_NS };
            let header = TruthHeader { time_ns: end_ns, scan_period_s: 1.0, ..TruthHeader::default() };
            simulated.truth(&header, &[1, 2, 3].map(target));
            let reports: Vec<Track> =
                (1..=3).filter(|&id| at_ns(id) < end_ns).map(|id| track(id.into(), at_ns(id), place(id))).collect();
            simulated.tracks(&TracksHeader { time_ns: end_ns, ..TracksHeader::default() }, &reports);
        }
        let tracking = simulated.finish();
        assert_eq!((tracking.lost, tracking.truth_points), (Some(0), Some(7 * 3 + 1)), "{tracking:?}");
        assert_eq!((tracking.truth_share, tracking.gospa_false_m), (Some(1.0), Some(0.0)));
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
