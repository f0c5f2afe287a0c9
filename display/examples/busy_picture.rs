//! Serves a made-up picture of many tracks and plots, to see what a page and a server can bear.
//!
//! ```text
//! cargo run --release -p display --example busy_picture -- 10000 100000     # tracks, plots a scan
//! ```

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Sites};
use common::message::Stamps;
use common::messages::RecordedRef;
use common::plots::{HAS_ELEVATION, Plot, PlotsHeader};
use common::time::{monotonic_ns, process_cpu_ns, resident_bytes};
use common::tracks::{CONFIRMED, KIND_CONSTANT_VELOCITY, Track, TracksHeader, pack};
use display::serve::{Access, Served, bind, serve};

/// Sectors of a scan of one second.
const SECTORS: u32 = 128;
/// Range of the farthest track and plot, m.
const FARTHEST_M: f64 = 5000.0;
/// Golden angle as a share of a turn: what follows it is spread evenly.
const GOLDEN: f64 = 0.381_966_011_250_105;

fn main() -> Result<(), Box<dyn Error>> {
    let mut counts = std::env::args().skip(1).map(|text| text.parse::<u32>());
    let tracks = counts.next().transpose()?.unwrap_or(10_000);
    let plots = counts.next().transpose()?.unwrap_or(100_000);
    let mut chain = ChainConfig::default();
    chain.radar.sectors_per_scan = SECTORS;
    let listener = bind(chain.display.address())?;
    common::process::tell(&format!("picture: http://{}", listener.local_addr()?));
    let served = Arc::new(Served::live(&Sites::one(chain), Access::default()));
    serve(listener, Arc::clone(&served))?;
    let (began, pause) = (Instant::now(), Duration::from_secs(1) / SECTORS);
    for seq in 0_u32.. {
        let (scan, sector) = (seq / SECTORS, seq % SECTORS);
        let time_ns = 1_767_225_600_000_000_000 + u64::from(seq) * 1_000_000_000 / u64::from(SECTORS);
        let now_ns = monotonic_ns();
        let stamps = Stamps { source_out_ns: now_ns, plots_out_ns: now_ns, tracks_out_ns: now_ns, ..Stamps::default() };
        let of_sector = |count: u32| (0..count).filter(|number| number % SECTORS == sector);
        let header = PlotsHeader {
            seq: seq.into(),
            time_ns,
            scan,
            sector,
            sectors_per_scan: SECTORS,
            stamps,
            ..PlotsHeader::default()
        };
        let all: Vec<_> = of_sector(plots).map(|number| plot(number + scan * 7, sector, time_ns)).collect();
        served.take(0, RecordedRef::Plots(&header, &all), now_ns);
        let header = TracksHeader {
            seq: seq.into(),
            time_ns,
            scan,
            sector,
            sectors_per_scan: SECTORS,
            alive: tracks,
            confirmed: tracks,
            stamps,
            ..TracksHeader::default()
        };
        let all: Vec<_> = of_sector(tracks).map(|number| track(number, seq, time_ns)).collect();
        served.take(0, RecordedRef::Tracks(&header, &all), now_ns);
        if sector == 0 {
            let (cpu_s, (resident, _)) = (process_cpu_ns() as f64 / 1e9, resident_bytes());
            let share = cpu_s / began.elapsed().as_secs_f64().max(1e-9) * 100.0;
            common::process::tell(&format!(
                "scan {scan}: {share:.0} % of a core so far, {} MiB, {:?}",
                resident >> 20,
                served.counts()
            ));
        }
        sleep((pause * (seq + 1)).saturating_sub(began.elapsed()));
    }
    Ok(())
}

fn plot(number: u32, sector: u32, time_ns: u64) -> Plot {
    let share = (f64::from(number) * GOLDEN).fract();
    let azimuth_rad = TAU * (f64::from(sector) + share) / f64::from(SECTORS);
    let range_m = FARTHEST_M * (f64::from(number) * GOLDEN * GOLDEN).fract().sqrt();
    Plot { time_ns, range_m, azimuth_rad, elevation_rad: 0.1, snr_db: 15.0, flags: HAS_ELEVATION, ..Plot::default() }
}

/// A track on a circle about the antenna.
fn track(number: u32, seq: u32, time_ns: u64) -> Track {
    let (radius_m, speed_mps) = (FARTHEST_M * (f64::from(number) * GOLDEN).fract().sqrt().max(0.05), 20.0);
    let angle =
        TAU * f64::from(number % SECTORS) / f64::from(SECTORS) + speed_mps / radius_m * f64::from(seq / SECTORS);
    let (sin, cos) = angle.sin_cos();
    let mut track = Track {
        id: u64::from(number) + 1,
        time_ns,
        state_code: CONFIRMED,
        known: 6,
        models: 1,
        existence: 1.0,
        ..Track::EMPTY
    };
    (track.state[0], track.state[3], track.state[6]) = (radius_m * sin, radius_m * cos, 300.0);
    (track.state[1], track.state[4]) = (speed_mps * cos, -speed_mps * sin);
    for axis in [0, 3, 6] {
        track.covariance[pack(axis, axis)] = 100.0;
    }
    (track.model_kind[0], track.model_probability[0], track.snr_db) = (KIND_CONSTANT_VELOCITY, 1.0, 20.0);
    track
}
