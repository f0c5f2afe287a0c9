//! Truncated and corrupted recordings: whole chunks are read, and the check says where the file ends.

use std::io::Cursor;

use common::health::{Health, HealthHeader};
use common::message::Lineage;
use common::plots::{Plot, PlotsHeader};
use common::recording::container::{Block, Blocks, Description, Reader, Writer};
use common::recording::{Gap, GapReason, Recorded, RecordingError};
use common::topic::Topic;
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use recorder::verify::Verification;

/// Random places with a fixed seed.
struct Places(u64);

impl Places {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }
}

fn message(seq: u64, published_before: u64) -> Recorded {
    let lineage = Lineage { published_before, ..Lineage::default() };
    let header = TracksHeader { seq, session: 3, time_ns: 1 + seq * 1_000_000, lineage, ..TracksHeader::default() };
    let state = [(seq as f64 + 0.1).sqrt(); 9];
    Recorded::Tracks(header, vec![Track { id: seq, state, ..Track::default() }; (seq % 4) as usize])
}

const CHUNK: u64 = 7;

fn description(part: u32) -> Description {
    Description { site: "here".into(), run: "test".into(), part, ..Description::default() }
}

/// Messages `from..to`, in chunks of seven; closed in order or not.
fn recording(part: u32, from: u64, to: u64, gap: Option<Gap>, close: bool) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut file, &description(part), "", 1 << 20).expect("memory");
    if let Some(gap) = gap {
        writer.write_gap(&gap).expect("memory");
    }
    for seq in from..to {
        writer.write(message(seq, seq).by_ref()).expect("memory");
        if (seq + 1) % CHUNK == 0 {
            writer.flush().expect("memory");
        }
    }
    if close {
        writer.finish().expect("memory");
    } else {
        writer.flush().expect("memory");
        let whole = usize::try_from(writer.safe_bytes()).expect("a length");
        drop(writer);
        file.get_mut().truncate(whole);
    }
    file.into_inner()
}

fn verify(files: &[&[u8]]) -> (String, u64) {
    let mut verification = Verification::default();
    for (index, bytes) in files.iter().enumerate() {
        verification.file(&format!("file {index}"), bytes.len() as u64, *bytes);
    }
    verification.finish()
}

/// End of each chunk in the file and the messages up to it.
fn chunks(bytes: &[u8]) -> Vec<usize> {
    let offsets = Blocks::new(bytes).filter_map(|block| match block {
        Block::Chunk { offset, .. } => usize::try_from(offset).ok(),
        _ => None,
    });
    let length =
        |offset: usize| u64::from_le_bytes(bytes[offset + 1..offset + 9].try_into().expect("8 bytes")) as usize;
    offsets.map(|offset| offset + 9 + length(offset)).collect()
}

#[test]
fn a_recording_cut_at_a_thousand_places_gives_every_whole_chunk_and_says_where_it_ends() {
    let messages = 60 * CHUNK;
    let bytes = recording(0, 0, messages, None, true);
    assert_eq!(verify(&[&bytes]).1, 0, "{}", verify(&[&bytes]).0);
    let ends = chunks(&bytes).split_off(1); // the first one holds the channels
    assert_eq!(ends.len() as u64, 60);
    let mut places = Places(4);
    // The first bytes one by one, and a thousand places anywhere.
    let cuts = (0..16).chain((0..1000).map(|_| places.below(bytes.len())));
    for cut in cuts {
        let whole = ends.iter().filter(|&&end| end <= cut).count() as u64 * CHUNK;
        let read: Vec<Recorded> = Reader::new(&bytes[..cut])
            .collect::<Result<_, _>>()
            .unwrap_or_else(|error| panic!("cut at {cut}: {error}"));
        assert_eq!(read.len() as u64, whole, "cut at {cut}");
        assert!(read.iter().zip(0..).all(|(read, seq)| *read == message(seq, seq)), "cut at {cut}");

        let (text, findings) = verify(&[&bytes[..cut]]);
        assert_eq!(findings, 1, "cut at {cut}: {text}");
        let last =
            if whole == 0 { "no message".to_string() } else { format!("last whole message tracks {}", whole - 1) };
        let line = text.lines().find(|line| line.contains("cut: ends at byte")).unwrap_or_else(|| panic!("{text}"));
        assert!(line.contains(&format!("of {cut}, {last}")), "cut at {cut}: {line}");
        let end: usize = line.split(' ').nth(6).and_then(|word| word.parse().ok()).expect("a number");
        let last_chunk = ends.iter().copied().filter(|&end| end <= cut).max().unwrap_or(8.min(cut));
        assert!(end <= cut && end >= last_chunk, "cut at {cut}: {line}");
    }
}

#[test]
fn a_spoilt_chunk_is_found_by_its_place_and_the_others_are_read() {
    let bytes = recording(0, 0, 60 * CHUNK, None, true);
    let ends = chunks(&bytes);
    let mut places = Places(5);
    for _ in 0..100 {
        let chunk = 1 + places.below(ends.len() - 1);
        // In the second half of the record lie its packed messages.
        let (start, end) = (ends[chunk - 1], ends[chunk]);
        let place = end - 1 - places.below((end - start) / 4);
        let mut spoilt = bytes.clone();
        spoilt[place] ^= 0x55;
        let read: Vec<Result<Recorded, RecordingError>> = Reader::new(spoilt.as_slice()).collect();
        assert_eq!(read.iter().filter(|message| message.is_ok()).count() as u64, 59 * CHUNK, "byte {place}");
        assert_eq!(read.iter().filter(|message| message.is_err()).count(), 1);
        let (text, findings) = verify(&[&spoilt]);
        assert!(findings >= 1 && text.contains("FOUND damaged container: byte"), "byte {place}: {text}");
    }
}

/// Plots, tracks, truth and health as a chain sends them, in chunks of seven messages.
fn mixed(scans: u64) -> (Vec<Recorded>, Vec<u8>) {
    let mut messages = Vec::new();
    for seq in 0..scans * 4 {
        let time_ns = 1_700_000_000_000_000_000 + seq * 250_000_000;
        let lineage = Lineage { published_before: seq, ..Lineage::default() };
        let header = PlotsHeader { seq, session: 2, time_ns, lineage, ..PlotsHeader::default() };
        let plot = Plot { time_ns, range_m: (seq as f64).sqrt(), ..Plot::default() };
        messages.push(Recorded::Plots(header, vec![plot; (seq % 3) as usize]));
        messages.push(message(seq, seq));
        if seq % 4 == 3 {
            let header = TruthHeader { seq: seq / 4, session: 1, time_ns, ..TruthHeader::default() };
            messages.push(Recorded::Truth(header, vec![TruthTarget { time_ns, ..TruthTarget::default() }]));
            let mut health = Health { session: 3, seq: seq / 4, ..Health::default() };
            health.process = "tracker".into();
            messages.push(Recorded::HealthReports(HealthHeader { session: 3, seq: seq / 4 }, vec![health]));
        }
    }
    let mut file = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut file, &description(0), "", 1 << 20).expect("memory");
    for (index, message) in (1..).zip(&messages) {
        writer.write(message.by_ref()).expect("memory");
        if index % CHUNK == 0 {
            writer.flush().expect("memory");
        }
    }
    writer.finish().expect("memory");
    (messages, file.into_inner())
}

#[test]
fn a_byte_spoilt_anywhere_is_found_and_nothing_wrong_is_read() {
    let (messages, bytes) = mixed(30);
    let (text, findings) = verify(&[&bytes]);
    assert_eq!(findings, 0, "{text}");
    let mut places = Places(6);
    // Header, chunks, index and footer: the first and last bytes one by one, and a thousand anywhere.
    let ends = (0..64).chain(bytes.len() - 64..bytes.len());
    for place in ends.chain((0..1000).map(|_| places.below(bytes.len()))) {
        let mut spoilt = bytes.clone();
        spoilt[place] ^= 0x55;
        let (text, findings) = verify(&[&spoilt]);
        assert!(findings >= 1, "byte {place} of {}: {text}", bytes.len());
        // Whatever is read was written, in its order.
        let mut written = messages.iter();
        for read in Reader::new(spoilt.as_slice()).flatten() {
            assert!(written.any(|message| *message == read), "byte {place}: {read:?}");
        }
    }
}

#[test]
fn a_mixed_recording_cut_anywhere_gives_its_first_messages() {
    let (messages, bytes) = mixed(30);
    let mut places = Places(7);
    for _ in 0..1000 {
        let cut = places.below(bytes.len());
        let read: Vec<Recorded> = Reader::new(&bytes[..cut])
            .collect::<Result<_, _>>()
            .unwrap_or_else(|error| panic!("cut at {cut}: {error}"));
        assert!(read == messages[..read.len()], "cut at {cut}");
        assert!(
            (read.len() as u64).is_multiple_of(CHUNK) || read.len() == messages.len(),
            "cut at {cut}: {}",
            read.len()
        );
        let (text, findings) = verify(&[&bytes[..cut]]);
        assert!(findings == 1 && text.contains("cut: ends at byte"), "cut at {cut}: {text}");
    }
}

#[test]
fn what_follows_the_end_is_found() {
    let bytes = recording(0, 0, 20 * CHUNK, None, true);
    for more in [&[0_u8][..], b"more", &bytes] {
        let (text, findings) = verify(&[&[&bytes[..], more].concat()]);
        let place = format!("FOUND damaged container: byte {}: bytes after the end", bytes.len());
        assert!(findings == 1 && text.contains(&place), "{} bytes more: {text}", more.len());
    }
}

#[test]
fn parts_that_are_missing_between_others_are_named() {
    let parts: Vec<Vec<u8>> = (0..5).map(|part| recording(part as u32, part * 7, part * 7 + 7, None, true)).collect();
    let check = |numbers: &[usize]| verify(&numbers.iter().map(|&part| parts[part].as_slice()).collect::<Vec<_>>());
    assert_eq!(check(&[0, 1, 2, 3, 4]).1, 0);
    let cases = [
        (&[0, 2][..], "part 1 of the run is missing"),
        (&[0, 1, 4], "parts 2 to 3 of the run are missing"),
        (&[1, 0], "part 0 comes after part 1"),
        (&[2, 2], "part 2 comes after part 2"),
    ];
    for (numbers, words) in cases {
        let (text, findings) = check(numbers);
        assert!(findings >= 1 && text.contains(&format!("FOUND {words}")), "{numbers:?}: {text}");
    }
}

#[test]
fn a_lone_part_is_checked_against_what_was_counted_before_it() {
    let mut fold = recorder::Fold::new(&common::config::ChainConfig::default());
    for seq in 0..30 {
        fold.take(message(seq, seq).by_ref(), 0);
    }
    let part = |from| {
        let mut file = Cursor::new(Vec::new());
        let mut writer = Writer::new(&mut file, &description(1), &fold.counts(), 1 << 20).expect("memory");
        for seq in from..60 {
            writer.write(message(seq, seq).by_ref()).expect("memory");
        }
        writer.finish().expect("memory");
        file.into_inner()
    };
    let (text, findings) = verify(&[&part(30)]);
    assert_eq!(findings, 0, "{text}");
    let (text, findings) = verify(&[&part(34)]);
    assert!(findings == 1 && text.contains("4 missing at positions 30 to 33"), "{text}");
}

#[test]
fn what_is_missing_must_be_what_the_gaps_say() {
    let gap = |count| Gap {
        topic: Topic::Tracks,
        session: 3,
        first_seq: 21,
        last_seq: 20 + count,
        count,
        reason: GapReason::Away,
    };
    let cut = recording(0, 0, 21, None, false);
    assert!(verify(&[&cut]).0.contains("no next part follows"));
    // Nine are missing between the two parts: 21 to 29.
    let next = |gap| recording(1, 30, 60, gap, true);
    let (text, findings) = verify(&[&cut, &next(Some(gap(9)))]);
    assert_eq!(findings, 0, "{text}");
    assert!(text.contains("gap in tracks: 9 missing at positions 21 to 29 (recorder away)"), "{text}");
    for (gap, words) in [(None, "9 missing"), (Some(gap(7)), "2 missing"), (Some(gap(10)), "1 messages fewer")] {
        let (text, findings) = verify(&[&cut, &next(gap)]);
        assert!(findings == 1 && text.contains(words), "{text}");
    }
}
