//! A real radar: two whole turns of a HALO, and the ships that report themselves by AIS while it looks.

mod ais;

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io::Read;
use std::path::Path;

use ais::Traffic;
use common::config::{self, ChainConfig};
use common::health::Reject;
use common::plots::{Plot, PlotsHeader};
use plot_extractor::PlotExtractor;
use tracker::Tracker;
use video_source::VideoRecording;

const CAPTURE: &[u8] = include_bytes!("data/halo-6s.pcap.gz");

fn capture() -> Vec<u8> {
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(CAPTURE).read_to_end(&mut bytes).expect("gzip");
    bytes
}

fn chain(changes: &[&str]) -> ChainConfig {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../config/halo.toml");
    let changes: Vec<String> = changes.iter().map(|&change| change.into()).collect();
    config::load(Some(&file), &changes).expect("a valid preset")
}

fn plots(recording: &VideoRecording, chain: &ChainConfig) -> Vec<(PlotsHeader, Vec<Plot>)> {
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut found = Vec::new();
    let mut amplitudes = Vec::new();
    for (header, spoke) in recording.dwells() {
        amplitudes.resize(spoke.cells, 0.0);
        spoke.fill(&mut amplitudes);
        let taken = extractor.take(header, &amplitudes, 0, |header, plots| {
            found.push((*header, plots.to_vec()));
            Ok::<(), Infallible>(())
        });
        assert_eq!(taken, Ok(None), "dwell {}", header.seq);
    }
    found
}

/// A place that is a ship's if it is within 100 m of her range and 200 m across, in units of these.
fn distance(
    traffic: &Traffic,
    ship: &ais::Report,
    [range_m, azimuth_rad]: [f64; 2],
    time_ns: u64,
    turned_rad: f64,
) -> f64 {
    let [east_m, north_m] = traffic.position_m(ship, time_ns);
    let ship_range_m = east_m.hypot(north_m);
    let across_m = common::angle::difference(azimuth_rad, east_m.atan2(north_m) + turned_rad) * ship_range_m;
    ((range_m - ship_range_m) / 100.0).hypot(across_m / 200.0)
}

/// How far off a plot or track may be, in these units: the receiver of the positions is not the antenna, and the compass is a degree or so off.
const GATE: f64 = 3.0;

/// Of the ships under way within the radar's range, those that have a place within the gate; the picture turned by some angle.
fn matched(traffic: &Traffic, places: &[([f64; 2], u64)], turned_rad: f64) -> (usize, usize) {
    let time_ns = places.first().expect("places").1;
    let under_way = traffic.ships.values().filter(|ship| {
        let [east_m, north_m] = traffic.position_m(ship, time_ns);
        ship.speed_mps > 1.0 && (1_000.0..24_000.0).contains(&east_m.hypot(north_m))
    });
    under_way.fold((0, 0), |(found, ships), ship| {
        let is_near = |&(place, at_ns): &([f64; 2], u64)| distance(traffic, ship, place, at_ns, turned_rad) < GATE;
        (found + usize::from(places.iter().any(is_near)), ships + 1)
    })
}

/// The picture turned by other angles, for what chance matches.
const TURNED_RAD: [f64; 3] = [0.2, -0.3, 1.0];

/// 6,528 spokes without a gap, 2,048 to a turn of two seconds; 62 of them come before the first north. The last packet of the capture begins a datagram that does not end.
#[test]
fn every_spoke_is_a_dwell() {
    let chain = chain(&[]);
    let recording = VideoRecording::read(&capture(), Path::new("halo.pcap"), &chain).expect("video");
    let dwells = recording.dwells();
    assert_eq!((dwells.len(), recording.rejected().total(), recording.unread()), (6466, 62, 1));
    for (pair, place) in dwells.windows(2).zip(0_u64..) {
        let (header, next) = (&pair[0].0, &pair[1].0);
        assert_eq!((header.seq, next.seq), (place, place + 1));
        assert!(header.time_ns < next.time_ns);
    }
    let first = &dwells[0].0;
    assert!((first.scan_period_s - 2.0).abs() < 0.05, "{}", first.scan_period_s);
    assert!((first.range_step_m - 24.87).abs() < 0.01 && (first.full_scale - 13.5).abs() < 1e-6, "{first:?}");
}

/// Two thirds of the ships under way have plots, by every detector along range, and a third of that by chance.
#[test]
fn ships_that_report_themselves_have_plots() {
    let bytes = capture();
    let traffic = Traffic::read(&bytes);
    for (cfar, least) in [("os", 26), ("so", 28), ("ca", 26), ("go", 24)] {
        let chain = chain(&[&format!("extractor.cfar={cfar}")]);
        let recording = VideoRecording::read(&bytes, Path::new("halo.pcap"), &chain).expect("video");
        let plots = plots(&recording, &chain);
        let places: Vec<([f64; 2], u64)> = plots
            .iter()
            .flat_map(|(_, plots)| plots)
            .map(|plot| ([plot.range_m, plot.azimuth_rad], plot.time_ns))
            .collect();
        let (found, ships) = matched(&traffic, &places, 0.0);
        let by_chance = TURNED_RAD.map(|turned_rad| matched(&traffic, &places, turned_rad).0);
        eprintln!("{cfar}: {} plots, {found} of {ships} ships, by chance {by_chance:?}", places.len());
        assert_eq!(ships, 40);
        assert!(found >= least, "{cfar}: {found} of {ships}");
        assert!(by_chance.iter().all(|chance| 2 * chance < found), "{cfar}: {found}, by chance {by_chance:?}");
    }
}

/// Three turns are too few for confirmed tracks; of the ships under way, more than a third have a track that has begun.
#[test]
fn ships_that_report_themselves_have_tracks() {
    let bytes = capture();
    let traffic = Traffic::read(&bytes);
    let chain = chain(&[]);
    let recording = VideoRecording::read(&bytes, Path::new("halo.pcap"), &chain).expect("video");
    let mut tracker = Tracker::new(&chain.tracker, 1).expect("a valid configuration");
    let (mut said, mut last) = (Vec::new(), BTreeMap::new());
    for (header, plots) in plots(&recording, &chain) {
        let processed = tracker.process_plots(&header, &plots, &mut said);
        assert_eq!(processed.rejected.total(), 0);
        last.extend(said.iter().map(|track| (track.id, *track)));
    }
    let places: Vec<([f64; 2], u64)> = last
        .values()
        .map(|track| {
            let [east_m, north_m, _] = track.position_m();
            ([east_m.hypot(north_m), east_m.atan2(north_m)], track.time_ns)
        })
        .collect();
    let (found, ships) = matched(&traffic, &places, 0.0);
    let by_chance = TURNED_RAD.map(|turned_rad| matched(&traffic, &places, turned_rad).0);
    eprintln!("{} tracks, {found} of {ships} ships, by chance {by_chance:?}", places.len());
    assert!(3 * found > ships, "{found} of {ships}");
    assert!(by_chance.iter().all(|chance| 2 * chance < found), "{found}, by chance {by_chance:?}");
}

/// Another transmitter's pulses over the ranges of ten spokes: they are counted, and there is no plot at them.
#[test]
fn a_jammed_azimuth_is_counted_and_gives_no_plots() {
    let chain = chain(&[]);
    let recording = VideoRecording::read(&capture(), Path::new("halo.pcap"), &chain).expect("video");
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let (mut jammed, mut saturated, mut found) = (0, 0, Vec::new());
    let begin = recording.dwells()[0].0.seq;
    let is_hit = |seq: u64, from: u64| (begin + from..begin + from + 10).contains(&seq);
    for (header, spoke) in &recording.dwells()[..600] {
        let mut amplitudes = vec![0.0; spoke.cells];
        spoke.fill(&mut amplitudes);
        if is_hit(header.seq, 300) {
            // A pulse every thirteenth cell.
            amplitudes.iter_mut().skip(header.seq as usize % 13).step_by(13).for_each(|amplitude| *amplitude = 12.5);
        } else if is_hit(header.seq, 400) {
            amplitudes[300..].fill(header.full_scale);
        }
        let taken = extractor.take(header, &amplitudes, 0, |_, plots| {
            found.extend_from_slice(plots);
            Ok::<(), Infallible>(())
        });
        match taken {
            Ok(Some(Reject::Jammed)) if is_hit(header.seq, 300) => jammed += 1,
            Ok(Some(Reject::Saturated)) if is_hit(header.seq, 400) => saturated += 1,
            other => assert_eq!(other, Ok(None), "dwell {}", header.seq),
        }
    }
    assert_eq!((jammed, saturated), (10, 10));
    let azimuth_rad = |from: usize| recording.dwells()[from].0.azimuth_rad;
    for from in [300, 400] {
        let inside = found.iter().filter(|plot| (azimuth_rad(from)..azimuth_rad(from + 9)).contains(&plot.azimuth_rad));
        assert_eq!(inside.count(), 0, "plots in spokes from {from} on");
    }
}
