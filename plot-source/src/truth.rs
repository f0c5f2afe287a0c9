//! A cooperative sensor, recorded or listened to: where the targets that carry transponders were.
//!
//! Positions are Cartesian about the sensor's reference point; [`Registration`] brings them
//! into the radar's frame, at the height of the ground: flight levels are barometric
//! and not used. The radar sees an aircraft's centroid, which lies behind its antenna,
//! so that an aircraft's position is moved back along its heading. Vehicles are not moved.

use std::collections::HashMap;

use asterix::editions::{EditionError, Editions};
use asterix::recording::{Received, Recording};
use asterix::recovery::records;
use asterix::report::{Artificial, Message, TargetKind, TimeOfDay};
use common::config::PlotSourceConfig;
use common::health::{Reject, Rejected};
use common::truth::{AIRBORNE, MAX_TARGETS, MODE_UNKNOWN, ON_GROUND, PLANAR, TruthTarget, VEHICLE, VISIBLE};
use nalgebra::Vector3;

use crate::clock::DayClock;
use crate::contents::{Contents, editions};
use crate::registration::Registration;
use crate::repeats::Repeats;

/// Below this speed the direction of a velocity says nothing of the heading: the last one holds, m/s.
const SLOWEST_HEADING_MPS: f64 = 1.0;
/// Targets that wait for the end of a scan at most: twice what a message holds.
const MOST_WAITING: usize = 2 * MAX_TARGETS;

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
    editions: Editions,
    decoder: Decoder,
    repeats: Repeats,
    contents: Contents,
    /// Targets of scans that have not ended.
    waiting: Vec<TruthTarget>,
    /// The last scan ended at this measurement time, ns.
    ended_ns: u64,
    rejected: Rejected,
}

impl LiveTruth {
    /// The sensor of a configuration.
    ///
    /// # Errors
    /// [`EditionError`]: an edition is configured that is not known.
    pub fn new(config: &PlotSourceConfig) -> Result<Self, EditionError> {
        Ok(Self {
            editions: editions(config)?,
            decoder: Decoder::new(config),
            repeats: Repeats::default(),
            contents: Contents::default(),
            waiting: Vec::new(),
            ended_ns: 0,
            rejected: Rejected::default(),
        })
    }

    /// Takes a datagram that arrived at `now_ns`; `time_of` says the measurement time of a time of day, ns.
    pub fn take(&mut self, datagram: &[u8], now_ns: u64, time_of: impl Fn(TimeOfDay) -> i64) {
        for record in records(&self.editions, datagram, 0) {
            if let Ok(record) = &record
                && self.repeats.is_repeated(record.edition.category, record.bytes, true, now_ns)
            {
                continue;
            }
            let received = record.map(|record| Received { record, time_ns: None, destination: None });
            let message = self.contents.take(received, &mut self.rejected);
            let target = message.and_then(|message| self.decoder.target(&message, &time_of));
            match target.and_then(|target| self.place_for(&target).map(|()| target)) {
                Ok(target) => self.waiting.push(target),
                Err(reason) => self.rejected.count(reason),
            }
        }
    }

    fn place_for(&self, target: &TruthTarget) -> Result<(), Reject> {
        match target.time_ns {
            time_ns if time_ns < self.ended_ns => Err(Reject::Late),
            _ if self.waiting.len() >= MOST_WAITING => Err(Reject::Full),
            _ => Ok(()),
        }
    }

    /// Where the targets were until a scan ended at measurement time `end_ns`, by time; later ones wait.
    pub fn until(&mut self, end_ns: u64) -> Vec<TruthTarget> {
        self.ended_ns = self.ended_ns.max(end_ns);
        self.waiting.sort_by_key(|target| (target.time_ns, target.target_id));
        let of_scan = self.waiting.partition_point(|target| target.time_ns < end_ns);
        let mut targets: Vec<TruthTarget> = self.waiting.drain(..of_scan).collect();
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
