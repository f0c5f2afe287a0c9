//! Tracks against truth from transponders, in the plane.
//!
//! Distances and times that the configuration leaves open follow from the radar's cells (module `reach`) and its scan period.
//!
//! **What counts.** A truth report counts if the target moves faster than `speed_min_mps` and
//! is within `range_max_m` of the radar, or visible to it. It is followed if the track that its address has in
//! that second lies within `gate_m` of it, confirmed or coasting, at the time of the report:
//! between two track reports up to `gap_max_s` apart, or predicted up to `hold_max_s`.
//!
//! **Which track.** Seconds of UTC are taken one after the other. In each, an address keeps
//! the track it had last while that is within the gate; then the remaining addresses and
//! tracks are paired, nearest first. A track has one address in a second, and an
//! address one track. An address that gets another track than its last one is a change.
//!
//! **False tracks.** A confirmed track that was never within the gate of any address, moving
//! or not, at any range. **Redundant tracks.** A confirmed track that in some second was within the gate of reports
//! that count, all of which had other tracks.
//!
//! With these definitions the tracker of the Barcelona radar itself (example `own_tracks` of
//! the plot source) has, beside the figures that the description of the data gives:
//!
//! | figure | here | given |
//! |---|---|---|
//! | share of truth followed | 0.737 | 0.737 |
//! | share of aircraft on the ground | 0.985 | 0.984 |
//! | distance, 50 % and 95 % | 3.58 m, 14.1 m | 3.5 m, 13.5 m |
//! | changes of track number | 137 | 133 |
//! | tracks never near an address, per hour | 247.4 | 247 |

use std::collections::{BTreeMap, HashMap, HashSet};

use common::config::ScoringConfig;
use common::plots::PlotsHeader;
use common::report::Tracking;
use common::tracks::{Track, TracksHeader};
use common::truth::{ON_GROUND, TruthHeader, TruthTarget, VEHICLE, VISIBLE};
use common::units::{NS_PER_S, seconds_between};
use evaluation::following::{Role, Standing};
use evaluation::identity::Holder;
use evaluation::poisson;
use hdrhistogram::Histogram;

use super::path::{Path, PlanarPoint, distance_m, ns};
use super::reach::Reach;

/// A track is interpolated over gaps up to this, scans, unless `gap_max_s` is set.
const GAP_SCANS: f64 = 5.0;
/// A track is predicted past its last report up to this, scans, unless `hold_max_s` is set.
const HOLD_SCANS: f64 = 2.0;
/// One topic is waited for no longer than this when the other goes on, s.
const LONGEST_WAIT_S: f64 = 60.0;

/// The fold of truth and tracks.
#[derive(Debug)]
pub struct Cooperative {
    config: ScoringConfig,
    reach: Option<Reach>,
    scan_period_s: f64,
    /// Truth not scored yet, by second.
    seconds: BTreeMap<u64, Vec<TruthTarget>>,
    targets: HashMap<u32, Path>,
    tracks: HashMap<u64, Followed>,
    /// Last track of each address.
    holder: HashMap<u32, Holder<u64>>,
    tracks_ns: u64,
    truth_ns: u64,
    truth_span_ns: Option<(u64, u64)>,
    scored_until: u64,
    points: Share,
    ground: Share,
    changes: u64,
    never_near: u64,
    redundant: u64,
    /// Distances, mm.
    distances: Histogram<u64>,
}

#[derive(Debug, Default)]
struct Followed {
    path: Path,
    standing: Standing,
}

#[derive(Debug, Default, Clone, Copy)]
struct Share {
    all: u64,
    followed: u64,
}

impl Share {
    fn count(&mut self, followed: bool) {
        self.all += 1;
        self.followed += u64::from(followed);
    }

    fn value(self) -> Option<f64> {
        (self.all > 0).then(|| self.followed as f64 / self.all as f64)
    }
}

impl Cooperative {
    /// Nothing seen yet.
    pub fn new(config: &ScoringConfig) -> Self {
        Self {
            config: config.clone(),
            reach: None,
            scan_period_s: 1.0,
            seconds: BTreeMap::new(),
            targets: HashMap::new(),
            tracks: HashMap::new(),
            holder: HashMap::new(),
            tracks_ns: 0,
            truth_ns: 0,
            truth_span_ns: None,
            scored_until: 0,
            points: Share::default(),
            ground: Share::default(),
            changes: 0,
            never_near: 0,
            redundant: 0,
            distances: Histogram::new_with_bounds(1, 10_000_000, 3).expect("constant bounds are valid"),
        }
    }

    /// Takes note of the radar's cells and its scan period.
    pub fn see(&mut self, header: &PlotsHeader) {
        self.reach = Reach::of_plots(header).or(self.reach);
        self.scan_period_s = header.scan_period_s;
    }

    /// Takes the tracks of a sector.
    pub fn tracks(&mut self, header: &TracksHeader, tracks: &[Track]) {
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            self.tracks.entry(track.id).or_default().path.push(PlanarPoint::from(track));
        }
        self.tracks_ns = self.tracks_ns.max(header.time_ns);
        self.score_what_is_complete();
    }

    /// Takes the truth of a scan.
    pub fn truth(&mut self, header: &TruthHeader, targets: &[TruthTarget]) {
        for target in targets {
            let (first, last) = self.truth_span_ns.unwrap_or((target.time_ns, target.time_ns));
            self.truth_span_ns = Some((first.min(target.time_ns), last.max(target.time_ns)));
            self.targets.entry(target.target_id).or_default().push(PlanarPoint::from(target));
            self.seconds.entry(target.time_ns / NS_PER_S as u64).or_default().push(*target);
        }
        self.truth_ns = self.truth_ns.max(header.time_ns);
        self.score_what_is_complete();
    }

    /// Scores what is left, and the result.
    pub fn finish(&mut self) -> Tracking {
        let end_ns = self.tracks_ns.max(self.truth_ns) + ns(self.gap_max_s() + 2.0);
        self.score_until(end_ns / NS_PER_S as u64 + 1);
        let alive = |of: fn(&Standing) -> bool| self.tracks.values().filter(|track| of(&track.standing)).count() as u64;
        let never_near = self.never_near + alive(Standing::is_false);
        let redundant = self.redundant + alive(Standing::is_redundant);
        let hours = self.truth_span_ns.map(|(first, last)| seconds_between(first, last) / 3600.0);
        let counted = hours.filter(|&hours| hours > 0.0);
        let per_hour = |tracks| counted.map(|hours| poisson::per_hour(tracks, hours * 3600.0, 0.95));
        let distance_m =
            |quantile| (!self.distances.is_empty()).then(|| self.distances.value_at_quantile(quantile) as f64 / 1000.0);
        Tracking {
            false_tracks: hours.map(|_| never_near),
            redundant_tracks: hours.map(|_| redundant),
            false_tracks_per_hour: per_hour(never_near).map(|rate| rate.value),
            false_tracks_per_hour_interval: per_hour(never_near).map(|rate| [rate.lo, rate.hi]),
            redundant_tracks_per_hour: per_hour(redundant).map(|rate| rate.value),
            truth_hours: hours,
            truth_share: self.points.value(),
            truth_share_ground: self.ground.value(),
            truth_points: hours.map(|_| self.points.all),
            distance_p50_m: distance_m(0.5),
            distance_p95_m: distance_m(0.95),
            id_changes: hours.map(|_| self.changes),
            ..Tracking::default()
        }
    }

    fn gap_max_s(&self) -> f64 {
        self.config.gap_max_s.unwrap_or(GAP_SCANS * self.scan_period_s)
    }

    fn hold_max_s(&self) -> f64 {
        self.config.hold_max_s.unwrap_or(HOLD_SCANS * self.scan_period_s)
    }

    /// A track that follows a target at this place is not farther from it than this, m.
    fn gate_m(&self, at: &PlanarPoint) -> f64 {
        let [range_m, speed_mps] = [at.position_m, at.velocity_mps].map(|along| distance_m(along, [0.0; 2]));
        let of_radar = || self.reach.map_or(0.0, |reach| reach.gate_m(range_m, speed_mps, self.scan_period_s));
        self.config.gate_m.unwrap_or_else(of_radar)
    }

    /// Scores every second that no later report of a track or target can change.
    fn score_what_is_complete(&mut self) {
        let (behind, ahead) = (self.tracks_ns.min(self.truth_ns), self.tracks_ns.max(self.truth_ns));
        let known_ns = behind.max(ahead.saturating_sub(ns(LONGEST_WAIT_S)));
        let complete = known_ns.saturating_sub(ns(self.gap_max_s() + 1.0)) / NS_PER_S as u64;
        self.score_until(complete);
    }

    fn score_until(&mut self, end: u64) {
        while let Some(entry) = self.seconds.first_entry().filter(|entry| *entry.key() < end) {
            let (second, reports) = entry.remove_entry();
            self.mark_near(second);
            self.score(&reports);
        }
        if end > self.scored_until {
            self.scored_until = end;
            self.forget();
        }
    }

    /// Marks the tracks that were within the gate of an address in `second`.
    fn mark_near(&mut self, second: u64) {
        let gap_max_s = self.gap_max_s();
        let is_near = |point: &PlanarPoint| {
            self.targets.values().any(|target| {
                target
                    .position_at(point.time_ns, gap_max_s, 0.0)
                    .is_some_and(|truth| distance_m(truth, point.position_m) <= self.gate_m(point))
            })
        };
        let unknown = self.tracks.iter().filter(|(_, track)| track.standing.is_false());
        let near = unknown.filter(|(_, track)| {
            track.path.points().any(|point| point.time_ns / NS_PER_S as u64 == second && is_near(point))
        });
        let near: Vec<u64> = near.map(|(&id, _)| id).collect();
        for id in near {
            if let Some(track) = self.tracks.get_mut(&id) {
                track.standing.note_near();
            }
        }
    }

    /// Scores the reports of one second.
    fn score(&mut self, reports: &[TruthTarget]) {
        let counts = |target: &TruthTarget| {
            let point = PlanarPoint::from(target);
            distance_m(point.velocity_mps, [0.0; 2]) > self.config.speed_min_mps
                && self
                    .config
                    .range_max_m
                    .map_or(target.has(VISIBLE), |range_max_m| distance_m(point.position_m, [0.0; 2]) <= range_max_m)
        };
        let reports: Vec<&TruthTarget> = reports.iter().filter(|target| counts(target)).collect();
        let given = self.assign(&reports);
        for report in reports {
            let distance = given.get(&report.target_id).and_then(|track| self.distance(report, &self.tracks[track]));
            self.points.count(distance.is_some());
            if report.flags & (VEHICLE | ON_GROUND) == ON_GROUND {
                self.ground.count(distance.is_some());
            }
            if let Some(distance) = distance {
                self.distances.saturating_record((distance * 1000.0).round() as u64);
            }
        }
        for (address, track) in given {
            self.changes += u64::from(self.holder.entry(address).or_default().follow(track));
        }
    }

    /// The track of each address in one second.
    fn assign(&mut self, reports: &[&TruthTarget]) -> HashMap<u32, u64> {
        let mut pairs = Vec::new();
        for report in reports {
            for (&track, followed) in &self.tracks {
                if let Some(distance) = self.distance(report, followed) {
                    let kept = self.holder.get(&report.target_id).is_some_and(|holder| holder.is(&track));
                    pairs.push((!kept, distance, report.target_id, track));
                }
            }
        }
        pairs.sort_by(|a, b| a.partial_cmp(b).expect("distances are numbers"));
        let (mut given, mut taken) = (HashMap::new(), HashSet::new());
        for &(_, _, address, track) in &pairs {
            if !given.contains_key(&address) && taken.insert(track) {
                given.insert(address, track);
            }
        }
        for (_, _, _, track) in pairs.iter().filter(|(_, _, _, track)| !taken.contains(track)) {
            if let Some(followed) = self.tracks.get_mut(track) {
                followed.standing.note(Role::Redundant);
            }
        }
        given
    }

    /// Distance of a track from a report if it is within the gate, m.
    fn distance(&self, report: &TruthTarget, track: &Followed) -> Option<f64> {
        let position = track.path.position_at(report.time_ns, self.gap_max_s(), self.hold_max_s())?;
        let [x, y, _] = report.position_m();
        Some(distance_m(position, [x, y])).filter(|&distance| distance <= self.gate_m(&PlanarPoint::from(report)))
    }

    /// Forgets what no later second needs.
    fn forget(&mut self) {
        let needed_ns = (self.scored_until * NS_PER_S as u64).saturating_sub(ns(self.gap_max_s() + 1.0));
        for track in self.tracks.values_mut() {
            track.path.forget_before(needed_ns);
        }
        let Self { tracks, never_near, redundant, .. } = self;
        tracks.retain(|_, track| {
            let ended = track.path.last_ns() < needed_ns;
            *never_near += u64::from(ended && track.standing.is_false());
            *redundant += u64::from(ended && track.standing.is_redundant());
            !ended
        });
        self.targets.retain(|_, target| {
            target.forget_before(needed_ns);
            target.last_ns() >= needed_ns
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::CONFIRMED;

    /// Scores a target that moves east at 10 m/s for twenty seconds; tracks 1, 2, … are `beside` it by so much, m north.
    fn score(beside: &[f64]) -> Tracking {
        let config = ScoringConfig { gate_m: Some(75.0), range_max_m: Some(3000.0), ..ScoringConfig::default() };
        let mut cooperative = Cooperative::new(&config);
        for second in 1..=20_u32 {
            let time_ns = u64::from(second) * NS_PER_S as u64;
            let mut target = TruthTarget { target_id: 7, time_ns, ..TruthTarget::default() };
            (target.state[0], target.state[1]) = (10.0 * f64::from(second), 10.0);
            cooperative.truth(&TruthHeader { time_ns, ..TruthHeader::default() }, &[target]);
            let tracks: Vec<Track> = (1..)
                .zip(beside)
                .map(|(id, north_m)| {
                    let mut track = Track { id, time_ns, state_code: CONFIRMED, ..Track::default() };
                    (track.state[0], track.state[1], track.state[3]) = (target.state[0], 10.0, *north_m);
                    track
                })
                .collect();
            cooperative.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &tracks);
        }
        cooperative.finish()
    }

    #[test]
    fn a_second_track_of_an_address_is_redundant_and_not_false() {
        let counts = |tracking: &Tracking| (tracking.false_tracks, tracking.redundant_tracks, tracking.id_changes);
        assert_eq!(counts(&score(&[1.0])), (Some(0), Some(0), Some(0)));
        assert_eq!(counts(&score(&[1.0, 40.0])), (Some(0), Some(1), Some(0)));
        assert_eq!(counts(&score(&[1.0, 400.0])), (Some(1), Some(0), Some(0)));
    }
}
