//! A recording as the messages of its scans.

use std::path::Path;
use std::process::ExitCode;

use asterix::report::SourceId;
use common::config::{ChainConfig, PlotSourceConfig, SiteConfig};
use common::health::{Reject, Rejected};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{Plot, PlotsHeader};
use common::process::EXIT_CHECK_BROKEN;
use common::truth::{MAX_TARGETS, TruthHeader, TruthTarget};
use common::turning::Turning;
use common::units::{NS_PER_S, seconds_between};

use crate::contents::{Contents, editions};
use crate::error::SourceError;
use crate::habits::RangeRates;
use crate::level::AmplitudeLevel;
use crate::live::Trouble;
use crate::radar::{RadarRecording, Report, WhichSource};
use crate::registration::Registration;
use crate::rotation::Rotations;
use crate::scan_lines::ScanLines;
use crate::sectors::{SectorLayout, Sighting};
use crate::table::Table;
use crate::truth::TruthRecording;
use crate::turning::{Learnt, learn};
use crate::unlike::what_is;

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
    reports: Vec<(u32, Sighting)>,
    /// Truth by time, if there is a recording of it.
    truth: Option<Vec<TruthTarget>>,
    scans: u32,
    next: u32,
    rejected: Rejected,
    records: u64,
    notes: Vec<String>,
    is_sound: bool,
}

/// A turn is another one than the configured one that differs from it by this share.
const OTHER_TURN: f64 = 0.05;

impl Source {
    /// Reads and decodes the recordings that `config` names.
    ///
    /// # Errors
    /// [`SourceError`]: a file cannot be read, or there is nothing of use in it.
    pub fn open(config: &ChainConfig) -> Result<Self, SourceError> {
        let name = &config.plot_source.file;
        if name.is_empty() {
            return Err(SourceError::NoFile);
        }
        if name.contains("://") {
            return Err(SourceError::NotAFile { name: name.clone() });
        }
        if config.plot_source.truth.contains("://") {
            return Err(SourceError::TruthNotAFile { name: config.plot_source.truth.clone() });
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
        let plot_source = &config.plot_source;
        let midnight_ns = plot_source.midnight_ns();
        let bias_rad = Registration::new(&plot_source.registration).azimuth_bias_rad();
        let path = || radar_path.to_path_buf();
        let editions = editions(plot_source)?;
        let nominal_ns = (plot_source.scan_period_s * NS_PER_S) as i64;
        let scan_lines = ScanLines::of(radar);
        let table = if scan_lines.is_none() { Table::of(radar) } else { None };
        if let Some(table) = table.as_ref().filter(|table| table.rows.is_empty()) {
            return Err(SourceError::NoRow { path: path(), why: table.why_no_row() });
        }
        let mut recording = if let Some(lines) = &scan_lines {
            RadarRecording::of_scans(lines, nominal_ns, bias_rad)
        } else if let Some(table) = &table {
            RadarRecording::of_table(table, midnight_ns, bias_rad)
        } else {
            refuse_other_formats(radar_path, radar)?;
            let recording = RadarRecording::decode(radar, &editions, plot_source, bias_rad, &config.site)
                .map_err(|WhichSource(found)| SourceError::WhichSource { path: path(), found })?;
            refuse_without_records(radar_path, radar, &recording.contents)?;
            recording
        };
        let turns = Turns::of(&mut recording, plot_source, table.is_some())
            .ok_or_else(|| SourceError::NoCycle { path: path() })?;
        let Turns { ref rotations, turning, .. } = turns;
        let mut notes = named(radar_path, recording.contents.notes());
        notes.extend(named(radar_path, about_source(&recording, config)));
        notes.extend(named(radar_path, turns.notes()));
        notes.extend(named(radar_path, table.as_ref().and_then(about_columns).into_iter().collect()));
        let unread = scan_lines.and_then(|lines| lines.unread).or_else(|| table.and_then(|table| table.unread));
        if let Some(unread) = &unread {
            let text =
                format!("{} lines could not be read, the first is {}: {}", unread.lines, unread.first, unread.why);
            notes.extend(named(radar_path, vec![text]));
            recording.rejected.count_many(Reject::BadPlot, unread.lines);
        }
        notes.extend(named(radar_path, about_time(&recording, rotations, plot_source.scan_period_s)));
        let mut is_sound = recording.contents.unread_bytes == 0 && unread.is_none();

        let mut rejected = recording.rejected;
        let mut records = recording.contents.records;
        let boats = truth.and_then(|(_, bytes)| ScanLines::of(bytes));
        let truth = match truth {
            Some(_) if boats.is_some() => boats.map(|lines| lines.truth(plot_source.coverage_range_m)),
            Some((path, bytes)) => {
                refuse_other_formats(path, bytes)?;
                let begin_ns = rotations.bounds_ns(0).0 as i64;
                let recording = TruthRecording::decode(bytes, &editions, midnight_ns, begin_ns, plot_source);
                refuse_without_records(path, bytes, &recording.contents)?;
                rejected.add(&recording.rejected);
                records += recording.contents.records;
                notes.extend(named(path, recording.contents.notes()));
                is_sound &= recording.contents.unread_bytes == 0;
                Some(recording.targets)
            }
            None => None,
        };
        let mut reports = Vec::with_capacity(recording.reports.len());
        let (mut level, mut astray) = (AmplitudeLevel::new(plot_source.pfa), 0);
        for (index, report) in recording.reports.iter().enumerate() {
            let time_ns = rotations.time_of(index, report);
            let Some(scan) = rotations.scan_of(time_ns, report.azimuth_rad) else {
                astray += 1;
                rejected.count(Reject::Late);
                continue;
            };
            astray += usize::from(!rotations.fits(scan, time_ns, report.azimuth_rad));
            let time_ns =
                recording.half_turn_ns.map_or(time_ns, |half_ns| rotations.bounds_ns(scan).0 as i64 + half_ns);
            let statistic = report.amplitude_db.map(|amplitude_db| level.statistic(amplitude_db));
            let sighting = Sighting { time_ns: time_ns.max(0) as u64, report: *report, statistic };
            reports.push((scan as u32, sighting));
        }
        if !turns.are_assumed && 2 * astray > recording.reports.len() {
            notes.extend(named(radar_path, vec![Trouble::Astray.to_string()]));
        }
        if reports.is_empty() {
            is_sound = false;
            notes.extend(named(radar_path, vec![about_nothing(&rejected)]));
        }
        reports.sort_by_key(|&(scan, _)| scan);
        let available = rotations.scans() as u32;
        let scans = if config.run.scans == 0 { available } else { available.min(config.run.scans) };
        let source_id = recording.source.map_or(config.site.source_id(), |source| source.number().into());
        let coordinates = recording.reports.iter().collect();
        let layout = SectorLayout::new(source_id, turning, plot_source, &config.site, coordinates);
        let rotations = turns.rotations;
        Ok(Self { layout, rotations, reports, truth, scans, next: 0, rejected, records, notes, is_sound })
    }

    /// What the user should know of the recordings, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// 0 if every byte could be read and there are plots, else [`EXIT_CHECK_BROKEN`].
    pub fn exit_code(&self) -> ExitCode {
        if self.is_sound { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) }
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
        let reports: Vec<Sighting> = self.reports[from..to].iter().map(|&(_, report)| report).collect();
        let mut plots = self.layout.messages(scan, bounds_ns, &reports);
        if let Some((header, _)) = plots.last_mut() {
            header.flags |= end;
        }
        Some(Scan { begin_ns: bounds_ns.0, plots, truth: self.truth_of(scan, bounds_ns, end) })
    }
}

/// The turns of a recording, and how they are known.
struct Turns {
    rotations: Rotations,
    turning: Turning,
    /// The radar says when its antenna passes north.
    has_norths: bool,
    /// Nothing tells them: they are as long as the configuration says.
    are_assumed: bool,
}

impl Turns {
    /// Those of a recording, which may be a table; `None` without a north passage.
    fn of(recording: &mut RadarRecording, config: &PlotSourceConfig, is_table: bool) -> Option<Self> {
        let nominal_ns = (config.scan_period_s * NS_PER_S) as i64;
        let errors = (config.sigma_range_m, config.sigma_azimuth_deg.to_radians());
        let has_norths = !recording.cycles.is_empty();
        let mut turning = config.turning.unwrap_or_default();
        if !has_norths && let Some(learnt) = learn(&recording.reports, nominal_ns, config.turning) {
            Learnt { turning, norths: recording.cycles } = learnt;
        }
        let are_assumed = is_table && recording.cycles.is_empty();
        if are_assumed {
            recording.assume_turns(nominal_ns);
        }
        let mut rotations = rotations_of(recording, nominal_ns, errors)?.turning(turning);
        if has_norths && recording.half_turn_ns.is_none() && config.turning.is_none() {
            let learnt = otherwise(recording, &rotations, nominal_ns);
            turning = learnt.as_ref().map_or(turning, |learnt| learnt.turning);
            if let Some(Learnt { turning: Turning::Standing, norths }) = learnt {
                recording.cycles = norths;
                rotations = rotations_of(recording, nominal_ns, errors)?;
            }
            rotations = rotations.turning(turning);
        }
        Some(Self { rotations, turning, has_norths, are_assumed })
    }

    /// What the user should know of them.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.are_assumed {
            notes.push("times and azimuths tell no turn: scans are as long as `plot_source.scan_period_s` says".into());
        } else if !self.has_norths && self.turning != Turning::Standing {
            notes.push("no north markers: the turns are those that times and azimuths of the reports tell".into());
        }
        if self.turning != Turning::Clockwise {
            notes.push(said_of(self.turning).into());
        }
        notes
    }
}

/// What the user should know of the columns of a table.
fn about_columns(table: &Table) -> Option<String> {
    let names: Vec<String> = table.ignored.iter().map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| format!("columns ignored: {}", names.join(", ")))
}

/// Why there is not one plot.
fn about_nothing(rejected: &Rejected) -> String {
    let (without, left_out) = (rejected.of(Reject::NoPosition), rejected.of(Reject::FixedMonitor));
    format!(
        "not one plot; {without} target reports without range and azimuth (item 040), {left_out} simulated, of a test or of a \
         monitor (keys `plot_source.use_simulated`, `use_test`, `use_monitors`)"
    )
}

/// The turns of a recording; `None` without a north passage.
fn rotations_of(recording: &RadarRecording, nominal_ns: i64, errors: (f64, f64)) -> Option<Rotations> {
    match recording.half_turn_ns {
        Some(_) => Rotations::of_scans(&recording.cycles, nominal_ns),
        None => Rotations::new(&recording.cycles, &recording.reports, nominal_ns, errors),
    }
}

/// How the antenna turns, if the reports do not fit an antenna that turns clockwise and passes north when it says so, but another.
fn otherwise(recording: &RadarRecording, rotations: &Rotations, nominal_ns: i64) -> Option<Learnt> {
    let reports = &recording.reports;
    let fitting = |rotations: &Rotations| {
        let fits = |(index, report): (usize, &Report)| {
            let time_ns = rotations.time_of(index, report);
            let scan = rotations.scan_of(time_ns, report.azimuth_rad);
            report.clock_ns.is_some() && scan.is_some_and(|scan| rotations.fits(scan, time_ns, report.azimuth_rad))
        };
        reports.iter().enumerate().filter(|&report| fits(report)).count()
    };
    let timed = reports.iter().filter(|report| report.clock_ns.is_some()).count();
    if timed == 0 || 2 * fitting(rotations) >= timed {
        return None;
    }
    let turning = Turning::CounterClockwise;
    if 4 * fitting(&rotations.clone().turning(turning)) >= 3 * timed {
        return Some(Learnt { turning, norths: Vec::new() });
    }
    learn(reports, nominal_ns, None).filter(|learnt| learnt.turning == Turning::Standing)
}

/// How an antenna turns, for the user.
pub(crate) fn said_of(turning: Turning) -> &'static str {
    match turning {
        Turning::Clockwise => "the antenna turns clockwise",
        Turning::CounterClockwise => "the antenna turns counter-clockwise",
        Turning::Standing => "the antenna stands: a scan is a period in which targets are reported once",
    }
}

/// What the user should know of the sensors in a recording.
fn about_source(recording: &RadarRecording, config: &ChainConfig) -> Vec<String> {
    let mut notes: Vec<String> =
        recording.foreign().map(|(source, count)| format!("{source}: {count} records foreign, not used")).collect();
    notes.extend(recording.source.and_then(|source| taken_for_the_sites(source, &config.site)));
    match recording.range_rates {
        RangeRates::Receding => {}
        RangeRates::Approaching => {
            notes.push("range rates are positive for approaching targets, by the ranges: their sign is changed".into());
        }
        RangeRates::Unfit => notes.push("range rates do not fit the change of the ranges: they are not used".into()),
    }
    notes
}

/// That a sensor is taken for the site's, unless the site names it.
pub(crate) fn taken_for_the_sites(source: SourceId, site: &SiteConfig) -> Option<String> {
    let is_named = site.sac.is_some() && site.sic.is_some();
    (!is_named).then(|| format!("taken for the site's: {source} (keys `site.sac` and `site.sic` do not both say)"))
}

/// Whether a turn differs so much from the configured one that it is worth a word.
pub(crate) fn is_other_turn(turn_s: f64, configured_s: f64) -> bool {
    (turn_s / configured_s - 1.0).abs() > OTHER_TURN
}

/// What the user should know of the time in a recording.
fn about_time(recording: &RadarRecording, rotations: &Rotations, configured_s: f64) -> Vec<String> {
    let mut notes = Vec::new();
    let turns_s = rotations.typical_turns_s();
    if is_other_turn(turns_s.0, configured_s) || is_other_turn(turns_s.1, configured_s) {
        let (from_s, to_s) = turns_s;
        let takes =
            if to_s - from_s < 0.01 * to_s { format!("{to_s:.3}") } else { format!("{from_s:.3} to {to_s:.3}") };
        notes.push(format!(
            "a turn takes {takes} s by the start-of-cycle messages, which are followed; \
             `plot_source.scan_period_s` says {configured_s}"
        ));
    }
    if let Some(text) = listed(&rotations.steps, |step| format!("{:+.3} s before scan {}", step.by_s, step.scan)) {
        let count = rotations.steps.len();
        notes.push(format!("clock steps {count}: {text}; measurement time runs on as if the clock had not been set"));
    }
    if let Some(text) = listed(&rotations.pauses, |pause| format!("{:.3} s at scan {}", pause.lasted_s, pause.scan)) {
        notes.push(format!("pauses {}: {text}; their scans are without plots", rotations.pauses.len()));
    }
    if recording.half_turn_ns.is_some() {
        notes.push("plots have the time of their scan: when within it the beam passed them is not in the file".into());
        return notes;
    }
    let timeless = recording.reports.iter().filter(|report| report.clock_ns.is_none()).count();
    if timeless > 0 {
        notes.push(format!("reports without time {timeless}: they have that of the antenna at their azimuth"));
    }
    notes
}

/// The first few in words.
fn listed<T>(all: &[T], text: impl Fn(&T) -> String) -> Option<String> {
    const NAMED: usize = 5;
    let mut names: Vec<String> = all.iter().take(NAMED).map(text).collect();
    if all.len() > NAMED {
        names.push(format!("{} more", all.len() - NAMED));
    }
    (!names.is_empty()).then(|| names.join(", "))
}

/// Says of which file the notes are.
fn named(path: &Path, notes: Vec<String>) -> Vec<String> {
    notes.into_iter().map(|note| format!("{}: {note}", path.display())).collect()
}

fn refuse_other_formats(path: &Path, bytes: &[u8]) -> Result<(), SourceError> {
    match what_is(bytes) {
        Some(found) => Err(SourceError::NotAsterix { path: path.to_path_buf(), found: format!("it is {found}") }),
        None => Ok(()),
    }
}

fn refuse_without_records(path: &Path, bytes: &[u8], contents: &Contents) -> Result<(), SourceError> {
    if contents.records > 0 {
        return Ok(());
    }
    let nothing = || format!("no readable record in {} bytes", bytes.len());
    Err(SourceError::NotAsterix {
        path: path.to_path_buf(),
        found: contents.categories_found().unwrap_or_else(nothing),
    })
}

fn read(path: &Path) -> Result<Vec<u8>, SourceError> {
    std::fs::read(path).map_err(|cause| SourceError::Read { path: path.to_path_buf(), cause })
}
