//! Writes the tracks of a radar's own tracker (I010/161 with I010/042 and I010/202) as
//! `tracks` messages, to calibrate the scores against known figures:
//!
//! ```text
//! cargo run --release -p plot-source --example own_tracks -- config/smr.toml FILE.ast tracks.jsonl
//! recorder score --config config/smr.toml --tracks tracks.jsonl --truth truth.jsonl
//! ```

use std::collections::HashMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use anyhow::Context;
use asterix::cat010::VELOCITY_STEP_MPS;
use asterix::clock::DayClock;
use asterix::recording::Recording;
use asterix::report::{Message, TargetReport};
use common::config;
use common::recording::RecordedRef;
use common::recording::jsonl::Writer;
use common::tracks::{CONFIRMED, TENTATIVE, Track, TracksHeader};
use plot_source::contents::editions;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [config, recording, output] = arguments.as_slice() else {
        anyhow::bail!("usage: own_tracks CONFIG RECORDING OUTPUT");
    };
    let chain = config::load(Some(Path::new(config)), &[])?;
    let registration = &chain.plot_source.registration;
    let bytes = std::fs::read(recording).with_context(|| format!("reading {recording}"))?;
    let mut clock = DayClock::new(chain.plot_source.midnight_ns());
    let mut writer = Writer::new(BufWriter::new(File::create(output)?));
    let mut reports = Vec::new();
    let mut lives: HashMap<u16, u64> = HashMap::new();
    let editions = editions(&chain.plot_source)?;
    for received in Recording::new(&bytes, &editions).records(&editions).flatten() {
        if let Some(Message::Target(report)) = Message::of(&received.record) {
            reports.extend(own_track(&report, &mut clock, registration, &mut lives));
        }
    }
    reports.sort_by_key(|track| track.time_ns);
    for (seq, track) in reports.iter().enumerate() {
        let header = TracksHeader { seq: seq as u64, time_ns: track.time_ns, ..TracksHeader::default() };
        writer.write(RecordedRef::Tracks(&header, std::slice::from_ref(track)))?;
    }
    writer.finish()?;
    Ok(())
}

/// The report of a record as a track; numbers that are given again after the last report of a track are new tracks.
fn own_track(
    report: &TargetReport,
    clock: &mut DayClock,
    registration: &config::RegistrationConfig,
    lives: &mut HashMap<u16, u64>,
) -> Option<Track> {
    let number = report.track_number?;
    let life = lives.entry(number).or_default();
    let id = u64::from(number) + (*life << 12);
    *life += u64::from(report.last_report == Some(true));
    let time_ns = clock.time_ns(report.time_of_day?).max(0) as u64;
    let (sin, cos) = registration.azimuth_bias_deg.to_radians().sin_cos();
    let turn = |(x, y): (f64, f64)| (x * cos - y * sin, x * sin + y * cos);
    let (x, y) = turn(report.cartesian_m?);
    let scale = registration.truth_velocity_step_mps / VELOCITY_STEP_MPS;
    let (vx, vy) = report.velocity_mps.map_or((0.0, 0.0), |(vx, vy)| turn((vx * scale, vy * scale)));
    let state_code = if report.tentative == Some(true) { TENTATIVE } else { CONFIRMED };
    let state = [x, vx, 0.0, y, vy, 0.0, 0.0, 0.0, 0.0];
    Some(Track { time_ns, id, state, state_code, ..Track::default() })
}
