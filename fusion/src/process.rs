//! The process `fusion`: takes the tracks of all other sites, publishes system tracks, cycle by cycle of measurement time.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use common::angle;
use common::config::{ChainConfig, FusionConfig, Mode, Sites, Source};
use common::geodesy::Position;
use common::health::{Intake, Reject, Rejected};
use common::ipc::{Domain, Flow, Publisher, Station, attend};
use common::message::{END_OF_SCAN, END_OF_STREAM, Lineage, Stamps, TRUNCATED};
use common::messages::{Message, SystemTracks, Tracks, Truth};
use common::process::{HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::system_tracks::{MAX_SYSTEM_TRACKS, SystemTrack, SystemTracksHeader};
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::FUSION;
use common::tracks::{MAX_TRACKS, Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use common::units::{NS_PER_S, seconds_between};
use tracing::{info, warn};

use crate::engine::Fusion;
use crate::feed::Feed;
use crate::motion::Motion;
use crate::outgoing::{Centre, track};
use crate::pacing::Pacing;
use crate::registration::Bias;
use crate::remarks::{Heard, Remark, Remarks};
use crate::settings::{Settings, Site};

/// Name of the process.
pub const NAME: &str = FUSION;
/// A day, s.
const DAY_S: f64 = 86_400.0;

/// Runs the process until the tracks of all other sites have ended.
///
/// # Errors
/// Configuration or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let (sites, chain) = (args.load_sites()?, args.load()?);
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let mut stage = Stage::new(&sites, &chain, &station)?;
    let others: Vec<&ChainConfig> = others(&sites).collect();
    let (mut feeds, mut wakes) = (Vec::new(), Vec::new());
    for site in &others {
        let there = station.at(site);
        feeds.push(Feed::new(&there, site, &stage.centre_position)?);
        wakes.push(there.wake(Topic::Tracks)?);
    }
    let wakes: Vec<_> = wakes.iter().collect();
    let mut reporter = HealthReporter::new(&station, &chain, stage.session, refused)?;
    let (mut pacing, mut remarks) = (Pacing::new(&chain), Remarks::default());

    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let limit_ns = pacing.limit_ns(stage.next_ns());
        for (site, feed) in feeds.iter_mut().enumerate() {
            feed.take_waiting(site, limit_ns, &mut stage.fusion)?;
        }
        pacing.stopping = stop_requested();
        pacing.find_out_of_step(&mut feeds, &others, &mut stage.fusion);
        if stage.next.is_none() {
            stage.begin(&feeds, &pacing);
        }
        let mut worked = false;
        while let Some(now_ns) = stage.next_ns().filter(|&now_ns| pacing.is_due(now_ns, &feeds)) {
            stage.cycle(now_ns, 0, &mut feeds)?;
            let heard = feeds.iter().zip(&others).map(|(feed, site)| Heard {
                name: &site.site.name,
                scan_period_s: site.scan_period_s(),
                is_in_time: feed.has_passed(now_ns) || feed.is_out_of_step() || pacing.has_ended(feed),
            });
            for remark in remarks.look(now_ns, &stage.fusion, heard) {
                match remark {
                    Remark::Wrong(text) => warn!("{text}"),
                    Remark::Over(text) => info!("{text}"),
                }
            }
            stage.skip_days(&feeds);
            worked = true;
        }
        let ended = feeds.iter().all(|feed| pacing.has_ended(feed));
        if ended {
            stage.cycle(stage.next_ns().unwrap_or(0), END_OF_STREAM, &mut feeds)?;
        }
        if ended || reporter.is_due() {
            stage.describe(&mut reporter, &feeds);
            reporter.health.ended = u32::from(ended);
            reporter.publish()?;
        }
        Ok(match (ended, worked) {
            (true, _) => Flow::End,
            (false, true) => Flow::Again, // what has been held back may come now
            (false, false) => Flow::Wait,
        })
    })?;
    stage.say_biases(&others);
    stage.tracks_out.linger();
    Ok(ExitCode::SUCCESS)
}

/// What [`Stage::begin`] has kept.
fn read_start(file: &Path) -> Option<u64> {
    std::fs::read_to_string(file).ok()?.parse().ok()
}

/// The sites whose tracks are fused.
fn others(sites: &Sites) -> impl Iterator<Item = &ChainConfig> {
    sites.all().iter().filter(|site| site.run.source != Source::Fusion)
}

fn settings(chain: &ChainConfig) -> Settings {
    let (config, default) = (&chain.fusion, Settings::default());
    Settings {
        motion: Motion {
            noise: [config.straight_noise, config.manoeuvre_noise],
            stay_s: [config.straight_s, config.manoeuvre_s],
        },
        coast_s: config.coast_s,
        hidden_s: config.hidden_s,
        // In lossless mode all wait for all, so that nothing is too early or too late.
        patience_s: if chain.run.mode == Mode::RealTime { default.patience_s } else { f64::INFINITY },
        ..default
    }
}

/// A site as the fusion sees it.
fn site(config: &ChainConfig, centre: &Position, fusion: &FusionConfig) -> Site {
    let radar = &config.radar;
    let beam_rad = |number: f64| (radar.elevation_first_deg + number * radar.elevation_step_deg).to_radians();
    // Half a step beyond the centres of the outermost cells and beams.
    let simulated_m = [-0.5, f64::from(radar.ranges) - 0.5].map(|cell| radar.range_first_m + cell * radar.range_step_m);
    let simulated_rad = [-0.5, f64::from(radar.elevations) - 0.5].map(beam_rad);
    let is_simulated = config.run.source == Source::RadarSim;
    Site {
        position: config.site.position.unwrap_or(*centre),
        range_m: if is_simulated { simulated_m } else { [0.0, fusion.range_m] },
        // A single broad beam measures no elevation; of other radars nothing is known.
        elevation_rad: if is_simulated && radar.elevations > 1 { simulated_rad } else { Site::ALL_ELEVATIONS_RAD },
        period_s: config.scan_period_s(),
        bias: Bias::new(
            fusion.range_bias_m,
            fusion.azimuth_bias_deg.to_radians(),
            fusion.elevation_bias_deg.to_radians(),
            fusion.time_bias_s,
        ),
    }
}

/// The fusion with its outputs.
struct Stage {
    fusion: Fusion,
    centre_position: Position,
    centre: Centre,
    /// Place of each fused site among those of the chain.
    places: Vec<u32>,
    sectors: u32,
    cycle_s: f64,
    cycle_ns: u64,
    /// Begin of the first cycle of the run; `None` while it is not known.
    start_ns: Option<u64>,
    /// Where that is kept for one that is started again.
    start_file: PathBuf,
    /// Number of the first cycle where nothing is heard any more.
    first_cycle: u32,
    /// Number of the next cycle; `None` while this process has not begun.
    next: Option<u32>,
    session: u64,
    tracks_out: Publisher<Tracks>,
    truth_out: Publisher<Truth>,
    system_out: Publisher<SystemTracks>,
    by_sector: Vec<Vec<Track>>,
    told: Vec<SystemTrack>,
    messages: u64,
    elements: u64,
    confirmed: u32,
}

impl Stage {
    fn new(sites: &Sites, chain: &ChainConfig, station: &Station) -> anyhow::Result<Self> {
        let centre_position = chain.site.position.context("the centre has no position")?;
        let of_fusion: Vec<Site> = others(sites).map(|other| site(other, &centre_position, &chain.fusion)).collect();
        let sectors = chain.fusion.sectors;
        let numbered = sites.all().iter().enumerate();
        let places = numbered.filter(|(_, site)| site.run.source != Source::Fusion).map(|(place, _)| place as u32);
        let start_file = Domain::root(&chain.ipc).join(format!("fusion-start-{}", chain.site.name));
        Ok(Self {
            fusion: Fusion::new(&centre_position, &of_fusion, settings(chain)).numbered_from(chain.run.first_track),
            centre: Centre::new(&centre_position),
            centre_position,
            places: places.collect(),
            sectors,
            cycle_s: chain.fusion.cycle_s,
            cycle_ns: (chain.fusion.cycle_s * NS_PER_S) as u64,
            start_ns: (chain.run.first_scan > 0).then(|| read_start(&start_file)).flatten(),
            start_file,
            first_cycle: chain.run.first_scan,
            next: None,
            session: new_session(),
            tracks_out: station.publisher::<Tracks>(Tracks::MOST)?,
            truth_out: station.publisher::<Truth>(Truth::MOST)?,
            system_out: station.publisher::<SystemTracks>(SystemTracks::MOST)?,
            by_sector: vec![Vec::with_capacity(MAX_TRACKS); sectors as usize],
            told: Vec::with_capacity(MAX_SYSTEM_TRACKS),
            messages: 0,
            elements: 0,
            confirmed: 0,
        })
    }

    /// Sets the time of the first cycle once all sites have been heard that are waited for.
    fn begin(&mut self, feeds: &[Feed], pacing: &Pacing) {
        let first_ns = feeds.iter().filter(|feed| !feed.is_out_of_step()).filter_map(Feed::first_ns).min();
        let all = feeds.iter().all(|feed| feed.first_ns().is_some() || pacing.has_ended(feed));
        if let Some(first_ns) = first_ns
            && (all || pacing.is_overdue(first_ns))
        {
            let start_ns = self.start_ns.unwrap_or(first_ns / self.cycle_ns * self.cycle_ns);
            self.start_ns = Some(start_ns);
            self.next = Some(self.number_at(first_ns));
            // Without it one that is started again would only number its cycles anew.
            let _ = std::fs::write(&self.start_file, start_ns.to_string());
        }
    }

    /// Number of the cycle that a time belongs to.
    fn number_at(&self, time_ns: u64) -> u32 {
        (time_ns.saturating_sub(self.start_ns.unwrap_or(time_ns)) / self.cycle_ns) as u32
    }

    /// Leaves out the cycles of days in which no site has anything: a clock was wrong, or a recording has a hole.
    fn skip_days(&mut self, feeds: &[Feed]) {
        let earliest_ns = feeds.iter().filter_map(Feed::time_ns).min();
        if let (Some(next_ns), Some(earliest_ns)) = (self.next_ns(), earliest_ns)
            && self.fusion.is_empty()
            && seconds_between(next_ns, earliest_ns) > DAY_S
        {
            self.next = Some(self.number_at(earliest_ns));
        }
    }

    /// End of the next cycle, ns UTC.
    fn next_ns(&self) -> Option<u64> {
        Some(self.start_ns? + u64::from(self.next? + 1) * self.cycle_ns)
    }

    fn cycle(&mut self, now_ns: u64, flags: u32, feeds: &mut [Feed]) -> anyhow::Result<()> {
        self.fusion.cycle(now_ns);
        let number = self.next.unwrap_or(self.first_cycle);
        self.next = Some(number + 1);
        let mut truth = BTreeMap::new();
        for feed in feeds.iter_mut() {
            feed.truth_at(now_ns, &mut truth);
        }
        if !truth.is_empty() {
            self.publish_truth(number, now_ns, &truth)?;
        }
        self.publish_system_tracks(number, now_ns, flags, feeds)?;
        self.publish_tracks(number, now_ns, flags, feeds)?;
        Ok(())
    }

    fn publish_truth(
        &mut self,
        number: u32,
        now_ns: u64,
        truth: &BTreeMap<u32, (u64, TruthTarget)>,
    ) -> anyhow::Result<()> {
        let targets: Vec<TruthTarget> = truth.values().map(|of| of.1).take(Truth::MOST).collect();
        let header = TruthHeader {
            seq: number.into(),
            session: self.session,
            time_ns: now_ns,
            scan_period_s: self.cycle_s,
            scan: number,
            ..TruthHeader::default()
        };
        let published = self.truth_out.publish(&header, &targets, |header| header.source_out_ns = monotonic_ns());
        published.context("publishing truth")
    }

    fn publish_system_tracks(&mut self, number: u32, now_ns: u64, flags: u32, feeds: &[Feed]) -> anyhow::Result<()> {
        self.told.clear();
        self.told.extend(self.fusion.system_tracks().map(|track| self.centre.system_track(&track, &self.places)));
        let mut header = SystemTracksHeader {
            seq: number.into(),
            session: self.session,
            time_ns: now_ns,
            tracks_out_ns: last_ns(feeds),
            cycle_s: self.cycle_s,
            flags: flags | END_OF_SCAN,
            sites_heard: feeds.iter().filter(|feed| feed.has_passed(now_ns)).count() as u32,
            ..SystemTracksHeader::default()
        };
        if self.told.len() > MAX_SYSTEM_TRACKS {
            header.left_out = (self.told.len() - MAX_SYSTEM_TRACKS) as u32;
            header.flags |= TRUNCATED;
            self.told.truncate(MAX_SYSTEM_TRACKS);
        }
        let registration = self.fusion.registration();
        for (number, &place) in self.places.iter().enumerate() {
            let Some(told) = header.biases.get_mut(place as usize) else { continue };
            let (bias, covariance) = (registration.bias(number), registration.covariance(number, number));
            told.bias = std::array::from_fn(|i| bias[i] as f32);
            told.sigma = std::array::from_fn(|i| covariance[(i, i)].sqrt() as f32);
        }
        let published = self.system_out.publish(&header, &self.told, |header| header.fused_out_ns = monotonic_ns());
        published.context("publishing system tracks")
    }

    fn publish_tracks(&mut self, number: u32, now_ns: u64, flags: u32, feeds: &[Feed]) -> anyhow::Result<()> {
        self.by_sector.iter_mut().for_each(Vec::clear);
        let (mut alive, mut confirmed) = (0, 0);
        for system in self.fusion.system_tracks() {
            let track = track(&system);
            let [east, north, _] = track.position_m();
            let sector = angle::wrap(east.atan2(north)) / TAU * f64::from(self.sectors);
            self.by_sector[(sector as usize).min(self.sectors as usize - 1)].push(track);
            alive += u32::from(!system.ended);
            confirmed += u32::from(track.is_confirmed());
        }
        for (sector, tracks) in self.by_sector.iter_mut().enumerate() {
            let last = sector + 1 == self.sectors as usize;
            let mut header = TracksHeader {
                seq: u64::from(number) * u64::from(self.sectors) + sector as u64,
                session: self.session,
                time_ns: now_ns,
                lineage: Lineage { published_before: self.messages, ..Lineage::default() },
                stamps: Stamps { source_out_ns: last_ns(feeds), ..Stamps::default() },
                scan: number,
                sector: sector as u32,
                sectors_per_scan: self.sectors,
                flags: if last { flags | END_OF_SCAN } else { 0 },
                alive,
                confirmed,
                ..TracksHeader::default()
            };
            if tracks.len() > MAX_TRACKS {
                header.left_out = (tracks.len() - MAX_TRACKS) as u32;
                header.flags |= TRUNCATED;
                tracks.truncate(MAX_TRACKS);
            }
            let published =
                self.tracks_out.publish(&header, tracks, |header| header.stamps.tracks_out_ns = monotonic_ns());
            published.context("publishing tracks")?;
            self.messages += 1;
            self.elements += tracks.len() as u64;
        }
        self.confirmed = confirmed;
        Ok(())
    }

    fn describe(&self, reporter: &mut HealthReporter, feeds: &[Feed]) {
        let health = &mut reporter.health;
        health.scan = self.next.unwrap_or(0).saturating_sub(1);
        (health.messages_out, health.elements_out) = (self.messages, self.elements);
        (health.tracks, health.confirmed) = (self.told.len() as u32, self.confirmed);
        let of_all = feeds.iter().map(Feed::intake).fold(Intake::default(), Intake::plus);
        health.set_intake(Topic::Tracks, of_all);
        health.set_waiting(Topic::Tracks, feeds.iter().filter_map(Feed::take_most_waiting).max());
        let mut rejected = Rejected::default();
        for counts in (0..feeds.len()).map(|site| self.fusion.counts(site)) {
            rejected.count_many(Reject::Late, counts.untimely + counts.repeated);
            rejected.count_many(Reject::BadTrack, counts.unsound);
        }
        health.set_rejected(&rejected);
    }

    fn say_biases(&self, sites: &[&ChainConfig]) {
        for (number, site) in sites.iter().enumerate() {
            let bias = self.fusion.registration().bias(number);
            info!(
                site = site.site.name,
                range_m = bias[0],
                azimuth_deg = bias[1].to_degrees(),
                elevation_deg = bias[2].to_degrees(),
                counts = ?self.fusion.counts(number),
                "bias of the radar"
            );
        }
    }
}

/// CLOCK_MONOTONIC at which the last tracks that came were published, ns.
fn last_ns(feeds: &[Feed]) -> u64 {
    feeds.iter().map(|feed| feed.tracks_out_ns).max().unwrap_or(0)
}
