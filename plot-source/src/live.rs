//! A radar that is listened to: datagrams in, `plots` messages of its sectors out.
//!
//! A sector is closed as soon as a sector message of the radar says that the antenna has left it, or, without one, when
//! `latency_s` have gone by since it must have: by the antenna's turn ([`Antenna`]) and by how long the radar's messages
//! are on their way. How the antenna turns is learnt; of one that stands, sectors are shares of its period. Reports that come while
//! the turn is not known yet are kept until it is. Reports that come after the message are waited for, as long as the last ones took. Empty sectors are
//! published too, also while nothing arrives at all: tracks coast and end as if the radar saw nothing.
//!
//! Measurement time is the radar's clock. Where that is set, measurement time goes on as the clock of this computer does.
//! Nothing here reads a clock: the time of this computer, as UTC, comes with every call.

use std::collections::{BTreeMap, VecDeque};

use asterix::block::Blocks;
use asterix::editions::{EditionError, Editions};
use asterix::record::{Record, Records};
use asterix::recovery::Cause;
use asterix::report::{Artificial, Message, Service, ServiceMessage, SourceId, TargetReport};
use common::angle;
use common::config::ChainConfig;
use common::health::{Reject, Rejected};
use common::plots::{MAX_PLOTS, Plot, PlotsHeader};
use common::turning::Turning;
use common::units::NS_PER_S;

use crate::antenna::{Antenna, Change, Fix};
use crate::contents::{editions, reason};
use crate::habits::Habits;
use crate::level::AmplitudeLevel;
use crate::radar::{Report, is_of, is_used};
use crate::radar_clock::RadarClock;
use crate::registration::Registration;
use crate::repeats::Repeats;
use crate::sectors::{Coordinates, SectorLayout, Sighting};
use crate::turning::{LEAST_STOPPED, Learnt, SEARCHED, SHORTEST_SEARCHED, learn};

/// Turns in which the expected lateness of reports falls to 1/e.
const LATENESS_FADES: f64 = 60.0;
/// Reports are waited for this many times as long as the latest of the last ones took.
const LATENESS_MARGIN: f64 = 1.25;
/// Reports that are kept at most while the turn is not known.
const MOST_UNPLACED: usize = 32_768;
/// Reports that tell how an antenna turns whose place is known.
const FEWEST_KEPT: usize = 4;
/// So many of the last 32 reports must fit an antenna that turns the other way.
const FITTING: u32 = 24;
/// An azimuth at which a sector begins is not before it for the rounding of its angle; a share of a turn.
const ROUNDING: f64 = 1e-9;
/// A report farther ahead of the antenna than so many turns is impossible.
const TURNS_AHEAD: i64 = 2;
/// A radar that has sent no message of its antenna for so many turns sends none.
const SILENT_TURNS: f64 = 5.0;
/// Reports that wait for the end of one sector at most: twice what a message holds.
const MOST_WAITING: usize = 2 * MAX_PLOTS;

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
    /// Messages and reports of an azimuth where the antenna was not at their time.
    pub astray: u64,
}

/// Why plots are missing or wrong, as far as the radar itself shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// No turn can be found.
    #[error(
        "times and azimuths tell no turn, no plots are published: the antenna stands without a rhythm of its reports (then \
         set `plot_source.turning`), or the radar is sent at another speed than `run.speed`"
    )]
    NoTurn,
    /// Most reports are of azimuths where the antenna was not at their time.
    #[error(
        "reports do not fit the turn, plots are late or wrong: the antenna turns otherwise than `plot_source.turning` or the \
         radar's messages say, or the radar is sent at another speed than `run.speed`"
    )]
    Astray,
}

/// A report that waits until it is known where the antenna was.
#[derive(Debug, Clone, Copy)]
struct Unplaced {
    report: Report,
    /// Measurement time, and UTC of this computer, when it arrived.
    present_ns: i64,
    now_ns: u64,
}

/// A radar that is listened to.
#[derive(Debug)]
pub struct LiveRadar {
    config: ChainConfig,
    editions: Editions,
    source: Option<SourceId>,
    azimuth_bias_rad: f64,
    clock: RadarClock,
    antenna: Antenna,
    /// Measurement time of the last message of the antenna.
    service_ns: Option<i64>,
    /// What the messages of an antenna say that is believed to stand.
    started: Antenna,
    /// Reports since the turn is not known, or does not fit them.
    unplaced: Vec<Unplaced>,
    /// So many of them have been searched for a turn, in vain.
    searched: usize,
    /// Reports of many turns have been searched for a turn, in vain.
    has_searched: bool,
    /// Whether each of the last 32 reports is astray, a bit each, and whether it fits an antenna that turns the other way.
    astray: u32,
    mirrored: u32,
    habits: Habits,
    level: AmplitudeLevel,
    repeats: Repeats,
    /// What its reports hold.
    coordinates: Coordinates,
    sectors: i64,
    /// Number of the scan that is turn 0 of the antenna.
    scan_of_turn_0: i64,
    /// The next sector to be closed, counted through all scans; none before the first north passage.
    next: Option<i64>,
    /// Measurement time of the last message.
    last_ns: u64,
    waiting: BTreeMap<i64, Vec<Sighting>>,
    /// The radar has said that sectors before one are complete, and when; in order, of the last turn.
    complete: VecDeque<(i64, u64)>,
    /// How long after that reports still come, ns.
    lateness_ns: f64,
    rejected: Rejected,
    events: Events,
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
            clock: RadarClock::default(),
            antenna: Antenna::new(plot_source.scan_period_s * NS_PER_S, plot_source.turning),
            service_ns: None,
            started: Antenna::new(plot_source.scan_period_s * NS_PER_S, None),
            unplaced: Vec::new(),
            searched: 0,
            has_searched: false,
            astray: 0,
            mirrored: 0,
            habits: Habits::new(plot_source.sigma_range_m, plot_source.sigma_range_rate_mps),
            level: AmplitudeLevel::new(plot_source.pfa),
            repeats: Repeats::default(),
            coordinates: Coordinates::default(),
            sectors: i64::from(plot_source.sectors_per_scan),
            scan_of_turn_0: i64::from(config.run.first_scan),
            next: None,
            last_ns: 0,
            waiting: BTreeMap::new(),
            complete: VecDeque::new(),
            lateness_ns: 0.0,
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
        Events { clock_set: self.clock.times_set(), ..self.events }
    }

    /// The radar that is listened to, once it is known.
    pub fn source(&self) -> Option<SourceId> {
        self.source
    }

    /// What the antenna takes for a turn, s, once it is known.
    pub fn turn_s(&self) -> Option<f64> {
        self.antenna.is_locked().then(|| self.antenna.turn_ns() / NS_PER_S)
    }

    /// How the antenna turns, once it is known.
    pub fn turning(&self) -> Option<Turning> {
        self.antenna.is_locked().then(|| self.antenna.turning())
    }

    /// What is wrong at present.
    pub fn trouble(&self) -> Option<Trouble> {
        match self.antenna.is_locked() {
            false if self.has_searched => Some(Trouble::NoTurn),
            true if self.is_astray() => Some(Trouble::Astray),
            _ => None,
        }
    }

    /// Whether most of the last reports are astray.
    fn is_astray(&self) -> bool {
        self.astray.count_ones() > u32::BITS / 2
    }

    /// Takes a datagram that arrived at `now_ns`.
    pub fn take(&mut self, datagram: &[u8], now_ns: u64) {
        let mut blocks = Blocks::new(datagram);
        while let Some(block) = blocks.next() {
            let Ok(block) = block else {
                self.rejected.count_many(Reject::UnreadByte, blocks.left() as u64);
                self.rejected.count(Reject::BadHeader);
                return;
            };
            let Some(edition) = self.editions.of(block.category) else {
                self.rejected.count(Reject::OtherCategory);
                continue;
            };
            let mut records = Records::new(edition, block.records, block.offset);
            while let Some(record) = records.next() {
                let taken = match record {
                    Ok(record) => self.record(&record, now_ns),
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

    fn record(&mut self, record: &Record<'_>, now_ns: u64) -> Result<(), Reject> {
        let message = Message::of(record).ok_or(Reject::OtherCategory)?;
        let has_time = message.time_of_day().is_some();
        if self.repeats.is_repeated(record.edition.category, record.bytes, has_time, now_ns) {
            self.events.repeated += 1;
            return Ok(());
        }
        self.events.records += 1;
        self.message(&message, now_ns)
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

    /// The radar's clock.
    pub fn clock(&self) -> &RadarClock {
        &self.clock
    }

    fn service(&mut self, message: &ServiceMessage, now_ns: u64) -> Result<(), Reject> {
        let azimuth_rad = match message.service {
            Service::North => 0.0,
            Service::Sector => message.azimuth_rad.ok_or(Reject::NoPosition)?,
            _ => return Err(Reject::NotATarget),
        };
        let time_ns = match message.time_of_day {
            Some(time) => self.clock.take(time, now_ns)?,
            None => self.clock.present_ns(now_ns),
        };
        self.service_ns = Some(time_ns);
        if self.antenna.turning() == Turning::Standing {
            self.watch(message.service, Fix { time_ns, turned: self.started.turned(azimuth_rad) });
            return Ok(());
        }
        if let Some(turn_s) = message.turn_s {
            self.antenna.set_turn(turn_s * NS_PER_S);
        }
        let fix = Fix { time_ns, turned: self.antenna.turned(azimuth_rad) };
        match self.antenna.fix(fix) {
            Change::Followed => {}
            Change::Outlier => {
                self.events.astray += 1;
                return Ok(());
            }
            Change::Locked => {
                self.turn_by_reports();
                self.start(time_ns);
            }
            Change::Moved => self.resume(),
            Change::Reversed => {
                self.forget_waiting();
                return Ok(());
            }
        }
        if self.antenna.is_locked() {
            let sector = self.sector_of(fix);
            let is_open =
                self.next.is_some_and(|next| (next + 1..=next + TURNS_AHEAD * self.sectors).contains(&sector));
            // A radar that says no more than when it passes north says little of the sectors before: reports may follow.
            let last = self.complete.back().map(|&(before, _)| before);
            let says_sectors =
                message.service == Service::Sector || last.is_some_and(|before| before > sector - self.sectors);
            if is_open && says_sectors && last.is_none_or(|before| before < sector) {
                self.complete.push_back((sector, now_ns));
            }
        }
        Ok(())
    }

    fn target(&mut self, report: &TargetReport, now_ns: u64) -> Result<(), Reject> {
        let time_ns = report.time_of_day.map(|time| self.clock.take(time, now_ns)).transpose()?;
        self.habits.learn(report, time_ns);
        let has_height = report.height_m.or(report.pressure_height_m).is_some();
        self.coordinates.count(report.radial_velocity_mps.is_some(), has_height);
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
            address: report.address.unwrap_or(0),
        };
        let present_ns = self.clock.present_ns(now_ns);
        let unplaced = Unplaced { report, present_ns, now_ns };
        if self.antenna.is_locked() {
            return self.place(&unplaced);
        }
        self.search(unplaced);
        Ok(())
    }

    /// Whether the radar says where its antenna is.
    fn has_service(&self, present_ns: i64) -> bool {
        let silence_ns = self.service_ns.map_or(f64::INFINITY, |service_ns| (present_ns - service_ns) as f64);
        silence_ns < SILENT_TURNS * self.antenna.turn_ns()
    }

    /// Takes a report to its sector.
    fn place(&mut self, unplaced: &Unplaced) -> Result<(), Reject> {
        let &Unplaced { report, present_ns, now_ns } = unplaced;
        let has_service = self.has_service(present_ns);
        let turned = self.antenna.turned(report.azimuth_rad);
        let stands = self.antenna.turning() == Turning::Standing;
        let time_ns = report.clock_ns.unwrap_or_else(|| {
            if stands {
                return present_ns;
            }
            // The antenna was there last.
            let turn = self.antenna.turn_of(Fix { time_ns: present_ns, turned });
            let passed_ns = self.antenna.time_of(turn, turned);
            if passed_ns > present_ns { self.antenna.time_of(turn - 1, turned) } else { passed_ns }
        });
        let fix = Fix { time_ns, turned };
        // An antenna that stands sees what it sees at any time; only a rhythm is followed.
        let is_followed = self.antenna.fits(fix);
        let fits = is_followed || stands;
        self.astray = self.astray << 1 | u32::from(!fits);
        self.mirrored = self.mirrored << 1 | u32::from(self.antenna.fits(fix.mirrored()));
        self.events.astray += u64::from(!fits);
        if is_followed && (!has_service || stands) {
            self.antenna.fix(fix);
        }
        if self.is_astray() {
            self.doubt(unplaced, has_service);
        } else if stands {
            self.search(*unplaced);
        }
        let fix = Fix { turned: self.antenna.turned(report.azimuth_rad), ..fix };
        let sector = self.sector_of(fix);
        let next = self.next.ok_or(Reject::Late)?;
        if fits && let Some(since_ns) = self.complete_since(sector) {
            self.expect_late(now_ns.saturating_sub(since_ns) as f64);
        }
        if sector < next {
            return Err(Reject::Late);
        }
        let antenna = Fix { time_ns: present_ns, turned: 0.0 };
        let furthest = next.max(self.first_sector(self.antenna.turn_of(antenna))) + TURNS_AHEAD * self.sectors;
        if sector > furthest {
            return Err(Reject::BadPlot);
        }
        let waiting = self.waiting.entry(sector).or_default();
        if waiting.len() >= MOST_WAITING {
            return Err(Reject::Full);
        }
        let statistic = report.amplitude_db.map(|amplitude_db| self.level.statistic(amplitude_db));
        waiting.push(Sighting { time_ns: time_ns.max(0) as u64, report, statistic });
        Ok(())
    }

    /// Most of the last reports are astray: the antenna turns the other way, or it is not known what it does.
    fn doubt(&mut self, unplaced: &Unplaced, has_service: bool) {
        if self.mirrored.count_ones() >= FITTING && self.antenna.reverse() {
            (self.astray, self.mirrored) = (0, 0);
            self.forget_waiting();
            self.resume();
        } else if has_service {
            self.search(*unplaced);
        } else {
            self.antenna.unlock();
            self.astray = 0;
        }
    }

    /// Keeps a report, and looks for the turn in those that are kept once they are enough: where the radar says nothing of its
    /// antenna, or says for long what does not fit.
    fn search(&mut self, unplaced: Unplaced) {
        self.unplaced.push(unplaced);
        let is_full = self.unplaced.len() >= MOST_UNPLACED;
        let times = [self.unplaced[0].present_ns, unplaced.present_ns];
        let turns = (times[1] - times[0]) as f64 / self.antenna.turn_ns();
        let has_service = self.has_service(unplaced.present_ns);
        let enough_turns = if has_service { SILENT_TURNS } else { SHORTEST_SEARCHED };
        let is_enough = self.unplaced.len() >= SEARCHED.max(2 * self.searched) && turns >= enough_turns;
        if !is_enough && !is_full {
            return;
        }
        let reports: Vec<Report> = self.unplaced.iter().map(|unplaced| unplaced.report).collect();
        let is_locked = self.antenna.is_locked();
        let nominal_ns = self.antenna.turn_ns() as i64;
        let learnt = learn(&reports, nominal_ns, self.config.plot_source.turning);
        // What does not turn in a few turns may turn slowly.
        let is_over = is_full || turns >= LEAST_STOPPED;
        if learnt.is_none() && !is_over {
            self.searched = self.unplaced.len();
            return;
        }
        self.searched = 0;
        self.has_searched = learnt.is_none();
        let is_news = |learnt: &Learnt| {
            // Reports alone are not believed against what the radar says of an antenna that turns.
            let stands = [learnt.turning, self.antenna.turning()].map(|turning| turning == Turning::Standing);
            !is_locked || stands[0] != stands[1]
        };
        if let Some(learnt) = learnt.filter(is_news) {
            let turn_ns = learnt.last_turn_ns(nominal_ns);
            if is_locked {
                self.unplaced.clear(); // they have been placed
            }
            if let Some(last) = learnt.norths.last() {
                self.antenna.start(learnt.turning, last.clock_ns, turn_ns as f64);
                (self.astray, self.mirrored) = (0, 0);
                self.started = Antenna::new(turn_ns as f64, None);
                return self.start(last.clock_ns);
            }
        }
        if !is_locked {
            self.rejected.count_many(Reject::Late, self.unplaced.len() as u64);
        }
        self.unplaced.clear();
    }

    /// Follows what the messages of an antenna say that is believed to stand: sector messages that go on are of one that turns.
    fn watch(&mut self, service: Service, fix: Fix) {
        if service == Service::Sector
            && self.config.plot_source.turning.is_none()
            && self.started.fix(fix) == Change::Locked
        {
            self.antenna = std::mem::replace(&mut self.started, Antenna::new(self.antenna.turn_ns(), None));
            (self.astray, self.mirrored) = (0, 0);
            self.unplaced.clear();
            self.start(fix.time_ns);
        }
    }

    /// The reports that were kept may tell that an antenna whose place is known turns the other way.
    fn turn_by_reports(&mut self) {
        let fits = |fix: &Fix| self.antenna.fits(*fix);
        let timed = self.unplaced.iter().filter_map(|it| Some((it.report.clock_ns?, it.report.azimuth_rad)));
        let fixes: Vec<Fix> = timed.map(|(time_ns, it)| Fix { time_ns, turned: self.antenna.turned(it) }).collect();
        let usual = fixes.iter().filter(|fix| fits(fix)).count();
        let other = fixes.iter().filter(|fix| fits(&fix.mirrored())).count();
        if fixes.len() >= FEWEST_KEPT && 4 * other >= 3 * fixes.len() && other > 2 * usual {
            self.antenna.reverse();
        }
    }

    /// The sector of a passage: one that begins there, or there but for the rounding of its angle.
    fn sector_of(&self, fix: Fix) -> i64 {
        let turned = match self.antenna.turning() {
            Turning::Standing => self.antenna.passed(fix.time_ns),
            _ => fix.turned,
        };
        let sector = ((turned + ROUNDING) * self.sectors as f64) as i64;
        self.first_sector(self.antenna.turn_of(fix)) + sector.min(self.sectors - 1)
    }

    fn first_sector(&self, turn: i64) -> i64 {
        (turn + self.scan_of_turn_0) * self.sectors
    }

    /// The turn is known: the first scan is that of the first report that is kept, or begins with the next north passage, unless
    /// one has begun before.
    fn start(&mut self, time_ns: i64) {
        let kept = std::mem::take(&mut self.unplaced);
        (self.searched, self.has_searched) = (0, false);
        if self.next.is_some() {
            self.resume();
        } else {
            let first = kept.first().map(|it| Fix {
                time_ns: it.report.clock_ns.unwrap_or(it.present_ns),
                turned: self.antenna.turned(it.report.azimuth_rad),
            });
            let next = self.antenna.turn_of(Fix { time_ns, turned: 0.0 }) + 1;
            let turn = first.map_or(next, |first| self.antenna.turn_of(first).min(next));
            self.scan_of_turn_0 = i64::from(self.config.run.first_scan) - turn;
            self.next = Some(self.first_sector(turn));
        }
        for unplaced in &kept {
            if let Err(reason) = self.place(unplaced) {
                self.rejected.count(reason);
            }
        }
    }

    /// The antenna is elsewhere: the scan that was begun ends with the next north passage, and the next one begins.
    fn resume(&mut self) {
        self.events.moved += 1;
        self.complete.clear();
        let Some(next) = self.next else { return };
        let begun = next.div_euclid(self.sectors);
        let turn = self.antenna.turn_of(Fix { time_ns: self.last_ns as i64, turned: 0.0 }) + 1;
        self.scan_of_turn_0 = begun + 1 - turn;
        self.forget_waiting();
    }

    /// What is waiting was sorted by turns that are not true.
    fn forget_waiting(&mut self) {
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

    /// When the radar said that a sector is complete, UTC of this computer.
    fn complete_since(&self, sector: i64) -> Option<u64> {
        let first = self.complete.partition_point(|&(before, _)| before <= sector);
        self.complete.get(first).map(|&(_, since_ns)| since_ns)
    }

    /// A report has come so long after the message that its sector is complete: the most of the last ones counts.
    fn expect_late(&mut self, lateness_ns: f64) {
        if lateness_ns <= self.config.plot_source.latency_s * NS_PER_S {
            self.lateness_ns = self.lateness_ns.max(lateness_ns);
        }
    }

    /// When the next sector must be closed, if nothing closes it before; UTC of this computer.
    pub fn due_ns(&self) -> Option<u64> {
        let next = self.next?;
        let delay_ns = self.clock.delay_ns();
        let latency_ns = (self.config.plot_source.latency_s * NS_PER_S) as i64;
        let by_turn = (self.end_ns(next) + delay_ns + latency_ns).max(0) as u64;
        let wait_ns = (self.config.plot_source.sector_delay_s * NS_PER_S).max(LATENESS_MARGIN * self.lateness_ns);
        let by_message = self.complete_since(next).map(|since_ns| since_ns + wait_ns as u64);
        Some(by_message.map_or(by_turn, |by_message| by_message.min(by_turn)))
    }

    /// Closes the sectors that are due, those of a turn at most: after a long time without a call others are due at once.
    pub fn close_due(&mut self, now_ns: u64, closed: &mut Closed) {
        let most = closed.len() + self.sectors as usize;
        while let Some(next) = self.next
            && closed.len() < most
            && self.due_ns().is_some_and(|due_ns| due_ns <= now_ns)
        {
            self.events.timed_out += u64::from(self.complete_since(next).is_none());
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
        self.lateness_ns *= 1.0 - 1.0 / (LATENESS_FADES * self.sectors as f64);
        self.next = Some(sector + 1);
        while self.complete.front().is_some_and(|&(before, _)| before <= sector - self.sectors) {
            self.complete.pop_front();
        }
        closed.push((header, plots));
    }

    fn layout(&self) -> SectorLayout {
        let source_id = self.source.map_or(self.config.site.source_id(), |source| source.number().into());
        let turning = self.antenna.turning();
        SectorLayout::new(source_id, turning, &self.config.plot_source, &self.config.site, self.coordinates)
    }
}
