//! A radar that is listened to: datagrams in, `plots` messages of its sectors out.
//!
//! A sector is closed as soon as a message of the radar says that the antenna has left it, or, without one, when
//! `latency_s` have gone by since it must have: by the antenna's turn ([`Antenna`]) and by how long the radar's messages
//! are on their way. Empty sectors are published too, also while nothing arrives at all: tracks coast and end as if the
//! radar saw nothing.
//!
//! Measurement time is the radar's clock. Where that is set, measurement time goes on as the clock of this computer does.
//! Nothing here reads a clock: the time of this computer, as UTC, comes with every call.

use std::collections::BTreeMap;

use asterix::block::Blocks;
use asterix::editions::{EditionError, Editions};
use asterix::record::Records;
use asterix::recovery::Cause;
use asterix::report::{Artificial, Message, Service, ServiceMessage, SourceId, TargetReport, TimeOfDay};
use common::angle;
use common::config::ChainConfig;
use common::health::{Reject, Rejected};
use common::plots::{Plot, PlotsHeader};
use common::units::NS_PER_S;

use crate::antenna::{Antenna, Change, Fix, turned};
use crate::clock::DayClock;
use crate::contents::{editions, reason};
use crate::habits::Habits;
use crate::level::AmplitudeLevel;
use crate::radar::{Report, is_of, is_used};
use crate::registration::Registration;
use crate::repeats::Repeats;
use crate::sectors::{SectorLayout, Sighting};
use crate::turning::norths;

/// A clock that differs by more than this from what it did is set, if it stays so, ns.
const CLOCK_SET_NS: i64 = 1_000_000_000;
/// Messages in a row after which it has been set.
const CLOCK_SET_MESSAGES: u32 = 3;
/// Share by which the delay of messages grows towards that of the latest: the least of the last ones counts.
const DELAY_GROWTH: f64 = 1e-3;
/// Reports kept to search for the turn of a radar without north markers, and how many searches start after.
const SEARCHED: usize = 100;
/// An azimuth at which a sector begins is not before it for the rounding of its angle; a share of a turn.
const ROUNDING: f64 = 1e-9;
/// A report farther ahead of the antenna than so many turns is impossible.
const TURNS_AHEAD: i64 = 2;

/// Messages of sectors that are complete.
pub type Closed = Vec<(PlotsHeader, Vec<Plot>)>;

/// What has happened, in counts.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Events {
    /// Records read.
    pub records: u64,
    /// Records received before: of a second line, or repeated.
    pub repeated: u64,
    /// The radar's clock was set.
    pub clock_set: u64,
    /// The antenna was elsewhere than expected.
    pub moved: u64,
    /// Sectors closed because nothing of the radar had closed them in time.
    pub timed_out: u64,
}

/// A radar that is listened to.
#[derive(Debug)]
pub struct LiveRadar {
    config: ChainConfig,
    editions: Editions,
    source: Option<SourceId>,
    azimuth_bias_rad: f64,
    clock: Option<RadarClock>,
    antenna: Antenna,
    has_service: bool,
    searched: Vec<Report>,
    habits: Habits,
    level: AmplitudeLevel,
    repeats: Repeats,
    /// Whether the last report has a range rate.
    has_range_rate: bool,
    sectors: i64,
    /// Number of the scan that is turn 0 of the antenna.
    scan_of_turn_0: i64,
    /// The next sector to be closed, counted through all scans; none before the first north passage.
    next: Option<i64>,
    /// Measurement time of the last message.
    last_ns: u64,
    waiting: BTreeMap<i64, Vec<Sighting>>,
    /// Sectors before this one are complete, by a message of the radar, at this time.
    complete: Option<(i64, u64)>,
    rejected: Rejected,
    events: Events,
}

/// The radar's clock beside that of this computer.
#[derive(Debug)]
struct RadarClock {
    day: DayClock,
    /// Added to the radar's clock.
    offset_ns: i64,
    /// How long messages are on their way, ns; may be negative: clocks differ.
    delay_ns: f64,
    set: u32,
}

impl LiveRadar {
    /// The radar of a configuration.
    ///
    /// # Errors
    /// [`EditionError`]: an edition is configured that is not known.
    pub fn new(config: &ChainConfig) -> Result<Self, EditionError> {
        let plot_source = &config.plot_source;
        let source = config.site.sac.zip(config.site.sic).map(|(sac, sic)| SourceId { sac, sic });
        Ok(Self {
            editions: editions(plot_source)?,
            source,
            azimuth_bias_rad: Registration::new(&plot_source.registration).azimuth_bias_rad(),
            clock: None,
            antenna: Antenna::new(plot_source.scan_period_s * NS_PER_S),
            has_service: false,
            searched: Vec::new(),
            habits: Habits::new(plot_source.sigma_range_m, plot_source.sigma_range_rate_mps),
            level: AmplitudeLevel::new(plot_source.pfa),
            repeats: Repeats::default(),
            has_range_rate: false,
            sectors: i64::from(plot_source.sectors_per_scan),
            scan_of_turn_0: i64::from(config.run.first_scan),
            next: None,
            last_ns: 0,
            waiting: BTreeMap::new(),
            complete: None,
            rejected: Rejected::default(),
            events: Events::default(),
            config: config.clone(),
        })
    }

    /// What was not used.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }

    /// What has happened.
    pub fn events(&self) -> Events {
        self.events
    }

    /// The radar that is listened to, once it is known.
    pub fn source(&self) -> Option<SourceId> {
        self.source
    }

    /// Takes a datagram that arrived at `now_ns`.
    pub fn take(&mut self, datagram: &[u8], now_ns: u64) {
        let editions = self.editions.clone();
        for block in Blocks::new(datagram) {
            let Ok(block) = block else {
                self.rejected.count(Reject::BadHeader);
                return;
            };
            let Some(edition) = editions.of(block.category) else {
                self.rejected.count(Reject::OtherCategory);
                continue;
            };
            let mut records = Records::new(edition, block.records, block.offset);
            while let Some(record) = records.next() {
                let taken = match record {
                    Ok(record) if self.repeats.is_repeated(block.category, record.bytes, now_ns) => {
                        self.events.repeated += 1;
                        Ok(())
                    }
                    Ok(record) => {
                        self.events.records += 1;
                        Message::of(&record)
                            .ok_or(Reject::OtherCategory)
                            .and_then(|message| self.message(&message, now_ns))
                    }
                    Err(error) => {
                        self.rejected.count_many(Reject::UnreadByte, records.left() as u64);
                        Err(reason(&Cause::Record(error)))
                    }
                };
                if let Err(reason) = taken {
                    self.rejected.count(reason);
                }
            }
        }
    }

    fn message(&mut self, message: &Message, now_ns: u64) -> Result<(), Reject> {
        if let Some(source) = message.source() {
            if self.source.is_none() && is_of(source, &self.config.site) {
                self.source = Some(source);
            }
            if self.source != Some(source) {
                return Err(Reject::ForeignSource);
            }
        }
        match message {
            Message::Target(report) => self.target(report, now_ns),
            Message::Service(message) => self.service(message, now_ns),
        }
    }

    /// Measurement time of now, as far as messages tell how long they are on their way.
    fn present_ns(&self, now_ns: u64) -> i64 {
        now_ns as i64 - self.clock.as_ref().map_or(0.0, |clock| clock.delay_ns) as i64
    }

    /// Measurement time of a time of day.
    fn time_ns(&mut self, time: TimeOfDay, now_ns: u64) -> Result<i64, Reject> {
        let clock = self.clock.get_or_insert_with(|| RadarClock {
            day: DayClock::near(now_ns - now_ns % 86_400_000_000_000, now_ns as i64),
            offset_ns: 0,
            delay_ns: f64::INFINITY,
            set: 0,
        });
        let time_ns = clock.day.time_ns(time) + clock.offset_ns;
        let delay_ns = (now_ns as i64 - time_ns) as f64;
        if clock.delay_ns.is_finite() && (delay_ns - clock.delay_ns).abs() > CLOCK_SET_NS as f64 {
            clock.set += 1;
            if clock.set < CLOCK_SET_MESSAGES {
                return Err(Reject::NoTime); // it may be a single wrong one
            }
            self.events.clock_set += 1;
            clock.offset_ns += (delay_ns - clock.delay_ns) as i64;
            clock.set = 0;
            return Ok(time_ns + (delay_ns - clock.delay_ns) as i64);
        }
        clock.set = 0;
        clock.delay_ns = delay_ns.min(clock.delay_ns + DELAY_GROWTH * (delay_ns - clock.delay_ns).max(0.0));
        if !clock.delay_ns.is_finite() {
            clock.delay_ns = delay_ns;
        }
        Ok(time_ns)
    }

    fn service(&mut self, message: &ServiceMessage, now_ns: u64) -> Result<(), Reject> {
        let turned = match message.service {
            Service::North => 0.0,
            Service::Sector => turned(message.azimuth_rad.ok_or(Reject::NoPosition)?),
            _ => return Err(Reject::NotATarget),
        };
        let time_ns = match message.time_of_day {
            Some(time) => self.time_ns(time, now_ns)?,
            None => self.present_ns(now_ns),
        };
        self.has_service = true;
        if let Some(turn_s) = message.turn_s {
            self.antenna.set_turn(turn_s * NS_PER_S);
        }
        let fix = Fix { time_ns, turned };
        match self.antenna.fix(fix) {
            Change::Followed => {}
            Change::Locked => self.begin(time_ns),
            Change::Moved => self.resume(),
        }
        if self.antenna.is_locked() {
            let sector = self.first_sector(self.antenna.turn_of(fix)) + (turned * self.sectors as f64).round() as i64;
            let is_possible = self.next.is_some_and(|next| sector <= next + TURNS_AHEAD * self.sectors);
            self.complete = is_possible.then_some((sector, now_ns));
        }
        Ok(())
    }

    fn target(&mut self, report: &TargetReport, now_ns: u64) -> Result<(), Reject> {
        let time_ns = report.time_of_day.map(|time| self.time_ns(time, now_ns)).transpose()?;
        self.habits.learn(report, time_ns);
        is_used(report, &self.config.plot_source, &self.habits)?;
        let (range_m, azimuth_rad) = report.polar.ok_or(Reject::NoPosition)?;
        if range_m <= 0.0 {
            return Err(Reject::BadPlot);
        }
        let knows = self.habits.knows_range_rates();
        let report = Report {
            clock_ns: time_ns,
            range_m,
            azimuth_rad: angle::wrap(azimuth_rad - self.azimuth_bias_rad),
            range_rate_mps: self.habits.range_rates().of(report).filter(|_| knows),
            height_m: report.height_m.or(report.pressure_height_m),
            amplitude_db: report.amplitude_db,
            is_artificial: report.artificial != Artificial::default(),
        };
        if !self.antenna.is_locked() {
            self.search(report);
            return Err(Reject::Late);
        }
        let turned = turned(report.azimuth_rad);
        let now_ns = self.present_ns(now_ns);
        let time_ns = time_ns.unwrap_or_else(|| {
            // The antenna was there last.
            let turn = self.antenna.turn_of(Fix { time_ns: now_ns, turned });
            let passed_ns = self.antenna.time_of(turn, turned);
            if passed_ns > now_ns { self.antenna.time_of(turn - 1, turned) } else { passed_ns }
        });
        let fix = Fix { time_ns, turned };
        if !self.has_service {
            self.antenna.fix(fix);
        }
        let turn = self.antenna.turn_of(fix);
        let sector = ((turned + ROUNDING) * self.sectors as f64) as i64;
        let sector = self.first_sector(turn) + sector.min(self.sectors - 1);
        let next = self.next.ok_or(Reject::Late)?;
        if sector < next {
            return Err(Reject::Late);
        }
        if sector > next + TURNS_AHEAD * self.sectors {
            return Err(Reject::BadPlot);
        }
        let statistic = report.amplitude_db.map(|amplitude_db| self.level.statistic(amplitude_db));
        self.waiting.entry(sector).or_default().push(Sighting { time_ns: time_ns.max(0) as u64, report, statistic });
        self.has_range_rate = report.range_rate_mps.is_some();
        Ok(())
    }

    /// Looks for the turn in the reports of a radar without north markers.
    fn search(&mut self, report: Report) {
        if self.has_service {
            return;
        }
        self.searched.push(report);
        if self.searched.len() < SEARCHED {
            return;
        }
        let found = norths(&self.searched, self.antenna.turn_ns() as i64);
        self.searched.clear();
        if let Some([.., before, last]) = found.as_deref() {
            self.antenna.lock(last.clock_ns, (last.clock_ns - before.clock_ns) as f64);
            self.begin(last.clock_ns);
        }
    }

    fn first_sector(&self, turn: i64) -> i64 {
        (turn + self.scan_of_turn_0) * self.sectors
    }

    /// The first scan begins with the next north passage.
    fn begin(&mut self, time_ns: i64) {
        let turn = self.antenna.turn_of(Fix { time_ns, turned: 0.0 }) + 1;
        self.scan_of_turn_0 = i64::from(self.config.run.first_scan) - turn;
        self.next = Some(self.first_sector(turn));
    }

    /// The antenna is elsewhere: the scan that was begun ends with the next north passage, and the next one begins.
    fn resume(&mut self) {
        self.events.moved += 1;
        self.complete = None;
        let Some(next) = self.next else { return };
        let begun = next.div_euclid(self.sectors);
        let turn = self.antenna.turn_of(Fix { time_ns: self.last_ns as i64, turned: 0.0 }) + 1;
        self.scan_of_turn_0 = begun + 1 - turn;
        // What is waiting was sorted by the turns before.
        let lost: usize = self.waiting.values().map(Vec::len).sum();
        self.rejected.count_many(Reject::Late, lost as u64);
        self.waiting.clear();
    }

    /// When the beam leaves a sector.
    fn end_ns(&self, sector: i64) -> i64 {
        let turn = sector.div_euclid(self.sectors) - self.scan_of_turn_0;
        let turned = (sector.rem_euclid(self.sectors) + 1) as f64 / self.sectors as f64;
        self.antenna.time_of(turn, turned)
    }

    /// When the next sector must be closed, if nothing closes it before; UTC of this computer.
    pub fn due_ns(&self) -> Option<u64> {
        let next = self.next?;
        let delay_ns = self.clock.as_ref().map_or(0.0, |clock| clock.delay_ns) as i64;
        let latency_ns = (self.config.plot_source.latency_s * NS_PER_S) as i64;
        let by_turn = (self.end_ns(next) + delay_ns + latency_ns).max(0) as u64;
        let wait_ns = (self.config.plot_source.sector_delay_s * NS_PER_S) as u64;
        let by_message = self.complete.filter(|&(sector, _)| sector > next).map(|(_, since_ns)| since_ns + wait_ns);
        Some(by_message.map_or(by_turn, |by_message| by_message.min(by_turn)))
    }

    /// Closes the sectors that are due.
    pub fn close_due(&mut self, now_ns: u64, closed: &mut Closed) {
        while let Some(next) = self.next
            && self.due_ns().is_some_and(|due_ns| due_ns <= now_ns)
        {
            self.events.timed_out += u64::from(self.complete.is_none_or(|(sector, _)| sector <= next));
            self.close_next(next, closed);
        }
    }

    /// Closes the sector that is open, for the end of the stream.
    pub fn close_last(&mut self, closed: &mut Closed) {
        if let Some(next) = self.next {
            self.close_next(next, closed);
        }
    }

    fn close_next(&mut self, sector: i64, closed: &mut Closed) {
        let sightings = self.waiting.remove(&sector).unwrap_or_default();
        let (scan, index) = (sector.div_euclid(self.sectors), sector.rem_euclid(self.sectors));
        let begin_ns = self.antenna.time_of(scan - self.scan_of_turn_0, 0.0).max(0) as u64;
        let bounds_ns = (begin_ns, begin_ns + self.antenna.turn_ns() as u64);
        let (mut header, plots) = self.layout().message(scan as u32, index as u32, bounds_ns, &sightings);
        header.time_ns = header.time_ns.max(self.last_ns + 1);
        self.last_ns = header.time_ns;
        self.next = Some(sector + 1);
        closed.push((header, plots));
    }

    fn layout(&self) -> SectorLayout {
        let source_id = self.source.map_or(self.config.site.source_id(), |source| source.number().into());
        SectorLayout::new(source_id, &self.config.plot_source, &self.config.site, self.has_range_rate)
    }
}
