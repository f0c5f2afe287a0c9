//! The process that listens to a radar, and to a cooperative sensor: receives datagrams, and closes sectors in time.

use std::process::ExitCode;

use common::config::{ChainConfig, Mode};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::network::{Ears, LiveClock, NO_WAITING};
use common::plots::PlotsHeader;
use common::process::{BadInput, say, stop_requested, tell};
use common::truth::TruthHeader;
use common::turning::Turning;
use common::units::NS_PER_S;

use crate::live::{Closed, LiveRadar, Trouble};
use crate::process::Outlet;
use crate::source::{is_other_turn, said_of, taken_for_the_sites};
use crate::truth::LiveTruth;

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
    let radar_lines = chain.plot_source.listen.len();
    let has_truth = !chain.plot_source.truth.is_empty();
    let of_radar = chain.plot_source.listen.iter().map(|name| ("plot_source.listen", name.as_str()));
    let of_truth = has_truth.then_some(("plot_source.truth", chain.plot_source.truth.as_str()));
    let mut ears = Ears::open(of_radar.chain(of_truth))?;
    if chain.run.mode == Mode::Lossless {
        say(NO_WAITING);
    }
    let mut outlet = Outlet::open(chain)?;
    outlet.begin()?;
    let clock = LiveClock::start(chain.run.speed);
    let last_scan = if chain.run.scans == 0 { u32::MAX } else { chain.run.scans - 1 };
    let (mut closed, mut told) = (Closed::new(), Told::default());
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
    turning: Turning,
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
        if let Some(turning) = radar.turning().filter(|&turning| turning != self.turning) {
            self.turning = turning;
            say(said_of(turning));
        }
        if self.trouble != radar.trouble() {
            self.trouble = radar.trouble();
            say(&self.trouble.map_or("reports fit the turn again".into(), |trouble| trouble.to_string()));
        }
    }
}
