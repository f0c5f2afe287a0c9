//! Sends what a radar with many targets would send, as categories 048 and 034 over UDP, with malformed datagrams in between:
//!
//! ```text
//! cargo run --release -p asterix --example busy_radar -- 127.0.0.1:8600 --reports 2000 --malformed 10000 --seconds 60
//! ```
//!
//! SAC 25 SIC 7; a turn of 4 s, 32 sector messages a turn, a target for each report of a turn. The targets fly evenly.

use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write;
use std::net::UdpSocket;
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use asterix::report::{Service, ServiceMessage, SourceId, TargetReport, TimeOfDay};
use asterix::tables::{CAT034_1_29, CAT048_1_32};
use asterix::{BlockWriter, cat034, cat048};

const SOURCE: SourceId = SourceId { sac: 25, sic: 7 };
const TURN_S: f64 = 4.0;
const SECTORS: u32 = 32;
/// Datagrams are sent in bursts this far apart, of a tenth of a sector.
const BURSTS: u32 = 10;

fn time_of_day() -> Option<TimeOfDay> {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).ok()?.as_secs_f64();
    Some(TimeOfDay { steps: (since_1970 % 86_400.0 * 128.0) as u32, period: TimeOfDay::DAY })
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let to = arguments.next().ok_or("usage: busy_radar ADDRESS:PORT [--reports N] [--malformed N] [--seconds N]")?;
    let (mut reports, mut malformed, mut seconds) = (2000.0, 0.0, 60.0);
    while let (Some(name), Some(value)) = (arguments.next(), arguments.next()) {
        let value: f64 = value.parse()?;
        match name.as_str() {
            "--reports" => reports = value,
            "--malformed" => malformed = value,
            "--seconds" => seconds = value,
            _ => return Err(format!("{name}: not known").into()),
        }
    }
    let socket = UdpSocket::bind("0.0.0.0:0")?;
    let (targets, start) = ((reports * TURN_S) as u32, Instant::now());
    let burst_s = TURN_S / f64::from(SECTORS * BURSTS);
    let (mut sent, mut bad) = (0_u64, 0_u64);
    let mut datagram = Vec::new();
    for burst in 0_u32.. {
        let due = start + Duration::from_secs_f64(f64::from(burst) * burst_s);
        thread::sleep(due.saturating_duration_since(Instant::now()));
        if start.elapsed().as_secs_f64() > seconds {
            break;
        }
        let in_turn = burst % (SECTORS * BURSTS);
        let (from, to_turned) = (f64::from(in_turn), f64::from(in_turn + 1));
        let share = f64::from(SECTORS * BURSTS);
        if in_turn.is_multiple_of(BURSTS) {
            let turned = from / share;
            let (service, azimuth_rad) =
                if in_turn == 0 { (Service::North, None) } else { (Service::Sector, Some(turned * TAU)) };
            let time_of_day = time_of_day();
            let message =
                ServiceMessage { source: Some(SOURCE), service, time_of_day, azimuth_rad, turn_s: Some(TURN_S) };
            datagram.clear();
            BlockWriter::new(CAT034_1_29, &mut datagram).record(|record| cat034::write(&message, record))?;
            socket.send_to(&datagram, &to)?;
        }
        let first = (from / share * f64::from(targets)).ceil() as u32;
        let end = (to_turned / share * f64::from(targets)).ceil() as u32;
        for target in first..end {
            let turned = f64::from(target) / f64::from(targets);
            // 32 rings; outwards at up to 8 m/s, neighbours of all rings alike, so that nobody meets anybody.
            let speed_mps = f64::from(target / 32 % 9);
            let range_m = 10_000.0 + 2000.0 * f64::from(target % 32) + start.elapsed().as_secs_f64() * speed_mps;
            let report = TargetReport {
                source: Some(SOURCE),
                time_of_day: time_of_day(),
                primary: true,
                polar: Some((range_m, turned * TAU)),
                amplitude_db: Some(-60.0 - f64::from(target % 20)),
                ..TargetReport::default()
            };
            datagram.clear();
            BlockWriter::new(CAT048_1_32, &mut datagram).record(|record| cat048::write(&report, record))?;
            socket.send_to(&datagram, &to)?;
            sent += 1;
        }
        while (bad as f64) < malformed * start.elapsed().as_secs_f64() {
            let length = bad as usize % datagram.len().max(1);
            socket.send_to(datagram.get(..length).unwrap_or_default(), &to)?;
            bad += 1;
        }
    }
    writeln!(std::io::stdout(), "{sent} reports, {bad} malformed datagrams")?;
    Ok(())
}
