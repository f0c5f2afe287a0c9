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
use common::config;
use common::recording::RecordedRef;
use common::recording::jsonl::Writer;
use common::tracks::{CONFIRMED, TENTATIVE, Track, TracksHeader};
use plot_source::asterix::cat010::{MessageType, Record};
use plot_source::asterix::records;
use plot_source::clock::DayClock;

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
    for record in records(&bytes).flatten() {
        if let Some(track) = own_track(&record, &mut clock, registration, &mut lives) {
            reports.push(track);
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
    record: &Record,
    clock: &mut DayClock,
    registration: &config::RegistrationConfig,
    lives: &mut HashMap<u16, u64>,
) -> Option<Track> {
    if record.message_type != Some(MessageType::TargetReport) {
        return None;
    }
    let (number, status) = (record.track_number?, record.track_status.unwrap_or_default());
    let life = lives.entry(number).or_default();
    let id = u64::from(number) + (*life << 12);
    *life += u64::from(status.last_report);
    let time_ns = clock.time_ns(record.time_of_day?).max(0) as u64;
    let (sin, cos) = registration.azimuth_bias_deg.to_radians().sin_cos();
    let turn = |(x, y): (f64, f64)| (x * cos - y * sin, x * sin + y * cos);
    let (x, y) = turn(record.cartesian_m?);
    let step = registration.truth_velocity_step_mps;
    let (vx, vy) =
        record.velocity_steps.map_or((0.0, 0.0), |(vx, vy)| turn((f64::from(vx) * step, f64::from(vy) * step)));
    let state_code = if status.initialising { TENTATIVE } else { CONFIRMED };
    let state = [x, vx, 0.0, y, vy, 0.0, 0.0, 0.0, 0.0];
    Some(Track { time_ns, id, state, state_code, ..Track::default() })
}
