//! The radar's recording: target reports and the messages that say where the antenna is.

use std::f64::consts::TAU;

use asterix::clock::DayClock;
use asterix::editions::Editions;
use asterix::record::Record;
use asterix::recording::{Received, Recording};
use asterix::report::{Artificial, Message, Service, ServiceMessage, SourceId, TargetReport};
use common::angle;
use common::config::{PlotSourceConfig, SiteConfig};
use common::health::{Reject, Rejected};

use crate::contents::Contents;
use crate::habits::{Habits, RangeRates};
use crate::repeats::Repeats;
use crate::scan_lines::ScanLines;
use crate::table::Table;
use crate::turning::at_pace;

/// One target report: all that a tracker may know of it.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Report {
    /// Time of the report by the radar's clock, ns since 1970, if it has one.
    pub clock_ns: Option<i64>,
    /// Slant range, m.
    pub range_m: f64,
    /// Azimuth after registration, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// Range rate, m/s, positive when receding, if measured.
    pub range_rate_mps: Option<f64>,
    /// Height above the sea, m, if known.
    pub height_m: Option<f64>,
    /// Amplitude, dB relative to a reference of the radar, if sent.
    pub amplitude_db: Option<f64>,
    /// Simulated, of a test or of a fixed monitor.
    pub is_artificial: bool,
    /// 24-bit address of the transponder; 0 where none was received.
    pub address: u32,
}

/// A start-of-cycle message: the antenna passes north.
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
    /// What its range rates mean.
    pub range_rates: RangeRates,
    /// Where only the time of a whole scan is known: from north to that time, ns. It is that of all plots of the scan.
    pub half_turn_ns: Option<i64>,
    /// Crossings of the first sector: north, where the radar does not say so otherwise.
    first_sectors: Vec<Cycle>,
}

/// A recording of several sensors of which none, or more than one, can be the site's: those found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WhichSource(pub String);

/// How reports of a radar are taken.
struct Intake<'a> {
    clock: DayClock,
    config: &'a PlotSourceConfig,
    azimuth_bias_rad: f64,
    habits: Habits,
}

impl RadarRecording {
    /// Decodes `bytes`, whose first report was made on the configured day, and takes what comes from the sensor that
    /// `site` names, or from the only one.
    ///
    /// # Errors
    /// [`WhichSource`].
    pub fn decode(
        bytes: &[u8],
        editions: &Editions,
        config: &PlotSourceConfig,
        azimuth_bias_rad: f64,
        site: &SiteConfig,
    ) -> Result<Self, WhichSource> {
        let mut recording = Self::default();
        let file = Recording::new(bytes, editions);
        let mut all = Vec::new();
        let mut repeats = Repeats::default();
        for record in file.records(editions) {
            if record.as_ref().is_ok_and(|received| is_repeated(received, &mut repeats)) {
                recording.contents.repeated += 1;
                continue;
            }
            match recording.contents.take(record, &mut recording.rejected) {
                Ok(message) => all.push(message),
                Err(reason) => recording.rejected.count(reason),
            }
        }
        recording.contents.foreign = file.foreign;
        let own: Vec<SourceId> =
            recording.contents.sources.keys().copied().filter(|&source| is_of(source, site)).collect();
        recording.source = match own[..] {
            [source] => Some(source),
            [] if recording.contents.sources.is_empty() => None,
            _ => {
                let found = || WhichSource(recording.contents.sources_found());
                Some(recording.contents.dominating(&own).ok_or_else(found)?)
            }
        };
        let mut clock = clock_of(&all, config.midnight_ns());
        let mut habits = Habits::new(config.sigma_range_m, config.sigma_range_rate_mps);
        for report in all.iter().filter_map(own_report(recording.source)) {
            habits.learn(report, report.time_of_day.map(|time_of_day| clock.time_ns(time_of_day)));
        }
        recording.range_rates = habits.range_rates();
        let clock = clock_of(&all, config.midnight_ns());
        let mut intake = Intake { clock, config, azimuth_bias_rad, habits };
        for message in all {
            // A record that names no sensor can only be the site's.
            let is_foreign = message.source().is_some_and(|source| recording.source != Some(source));
            let taken = if is_foreign { Err(Reject::ForeignSource) } else { recording.take(&message, &mut intake) };
            if let Err(reason) = taken {
                recording.rejected.count(reason);
            }
        }
        if recording.cycles.is_empty() {
            recording.cycles = std::mem::take(&mut recording.first_sectors);
        }
        Ok(recording)
    }

    /// The plots of a table, in its order.
    pub fn of_table(table: &Table, midnight_ns: u64, azimuth_bias_rad: f64) -> Self {
        let reports: Vec<Report> = table
            .rows
            .iter()
            .zip(table.times_ns(midnight_ns))
            .map(|(row, time_ns)| Report {
                clock_ns: Some(time_ns),
                range_m: row.range_m,
                azimuth_rad: angle::wrap(row.azimuth_deg.to_radians() - azimuth_bias_rad),
                range_rate_mps: row.range_rate_mps,
                height_m: row.height_m,
                amplitude_db: row.amplitude_db,
                is_artificial: false,
                address: 0,
            })
            .collect();
        let contents = Contents { records: reports.len() as u64, ..Contents::default() };
        Self { reports, contents, ..Self::default() }
    }

    /// The plots of whole scans. Where the beam was at their time is not known: each turn is laid about the time of its scan.
    pub fn of_scans(lines: &ScanLines, turn_ns: i64, azimuth_bias_rad: f64) -> Self {
        let mut this = Self { half_turn_ns: Some(turn_ns / 2), ..Self::default() };
        for scan in &lines.scans {
            this.cycles.push(Cycle { clock_ns: scan.time_ns() - turn_ns / 2, reports_before: this.reports.len() });
            this.reports.extend(scan.polar().map(|(range_m, azimuth_rad)| Report {
                range_m,
                azimuth_rad: angle::wrap(azimuth_rad - azimuth_bias_rad),
                ..Report::default()
            }));
        }
        this.contents.records = this.reports.len() as u64;
        this
    }

    /// North passages at the pace of the configured turn, for plots whose times and azimuths know of none.
    pub fn assume_turns(&mut self, turn_ns: i64) {
        self.cycles = at_pace(&self.reports, turn_ns, 0);
    }

    fn take(&mut self, message: &Message, intake: &mut Intake<'_>) -> Result<(), Reject> {
        match message {
            Message::Target(report) => {
                let report = intake.report(report)?;
                self.reports.push(report);
            }
            Message::Service(message) => {
                let cycles = match message.service {
                    Service::North => &mut self.cycles,
                    Service::Sector if is_first_sector(message) => &mut self.first_sectors,
                    _ => return Err(Reject::NotATarget),
                };
                let clock_ns = intake.clock.time_ns(message.time_of_day.ok_or(Reject::NoTime)?);
                cycles.push(Cycle { clock_ns, reports_before: self.reports.len() });
            }
        }
        Ok(())
    }

    /// The sensors of the file that are not the site's, with their records.
    pub fn foreign(&self) -> impl Iterator<Item = (SourceId, u64)> {
        let own = self.source;
        self.contents.sources.iter().map(|(&source, &count)| (source, count)).filter(move |(id, _)| Some(*id) != own)
    }
}

impl Intake<'_> {
    fn report(&mut self, report: &TargetReport) -> Result<Report, Reject> {
        is_used(report, self.config, &self.habits)?;
        let clock_ns = report.time_of_day.map(|time_of_day| self.clock.time_ns(time_of_day));
        let (range_m, azimuth_rad) = report.polar.ok_or(Reject::NoPosition)?;
        if range_m <= 0.0 {
            return Err(Reject::BadPlot);
        }
        Ok(Report {
            clock_ns,
            range_m,
            azimuth_rad: angle::wrap(azimuth_rad - self.azimuth_bias_rad),
            range_rate_mps: self.habits.range_rates().of(report),
            height_m: report.height_m.or(report.pressure_height_m),
            amplitude_db: report.amplitude_db,
            is_artificial: report.artificial != Artificial::default(),
            address: report.address.unwrap_or(0),
        })
    }
}

/// Whether a record was captured before: on a second line, or twice on one. A file of blocks knows nothing of lines.
fn is_repeated(received: &Received<'_>, repeats: &mut Repeats) -> bool {
    let Some((now_ns, message)) = received.time_ns.zip(Message::of(&received.record)) else { return false };
    let Record { edition, bytes, .. } = received.record;
    repeats.is_repeated(edition.category, bytes, message.time_of_day().is_some(), now_ns)
}

/// The target reports of a sensor, and those that name none.
fn own_report(source: Option<SourceId>) -> impl Fn(&Message) -> Option<&TargetReport> {
    move |message| match message {
        Message::Target(report) if report.source.is_none() || report.source == source => Some(report),
        _ => None,
    }
}

/// A clock that knows the day's time also where the first reports send only a part of it.
fn clock_of(messages: &[Message], midnight_ns: u64) -> DayClock {
    let mut times = messages.iter().filter_map(Message::time_of_day);
    let first_whole = times.find(|time| time.period == asterix::report::TimeOfDay::DAY);
    match first_whole {
        Some(time) => {
            let near_ns = DayClock::new(midnight_ns).time_ns(time);
            DayClock::near(midnight_ns, near_ns)
        }
        None => DayClock::new(midnight_ns),
    }
}

/// Sector messages name the azimuth at which their sector begins, to 360°/256.
fn is_first_sector(message: &ServiceMessage) -> bool {
    message.azimuth_rad.is_some_and(|azimuth_rad| azimuth_rad < 0.5 * TAU / 256.0)
}

/// Refuses reports of what is not there, as far as the configuration does.
pub(crate) fn is_used(report: &TargetReport, config: &PlotSourceConfig, habits: &Habits) -> Result<(), Reject> {
    let Artificial { simulated, test, monitor } = report.artificial;
    if (simulated && !config.use_simulated) || (test && !config.use_test) || (monitor && !config.use_monitors) {
        return Err(Reject::FixedMonitor);
    }
    if habits.is_extrapolated(report) { Err(Reject::NotATarget) } else { Ok(()) }
}

/// Whether a sensor may be that of a site.
pub(crate) fn is_of(source: SourceId, site: &SiteConfig) -> bool {
    site.sac.is_none_or(|it| it == source.sac) && site.sic.is_none_or(|it| it == source.sic)
}
