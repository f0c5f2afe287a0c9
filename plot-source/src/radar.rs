//! The radar's recording: target reports and start-of-cycle messages.

use common::angle;
use common::config::SiteConfig;
use common::health::{Reject, Rejected};

use crate::asterix::cat010::{MessageType, Record};
use crate::asterix::records;
use crate::clock::DayClock;
use crate::contents::{Contents, SourceId};

/// One target report: all that a tracker may know of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Time of the report by the radar's clock, ns since 1970, if it has one.
    pub clock_ns: Option<i64>,
    /// Slant range, m.
    pub range_m: f64,
    /// Azimuth after registration, rad, in [0, 2π).
    pub azimuth_rad: f64,
}

/// A start-of-cycle message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cycle {
    /// Its time by the radar's clock, ns since 1970.
    pub clock_ns: i64,
    /// Target reports that stand before it in the file.
    pub reports_before: usize,
}

/// A radar's recording, decoded; everything in the order of the file.
#[derive(Debug, Clone, Default)]
pub struct RadarRecording {
    /// Target reports.
    pub reports: Vec<Report>,
    /// Start-of-cycle messages.
    pub cycles: Vec<Cycle>,
    /// What the file holds.
    pub contents: Contents,
    /// The sensor whose records were taken, if they name one.
    pub source: Option<SourceId>,
    /// What was not used.
    pub rejected: Rejected,
}

/// A recording of several sensors of which none, or more than one, can be the site's: those found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WhichSource(pub String);

impl RadarRecording {
    /// Decodes `bytes`, whose first report was made on the day that begins at `midnight_ns`, and takes what comes from
    /// the sensor that `site` names, or from the only one.
    ///
    /// # Errors
    /// [`WhichSource`].
    pub fn decode(
        bytes: &[u8],
        midnight_ns: u64,
        azimuth_bias_rad: f64,
        site: &SiteConfig,
    ) -> Result<Self, WhichSource> {
        let mut recording = Self::default();
        let mut all = Vec::new();
        for record in records(bytes) {
            match recording.contents.take(record, &mut recording.rejected) {
                Ok(record) => all.push(record),
                Err(reason) => recording.rejected.count(reason),
            }
        }
        let own: Vec<SourceId> =
            recording.contents.sources.keys().copied().filter(|&source| is_of(source, site)).collect();
        recording.source = match own[..] {
            [source] => Some(source),
            [] if recording.contents.sources.is_empty() => None,
            _ => return Err(WhichSource(recording.contents.sources_found())),
        };
        let mut clock = DayClock::new(midnight_ns);
        for record in all {
            // A record that names no sensor can only be the site's.
            let is_foreign = record.source_id.is_some_and(|source| recording.source != Some(SourceId(source)));
            let taken = if is_foreign {
                Err(Reject::ForeignSource)
            } else {
                recording.take(&record, &mut clock, azimuth_bias_rad)
            };
            if let Err(reason) = taken {
                recording.rejected.count(reason);
            }
        }
        Ok(recording)
    }

    fn take(&mut self, record: &Record, clock: &mut DayClock, azimuth_bias_rad: f64) -> Result<(), Reject> {
        match record.message_type {
            Some(MessageType::TargetReport) => {
                if record.descriptor.is_some_and(|descriptor| descriptor.fixed_monitor || descriptor.test) {
                    return Err(Reject::FixedMonitor);
                }
                let clock_ns = record.time_of_day.map(|time_of_day| clock.time_ns(time_of_day));
                let (range_m, azimuth_rad) = record.polar.ok_or(Reject::NoPosition)?;
                if range_m <= 0.0 {
                    return Err(Reject::BadPlot);
                }
                let azimuth_rad = angle::wrap(azimuth_rad - azimuth_bias_rad);
                self.reports.push(Report { clock_ns, range_m, azimuth_rad });
            }
            Some(MessageType::StartOfUpdateCycle) => {
                let clock_ns = clock.time_ns(record.time_of_day.ok_or(Reject::NoTime)?);
                self.cycles.push(Cycle { clock_ns, reports_before: self.reports.len() });
            }
            _ => return Err(Reject::NotATarget),
        }
        Ok(())
    }

    /// The sensors of the file that are not the site's, with their records.
    pub fn foreign(&self) -> impl Iterator<Item = (SourceId, u64)> {
        let own = self.source;
        self.contents.sources.iter().map(|(&source, &count)| (source, count)).filter(move |(id, _)| Some(*id) != own)
    }
}

/// Whether a sensor may be that of a site.
fn is_of(SourceId(source): SourceId, site: &SiteConfig) -> bool {
    let [sac, sic] = source.to_be_bytes();
    site.sac.is_none_or(|it| it == sac) && site.sic.is_none_or(|it| it == sic)
}
