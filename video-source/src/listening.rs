//! The process that listens to the video of a radar.

use std::process::ExitCode;

use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::network::{Ears, LiveClock};
use common::process::{BadInput, say, stop_requested, tell};

use crate::live::LiveVideo;
use crate::process::Outlet;
use crate::spoke::Spoke;

/// Runs the process until it is asked to stop, or for the configured number of scans.
pub(crate) fn run(chain: &ChainConfig) -> anyhow::Result<ExitCode> {
    if !chain.video_source.file.is_empty() {
        return Err(
            BadInput("keys `video_source.file` and `video_source.listen` are both set, expected one".into()).into()
        );
    }
    let mut radar = LiveVideo::new(chain);
    let mut ears = Ears::open(chain.video_source.listen.iter().map(|name| ("video_source.listen", name.as_str())))?;
    let mut outlet = Outlet::open(chain, chain.video_source.largest_cells as usize)?;
    outlet.begin()?;
    let clock = LiveClock::start(chain.run.speed);
    let last_scan = if chain.run.scans == 0 { u32::MAX } else { chain.run.scans - 1 };
    // Held back until the next one has come: the last one of all says that it is.
    let mut held: Option<(DwellHeader, Spoke)> = None;
    let mut arrived = Vec::new();
    loop {
        ears.sleep(None)?;
        ears.hear(|_, datagram| radar.take(datagram, clock.now_ns(), |header, spoke| arrived.push((header, spoke))))?;
        outlet.reporter.health.set_rejected(&radar.rejected());
        if let Some(found) = radar.other_count() {
            let expected = chain.radar.dwells_per_scan;
            say(&format!(
                "the radar sends {found} spokes in a turn, key `radar.dwells_per_scan` says {expected}: most of them are of no use"
            ));
        }
        for dwell in arrived.drain(..) {
            let ends = dwell.0.scan > last_scan || held.as_ref().is_some_and(|(header, _)| is_last(header, last_scan));
            if let Some((mut header, spoke)) = held.take() {
                header.flags |= if ends { END_OF_STREAM } else { 0 };
                outlet.publish(header, &spoke)?;
                if ends {
                    summarise(&radar);
                    return Ok(ExitCode::SUCCESS);
                }
            }
            held = Some(dwell);
        }
        if stop_requested() || held.as_ref().is_some_and(|(header, _)| is_last(header, last_scan)) {
            match held {
                Some((mut header, spoke)) => {
                    header.flags |= END_OF_STREAM;
                    outlet.publish(header, &spoke)?;
                }
                // No scan has begun: there is nothing whose end could be told.
                None => outlet.end()?,
            }
            summarise(&radar);
            return Ok(ExitCode::SUCCESS);
        }
        if outlet.reporter.is_due() {
            outlet.reporter.publish()?;
        }
    }
}

/// Whether a dwell is the last one of the last scan.
fn is_last(header: &DwellHeader, last_scan: u32) -> bool {
    header.scan == last_scan && header.has(END_OF_SCAN)
}

fn summarise(radar: &LiveVideo) {
    tell(&format!("{} dwells whose spokes have not come", radar.missing()));
}
