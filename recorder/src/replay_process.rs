//! The process `replay`: puts a recording back onto the services.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use common::commands::{ASKED, Command, CommandsHeader};
use common::config::ChainConfig;
use common::ipc::{Publisher, Station};
use common::message::{END_OF_STREAM, Stamps};
use common::messages::{Actions, Commands, Dwells, Message, Plots, Tracks, Truth};
use common::pace::Pace;
use common::process::{BadInput, HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::recording::{Recorded, commands_of};
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::{self, TRACKER, last_in_processing};

use crate::replay::{Playback, lineage_again};

/// Name of the process.
pub const NAME: &str = "replay";

/// Runs the process until the recording ends or it is asked to stop.
///
/// # Errors
/// Configuration, recording or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    replay(&args.load()?)
}

/// As [`run`], with a configuration that is loaded already.
///
/// # Errors
/// Recording or shared memory.
pub fn replay(chain: &ChainConfig) -> anyhow::Result<ExitCode> {
    let mut playback = Playback::open(chain).map_err(|error| BadInput(error.to_string()))?;
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, chain)?;
    let ports = Ports::new(&station, chain)?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, chain, session, refused)?;
    reporter.publish()?;
    ports.wait_for_consumers()?;
    if topology::runs(chain, TRACKER) {
        give_commands(&station, chain, &mut reporter)?;
    }

    let mut pace = Pace::new(chain.run.speed);
    let (mut plots_out, mut tracks_out, mut actions_out, mut dwells_taken, mut plots_taken) = (0, 0, 0, 0, 0);
    let driving = last_in_processing(&chain.replay.topics);
    for message in playback.by_ref() {
        let mut message = message.map_err(|error| BadInput(format!("{}: {error}", chain.replay.file)))?;
        let (drives, length) = (message.by_ref().topic() == driving, message.by_ref().len());
        if drives {
            pace.wait_until(message.by_ref().time_ns(), || reporter.publish())?;
        }
        let stop = if drives && stop_requested() { END_OF_STREAM } else { 0 };
        let (scan, flags) = match &mut message {
            Recorded::Dwells(header, cells) => {
                (header.session, header.flags) = (session, header.flags | stop);
                ports.dwells.send(header, cells, |header| header.source_out_ns = monotonic_ns())?;
                (header.scan, header.flags)
            }
            Recorded::Plots(header, plots) => {
                (header.session, header.flags) = (session, header.flags | stop);
                header.lineage = lineage_again(&header.lineage, &mut dwells_taken, plots_out);
                // Stages that do not run have no stamps: those of the recorded run are of another clock.
                ports.plots.send(header, plots, |header| {
                    let now_ns = monotonic_ns();
                    header.stamps = Stamps { source_out_ns: now_ns, plots_out_ns: now_ns, ..Stamps::default() };
                })?;
                plots_out += 1;
                (header.scan, header.flags)
            }
            Recorded::Tracks(header, tracks) => {
                (header.session, header.flags) = (session, header.flags | stop);
                header.lineage = lineage_again(&header.lineage, &mut plots_taken, tracks_out);
                ports.tracks.send(header, tracks, |header| {
                    header.stamps = Stamps { tracks_out_ns: monotonic_ns(), ..Stamps::default() };
                })?;
                tracks_out += 1;
                (header.scan, header.flags)
            }
            Recorded::Truth(header, targets) => {
                header.session = session;
                ports.truth.send(header, targets, |header| header.source_out_ns = monotonic_ns())?;
                continue;
            }
            Recorded::Actions(header, actions) => {
                // Those of a tracker that was started again had numbers from 0 on.
                (header.session, header.seq) = (session, actions_out);
                actions_out += 1;
                ports.actions.send(header, actions, |header| header.out_ns = monotonic_ns())?;
                continue;
            }
            _ => continue,
        };
        let health = &mut reporter.health;
        health.scan = scan;
        health.messages_out += 1;
        health.elements_out += length as u64;
        let last = drives && flags & END_OF_STREAM != 0;
        health.ended = u32::from(last);
        if last || reporter.is_due() {
            reporter.publish()?;
        }
        if last {
            ports.linger();
            return Ok(ExitCode::SUCCESS);
        }
    }
    if playback.has_passed() {
        reporter.health.ended = 1;
        reporter.publish()?;
        return Ok(ExitCode::SUCCESS);
    }
    Err(BadInput(format!("{} holds no {} of these scans", chain.replay.file, driving.name())).into())
}

/// Asks the tracker at once for all that operators had done: it waits for the plots before which each was done.
fn give_commands(station: &Station, chain: &ChainConfig, reporter: &mut HealthReporter) -> anyhow::Result<()> {
    let (file, mut told) = (Path::new(&chain.replay.file), Ok(()));
    let commands = commands_of(file, chain.run.first_scan, chain.sectors_per_scan(), || {
        if told.is_ok() && reporter.is_due() {
            told = reporter.publish();
        }
    });
    let commands = commands.map_err(|error| BadInput(error.to_string()))?;
    told?;
    if commands.is_empty() {
        return Ok(());
    }
    let publisher = station.publisher::<Commands>(Commands::MOST)?;
    for (seq, command) in commands.into_iter().enumerate() {
        let header = CommandsHeader { seq: seq as u64, session: reporter.health.session, ..CommandsHeader::default() };
        let asked = Command { outcome: ASKED, ..command };
        publisher.publish(&header, &[asked], |header| header.out_ns = monotonic_ns()).context("publishing commands")?;
    }
    Ok(())
}

/// Publisher of a topic, if it is replayed.
struct Port<M: Message>(Option<Publisher<M>>);

impl<M: Message> Port<M> {
    fn new(station: &Station, chain: &ChainConfig, most: usize) -> anyhow::Result<Self> {
        // What operators did belongs to the tracks that are replayed.
        let named = if M::TOPIC == Topic::Actions { Topic::Tracks } else { M::TOPIC };
        let wanted = chain.replay.topics.contains(&named);
        Ok(Self(wanted.then(|| station.publisher(most)).transpose()?))
    }

    fn send(
        &self,
        header: &M::Header,
        elements: &[M::Element],
        stamp: impl FnMut(&mut M::Header),
    ) -> anyhow::Result<()> {
        let Some(publisher) = &self.0 else { return Ok(()) };
        publisher.publish(header, elements, stamp).with_context(|| format!("publishing {}", M::TOPIC.name()))
    }

    fn wait(&self) -> anyhow::Result<()> {
        Ok(self.0.as_ref().map_or(Ok(()), Publisher::wait_for_consumers)?)
    }
}

struct Ports {
    dwells: Port<Dwells>,
    plots: Port<Plots>,
    tracks: Port<Tracks>,
    truth: Port<Truth>,
    actions: Port<Actions>,
}

impl Ports {
    fn new(station: &Station, chain: &ChainConfig) -> anyhow::Result<Self> {
        let cells = chain.radar.grid().cells().min(Dwells::MOST);
        Ok(Self {
            dwells: Port::new(station, chain, cells)?,
            plots: Port::new(station, chain, Plots::MOST)?,
            tracks: Port::new(station, chain, Tracks::MOST)?,
            truth: Port::new(station, chain, Truth::MOST)?,
            actions: Port::new(station, chain, Actions::MOST)?,
        })
    }

    fn wait_for_consumers(&self) -> anyhow::Result<()> {
        self.dwells.wait()?;
        self.plots.wait()?;
        self.tracks.wait()?;
        self.truth.wait()?;
        self.actions.wait()
    }

    fn linger(&self) {
        let Self { dwells, plots, tracks, .. } = self;
        dwells.0.iter().for_each(Publisher::linger);
        plots.0.iter().for_each(Publisher::linger);
        tracks.0.iter().for_each(Publisher::linger);
    }
}
