//! Video from the network, on the clock of the test: lost, doubled, foreign and malformed datagrams, pauses, other scales.

#[expect(dead_code, reason = "files have more forms")]
mod synthetic;

use std::path::Path;

use common::dwell::DwellHeader;
use common::health::Reject;
use synthetic::{BYTES, SPOKES, block, chain};
use video_source::{LiveVideo, Spoke, VideoRecording};

const START_NS: u64 = 1_728_000_000_000_000_000;
/// A turn takes 2 s, as configured.
const DWELL_NS: u64 = 2_000_000_000 / SPOKES as u64;

/// Hands datagrams over at their times; ns after the start.
fn hear(radar: &mut LiveVideo, datagrams: impl IntoIterator<Item = (u64, Vec<u8>)>) -> Vec<(DwellHeader, Spoke)> {
    let mut heard = Vec::new();
    for (time_ns, datagram) in datagrams {
        radar.take(&datagram, START_NS + time_ns, |header, spoke| heard.push((header, spoke)));
    }
    heard
}

fn spoke(number: u16) -> (u64, Vec<u8>) {
    (u64::from(number) * DWELL_NS, block(number, &[1, 2, 3, number.into()], BYTES, 0))
}

/// The same spoke with its azimuth 0.3 dwells farther on.
fn turned((time_ns, mut datagram): (u64, Vec<u8>)) -> (u64, Vec<u8>) {
    for at in [12, 14] {
        let azimuth = u16::from_be_bytes([datagram[at], datagram[at + 1]]);
        let turned = azimuth.wrapping_add((0.3 * 65_536.0 / f64::from(SPOKES)) as u16);
        datagram[at..at + 2].copy_from_slice(&turned.to_be_bytes());
    }
    (time_ns, datagram)
}

fn places(heard: &[(DwellHeader, Spoke)]) -> Vec<u64> {
    heard.iter().map(|(header, _)| header.seq).collect()
}

#[test]
fn dwells_are_those_of_a_file_and_begin_at_north() {
    let chain = chain(&[]);
    let mut radar = LiveVideo::new(&chain);
    let datagrams: Vec<_> = (20..200).map(spoke).collect();
    let heard = hear(&mut radar, datagrams.clone());
    let bytes: Vec<u8> = datagrams.into_iter().flat_map(|(_, datagram)| datagram).collect();
    let recording = VideoRecording::read(&bytes, Path::new("radar.ast"), &chain).expect("video");
    assert_eq!(places(&heard), (0..136).collect::<Vec<_>>());
    assert_eq!(places(&heard), recording.dwells().iter().map(|(header, _)| header.seq).collect::<Vec<_>>());
    for ((header, spoke), (of_file, from_file)) in heard.iter().zip(recording.dwells()) {
        assert_eq!((&spoke.octets, spoke.cells), (&from_file.octets, from_file.cells));
        let flags = of_file.flags & !common::message::END_OF_STREAM;
        assert_eq!((header.flags, header.range_step_m), (flags, of_file.range_step_m));
        assert_eq!(header.time_ns, START_NS + (64 + header.seq) * DWELL_NS);
    }
    assert_eq!((radar.missing(), radar.rejected().of(Reject::Late)), (0, 44));
}

#[test]
fn lost_doubled_and_foreign_datagrams_cost_nothing_but_themselves() {
    let mut radar = LiveVideo::new(&chain(&["video_source.largest_cells=4"]));
    let mut datagrams = Vec::new();
    for number in (0..256).filter(|number| !matches!(number, 70 | 71 | 140)) {
        let (time_ns, datagram) = turned(spoke(number));
        datagrams.push((time_ns, datagram.clone()));
        match number % 8 {
            1 => datagrams.push((time_ns + 1000, datagram)),
            2 => datagrams.push((time_ns + 1000, datagram[..datagram.len() - 3].to_vec())),
            3 => datagrams.push((time_ns + 1000, vec![48, 0, 200, 0xf0])),
            4 => datagrams.push((time_ns + 1000, block(number + 1, &[1; 5], BYTES, 0))),
            5 => {
                let mut of_another = block(number + 1, &[1; 4], BYTES, 0);
                of_another[6] += 1; // its SIC
                datagrams.push((time_ns + 1000, of_another));
            }
            6 => datagrams.push((time_ns + 1000, block(number + 20, &[1; 4], BYTES, 0))),
            _ => {}
        }
    }
    let heard = hear(&mut radar, datagrams);
    assert_eq!(places(&heard), (0..256).filter(|place| ![70, 71, 140].contains(place)).collect::<Vec<_>>());
    let rejected = radar.rejected();
    let reasons =
        [Reject::Late, Reject::BadHeader, Reject::OtherCategory, Reject::LengthMismatch, Reject::ForeignSource];
    let of = reasons.map(|reason| rejected.of(reason));
    // Late are second ones and those that are too far ahead; of the latter one falls on a lost spoke.
    assert_eq!((radar.missing(), of), (3, [32 + 31, 32, 32, 31, 32]), "{rejected:?}");
}

/// A radar that is switched off for a while, less and more than a turn: scans go on by as many as have passed.
#[test]
fn a_pause_is_as_many_scans_as_it_lasts() {
    for (pause, scans) in [(0.4, 0), (0.8, 0), (2.5, 2), (30.0, 30)] {
        let mut radar = LiveVideo::new(&chain(&[]));
        let pause_dwells = (pause * f64::from(SPOKES)).round() as u64;
        let first = (0..129).map(spoke);
        let after = (0..160_u16).map(|number| {
            let azimuth = (129 + pause_dwells) % u64::from(SPOKES) + u64::from(number);
            ((129 + pause_dwells + u64::from(number)) * DWELL_NS, block(azimuth as u16, &[1, 2, 3, 4], BYTES, 0))
        });
        let heard = hear(&mut radar, first.chain(after));
        let expected: Vec<u64> = (0..129).chain((0..160).map(|number| 129 + pause_dwells + number)).collect();
        assert_eq!(places(&heard), expected, "{pause}");
        assert_eq!(heard[129].0.scan - heard[128].0.scan, scans, "{pause}");
        assert_eq!(radar.missing(), pause_dwells);
        assert!((heard[280].0.scan_period_s - 2.0).abs() < 0.01, "{}", heard[280].0.scan_period_s);
    }
}

/// The time of a turn is learnt, and a number of spokes that is not the configured one is told once.
#[test]
fn turns_are_learnt_and_other_numbers_of_spokes_told() {
    let mut radar = LiveVideo::new(&chain(&[]));
    let slower = (0..256).map(|number| (u64::from(number) * DWELL_NS * 11 / 10, spoke(number).1));
    let heard = hear(&mut radar, slower);
    assert!((heard[255].0.scan_period_s - 2.2).abs() < 1e-6, "{}", heard[255].0.scan_period_s);
    assert_eq!(radar.other_count(), None);
    let mut radar = LiveVideo::new(&chain(&[]));
    hear(&mut radar, (0..256).map(|number| (u64::from(number) * DWELL_NS * 3 / 2, spoke(number).1)));
    assert!((radar.turn_s() - 3.0).abs() < 1e-6, "far from what is configured: {}", radar.turn_s());
    let mut radar = LiveVideo::new(&chain(&["radar.dwells_per_scan=96"]));
    hear(&mut radar, (0..256).map(spoke));
    assert_eq!((radar.other_count(), radar.other_count()), (Some(64), None));
}
