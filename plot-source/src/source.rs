//! A recording as the messages of its scans.

use std::path::Path;

use common::config::ChainConfig;
use common::health::Rejected;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{Plot, PlotsHeader};
use common::truth::{MAX_TARGETS, TruthHeader, TruthTarget};
use common::units::{NS_PER_S, seconds_between};

use crate::error::SourceError;
use crate::radar::{RadarRecording, Report};
use crate::registration::Registration;
use crate::rotation::Rotations;
use crate::sectors::SectorLayout;
use crate::truth::TruthRecording;

/// The messages of one scan, in the order of their publication. Sessions and stamps are the shell's.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// When the scan began, ns UTC.
    pub begin_ns: u64,
    /// One message per sector.
    pub plots: Vec<(PlotsHeader, Vec<Plot>)>,
    /// Where the cooperative targets were in this scan; none without a recording of truth.
    pub truth: Option<(TruthHeader, Vec<TruthTarget>)>,
}

/// Decoded recordings, scan by scan.
#[derive(Debug)]
pub struct Source {
    layout: SectorLayout,
    rotations: Rotations,
    /// Reports with their scans, by scan.
    reports: Vec<(u32, Report)>,
    /// Truth by time, if there is a recording of it.
    truth: Option<Vec<TruthTarget>>,
    scans: u32,
    next: u32,
    rejected: Rejected,
    records: u64,
}

impl Source {
    /// Reads and decodes the recordings that `config` names.
    ///
    /// # Errors
    /// [`SourceError`]: a file cannot be read, or there is nothing of use in it.
    pub fn open(config: &ChainConfig) -> Result<Self, SourceError> {
        if config.plot_source.file.is_empty() {
            return Err(SourceError::NoFile);
        }
        let radar_path = Path::new(&config.plot_source.file);
        let truth_path = Path::new(&config.plot_source.truth);
        let radar = read(radar_path)?;
        let truth = if config.plot_source.truth.is_empty() { None } else { Some(read(truth_path)?) };
        Self::decode(config, (radar_path, &radar), truth.as_deref().map(|bytes| (truth_path, bytes)))
    }

    /// As [`Source::open`], from bytes; the paths are for messages.
    ///
    /// # Errors
    /// [`SourceError`]: there is nothing of use in a recording.
    pub fn decode(
        config: &ChainConfig,
        (radar_path, radar): (&Path, &[u8]),
        truth: Option<(&Path, &[u8])>,
    ) -> Result<Self, SourceError> {
        let midnight_ns = config.plot_source.midnight_ns();
        let bias_rad = Registration::new(&config.plot_source.registration).azimuth_bias_rad();
        let radar_recording = RadarRecording::decode(radar, midnight_ns, bias_rad);
        let not_asterix =
            |path: &Path, bytes: &[u8]| SourceError::NotAsterix { path: path.to_path_buf(), bytes: bytes.len() };
        let begin_ns = radar_recording.begin_ns();
        if radar_recording.records == 0 {
            return Err(not_asterix(radar_path, radar));
        }
        let no_cycle = || SourceError::NoCycle { path: radar_path.to_path_buf() };
        let begin_ns = begin_ns.ok_or_else(no_cycle)?;
        let period_ns = (config.plot_source.scan_period_s * NS_PER_S) as u64;
        let rotations = Rotations::new(radar_recording.cycles_ns, Some(begin_ns), period_ns).ok_or_else(no_cycle)?;

        let mut rejected = radar_recording.rejected;
        let mut records = radar_recording.records;
        let truth = match truth {
            Some((path, bytes)) => {
                let recording = TruthRecording::decode(bytes, midnight_ns, begin_ns, &config.plot_source);
                if recording.records == 0 {
                    return Err(not_asterix(path, bytes));
                }
                rejected.add(&recording.rejected);
                records += recording.records;
                Some(recording.targets)
            }
            None => None,
        };
        let mut reports = Vec::with_capacity(radar_recording.reports.len());
        for report in radar_recording.reports {
            match rotations.scan_of(report.time_ns, report.azimuth_rad / std::f64::consts::TAU) {
                Some(scan) => reports.push((scan as u32, report)),
                None => rejected.count(common::health::Reject::Late),
            }
        }
        reports.sort_by_key(|&(scan, _)| scan);
        let available = rotations.scans() as u32;
        let scans = if config.run.scans == 0 { available } else { available.min(config.run.scans) };
        let layout = SectorLayout::new(&config.site, &config.plot_source);
        Ok(Self { layout, rotations, reports, truth, scans, next: 0, rejected, records })
    }

    /// Number of scans that there are to publish.
    pub fn scans(&self) -> u32 {
        self.scans
    }

    /// Records that could be read, of all recordings.
    pub fn records(&self) -> u64 {
        self.records
    }

    /// What was not used, by reason.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }

    /// Goes on with scan number `scan`: a restarted process rejoins the schedule.
    pub fn skip_to(&mut self, scan: u32) {
        self.next = scan.min(self.scans.saturating_sub(1));
    }

    fn truth_of(&self, scan: u32, bounds_ns: (u64, u64), end: u32) -> Option<(TruthHeader, Vec<TruthTarget>)> {
        let truth = self.truth.as_ref()?;
        let from = truth.partition_point(|target| target.time_ns < bounds_ns.0);
        let to = truth.partition_point(|target| target.time_ns < bounds_ns.1);
        let targets = truth[from..to].iter().copied().take(MAX_TARGETS).collect();
        let header = TruthHeader {
            seq: scan.into(),
            time_ns: bounds_ns.1,
            scan_period_s: seconds_between(bounds_ns.0, bounds_ns.1),
            scan,
            flags: END_OF_SCAN | end,
            ..TruthHeader::default()
        };
        Some((header, targets))
    }
}

impl Iterator for Source {
    type Item = Scan;

    fn next(&mut self) -> Option<Scan> {
        let scan = self.next;
        if scan >= self.scans {
            return None;
        }
        self.next += 1;
        let end = if self.next == self.scans { END_OF_STREAM } else { 0 };
        let bounds_ns = self.rotations.bounds_ns(scan as usize);
        let from = self.reports.partition_point(|&(of, _)| of < scan);
        let to = self.reports.partition_point(|&(of, _)| of <= scan);
        let reports: Vec<Report> = self.reports[from..to].iter().map(|&(_, report)| report).collect();
        let mut plots = self.layout.messages(scan, bounds_ns, &reports);
        if let Some((header, _)) = plots.last_mut() {
            header.flags |= end;
        }
        Some(Scan { begin_ns: bounds_ns.0, plots, truth: self.truth_of(scan, bounds_ns, end) })
    }
}

fn read(path: &Path) -> Result<Vec<u8>, SourceError> {
    std::fs::read(path).map_err(|cause| SourceError::Read { path: path.to_path_buf(), cause })
}
