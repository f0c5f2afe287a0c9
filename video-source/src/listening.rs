//! The process that listens to the video of a radar.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Mode};
use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR, END_OF_STREAM};
use common::network::{Ears, LiveClock, NO_WAITING};
use common::process::{BadInput, say, stop_requested, tell};

use crate::live::LiveVideo;
use crate::process::Outlet;
use crate::spoke::Spoke;

/// Datagrams of which none can be used for this long are worth a word.
const USELESS: Duration = Duration::from_secs(10);
/// A time of a turn that differs from the configured one by this share is worth a word.
const OTHER_TURN: f64 = 0.2;
/// A dwell that ends a sector waits so many dwells for the next one.
const HELD_DWELLS: f64 = 2.0;

/// Runs the process until it is asked to stop, or for the configured number of scans.
pub(crate) fn run(chain: &ChainConfig) -> anyhow::Result<ExitCode> {
    if !chain.video_source.file.is_empty() {
        return Err(
            BadInput("keys `video_source.file` and `video_source.listen` are both set, expected one".into()).into()
        );
    }
    let mut radar = LiveVideo::new(chain);
    let mut ears = Ears::open(chain.video_source.listen.iter().map(|name| ("video_source.listen", name.as_str())))?;
    if chain.run.mode == Mode::Lossless {
        say(NO_WAITING);
    }
    let mut outlet = Outlet::open(chain, chain.video_source.largest_cells as usize)?;
    let last_scan = if chain.run.scans == 0 { u32::MAX } else { chain.run.scans - 1 };
    if chain.run.first_scan > last_scan {
        // Started again after the last dwell: nothing is left to send.
        outlet.end()?;
        return Ok(ExitCode::SUCCESS);
    }
    outlet.begin()?;
    let clock = LiveClock::start(chain.run.speed);
    let mut dwells = HeldDwells { outlet, last_scan, held: None, has_ended: false };
    let (mut used, mut used_at, mut rejected) = (0, Instant::now(), 0);
    let (mut is_useless_told, mut is_turn_told) = (false, false);
    loop {
        let patience = Duration::from_secs_f64(radar.turn_s() / f64::from(chain.radar.dwells_per_scan) * HELD_DWELLS);
        ears.sleep(dwells.releases_after(patience))?;
        let mut taken = Ok(());
        ears.hear(|_, datagram| {
            radar.take(datagram, clock.now_ns(), |header, spoke| {
                if taken.is_ok() {
                    taken = dwells.take(header, spoke);
                }
            });
        })?;
        taken?;
        dwells.release(patience)?;
        if let Some(found) = radar.other_count() {
            let expected = chain.radar.dwells_per_scan;
            say(&format!(
                "the radar sends {found} spokes in a turn, key `radar.dwells_per_scan` says {expected}: most of them are of no use"
            ));
        }
        let (turn_s, configured_s) = (radar.turn_s(), chain.radar.scan_period_s);
        if !is_turn_told && (turn_s / configured_s - 1.0).abs() > OTHER_TURN {
            is_turn_told = true;
            say(&format!("the radar turns in {turn_s:.2} s, key `radar.scan_period_s` says {configured_s}"));
        }
        if radar.spokes() > used {
            (used, used_at, rejected) = (radar.spokes(), Instant::now(), radar.rejected().total());
        } else if !is_useless_told && used_at.elapsed() >= USELESS && radar.rejected().total() > rejected {
            is_useless_told = true;
            let reasons: Vec<_> = radar.rejected().named().map(|(reason, count)| format!("{count} {reason}")).collect();
            say(&format!(
                "no video in what has been received for {} s, expected ASTERIX category 240 or spokes of a HALO radar ({} so far)",
                USELESS.as_secs(),
                reasons.join(", ")
            ));
        }
        let reporter = &mut dwells.outlet.reporter;
        reporter.health.set_rejected(&radar.rejected());
        if dwells.has_ended || stop_requested() {
            dwells.end()?;
            tell(&format!("{} dwells whose spokes have not come", radar.missing()));
            return Ok(ExitCode::SUCCESS);
        }
        if reporter.is_due() {
            reporter.publish()?;
        }
    }
}

/// The last dwell of all says that it is: each is held back until the next one has come, but one that ends a sector not for long, because
/// the plots of the sector wait for it.
struct HeldDwells {
    outlet: Outlet,
    last_scan: u32,
    held: Option<(DwellHeader, Spoke, Instant)>,
    /// The last scan is over: what comes is left out.
    has_ended: bool,
}

impl HeldDwells {
    /// Takes a dwell, and publishes the one before.
    fn take(&mut self, header: DwellHeader, spoke: Spoke) -> anyhow::Result<()> {
        self.has_ended |= header.scan > self.last_scan;
        if self.has_ended {
            return Ok(());
        }
        self.publish(0)?;
        self.has_ended = header.scan == self.last_scan && header.has(END_OF_SCAN);
        self.held = Some((header, spoke, Instant::now()));
        Ok(())
    }

    fn publish(&mut self, flags: u32) -> anyhow::Result<()> {
        let Some((mut header, spoke, _)) = self.held.take() else { return Ok(()) };
        header.flags |= flags;
        self.outlet.publish(header, &spoke)
    }

    /// How long until the held dwell is not held any longer.
    fn releases_after(&self, patience: Duration) -> Option<Duration> {
        let ends_sector = self.held.as_ref().filter(|(header, ..)| header.has(END_OF_SECTOR) && !self.has_ended);
        ends_sector.map(|(.., since)| patience.saturating_sub(since.elapsed()))
    }

    /// Publishes the held dwell if it has been held long enough.
    fn release(&mut self, patience: Duration) -> anyhow::Result<()> {
        if self.releases_after(patience).is_some_and(|rest| rest.is_zero()) { self.publish(0) } else { Ok(()) }
    }

    /// Publishes the held dwell as the last one. Without one no scan has begun, or a whole sector was the last: there is no dwell that
    /// could tell the end.
    fn end(&mut self) -> anyhow::Result<()> {
        if self.held.is_some() { self.publish(END_OF_STREAM) } else { self.outlet.end() }
    }
}
