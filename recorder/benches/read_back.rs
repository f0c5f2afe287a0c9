//! Reading recordings back: bytes are those of the unpacked messages.

use std::hint::black_box;
use std::io::Cursor;

use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::plots::{Plot, PlotsHeader};
use common::recording::Recorded;
use common::recording::container::{Description, Reader, Writer};
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Values that hardly compress, as measured ones do.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Plots, tracks and truth of 500 scans as the default scenario has them: 32 sectors, two plots in each, a track in every
/// fourth, eight targets.
fn results() -> Vec<Recorded> {
    let (mut noise, mut messages) = (Noise(1), Vec::new());
    for seq in 0..500 * 32_u64 {
        let (time_ns, scan) = (1_700_000_000_000_000_000 + seq * 31_250_000, (seq / 32) as u32);
        let mut plot = || Plot {
            time_ns,
            range_m: 20_000.0 * noise.next(),
            azimuth_rad: 6.0 * noise.next(),
            elevation_rad: noise.next(),
            range_rate_mps: 50.0 * noise.next(),
            statistic: 9.0 * noise.next() as f32,
            snr_db: 20.0 * noise.next() as f32,
            flags: 7,
            ..Plot::default()
        };
        messages
            .push(Recorded::Plots(PlotsHeader { seq, time_ns, scan, ..PlotsHeader::default() }, vec![plot(), plot()]));
        let mut track = || Track {
            time_ns,
            id: seq % 8,
            state: std::array::from_fn(|_| noise.next()),
            model_state: std::array::from_fn(|_| noise.next()),
            covariance: std::array::from_fn(|_| noise.next()),
            model_covariance: std::array::from_fn(|_| noise.next()),
            ..Track::default()
        };
        let tracks = if seq % 4 == 0 { vec![track()] } else { Vec::new() };
        messages.push(Recorded::Tracks(TracksHeader { seq, time_ns, scan, ..TracksHeader::default() }, tracks));
        if seq % 32 == 31 {
            let mut target =
                || TruthTarget { time_ns, state: std::array::from_fn(|_| noise.next()), ..TruthTarget::default() };
            let targets = (0..8).map(|_| target()).collect();
            messages.push(Recorded::Truth(
                TruthHeader { seq: scan.into(), time_ns, scan, ..TruthHeader::default() },
                targets,
            ));
        }
    }
    messages
}

/// Dwells of the default radar, 64 MB of them.
fn dwells() -> Vec<Recorded> {
    let (mut noise, cells) = (Noise(2), ChainConfig::default().radar.grid().cells());
    let dwell = |seq| {
        let amplitudes = (0..cells).map(|_| noise.next() as f32).collect();
        Recorded::Dwells(DwellHeader { seq, time_ns: 1 + seq, ..DwellHeader::default() }, amplitudes)
    };
    (0..(16_000_000 / cells) as u64).map(dwell).collect()
}

/// The recording, kept for the rest of the process so that a reading thread may have it.
fn recording(messages: &[Recorded]) -> &'static [u8] {
    let mut file = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut file, &Description::default(), "", 768 << 10).expect("memory");
    for message in messages {
        writer.write(message.by_ref()).expect("memory");
    }
    writer.finish().expect("memory");
    file.into_inner().leak()
}

fn read_back(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("read_back");
    group.sample_size(20);
    for (name, messages) in [("plots_tracks_truth", results()), ("dwells", dwells())] {
        let file = recording(&messages);
        let read = || Reader::ahead(file).map(|message| message.expect("a message"));
        let payloads = mcap::MessageStream::new(file).expect("a container");
        let bytes = payloads.map(|message| message.expect("a message").data.len() as u64).sum();
        assert!(read().eq(messages.iter().cloned()), "what is read is what was written");
        group.throughput(Throughput::Bytes(bytes));
        group.bench_function(name, |bench| {
            bench.iter(|| assert_eq!(read().map(black_box).count(), messages.len()));
        });
    }
    group.finish();
}

criterion_group!(benches, read_back);
criterion_main!(benches);
