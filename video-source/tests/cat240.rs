//! Files of ASTERIX category 240, and files that are no recording.

mod synthetic;

use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;

use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR, END_OF_STREAM};
use proptest::prelude::*;
use synthetic::{BYTES, Form, LARGE, MEDIUM, SMALL, block, chain};
use video_source::VideoRecording;

fn read(bytes: &[u8], chain: &ChainConfig) -> VideoRecording {
    VideoRecording::read(bytes, Path::new("radar.ast"), chain).expect("video")
}

#[test]
fn every_size_of_cell_in_every_block_compressed_or_not() {
    let chain = chain(&[]);
    for resolution in 1..=6_u8 {
        let largest = u32::MAX >> (32 - (1 << (resolution - 1)));
        let codes: Vec<u32> = (0..100_u32).map(|cell| cell.wrapping_mul(0x9e37_79b9) & largest).collect();
        for (block_of, is_compressed, femto) in [(SMALL, false, false), (MEDIUM, true, false), (LARGE, false, true)] {
            let form = Form { resolution, is_compressed, block: block_of, femto };
            let recording = read(&block(5, &codes, form, 128), &chain);
            let [(header, spoke)] = recording.dwells() else { panic!("{form:?}: one spoke") };
            let mut amplitudes = vec![0.0; 100];
            spoke.fill(&mut amplitudes);
            // Of few bits somewhere in the step, of others in its middle.
            let places = |amplitude: &f32| if resolution < 4 { amplitude.floor() + 0.5 } else { *amplitude };
            let expected: Vec<f32> = codes.iter().map(|&code| code as f32 + 0.5).collect();
            assert_eq!(amplitudes.iter().map(places).collect::<Vec<_>>(), expected, "{form:?}");
            assert_eq!(
                (header.dwell, header.ranges, header.source_id, header.time_ns),
                (5, 100, 25 << 8 | 7, (chain.run.epoch_s + 1) * 1_000_000_000)
            );
            assert_eq!(header.full_scale.to_bits(), (largest as f32 + 0.5).to_bits());
            assert!((header.azimuth_rad - 5.5 / 64.0 * TAU).abs() < 1e-9);
            // 100 ns there and back are 15 m.
            assert!((header.range_step_m - 14.989_622_9).abs() < 1e-6, "{}", header.range_step_m);
            assert!((header.range_first_m - 10.5 * 14.989_622_9).abs() < 1e-5);
            assert!(recording.is_sound() && recording.rejected().total() == 0);
        }
    }
}

/// Two and a half turns over midnight, with a spoke lost.
#[test]
fn turns_sectors_and_times_go_on() {
    let codes = [1, 2, 3, 200];
    let day = 86_400 * 128;
    let mut bytes = Vec::new();
    for spoke in (0..160_u16).filter(|&spoke| spoke != 70) {
        bytes.extend(block(spoke, &codes, BYTES, (day - 256 + u32::from(spoke) * 4) % day));
    }
    let chain = chain(&[]);
    let recording = read(&bytes, &chain);
    let headers: Vec<DwellHeader> = recording.dwells().iter().map(|(header, _)| *header).collect();
    assert_eq!(headers.len(), 159);
    assert!((headers[0].scan_period_s - 2.0).abs() < 1e-6, "{}", headers[0].scan_period_s);
    for (header, place) in headers.iter().zip((0..160).filter(|&place| place != 70)) {
        assert_eq!((header.seq, header.scan, header.dwell), (place, (place / 64) as u32, (place % 64) as u32));
        assert_eq!(header.flags & END_OF_SECTOR != 0, place % 8 == 7, "{place}");
        assert_eq!(header.flags & END_OF_SCAN != 0, place % 64 == 63, "{place}");
        assert_eq!(header.flags & END_OF_STREAM != 0, place == 159, "{place}");
    }
    let passed_ns = headers[158].time_ns - headers[0].time_ns;
    assert_eq!(passed_ns, 159 * 4 * 1_000_000_000 / 128);
    // Scans that are asked for.
    let second = read(&bytes, &self::chain(&["run.first_scan=1", "run.scans=2"]));
    assert_eq!((second.dwells().len(), second.dwells()[0].0.seq), (63, 64));
    assert!(second.dwells()[62].0.flags & END_OF_STREAM != 0);
}

/// The time of a turn is that of most turns, whatever the recording has left out.
#[test]
fn a_pause_is_no_part_of_a_turn() {
    let mut bytes = Vec::new();
    for spoke in 0..320_u16 {
        let pause = if spoke >= 128 { 60 * 128 } else { 0 };
        bytes.extend(block(spoke, &[1, 2], BYTES, u32::from(spoke) * 4 + pause));
    }
    let recording = read(&bytes, &chain(&[]));
    let (header, _) = &recording.dwells()[0];
    assert!((header.scan_period_s - 2.0).abs() < 1e-6, "{}", header.scan_period_s);
}

proptest! {
    /// Whatever is cut off, changed or added, what is read has whole cells, and nothing panics.
    #[test]
    fn damaged_files_are_read_as_far_as_they_go(
        cut in 0_usize..3000, at in 0_usize..3000, byte in any::<u8>(), is_compressed in any::<bool>(),
    ) {
        let codes: Vec<u32> = (0..40).collect();
        let form = Form { is_compressed, ..BYTES };
        let mut bytes: Vec<u8> = (0..40).flat_map(|spoke| block(spoke, &codes, form, 128 + u32::from(spoke))).collect();
        let length = bytes.len();
        bytes[at % length] = byte;
        bytes.truncate(length - cut % length);
        if let Ok(recording) = VideoRecording::read(&bytes, Path::new("radar.ast"), &chain(&[])) {
            for (header, spoke) in recording.dwells() {
                let mut amplitudes = vec![0.0; header.ranges as usize];
                spoke.fill(&mut amplitudes);
                prop_assert!(amplitudes.iter().all(|&amplitude| amplitude >= 0.5));
            }
        }
    }
}

/// A file that ends within a spoke: those before it are there, and it is said that something is missing.
#[test]
fn a_cut_file_is_not_sound() {
    let bytes: Vec<u8> = (0..10).flat_map(|spoke| block(spoke, &[1, 2, 3, 4], BYTES, 128)).collect();
    let recording = read(&bytes[..bytes.len() - 5], &chain(&[]));
    assert_eq!((recording.dwells().len(), recording.is_sound()), (9, false));
}

/// One line and exit code 2 for what cannot be used at all.
#[test]
fn what_is_no_recording_is_said_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let few: Vec<u8> = (0..10).flat_map(|spoke| block(spoke, &[1, 2, 3, 4], BYTES, 128)).collect();
    for (content, dwells, expected) in [
        (Some(&b""[..]), 64, "an empty file found"),
        (Some(b"time_s,range_m\n1,2\n"), 64, "19 bytes of something else found"),
        (Some(&few), 1040, "holds 64 spokes in a turn, key `radar.dwells_per_scan` says 1040"),
        (None, 64, "cannot read"),
    ] {
        let file = folder.path().join("video.ast");
        match content {
            Some(content) => std::fs::write(&file, content).expect("a file"),
            None => std::fs::remove_file(&file).expect("the file before"),
        }
        let set = [
            "run.source=video-source".to_string(),
            format!("radar.dwells_per_scan={dwells}"),
            "radar.sectors_per_scan=8".into(),
            format!("video_source.file={}", file.display()),
        ];
        let output = Command::new(env!("CARGO_BIN_EXE_video-source"))
            .args(set.iter().flat_map(|set| ["--set", set]))
            .output()
            .expect("the program");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(expected) && said.trim().lines().count() == 1, "{said}");
    }
}
