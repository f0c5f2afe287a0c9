//! One output: what it takes, in which words, over which line.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use common::config::{OutputConfig, OutputFormat, Sent};
use common::message::END_OF_SCAN;
use common::plots::{Plot, PlotsHeader};
use common::process::BadInput;
use common::tracks::{Track, TracksHeader};

use crate::asterix_plots::AsterixPlots;
use crate::asterix_tracks::AsterixTracks;
use crate::cot::CursorOnTarget;
use crate::format::{Format, Frames, Update};
use crate::json::JsonLines;
use crate::lines::{self, Counts, Event, Line};
use crate::nmea::Nmea;
use crate::origins::Origins;
use crate::sapient::EdgeNode;
use crate::targets::{Roster, Site};

/// A format on a line, for some sites.
pub struct Output {
    name: String,
    sends: Sent,
    /// By place of the site in the chain: those that it takes, with their tracks.
    sites: Vec<Option<(Site, Roster)>>,
    format: Box<dyn Format>,
    line: Box<dyn Line>,
    frames: Frames,
    /// Plots with their times shifted.
    plots: Vec<Plot>,
    events: Vec<Event>,
    shift: Shift,
    reports: u64,
}

/// What is added to times.
#[derive(Debug, Clone, Copy)]
enum Shift {
    /// What makes the first message one of now.
    ToNow,
    /// ns.
    By(i64),
}

impl Output {
    /// Opens the output `name` for `sites`, `None` where it does not take a site of the chain.
    ///
    /// # Errors
    /// [`BadInput`]: an address or another value that cannot be used, or several sites where the format has room for one.
    pub fn open(name: &str, config: &OutputConfig, sites: Vec<Option<Site>>, session: u64) -> Result<Self, BadInput> {
        let format = format(name, config, &sites, session)?;
        let line = lines::open(name, config)?;
        let with_tracks = |site: Option<Site>| site.map(|site| (site, Roster::new(config)));
        Ok(Self {
            name: name.into(),
            sends: config.send,
            sites: sites.into_iter().map(with_tracks).collect(),
            format,
            line,
            frames: Frames::default(),
            plots: Vec::new(),
            events: Vec::new(),
            shift: if config.shift_time { Shift::ToNow } else { Shift::By(0) },
            reports: 0,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it sends.
    pub fn sends(&self) -> Sent {
        self.sends
    }

    /// What is added to times of measurement, ns.
    fn shift_ns(&mut self, time_ns: u64) -> i64 {
        match self.shift {
            Shift::By(shift_ns) => shift_ns,
            Shift::ToNow => {
                let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
                let shift_ns = now_ns.wrapping_sub(time_ns).cast_signed();
                self.shift = Shift::By(shift_ns);
                shift_ns
            }
        }
    }

    /// Sends the tracks of a message from the site of this place, which the source sent `latency_ns` ago.
    pub fn take_tracks(
        &mut self,
        site: usize,
        (header, tracks): (&TracksHeader, &[Track]),
        origins: &Origins,
        latency_ns: u64,
    ) {
        if self.sends != Sent::Tracks || self.sites[site].is_none() {
            return;
        }
        let shift_ns = self.shift_ns(header.time_ns);
        let Some((site, roster)) = &mut self.sites[site] else { return };
        let mut targets = Vec::with_capacity(tracks.len());
        roster.targets(site, header.numbering(), tracks, shift_ns, &mut targets);
        let update = Update {
            site,
            time_ns: header.time_ns.saturating_add_signed(shift_ns),
            ends_scan: header.has(END_OF_SCAN),
            targets: &targets,
            origins,
            latency_ns,
        };
        self.reports += targets.len() as u64;
        self.format.tracks(&update, &mut self.frames);
        if update.ends_scan {
            roster.forget(header.time_ns);
        }
        self.send();
    }

    /// Sends the plots of a message.
    pub fn take_plots(&mut self, site: usize, header: &PlotsHeader, plots: &[Plot]) {
        if self.sends != Sent::Plots || self.sites[site].is_none() {
            return;
        }
        let shift_ns = self.shift_ns(header.time_ns);
        let Some((site, _)) = &self.sites[site] else { return };
        let shifted = |time_ns: u64| time_ns.saturating_add_signed(shift_ns);
        self.plots.clear();
        self.plots.extend(plots.iter().map(|plot| Plot { time_ns: shifted(plot.time_ns), ..*plot }));
        self.reports += plots.len() as u64;
        let header = PlotsHeader { time_ns: shifted(header.time_ns), ..*header };
        self.format.plots(site, &header, &self.plots, &mut self.frames);
        self.send();
    }

    fn send(&mut self) {
        self.frames.iter().for_each(|frame| self.line.send(frame));
        self.frames.clear();
    }

    /// Does what is due: connects, hears, answers, sends what waits.
    pub fn attend(&mut self) {
        self.exchange();
        self.format.tick(SystemTime::now(), &mut self.frames);
        if self.frames.iter().next().is_some() {
            self.send();
            self.exchange();
        }
    }

    /// Lets the line do what it can, and the format know at once: what it says next may be for another peer.
    fn exchange(&mut self) {
        self.line.attend(Instant::now(), &mut self.events);
        for event in self.events.drain(..) {
            match event {
                Event::Opened => self.format.opened(),
                Event::Heard(octets) => self.format.heard(&octets),
            }
        }
        if let Some(why) = self.format.is_useless(SystemTime::now()) {
            self.line.give_up(why, Instant::now());
        }
    }

    /// Says its last words; [`Self::attend`] sends them while [`Self::is_waiting`].
    pub fn close(&mut self) {
        self.format.close(SystemTime::now(), &mut self.frames);
        self.send();
        self.exchange();
    }

    /// Whether frames wait for a peer.
    pub fn is_waiting(&self) -> bool {
        self.line.is_waiting()
    }

    /// Frames so far.
    pub fn counts(&self) -> Counts {
        let Counts { sent, dropped } = self.line.counts();
        Counts { sent, dropped: dropped + self.format.held_back() }
    }

    /// Tracks and plots reported so far.
    pub fn reports(&self) -> u64 {
        self.reports
    }

    /// Tracks and plots so far that cannot be said.
    pub fn not_said(&self) -> u64 {
        let rosters = self.sites.iter().flatten().map(|(_, roster)| roster.not_finite());
        self.format.not_said() + rosters.sum::<u64>()
    }

    /// What has become of everything, in one line.
    pub fn summary(&self) -> String {
        let (Counts { sent, dropped }, not_said) = (self.counts(), self.not_said());
        let what = if self.sends == Sent::Plots { "plots" } else { "tracks" };
        let reports = self.reports;
        format!(
            "output `{}`: {reports} reports of {what}, {not_said} not sayable; {sent} frames sent, {dropped} dropped",
            self.name
        )
    }
}

/// The format of an output.
fn format(
    name: &str,
    config: &OutputConfig,
    sites: &[Option<Site>],
    session: u64,
) -> Result<Box<dyn Format>, BadInput> {
    let no_format = || BadInput(format!("output `{name}`: it has no format"));
    Ok(match (config.format(name).ok_or_else(no_format)?, config.send) {
        (OutputFormat::Asterix, Sent::Tracks) => Box::<AsterixTracks>::default(),
        (OutputFormat::Asterix, Sent::Plots) => Box::<AsterixPlots>::default(),
        (OutputFormat::Cot, _) => Box::new(CursorOnTarget::new(config)),
        (OutputFormat::Nmea, _) => Box::<Nmea>::default(),
        (OutputFormat::Json, _) => Box::<JsonLines>::default(),
        (OutputFormat::Sapient, _) => {
            let taken: Vec<&Site> = sites.iter().flatten().collect();
            let [site] = taken[..] else {
                let found = taken.len();
                return Err(BadInput(format!(
                    "output `{name}`: {found} sites found, expected the one of a node (site)"
                )));
            };
            Box::new(EdgeNode::new(name, config, site, session)?)
        }
    })
}
