//! The process `tracker`: takes plots, publishes the tracks of each sector.

use std::process::ExitCode;

use anyhow::Context;
use common::commands::{ACCEPTED, Command, CommandsHeader, REMOVE_ZONE};
use common::config::{Mode, Source};
use common::health::{Reject, Rejected};
use common::ipc::{Domain, Flow, IpcError, Station, Subscriber, Turn, attend};
use common::message::{COUNTER_CLOCKWISE, END_OF_SCAN, END_OF_STREAM, Lineage, STANDING, TRUNCATED};
use common::messages::{Actions, ClutterMap, Commands, Message, Plots, Tracks};
use common::plots::PlotsHeader;
use common::process::{HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::time::monotonic_ns;
use common::topic::Topic;
use common::tracks::{MAX_TRACKS, Track, TracksHeader};

use crate::last_tracks::{Before, LastTracks};
use crate::orders::Orders;
use crate::zones::ZonesFile;
use crate::{Processed, Tracker};

/// Name of the process.
pub const NAME: &str = "tracker";
/// The clutter map is published once in so many scans: it changes slowly, and a viewer of a recording sees three scans back.
const SCANS_OF_A_MAP: u32 = 2;

/// Runs the process until the stream ends or it is asked to stop.
///
/// # Errors
/// Configuration or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let mut tracker = Tracker::new(&chain.tracker, chain.run.first_track)?;
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let publisher = station.publisher::<Tracks>(Tracks::MOST)?;
    let actions = station.publisher::<Actions>(Actions::MOST)?;
    let maps = station.publisher::<ClutterMap>(ClutterMap::MOST)?;
    let wakes = [station.wake(Topic::Plots)?, station.wake(Topic::Commands)?];
    let (plots, commands) = (station.subscriber::<Plots>()?, station.subscriber::<Commands>()?);
    let zones = ZonesFile::of(&Domain::root(&chain.ipc), &chain.site.name);
    let mut last_tracks = LastTracks::of(&chain);
    let Before { tracks: before, continued_session } = last_tracks.begin(chain.run.first_track);
    tracker.take_over(before);
    let mut orders = Orders::default();
    zones.read().into_iter().for_each(|zone| orders.take(zone));
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    let mut rejected = Rejected::default();
    let mut tracks = Vec::with_capacity(MAX_TRACKS);
    let (mut cells, mut maps_out) = (Vec::with_capacity(ClutterMap::MOST), 0);
    let mut plots_of_scan = 0;
    let external = chain.run.source == Source::External;

    let tell = |header: &CommandsHeader, action: &Command| -> anyhow::Result<()> {
        let published = actions.publish(header, &[*action], |header| {
            (header.session, header.out_ns) = (session, monotonic_ns());
        });
        published.context("publishing actions")
    };

    attend(&wakes.each_ref(), &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let turn = Turn::begin();
        take_commands(&commands, &mut orders)?; // also while no plots come
        while !turn.is_over()
            && let Some(message) = plots.receive()?
        {
            let received_ns = monotonic_ns();
            take_commands(&commands, &mut orders)?; // those that were sent before these plots
            orders.carry_out(&mut tracker, message.header(), |header, action, tracker| {
                if action.outcome == ACCEPTED && (action.sets_zone() || action.kind == REMOVE_ZONE) {
                    zones.write(tracker.zones()); // before anybody believes in it
                }
                tell(header, action)
            })?;
            let processed = tracker.process_plots(message.header(), message.elements(), &mut tracks);
            let mut header = header_of(message.header(), &processed, reporter.health.messages_out, received_ns);
            keep_what_fits(&mut tracks, &mut header);
            (header.session, header.continued_session) = (session, continued_session);
            let published = publisher.publish(&header, &tracks, |header| {
                header.stamps.tracks_out_ns = monotonic_ns();
            });
            published.context("publishing tracks")?;
            last_tracks.keep(&header, &tracks);
            orders.follow_up(&mut tracker, message.header(), tell)?;
            if header.has(END_OF_SCAN)
                && header.scan.is_multiple_of(SCANS_OF_A_MAP)
                && (chain.run.mode == Mode::Lossless || maps.is_heard()) // in real time nobody waits for who hears maps
                && let Some(map) = tracker.clutter_map(message.header(), &mut cells)
            {
                let published = maps.publish(&map, &cells, |map| {
                    (map.seq, map.session, map.out_ns) = (maps_out, session, monotonic_ns());
                });
                published.context("publishing the clutter map")?;
                maps_out += 1;
            }

            rejected.add(&processed.rejected);
            rejected.count_many(Reject::Full, header.left_out.into());
            let health = &mut reporter.health;
            plots_of_scan += message.elements().len() as u32;
            if header.has(END_OF_SCAN) {
                health.plots = std::mem::take(&mut plots_of_scan);
            }
            health.scan = header.scan;
            health.messages_out += 1;
            health.elements_out += tracks.len() as u64;
            health.tracks = processed.alive;
            health.confirmed = processed.confirmed;
            health.ended = u32::from(header.has(END_OF_STREAM));
            if health.ended == 1 {
                break;
            }
        }
        let ended = reporter.health.ended == 1;
        if ended || reporter.is_due() {
            reporter.health.set_intake(Topic::Plots, plots.intake());
            reporter.health.set_waiting(Topic::Plots, plots.take_most_waiting());
            reporter.health.set_rejected(&rejected);
            reporter.health.false_alarms = tracker.false_alarms();
            reporter.publish()?;
        }
        // Asked to stop, it still works off what is sent until the last plots; a source that nobody can ask to stop is not
        // waited for.
        let abandoned = !turn.is_over() && stop_requested() && (plots.publishers() == 0 || external);
        Ok(if ended || abandoned { Flow::End } else { turn.flow() })
    })?;
    publisher.linger();
    Ok(ExitCode::SUCCESS)
}

fn take_commands(commands: &Subscriber<Commands>, orders: &mut Orders) -> Result<(), IpcError> {
    while let Some(message) = commands.receive()? {
        message.elements().iter().for_each(|command| orders.take(*command));
    }
    Ok(())
}

/// Header of the tracks that the plots under `plots` have brought up to date, after
/// `taken_before` other messages of this session.
pub fn header_of(plots: &PlotsHeader, processed: &Processed, taken_before: u64, received_ns: u64) -> TracksHeader {
    let mut stamps = plots.stamps;
    stamps.tracker_in_ns = received_ns;
    TracksHeader {
        seq: plots.seq,
        time_ns: plots.time_ns,
        lineage: Lineage {
            session: plots.session,
            first_seq: plots.seq,
            last_seq: plots.seq,
            taken: 1,
            taken_in_session: taken_before + 1,
            published_before: taken_before,
        },
        stamps,
        scan: plots.scan,
        sector: plots.sector,
        sectors_per_scan: plots.sectors_per_scan,
        flags: plots.flags & (END_OF_SCAN | END_OF_STREAM | COUNTER_CLOCKWISE | STANDING),
        alive: processed.alive,
        confirmed: processed.confirmed,
        rejected: processed.rejected.total() as u32,
        source_id: plots.source_id,
        ..TracksHeader::default()
    }
}

/// Leaves tentative tracks out first where a message cannot hold all.
fn keep_what_fits(tracks: &mut Vec<Track>, header: &mut TracksHeader) {
    if tracks.len() > MAX_TRACKS {
        header.left_out = (tracks.len() - MAX_TRACKS) as u32;
        header.flags |= TRUNCATED;
        tracks.sort_by_key(|track| !track.is_confirmed());
        tracks.truncate(MAX_TRACKS);
    }
}
