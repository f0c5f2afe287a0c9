//! The recording of a cooperative sensor: where the targets that carry transponders were.
//!
//! Positions are Cartesian about the sensor's reference point; [`Registration`] brings them
//! into the radar's frame, at the height of the ground: flight levels are barometric
//! and not used. The radar sees an aircraft's centroid, which lies behind its antenna,
//! so that an aircraft's position is moved back along its heading. Vehicles are not moved.

use std::collections::HashMap;

use asterix::editions::Editions;
use asterix::recording::Recording;
use asterix::report::{Artificial, Message, TargetKind};
use common::config::PlotSourceConfig;
use common::health::{Reject, Rejected};
use common::truth::{AIRBORNE, MODE_UNKNOWN, ON_GROUND, PLANAR, TruthTarget, VEHICLE, VISIBLE};
use nalgebra::Vector3;

use crate::clock::DayClock;
use crate::contents::Contents;
use crate::registration::Registration;

/// Below this speed the direction of a velocity says nothing of the heading: the last one holds, m/s.
const SLOWEST_HEADING_MPS: f64 = 1.0;

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
        let mut decoder = Decoder {
            clock: DayClock::near(midnight_ns, near_ns),
            registration: Registration::new(&config.registration),
            coverage_range_m: config.coverage_range_m,
            headings: HashMap::new(),
        };
        let file = Recording::new(bytes, editions);
        for record in file.records(editions) {
            let message = recording.contents.take(record, &mut recording.rejected);
            match message.and_then(|message| decoder.target(&message)) {
                Ok(target) => recording.targets.push(target),
                Err(reason) => recording.rejected.count(reason),
            }
        }
        recording.contents.foreign = file.foreign;
        recording.targets.sort_by_key(|target| (target.time_ns, target.target_id));
        recording
    }
}

struct Decoder {
    clock: DayClock,
    registration: Registration,
    coverage_range_m: f64,
    /// Last known heading by address, a unit vector.
    headings: HashMap<u32, Vector3<f64>>,
}

impl Decoder {
    fn target(&mut self, message: &Message) -> Result<TruthTarget, Reject> {
        let Message::Target(report) = message else { return Err(Reject::NotATarget) };
        if report.artificial != Artificial::default() {
            return Err(Reject::FixedMonitor);
        }
        let target_id = report.address.filter(|&address| address != 0).ok_or(Reject::NoAddress)?;
        let time_ns = self.clock.time_ns(report.time_of_day.ok_or(Reject::NoTime)?).max(0) as u64;
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
