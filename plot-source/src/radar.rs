//! The radar's recording: target reports and start-of-cycle messages.

use common::angle;
use common::health::{Reject, Rejected};

use crate::asterix::cat010::{MessageType, Record};
use crate::asterix::records;
use crate::clock::DayClock;

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
        for record in records(bytes) {
            recording.records += u64::from(record.is_ok());
            let taken = record.and_then(|record| recording.take(&record, &mut clock, azimuth_bias_rad));
            if let Err(reason) = taken {
                recording.rejected.count(reason);
            }
        }
        recording
    }

    fn take(&mut self, record: &Record, clock: &mut DayClock, azimuth_bias_rad: f64) -> Result<(), Reject> {
        match record.message_type {
            Some(MessageType::TargetReport) => {
                if record.descriptor.is_some_and(|descriptor| descriptor.fixed_monitor || descriptor.test) {
                    return Err(Reject::FixedMonitor);
                }
                let time_ns = clock.time_ns(record.time_of_day.ok_or(Reject::NoTime)?);
                let (range_m, azimuth_rad) = record.polar.ok_or(Reject::NoPosition)?;
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

    /// Time of the earliest report or start of cycle, ns UTC.
    pub fn begin_ns(&self) -> Option<u64> {
        self.reports.iter().map(|report| report.time_ns).chain(self.cycles_ns.iter().copied()).min()
    }
}
