//! Radar reports to the `plots` messages of a scan, one per sector.
//!
//! Within a turn time and azimuth go together (see [`crate::rotation`]), but reports are not
//! in order of either. A sector holds the reports of its azimuth interval; with all
//! reports of the turn at hand, each interval is complete when it is published.

use std::f64::consts::TAU;

use common::angle;
use common::config::{PlotSourceConfig, SiteConfig};
use common::health::{Reject, Rejected};
use common::message::{END_OF_SCAN, Lineage, Stamps, TRUNCATED};
use common::plots::{Plot, PlotsHeader};
use common::services::MAX_PLOTS;
use common::units::seconds_between;

use crate::asterix::block::Blocks;
use crate::asterix::cat010::{CATEGORY, MessageType, Record, Records};
use crate::clock::DayClock;
use crate::rotation::Rotations;

/// One target report: all that a tracker may know of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Time of the report, ns UTC.
    pub time_ns: u64,
    /// Slant range, m.
    pub range_m: f64,
    /// Azimuth after registration, rad, in [0, 2π).
    pub azimuth_rad: f64,
}

/// A radar's recording, decoded.
#[derive(Debug, Clone, Default)]
pub struct RadarRecording {
    /// Target reports in file order.
    pub reports: Vec<Report>,
    /// Times of the start-of-cycle messages, ns UTC.
    pub cycles_ns: Vec<u64>,
    /// Records that could be read.
    pub records: u64,
    /// What was not used.
    pub rejected: Rejected,
}

impl RadarRecording {
    /// Decodes `bytes`, whose first report was made on the day that begins at `midnight_ns`.
    pub fn decode(bytes: &[u8], midnight_ns: u64, azimuth_bias_rad: f64) -> Self {
        let mut recording = Self::default();
        let mut clock = DayClock::new(midnight_ns);
        let mut rejected = Rejected::default();
        for record in records(bytes, &mut rejected) {
            recording.records += 1;
            if let Err(reason) = recording.take(&record, &mut clock, azimuth_bias_rad) {
                recording.rejected.count(reason);
            }
        }
        recording.rejected.add(&rejected);
        recording
    }

    fn take(&mut self, record: &Record, clock: &mut DayClock, azimuth_bias_rad: f64) -> Result<(), Reject> {
        match record.message_type {
            Some(MessageType::TargetReport) => {
                let time_ns = clock.time_ns(record.time_of_day.ok_or(Reject::NoTime)?);
                let (range_m, azimuth_rad) = record.polar.ok_or(Reject::NoPosition)?;
                if record.descriptor.is_some_and(|descriptor| descriptor.fixed_monitor) {
                    return Err(Reject::FixedMonitor);
                }
                if range_m <= 0.0 {
                    return Err(Reject::BadPlot);
                }
                let azimuth_rad = angle::wrap(azimuth_rad - azimuth_bias_rad);
                self.reports.push(Report { time_ns, range_m, azimuth_rad });
            }
            Some(MessageType::StartOfUpdateCycle) => {
                self.cycles_ns.push(clock.time_ns(record.time_of_day.ok_or(Reject::NoTime)?));
            }
            _ => return Err(Reject::NotATarget),
        }
        Ok(())
    }
}
