//! Prints the confirmed tracks of a running chain, and shows how to listen to one.
//!
//! ```text
//! cargo run --release -- run --scans 0                    # a chain, in one terminal
//! cargo run --release --example observer                  # this, in another
//! cargo run --release --example observer -- --site east --config config/two-radars.toml
//! ```
//!
//! An observer enters the domain of the chain under a name that no stage has, and subscribes to any topic of a site. The
//! chain never waits for it: where it is too slow, its full queue discards messages, and `status`, metrics and report say
//! how many it has missed. It may come and go at any time. The same in Python: `examples/python/observer.py`.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use common::ipc::{Flow, Station, Watchdog, attend};
use common::message::END_OF_STREAM;
use common::messages::Tracks;
use common::process::{self, StageArgs, stop_requested};
use common::topic::Topic;

/// Print the confirmed tracks of a running chain
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    stage: StageArgs,
}

fn main() -> ExitCode {
    process::run("observer", || {
        let chain = Arguments::parse().stage.load()?;
        let station = Station::enter("observer", &chain)?;
        let mut out = std::io::stdout().lock();
        let (wake, tracks) = (station.wake(Topic::Tracks)?, station.subscriber::<Tracks>()?);
        // Calls the closure whenever tracks have arrived, and every 100 ms.
        attend(&[&wake], &Watchdog::new(&chain, "observer"), || -> anyhow::Result<Flow> {
            while let Some(message) = tracks.receive()? {
                let header = message.header();
                if message.missing > 0 {
                    writeln!(out, "missed {} messages before scan {}", message.missing, header.scan)?;
                }
                for track in message.elements().iter().filter(|track| track.is_confirmed()) {
                    let ([east, north, up], [vx, vy, _]) = (track.position_m(), track.velocity_mps());
                    let (course, speed) = (vx.atan2(vy).to_degrees().rem_euclid(360.0), vx.hypot(vy));
                    let (scan, id) = (header.scan, track.id);
                    writeln!(
                        out,
                        "{scan:>6} {id:>4} {east:>9.1} {north:>9.1} {up:>7.1} m {course:>4.0}° {speed:>5.1} m/s"
                    )?;
                }
                if header.has(END_OF_STREAM) {
                    return Ok(Flow::End);
                }
            }
            Ok(if stop_requested() { Flow::End } else { Flow::Wait })
        })?;
        Ok(ExitCode::SUCCESS)
    })
}
