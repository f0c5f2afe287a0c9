//! A cooperative sensor, recorded or listened to: where the targets that carry transponders were.
//!
//! Positions are Cartesian about the sensor's reference point; [`Registration`] brings them
//! into the radar's frame, at the height of the ground: flight levels are barometric
//! and not used. The radar sees an aircraft's centroid, which lies behind its antenna,
//! so that an aircraft's position is moved back along its heading. Vehicles are not moved.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use asterix::clock::DayClock;
use asterix::editions::{EditionError, Editions};
use asterix::recording::{Received, Recording};
use asterix::recovery::records;
use asterix::report::{Artificial, Message, TargetKind, TimeOfDay};
use common::config::PlotSourceConfig;
use common::health::{Reject, Rejected};
use common::truth::{AIRBORNE, MAX_TARGETS, MODE_UNKNOWN, ON_GROUND, PLANAR, TruthTarget, VEHICLE, VISIBLE};
use nalgebra::Vector3;

use crate::contents::{Contents, editions};
use crate::radar_clock::RadarClock;
use crate::registration::Registration;
use crate::repeats::Repeats;

/// Below this speed the direction of a velocity says nothing of the heading: the last one holds, m/s.
const SLOWEST_HEADING_MPS: f64 = 1.0;
/// Targets that wait for the end of a scan at most: twice what a message holds.
const MOST_WAITING: usize = 2 * MAX_TARGETS;
/// A time that is farther ahead is wrong, ns.
const MOST_AHEAD_NS: i64 = 10_000_000_000;
/// Addresses whose headings are known, at most; then all are forgotten.
const MOST_HEADINGS: usize = 1 << 16;

/// A cooperative sensor's recording, decoded.
#[derive(Debug, Clone, Default)]
pub struct TruthRecording {
    /// Targets by time.
    pub targets: Vec<TruthTarget>,
    /// What the file holds.
    pub contents: Contents,
    /// What was not used.
    pub rejected: Rejected,
}

impl TruthRecording {
    /// Decodes `bytes`, a recording that began within half a day of `near_ns`.
    pub fn decode(
        bytes: &[u8],
        editions: &Editions,
        midnight_ns: u64,
        near_ns: i64,
        config: &PlotSourceConfig,
    ) -> Self {
        let mut recording = Self::default();
        let mut clock = DayClock::near(midnight_ns, near_ns);
        let mut decoder = Decoder::new(config);
        let file = Recording::new(bytes, editions);
        for record in file.records(editions) {
            let message = recording.contents.take(record, &mut recording.rejected);
            match message.and_then(|message| decoder.target(&message, |time| clock.time_ns(time))) {
                Ok(target) => recording.targets.push(target),
                Err(reason) => recording.rejected.count(reason),
            }
        }
        recording.contents.foreign = file.foreign;
        recording.targets.sort_by_key(|target| (target.time_ns, target.target_id));
        recording
    }
}

/// A cooperative sensor that is listened to.
#[derive(Debug)]
pub struct LiveTruth {
    editions: Arc<Editions>,
    decoder: Decoder,
    repeats: Repeats,
    contents: Contents,
    /// Targets that no scan has taken yet.
    waiting: VecDeque<TruthTarget>,
    /// When the scan began whose targets were taken last, ns: what is older comes too late.
    begun_ns: u64,
    rejected: Rejected,
}

impl LiveTruth {
    /// The sensor of a configuration.
    ///
    /// # Errors
    /// [`EditionError`]: an edition is configured that is not known.
    pub fn new(config: &PlotSourceConfig) -> Result<Self, EditionError> {
        Ok(Self {
            editions: Arc::new(editions(config)?),
            decoder: Decoder::new(config),
            repeats: Repeats::default(),
            contents: Contents::default(),
            waiting: VecDeque::new(),
            begun_ns: 0,
            rejected: Rejected::default(),
        })
    }

    /// Takes a datagram that arrived at `now_ns`; times are those of the radar's clock.
    pub fn take(&mut self, datagram: &[u8], now_ns: u64, clock: &RadarClock) {
        let editions = Arc::clone(&self.editions);
        for record in records(&editions, datagram, 0) {
            if let Ok(record) = &record
                && self.repeats.is_repeated(record.edition.category, record.bytes, true, now_ns)
            {
                continue;
            }
            let received = record.map(|record| Received { record, time_ns: None, destination: None });
            let message = self.contents.take(received, &mut self.rejected);
            match message.and_then(|message| self.decoder.target(&message, |time| clock.time_ns(time, now_ns))) {
                Ok(target) => self.wait(target, clock.present_ns(now_ns)),
                Err(reason) => self.rejected.count(reason),
            }
        }
    }

    /// Keeps a target for its scan, in place of the oldest if there is no room.
    fn wait(&mut self, target: TruthTarget, present_ns: i64) {
        if target.time_ns < self.begun_ns {
            return self.rejected.count(Reject::Late);
        }
        if target.time_ns as i64 > present_ns + MOST_AHEAD_NS {
            return self.rejected.count(Reject::NoTime);
        }
        if self.waiting.len() == MOST_WAITING {
            self.waiting.pop_front();
            self.rejected.count(Reject::Full);
        }
        self.waiting.push_back(target);
    }

    /// Where the targets were in a scan that lasted over these measurement times, ns, and what of the one before has come since; by
    /// time. Later ones wait.
    pub fn of_scan(&mut self, (begin_ns, end_ns): (u64, u64)) -> Vec<TruthTarget> {
        // Before the first scan there is nothing to score.
        let from_ns = if self.begun_ns == 0 { begin_ns } else { self.begun_ns };
        self.begun_ns = begin_ns.max(from_ns);
        let (mut targets, mut early) = (Vec::new(), 0);
        self.waiting.retain(|target| {
            let is_later = target.time_ns >= end_ns;
            if target.time_ns < from_ns {
                early += 1;
            } else if !is_later {
                targets.push(*target);
            }
            is_later
        });
        targets.sort_by_key(|target| (target.time_ns, target.target_id));
        self.rejected.count_many(Reject::Late, early);
        self.rejected.count_many(Reject::Full, targets.len().saturating_sub(MAX_TARGETS) as u64);
        targets.truncate(MAX_TARGETS);
        targets
    }

    /// What was not used.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }
}

#[derive(Debug)]
struct Decoder {
    registration: Registration,
    coverage_range_m: f64,
    /// Last known heading by address, a unit vector.
    headings: HashMap<u32, Vector3<f64>>,
}

impl Decoder {
    fn new(config: &PlotSourceConfig) -> Self {
        let registration = Registration::new(&config.registration);
        Self { registration, coverage_range_m: config.coverage_range_m, headings: HashMap::new() }
    }

    /// The target of a report; `time_of` says the measurement time of a time of day, ns.
    fn target(&mut self, message: &Message, time_of: impl FnOnce(TimeOfDay) -> i64) -> Result<TruthTarget, Reject> {
        let Message::Target(report) = message else { return Err(Reject::NotATarget) };
        if report.artificial != Artificial::default() {
            return Err(Reject::FixedMonitor);
        }
        let target_id = report.address.filter(|&address| address != 0).ok_or(Reject::NoAddress)?;
        let time_ns = time_of(report.time_of_day.ok_or(Reject::NoTime)?).max(0) as u64;
        let mut position = self.registration.position_enu(report.cartesian_m.ok_or(Reject::NoPosition)?);
        let velocity = self.registration.velocity_enu(report.velocity_mps.unwrap_or_default());
        if velocity.norm() > SLOWEST_HEADING_MPS {
            if self.headings.len() == MOST_HEADINGS {
                self.headings.clear();
            }
            self.headings.insert(target_id, velocity.normalize());
        }
        if report.kind == TargetKind::Aircraft
            && let Some(heading) = self.headings.get(&target_id)
        {
            position += self.registration.centroid_shift_m(heading);
        }
        let visible = if position.xy().norm() <= self.coverage_range_m { VISIBLE } else { 0 };
        let kind = match (report.kind, report.on_ground) {
            (TargetKind::GroundVehicle, _) => VEHICLE | ON_GROUND,
            (TargetKind::Undetermined, false) => 0,
            (_, true) => ON_GROUND,
            (_, false) => AIRBORNE,
        };
        Ok(TruthTarget {
            time_ns,
            target_id,
            mode: MODE_UNKNOWN,
            state: [position.x, velocity.x, 0.0, position.y, velocity.y, 0.0, 0.0, 0.0, 0.0],
            snr_db: f32::NAN,
            flags: visible | kind | PLANAR,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asterix::report::TargetReport;

    const SECOND: u64 = 1_000_000_000;

    fn live() -> LiveTruth {
        LiveTruth::new(&PlotSourceConfig::default()).expect("known editions")
    }

    fn target(target_id: u32, time_ns: u64) -> TruthTarget {
        TruthTarget { target_id, time_ns, ..TruthTarget::default() }
    }

    fn ids(targets: &[TruthTarget]) -> Vec<u32> {
        targets.iter().map(|target| target.target_id).collect()
    }

    /// What came before the first scan is not scored, what comes after the end of its scan is with the next one, and what is later or far
    /// ahead is counted.
    #[test]
    fn every_scan_has_its_targets() {
        let mut truth = live();
        let at =
            |truth: &mut LiveTruth, id: u32, time_s: u64| truth.wait(target(id, time_s * SECOND), 30 * SECOND as i64);
        at(&mut truth, 1, 5);
        at(&mut truth, 3, 12);
        at(&mut truth, 2, 11);
        at(&mut truth, 4, 22);
        assert_eq!(ids(&truth.of_scan((10 * SECOND, 20 * SECOND))), [2, 3]);
        at(&mut truth, 5, 19);
        at(&mut truth, 6, 9);
        at(&mut truth, 7, 3600);
        assert_eq!(ids(&truth.of_scan((20 * SECOND, 30 * SECOND))), [5, 4]);
        at(&mut truth, 8, 19);
        assert!(truth.of_scan((30 * SECOND, 40 * SECOND)).is_empty());
        let counts = [Reject::Late, Reject::NoTime, Reject::Full].map(|reason| truth.rejected().of(reason));
        assert_eq!(counts, [3, 1, 0]);
    }

    #[test]
    fn memory_is_bounded_whatever_comes() {
        let mut truth = live();
        for id in 0..10_000 {
            truth.wait(target(id, SECOND + u64::from(id)), SECOND as i64);
        }
        assert_eq!(truth.waiting.len(), MOST_WAITING);
        let targets = truth.of_scan((SECOND, 2 * SECOND));
        assert_eq!((targets.len(), targets[0].target_id), (MAX_TARGETS, 10_000 - MOST_WAITING as u32), "the last ones");
        assert_eq!(truth.rejected().of(Reject::Full) as usize, 10_000 - MAX_TARGETS);
        let mut decoder = Decoder::new(&PlotSourceConfig::default());
        let moving = TargetReport {
            time_of_day: Some(TimeOfDay { steps: 0, period: TimeOfDay::DAY }),
            cartesian_m: Some((100.0, 100.0)),
            velocity_mps: Some((10.0, 0.0)),
            ..TargetReport::default()
        };
        for address in 1..=2 * MOST_HEADINGS as u32 {
            let report = TargetReport { address: Some(address), ..moving };
            decoder.target(&Message::Target(report), |_| 0).expect("a target");
        }
        assert!(decoder.headings.len() <= MOST_HEADINGS);
    }
}
