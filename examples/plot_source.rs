//! Puts plots of a program of your own into the chain: here two targets on circles, seen by a 2-D radar.
//!
//! ```text
//! cargo run --release -- run --config examples/plot_source.toml                       # a chain without a source
//! cargo run --release --example plot_source -- --config examples/plot_source.toml     # its source, this program
//! ```
//!
//! # The contract of a plot source
//!
//! - **Site.** Both sides read one configuration: `run.source = "external"`; `[site]` names the radar; `[plot_source]` gives
//!   its scan period and sectors per scan. What the tracker must know of the radar stands in every header: scan period, size
//!   of a resolution cell, SAC/SIC.
//! - **Publisher.** One for each site. Its `session` is new at every start. Nothing is sent before tracker and recorder are
//!   connected; in lossless mode a full queue of theirs blocks `publish`.
//! - **Sectors.** One message for each sector, also when it is empty, in order. `seq` is `scan · sectors_per_scan + sector`:
//!   a gap is a loss, so a source that is restarted goes on where the schedule stands. `covered_from_rad` to
//!   `covered_to_rad` is the azimuth that is complete with this message; the last sector of a scan ends at 2π. With the flag
//!   `COUNTER_CLOCKWISE` it is what the antenna has turned since north, with `STANDING` nothing, and in the last sector all.
//! - **Plots.** In any order within their sector, at most `MAX_PLOTS`. Each has its own time (UTC, when the beam passed),
//!   slant range, azimuth clockwise from north in [0, 2π), and the standard errors of both. Elevation, range rate and decision
//!   statistic are optional, with a flag each. `target_id` is for scoring alone.
//! - **Flags.** `END_OF_SCAN` on the last sector of a scan, `END_OF_STREAM` on the last message of all: the chain then ends in
//!   order. After it the source lingers until its consumers have gone.
//! - **Stamps.** `source_out_ns` and `plots_out_ns`, CLOCK_MONOTONIC, just before publishing: latencies begin there.
//!
//! The same in Python: `examples/python/plot_source.py`.

use std::f64::consts::TAU;
use std::process::ExitCode;

use clap::Parser;
use common::ipc::Station;
use common::message::{END_OF_SCAN, END_OF_STREAM, Lineage};
use common::messages::{Message, Plots};
use common::pace::Pace;
use common::plots::{Plot, PlotsHeader};
use common::process::{self, StageArgs, new_session, stop_requested};
use common::time::monotonic_ns;

/// Publish plots of two targets on circles
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    stage: StageArgs,
}

fn main() -> ExitCode {
    process::run("my-radar", || {
        let chain = Arguments::parse().stage.load()?;
        let (radar, session) = (&chain.plot_source, new_session());
        let publisher = Station::enter("my-radar", &chain)?.publisher::<Plots>(Plots::MOST)?;
        let (sectors, period_s) = (radar.sectors_per_scan, radar.scan_period_s);
        let mut pace = Pace::new(chain.run.speed);
        for seq in 0.. {
            let (scan, sector) = ((seq / u64::from(sectors)) as u32, (seq % u64::from(sectors)) as u32);
            let turned = |sectors_passed: u32| f64::from(sectors_passed) / f64::from(sectors);
            let start_s = f64::from(scan) * period_s;
            let time_ns = |turn: f64| 1_700_000_000_000_000_000 + ((start_s + turn * period_s) * 1e9) as u64;
            let (from_rad, to_rad) = (TAU * turned(sector), TAU * turned(sector + 1));

            let mut plots = Vec::new();
            for (radius_m, speed_mps) in [(2000.0, 25.0), (3500.0, -40.0)] {
                let azimuth_rad = (0.5 + start_s * speed_mps / radius_m).rem_euclid(TAU);
                if (from_rad..to_rad).contains(&azimuth_rad) {
                    plots.push(Plot {
                        time_ns: time_ns(azimuth_rad / TAU),
                        range_m: radius_m,
                        azimuth_rad,
                        sigma_range_m: radar.sigma_range_m as f32,
                        sigma_azimuth_rad: radar.sigma_azimuth_deg.to_radians() as f32,
                        cell_count: 1,
                        source_id: chain.site.source_id(),
                        ..Plot::default()
                    });
                }
            }
            let last_of_scan = sector + 1 == sectors;
            let last = stop_requested() || last_of_scan && scan + 1 == chain.run.scans;
            let header = PlotsHeader {
                seq,
                session,
                time_ns: time_ns(turned(sector + 1)),
                lineage: Lineage { published_before: seq, ..Lineage::default() },
                covered_from_rad: from_rad,
                covered_to_rad: to_rad,
                scan_period_s: period_s,
                cell_range_m: radar.cell_range_m,
                cell_azimuth_rad: radar.cell_azimuth_deg.to_radians(),
                scan,
                sector,
                sectors_per_scan: sectors,
                flags: if last_of_scan { END_OF_SCAN } else { 0 } | if last { END_OF_STREAM } else { 0 },
                source_id: chain.site.source_id(),
                ..PlotsHeader::default()
            };
            pace.wait_until(header.time_ns, || Ok::<(), anyhow::Error>(()))?;
            publisher.publish(&header, &plots, |header| {
                header.stamps.source_out_ns = monotonic_ns();
                header.stamps.plots_out_ns = header.stamps.source_out_ns;
            })?;
            if last {
                break;
            }
        }
        publisher.linger();
        Ok(ExitCode::SUCCESS)
    })
}
