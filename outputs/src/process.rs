//! The process `outputs`: an observer of all sites, which sends on what they find.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, OutputFormat, Sent, Sites, Source};
use common::health::{Health, Intake, Reject, Rejected};
use common::ipc::{Flow, IpcError, ObserverLosses, Received, Station, Subscriber, Turn, attend};
use common::message::END_OF_STREAM;
use common::messages::{Actions, Message, Plots, SystemTracks, Tracks};
use common::process::{BadInput, HealthReporter, StageArgs, new_session, say, stop_requested, tell};
use common::realtime;
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::{OUTPUTS, TRACKER, runs};
use common::tracks::TERMINATED;

use crate::origins::Origins;
use crate::output::Output;
use crate::targets::{Site, units};

/// Name of the process.
pub const NAME: &str = OUTPUTS;
/// How long peers have at the end to take what waits for them.
const LAST_FRAMES: Duration = Duration::from_secs(1);

/// Sends until the tracks of all sites have ended or the process is asked to stop.
///
/// # Errors
/// Configuration, an address that cannot be used, or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let sites = args.load_sites()?;
    let chain = sites.first();
    if chain.outputs.is_empty() {
        return Err(BadInput("no output is configured, expected a table [outputs.NAME]".into()).into());
    }
    let (session, refused) = (new_session(), realtime::apply(chain.realtime.of(NAME)));
    let units = units(sites.all());
    let mut outputs = open_outputs(&sites, &units, session)?;
    let first = Station::enter(NAME, chain)?;
    let mut feeds = feeds(&first, &sites, &units)?;
    let mut wakes = Vec::new();
    for feed in &feeds {
        wakes.push(feed.station.wake(Topic::Tracks)?);
        if feed.plots.is_some() {
            wakes.push(feed.station.wake(Topic::Plots)?);
        }
    }
    let wakes: Vec<_> = wakes.iter().collect();
    let mut reporter = HealthReporter::new(&first, chain, session, refused)?;
    let mut dropped = vec![0; outputs.len()];

    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let turn = Turn::begin();
        for (index, feed) in feeds.iter_mut().enumerate() {
            feed.pass_on(index, &mut outputs, &turn)?;
        }
        outputs.iter_mut().for_each(Output::attend);
        let ended = stop_requested() || feeds.iter().all(|feed| feed.ended);
        if ended {
            finish(&mut outputs);
        }
        let flow = if ended { Flow::End } else { turn.flow() };
        if flow == Flow::End || reporter.is_due() {
            count_dropped(&outputs, &mut dropped, &first.observer_losses());
            describe(&mut reporter.health, &outputs, &feeds);
            reporter.health.ended = u32::from(flow == Flow::End);
            reporter.publish()?;
        }
        Ok(flow)
    })?;
    for output in &outputs {
        tell(&output.summary());
    }
    Ok(ExitCode::SUCCESS)
}

/// All outputs, each with the sites that it takes.
fn open_outputs(sites: &Sites, units: &[u8], session: u64) -> anyhow::Result<Vec<Output>> {
    let any_simulated = sites.all().iter().any(|site| site.run.source == Source::RadarSim);
    let is_simulated = |site: &ChainConfig| match site.run.source {
        Source::Fusion => any_simulated,
        source => source == Source::RadarSim,
    };
    let mut outputs = Vec::new();
    for (name, config) in &sites.first().outputs {
        if !config.site.is_empty() {
            sites.named(&config.site)?;
        }
        let of_site =
            |(site, &unit): (&ChainConfig, &u8)| config.takes(site).then(|| Site::new(site, unit, is_simulated(site)));
        let taken: Vec<_> = sites.all().iter().zip(units).map(of_site).collect();
        if taken.iter().flatten().any(|site| site.position.is_none()) {
            say(&format!("output `{name}`: key `site.position` is not set: no latitude, longitude or height is sent"));
        }
        outputs.push(Output::open(name, config, taken, session)?);
    }
    Ok(outputs)
}

/// Lets peers take what waits for them.
fn finish(outputs: &mut [Output]) {
    outputs.iter_mut().for_each(Output::close);
    let began = Instant::now();
    while outputs.iter().any(Output::is_waiting) && began.elapsed() < LAST_FRAMES {
        std::thread::sleep(Duration::from_millis(1));
        outputs.iter_mut().for_each(Output::attend);
    }
}

/// Notes what has been dropped since the last time.
fn count_dropped(outputs: &[Output], noted: &mut [u64], losses: &ObserverLosses) {
    for (output, noted) in outputs.iter().zip(noted) {
        let dropped = output.counts().dropped;
        if dropped > *noted {
            let topic = if output.sends() == Sent::Plots { Topic::Plots } else { Topic::Tracks };
            losses.count_many(topic, output.name(), dropped - *noted);
            *noted = dropped;
        }
    }
}

fn describe(health: &mut Health, outputs: &[Output], feeds: &[Feed]) {
    let mut rejected = Rejected::default();
    (health.messages_out, health.elements_out) = (0, 0);
    for output in outputs {
        health.messages_out += output.counts().sent;
        health.elements_out += output.reports();
        rejected.count_many(Reject::NotSayable, output.not_said());
    }
    health.set_rejected(&rejected);
    health.scan = feeds.iter().map(|feed| feed.scan).max().unwrap_or(0);
    tell_of(health, feeds.iter().map(|feed| &feed.tracks));
    tell_of(health, feeds.iter().filter_map(|feed| feed.plots.as_ref()));
    tell_of(health, feeds.iter().filter_map(|feed| feed.system_tracks.as_ref()));
    tell_of(health, feeds.iter().filter_map(|feed| feed.actions.as_ref()));
}

/// Notes what has come of a topic from all sites, if it is taken of any; of their queues, the fullest one.
fn tell_of<'a, M: Message + 'a>(health: &mut Health, subscribers: impl Iterator<Item = &'a Subscriber<M>> + Clone) {
    if let Some(intake) = subscribers.clone().map(Subscriber::intake).reduce(Intake::plus) {
        health.set_intake(M::TOPIC, intake);
        health.set_waiting(M::TOPIC, subscribers.filter_map(Subscriber::take_most_waiting).max());
    }
}

/// What comes from a site.
struct Feed {
    station: Station,
    tracks: Subscriber<Tracks>,
    /// Where an output sends plots of it, or says of which plots its tracks are.
    plots: Option<Subscriber<Plots>>,
    /// Where an output says of which local tracks its tracks are.
    system_tracks: Option<Subscriber<SystemTracks>>,
    /// Where an output says what operators call its tracks.
    actions: Option<Subscriber<Actions>>,
    origins: Origins,
    scan: u32,
    ended: bool,
}

fn feeds(first: &Station, sites: &Sites, units: &[u8]) -> Result<Vec<Feed>, IpcError> {
    let feed = |site: &ChainConfig| {
        let station = first.at(site);
        let tracks = station.subscriber()?;
        let takes = |format: OutputFormat, sent: Sent| {
            let mut of_site = site.outputs.iter().filter(|(_, output)| output.takes(site));
            of_site.any(|(name, output)| output.send == sent && output.format(name) == Some(format))
        };
        let sends = |format: OutputFormat| takes(format, Sent::Tracks);
        let (is_fused, says_origins) = (site.run.source == Source::Fusion, sends(OutputFormat::Asterix));
        let wants_plots = takes(OutputFormat::Asterix, Sent::Plots) || says_origins && !is_fused;
        // A replay says what operators did where no tracker does.
        let has_actions = runs(site, TRACKER) || site.run.source == Source::Replay;
        let wants_labels = sends(OutputFormat::Json) && has_actions;
        Ok(Feed {
            tracks,
            plots: wants_plots.then(|| station.subscriber()).transpose()?,
            system_tracks: (says_origins && is_fused).then(|| station.subscriber()).transpose()?,
            actions: wants_labels.then(|| station.subscriber()).transpose()?,
            origins: Origins::new(units.to_vec()),
            scan: 0,
            ended: false,
            station,
        })
    };
    sites.all().iter().map(feed).collect()
}

impl Feed {
    /// Hands what waits to the outputs; `site` is the place of the feed among the sites.
    fn pass_on(&mut self, site: usize, outputs: &mut [Output], turn: &Turn) -> Result<(), IpcError> {
        self.take_origins(site, outputs)?;
        while !turn.is_over()
            && let Some(message) = self.tracks.receive()?
        {
            // What tracks are made of is published before them: it is there when they are, and may not have been a moment ago.
            self.take_origins(site, outputs)?;
            let latency_ns = latency_ns(&message);
            self.scan = message.header().scan;
            self.ended = message.header().has(END_OF_STREAM);
            for output in &mut *outputs {
                output.take_tracks(site, (message.header(), message.elements()), &self.origins, latency_ns);
            }
            let ended = message.elements().iter().filter(|track| track.state_code == TERMINATED);
            ended.for_each(|track| self.origins.forget(track.id));
        }
        Ok(())
    }

    /// Remembers what tracks are made of and called, and hands plots on.
    fn take_origins(&mut self, site: usize, outputs: &mut [Output]) -> Result<(), IpcError> {
        while let Some(plots) = &self.plots
            && let Some(message) = plots.receive()?
        {
            self.origins.take_plots(message.header(), message.elements());
            for output in &mut *outputs {
                output.take_plots(site, message.header(), message.elements());
            }
        }
        while let Some(system_tracks) = &self.system_tracks
            && let Some(message) = system_tracks.receive()?
        {
            self.origins.take_system_tracks(message.header(), message.elements());
        }
        while let Some(actions) = &self.actions
            && let Some(message) = actions.receive()?
        {
            message.elements().iter().for_each(|action| self.origins.take_action(action));
        }
        Ok(())
    }
}

/// From the source's sending of the sector to now, ns.
fn latency_ns(message: &Received<Tracks>) -> u64 {
    match message.header().stamps.source_out_ns {
        0 => 0,
        sent_ns => monotonic_ns().saturating_sub(sent_ns),
    }
}
