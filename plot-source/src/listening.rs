//! The process that listens to a radar, and to a cooperative sensor: receives datagrams, and closes sectors in time.

use std::io::{self, ErrorKind};
use std::net::UdpSocket;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::ChainConfig;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::pace::Speed;
use common::plots::PlotsHeader;
use common::process::{BadInput, say, stop_requested, tell};
use common::truth::TruthHeader;
use common::units::NS_PER_S;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::live::{Closed, LiveRadar, Trouble};
use crate::network::{Endpoint, LARGEST_DATAGRAM};
use crate::process::Outlet;
use crate::source::{is_other_turn, taken_for_the_sites};
use crate::truth::LiveTruth;

/// How long the process sleeps at most: signals are obeyed and health is reported meanwhile.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);
/// Datagrams taken from one socket before sectors are looked at.
const MOST_AT_ONCE: usize = 256;
/// Nothing received for this long is worth a word.
const SILENCE: Duration = Duration::from_secs(10);

/// Runs the process until it is asked to stop, or for the configured number of scans.
pub(crate) fn run(chain: &ChainConfig) -> anyhow::Result<ExitCode> {
    if !chain.plot_source.file.is_empty() {
        return Err(
            BadInput("keys `plot_source.file` and `plot_source.listen` are both set, expected one".into()).into()
        );
    }
    let of_editions = |error| BadInput(format!("key `plot_source.editions`: {error}"));
    let mut radar = LiveRadar::new(chain).map_err(of_editions)?;
    let mut truth = LiveTruth::new(&chain.plot_source).map_err(of_editions)?;
    let mut sockets = Vec::new();
    for name in &chain.plot_source.listen {
        sockets.push(open("plot_source.listen", name)?);
    }
    let radar_lines = sockets.len();
    let has_truth = !chain.plot_source.truth.is_empty();
    if has_truth {
        sockets.push(open("plot_source.truth", &chain.plot_source.truth)?);
    }
    let mut outlet = Outlet::open(chain)?;
    outlet.begin()?;
    let clock = Clock::start(chain.run.speed);
    let last_scan = if chain.run.scans == 0 { u32::MAX } else { chain.run.scans - 1 };
    let (mut ears, mut closed, mut told) = (Ears::new(sockets), Closed::new(), Told::default());
    loop {
        ears.sleep(radar.due_ns().map(|due_ns| clock.until(due_ns)))?;
        ears.hear(|line, datagram| {
            let now_ns = clock.now_ns();
            if line < radar_lines {
                radar.take(datagram, now_ns);
            } else {
                truth.take(datagram, now_ns, radar.clock());
            }
        })?;
        radar.close_due(clock.now_ns(), &mut closed);
        told.tell_news(&radar, chain);
        let is_last = stop_requested();
        if is_last && closed.is_empty() {
            radar.close_last(&mut closed);
        }
        let mut rejected = *radar.rejected();
        rejected.add(truth.rejected());
        outlet.reporter.health.set_rejected(&rejected);
        let count = closed.len();
        for (index, (mut header, plots)) in closed.drain(..).enumerate() {
            let ends = header.scan >= last_scan && header.flags & END_OF_SCAN != 0;
            if ends || (is_last && index + 1 == count) {
                header.flags |= END_OF_STREAM;
            }
            let ended = header.flags & (END_OF_SCAN | END_OF_STREAM);
            if has_truth && ended != 0 {
                let PlotsHeader { scan, time_ns, scan_period_s, .. } = header;
                let of_scan = TruthHeader {
                    seq: scan.into(),
                    time_ns,
                    scan_period_s,
                    scan,
                    flags: ended,
                    ..TruthHeader::default()
                };
                let begin_ns = time_ns.saturating_sub((scan_period_s * NS_PER_S) as u64);
                outlet.publish_truth(of_scan, &truth.of_scan((begin_ns, time_ns)))?;
            }
            outlet.publish(header, &plots)?;
            if header.flags & END_OF_STREAM != 0 {
                summarise(&radar);
                return Ok(ExitCode::SUCCESS);
            }
        }
        if is_last {
            // No scan has begun: there is nothing whose end could be told.
            outlet.reporter.health.ended = 1;
            outlet.reporter.publish()?;
            return Ok(ExitCode::SUCCESS);
        }
        if outlet.reporter.is_due() {
            outlet.reporter.publish()?;
        }
    }
}

fn open(key: &str, name: &str) -> anyhow::Result<(Endpoint, UdpSocket)> {
    let endpoint: Endpoint = name.parse().map_err(|error| BadInput(format!("key `{key}`: {error}")))?;
    let socket = endpoint.open(LONGEST_SLEEP).map_err(|error| BadInput(error.to_string()))?;
    socket.set_nonblocking(true).with_context(|| format!("listening at {endpoint}"))?;
    Ok((endpoint, socket))
}

fn summarise(radar: &LiveRadar) {
    let events = radar.events();
    tell(&format!(
        "{} records, {} received before; clock set {} times, antenna elsewhere {} times, {} records astray; \
         {} sectors closed by time",
        events.records, events.repeated, events.clock_set, events.moved, events.astray, events.timed_out
    ));
}

/// What has been said of the radar.
#[derive(Default)]
struct Told {
    source: bool,
    turn: bool,
    trouble: Option<Trouble>,
}

impl Told {
    /// Says what has become known of the radar, and what is wrong with it, once.
    fn tell_news(&mut self, radar: &LiveRadar, chain: &ChainConfig) {
        if let Some(source) = radar.source()
            && !std::mem::replace(&mut self.source, true)
            && let Some(note) = taken_for_the_sites(source, &chain.site)
        {
            say(&note);
        }
        let configured_s = chain.plot_source.scan_period_s;
        if let Some(turn_s) = radar.turn_s()
            && !std::mem::replace(&mut self.turn, true)
            && is_other_turn(turn_s, configured_s)
        {
            say(&format!("a turn takes {turn_s:.3} s; `plot_source.scan_period_s` says {configured_s}"));
        }
        if self.trouble != radar.trouble() {
            self.trouble = radar.trouble();
            say(&self.trouble.map_or("reports fit the turn again".into(), |trouble| trouble.to_string()));
        }
    }
}

/// The time of this computer, or one that runs at a multiple of it: for recordings that are sent faster.
struct Clock {
    start: Instant,
    start_ns: u64,
    factor: f64,
}

impl Clock {
    fn start(speed: Speed) -> Self {
        let factor = match speed {
            Speed::Times(factor) => factor,
            Speed::Max => 1.0,
        };
        Self { start: Instant::now(), start_ns: common::process::new_session(), factor }
    }

    fn now_ns(&self) -> u64 {
        self.start_ns + (self.start.elapsed().as_nanos() as f64 * self.factor) as u64
    }

    /// How long until a time of this clock has come.
    fn until(&self, time_ns: u64) -> Duration {
        Duration::from_nanos((time_ns.saturating_sub(self.now_ns()) as f64 / self.factor) as u64)
    }
}

/// The sockets, and what is said of them.
struct Ears {
    sockets: Vec<(Endpoint, UdpSocket)>,
    datagram: Vec<u8>,
    heard: Instant,
    is_silent: bool,
}

impl Ears {
    fn new(sockets: Vec<(Endpoint, UdpSocket)>) -> Self {
        Self { sockets, datagram: vec![0; LARGEST_DATAGRAM], heard: Instant::now(), is_silent: false }
    }

    /// Sleeps until a datagram has come, for `longest` at most.
    fn sleep(&self, longest: Option<Duration>) -> io::Result<()> {
        let longest = longest.unwrap_or(LONGEST_SLEEP).min(LONGEST_SLEEP);
        let timeout = Timespec { tv_sec: 0, tv_nsec: longest.as_nanos() as i64 };
        let mut sockets: Vec<PollFd<'_>> =
            self.sockets.iter().map(|(_, socket)| PollFd::new(socket, PollFlags::IN)).collect();
        match poll(&mut sockets, Some(&timeout)) {
            Err(error) if error != rustix::io::Errno::INTR => Err(error.into()),
            _ => Ok(()),
        }
    }

    /// Hands over what has come, with the number of the socket.
    fn hear(&mut self, mut take: impl FnMut(usize, &[u8])) -> anyhow::Result<()> {
        let mut heard = false;
        for (line, (endpoint, socket)) in self.sockets.iter().enumerate() {
            for _ in 0..MOST_AT_ONCE {
                match socket.recv(&mut self.datagram) {
                    Ok(length) => take(line, &self.datagram[..length]),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                    Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                    Err(error) => return Err(error).with_context(|| format!("receiving at {endpoint}")),
                }
                heard = true;
            }
        }
        if heard {
            self.heard = Instant::now();
        }
        let becomes_silent = !self.is_silent && self.heard.elapsed() >= SILENCE;
        if becomes_silent || (self.is_silent && heard) {
            self.is_silent = becomes_silent;
            let names: Vec<String> = self.sockets.iter().map(|(endpoint, _)| endpoint.to_string()).collect();
            let names = names.join(", ");
            say(&if heard {
                format!("{names}: receiving again")
            } else {
                format!("{names}: nothing received for {} s", SILENCE.as_secs())
            });
        }
        Ok(())
    }
}
