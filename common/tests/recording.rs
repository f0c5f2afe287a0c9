//! Both forms of a recording: round trips, files cut and spoilt anywhere.

use std::cell::RefCell;
use std::io::Cursor;
use std::rc::Rc;

use common::dwell::DwellHeader;
use common::health::{Health, HealthHeader};
use common::plots::{Plot, PlotsHeader};
use common::recording::container::{self, Description, Reader, Writer};
use common::recording::{Recorded, RecordingError, jsonl, open, open_container as container_form};
use common::topic::Topic;
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use proptest::prelude::*;

fn description() -> Description {
    Description {
        site: "here".into(),
        config: "[site]\nname = \"here\"\n".into(),
        version: "0.1.0".into(),
        seed: 7,
        session: 1_800_000_000_000_000_000,
        run: "test".into(),
        part: 2,
    }
}

/// `scans` scans of four sectors with numbers that need all their digits.
fn messages(scans: u64) -> Vec<Recorded> {
    let odd = |seq: u64| (seq as f64 + 0.1).sqrt() * 1e3 / 3.0;
    let mut messages = Vec::new();
    for seq in 0..scans * 4 {
        let time_ns = 1_600_000_000_000_000_000 + seq * 250_000_000;
        let plot = Plot { time_ns, range_m: odd(seq), sigma_range_m: odd(seq) as f32, ..Plot::default() };
        let plots = PlotsHeader { seq, time_ns, scan: (seq / 4) as u32, ..PlotsHeader::default() };
        messages.push(Recorded::Plots(plots, vec![plot; (seq % 3) as usize]));
        let state = [odd(seq); 9];
        let track = Track { time_ns, id: seq % 5, state, covariance: [-odd(seq); 45], ..Track::default() };
        let tracks = TracksHeader { seq, time_ns, session: 5, ..TracksHeader::default() };
        messages.push(Recorded::Tracks(tracks, vec![track; (seq % 2) as usize]));
        if seq % 4 == 3 {
            let target = TruthTarget { time_ns, target_id: 1, snr_db: 12.345_678, state, ..TruthTarget::default() };
            let header = TruthHeader { seq: seq / 4, time_ns, ..TruthHeader::default() };
            messages.push(Recorded::Truth(header, vec![target]));
            let mut health = Health { seq: seq / 4, rss_bytes: 1 << 40, ..Health::default() };
            health.process = "tracker".into();
            messages.push(Recorded::HealthReports(HealthHeader { session: 5, seq: seq / 4 }, vec![health]));
        }
    }
    messages
}

fn container(messages: &[Recorded], flush_every: usize) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut file, &description(), "{}", 1 << 20).expect("memory");
    for (index, message) in messages.iter().enumerate() {
        writer.write(message.by_ref()).expect("memory");
        if index % flush_every == flush_every - 1 {
            writer.flush().expect("memory");
        }
    }
    writer.finish().expect("memory");
    file.into_inner()
}

#[test]
fn a_container_reads_back_with_its_description() {
    let mut written = messages(10);
    written.push(Recorded::Dwells(DwellHeader { seq: 3, ranges: 2, ..DwellHeader::default() }, vec![0.25, f32::MAX]));
    let bytes = container(&written, 7);
    let mut reader = Reader::new(bytes.as_slice());
    assert_eq!(reader.description(), Some(&description()));
    let read: Vec<Recorded> = reader.by_ref().collect::<Result<_, _>>().expect("whole");
    assert_eq!(read, written);
    assert!(reader.is_whole());
}

/// Old files need the old structs: their bytes must not be read as something else.
#[test]
fn messages_of_another_version_are_refused_by_name() {
    let (mut file, none) = (Cursor::new(Vec::new()), std::collections::BTreeMap::new());
    let mut writer = mcap::Writer::new(&mut file).expect("memory");
    let mut channel = |topic, schema| {
        let schema = writer.add_schema(schema, "rust", b"").expect("memory");
        writer.add_channel(schema, topic, "bincode", &none).expect("memory")
    };
    let ids = [
        channel("radar/here/plots", "plots/9"),
        channel("radar/here/tracks", "tracks/3"),
        channel("radar/here/health", "health/3"),
    ];
    let mut tracks = Vec::new();
    container::encode(Recorded::Tracks(TracksHeader::default(), Vec::new()).by_ref(), &mut tracks).expect("memory");
    // Health of another version is left out: all else can be read without.
    for (channel_id, payload) in [(ids[2], &tracks), (ids[0], &tracks), (ids[0], &tracks), (ids[1], &tracks)] {
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, payload).expect("memory");
    }
    writer.finish().expect("memory");
    drop(writer);
    let read: Vec<_> = Reader::new(file.get_ref().as_slice()).collect();
    assert_eq!(read.len(), 2);
    let error = read[0].as_ref().expect_err("another version").to_string();
    assert!(error.contains("radar/here/plots: recorded as plots/9, this version reads plots/2"), "{error}");
    assert!(matches!(read[1], Ok(Recorded::Tracks(..))));
}

/// Health has no measurement time: viewers find it where it was said, at that of the last message before.
#[test]
fn health_lies_at_the_time_of_the_message_before_it() {
    let written = messages(2);
    let bytes = container(&written, 7);
    let (mut before, mut health) = (0, 0);
    for (message, recorded) in mcap::MessageStream::new(&bytes).expect("a container").zip(&written) {
        let time_ns = recorded.by_ref().time_ns();
        health += u32::from(time_ns == 0);
        before = if time_ns == 0 { before } else { time_ns };
        assert_eq!(message.expect("a message").log_time, before);
    }
    assert_eq!(health, 2);
}

/// At every place in the file: all whole chunks before the cut, no error, no panic.
#[test]
fn a_container_cut_anywhere_is_readable_to_its_last_whole_chunk() {
    let written = messages(12);
    let (bytes, chunk) = (container(&written, 6), 6);
    let read_to = |cut: usize| {
        let mut reader = Reader::new(&bytes[..cut]);
        let read = reader.by_ref().collect::<Result<Vec<_>, _>>();
        let read = read.unwrap_or_else(|error| panic!("cut at {cut}: {error}"));
        assert_eq!(read, written[..read.len()], "cut at {cut}");
        assert!(read.len() % chunk == 0 || read.len() == written.len(), "cut at {cut}");
        read.len()
    };
    let cuts = layout::first_chunk(&bytes)..bytes.len();
    let half = cuts.start.midpoint(cuts.end);
    std::thread::scope(|scope| {
        for cuts in [cuts.start..half, half..cuts.end] {
            scope.spawn(move || assert!(cuts.map(read_to).is_sorted(), "a later cut loses messages"));
        }
    });
    assert_eq!(read_to(bytes.len() - 1), written.len());
    // Before the first chunk there is nothing to find: a few cuts will do.
    for cut in (0..layout::first_chunk(&bytes)).step_by(997) {
        assert_eq!(Reader::new(&bytes[..cut]).flatten().count(), 0, "cut at {cut}");
    }
}

/// Where things are in a container.
mod layout {
    /// Place of the first chunk record: magic, then (opcode, length, content) until opcode 6.
    pub(super) fn first_chunk(bytes: &[u8]) -> usize {
        let mut place = 8;
        while bytes[place] != 6 {
            let length: [u8; 8] = bytes[place + 1..place + 9].try_into().expect("8 bytes");
            place += 9 + usize::try_from(u64::from_le_bytes(length)).expect("a length");
        }
        place
    }
}

#[test]
fn json_lines_read_back_digit_for_digit() {
    let written = messages(10);
    let mut bytes = Vec::new();
    let mut writer = jsonl::Writer::new(&mut bytes);
    for message in &written {
        writer.write(message.by_ref()).expect("memory");
    }
    writer.finish().expect("memory");
    let read: Vec<Recorded> = jsonl::Reader::new(bytes.as_slice()).collect::<Result<_, _>>().expect("good lines");
    assert_eq!(read, written);
}

#[test]
fn what_is_not_known_is_null_in_json_and_comes_back_as_not_known() {
    let target = TruthTarget { snr_db: f32::NAN, ..TruthTarget::default() };
    let message = Recorded::Truth(TruthHeader::default(), vec![target]);
    let mut bytes = Vec::new();
    jsonl::Writer::new(&mut bytes).write(message.by_ref()).expect("memory");
    assert!(String::from_utf8_lossy(&bytes).contains("\"snr_db\":null"));
    let Some(Ok(Recorded::Truth(_, targets))) = jsonl::Reader::new(bytes.as_slice()).next() else {
        panic!("truth expected");
    };
    assert!(targets[0].snr_db.is_nan());
}

#[test]
fn a_bad_line_is_named_by_its_number_and_the_rest_is_read() {
    let text = b"{\"topic\":\"speed\",\"header\":{},\"elements\":[]}\n\n\
        {\"topic\":\"tracks\",\"header\":{},\"elements\":[]}\nx\n";
    let errors: Vec<String> =
        jsonl::Reader::new(&text[..]).map(|line| line.expect_err("must be refused").to_string()).collect();
    assert_eq!(
        errors[0],
        "line 1: topic `speed`: expected plots, tracks, truth, system-tracks, commands, actions, clutter-map or health"
    );
    assert!(errors[1].starts_with("line 3: header: missing field `seq`"), "{}", errors[1]);
    assert!(errors[2].starts_with("line 4: expected value"), "{}", errors[2]);
    assert!(errors.iter().all(|error| !error.contains('\n')));
}

/// Takes so many bytes and no more.
#[derive(Clone, Default)]
struct FullDisk(Rc<RefCell<Vec<u8>>>);

impl std::io::Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let mut disk = self.0.borrow_mut();
        let fits = bytes.len().min(60_000 - disk.len());
        disk.extend(&bytes[..fits]);
        if fits == 0 { Err(std::io::ErrorKind::StorageFull.into()) } else { Ok(fits) }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl std::io::Seek for FullDisk {
    fn seek(&mut self, _: std::io::SeekFrom) -> std::io::Result<u64> {
        Ok(self.0.borrow().len() as u64)
    }
}

/// The first error tells, and what is not in the file then is known to the message.
#[test]
fn a_full_disk_is_an_error_and_what_it_costs_is_known() {
    let disk = FullDisk::default();
    let mut writer = Writer::new(disk.clone(), &description(), "{}", 4096).expect("there is room");
    let written = messages(1000);
    let failed = written.iter().position(|message| writer.write(message.by_ref()).is_err()).expect("no room");
    let safe = usize::try_from(writer.safe_bytes()).expect("a length");
    let unsaved = usize::try_from(writer.unsaved().iter().map(|gap| gap.count).sum::<u64>()).expect("a count");
    assert!(writer.write(written[0].by_ref()).is_err());
    assert!(matches!(writer.finish(), Err(RecordingError::Io(_) | RecordingError::Container { .. })));
    let readable = Reader::new(&disk.0.borrow()[..safe]).flatten().count();
    assert!(readable > 10);
    assert_eq!(readable + unsaved, failed + 1);
}

#[test]
fn open_tells_the_forms_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let topics = |path: &std::path::Path| -> Vec<Topic> {
        open(path).expect("a recording").map(|message| message.expect("whole").by_ref().topic()).collect()
    };
    assert_eq!(topics(&file("a.mcap", &container(&messages(1), 2))).len(), 10);
    assert!(topics(&file("empty", b"")).is_empty());
    for length in 1..8 {
        let path = file("cut", &container::MAGIC[..length]);
        assert!(topics(&path).is_empty() && container_form(&path).is_ok(), "{length} bytes");
    }
    let lines = container_form(&file("lines.mcap", b"{}")).expect_err("JSON lines").to_string();
    assert!(lines.ends_with("lines.mcap holds JSON lines, expected an MCAP recording"), "{lines}");
    let error = |path: &std::path::Path| open(path).err().expect("must be refused").to_string();
    assert!(error(&file("x", b"\x7fELF")).contains("is not a recording"));
    assert!(error(folder.path()).contains("directory"));
    assert!(error(std::path::Path::new("/nowhere/x")).starts_with("cannot open recording /nowhere/x"));
}

/// Log times of all messages of a container.
fn log_times(bytes: &[u8]) -> Vec<u64> {
    let messages = mcap::MessageStream::new(bytes).expect("an MCAP file");
    messages.map(|message| message.expect("a message").log_time).collect()
}

#[test]
fn a_container_begins_with_its_first_measurement() {
    let measured = messages(2);
    let mut early: Vec<Recorded> = (0..3)
        .map(|seq| Recorded::HealthReports(HealthHeader { session: 5, seq }, vec![Health { seq, ..Health::default() }]))
        .collect();
    let first_ns = 1_600_000_000_000_000_000;
    let only_health = container(&early, 1);
    assert_eq!(log_times(&only_health), [description().session; 3]);
    early.extend(measured);
    let bytes = container(&early, 1);
    assert_eq!(Reader::new(bytes.as_slice()).map(|message| message.expect("a message")).collect::<Vec<_>>(), early);
    let times = log_times(&bytes);
    assert!(times.is_sorted() && times[..4] == [first_ns; 4], "{times:?}");
}

#[test]
fn a_compression_that_is_not_read_is_no_damage() {
    let mut bytes = container(&messages(1), 1000);
    let name = bytes.windows(4).position(|word| word == b"zstd").expect("a chunk");
    bytes[name..name + 4].copy_from_slice(b"lz4\x1b");
    let error = Reader::new(bytes.as_slice()).next().expect("an entry").expect_err("not read").to_string();
    assert!(
        error.starts_with("not supported: byte ")
            && error.ends_with("chunk compressed by `lz4\\u{1b}`, expected zstd or none"),
        "{error}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Spoilt bytes give an error or fewer messages, never a panic.
    #[test]
    fn spoilt_containers_do_no_harm(place in 0.0..1.0_f64, value in any::<u8>(), length in 1usize..9) {
        let mut bytes = container(&messages(6), 5);
        let start = (place * bytes.len() as f64) as usize;
        let end = (start + length).min(bytes.len());
        bytes[start..end].fill(value);
        let mut reader = Reader::new(bytes.as_slice());
        let _ = reader.description();
        let _ = reader.count();
    }

    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let mut with_magic = common::recording::container::MAGIC.to_vec();
        with_magic.extend(&bytes);
        let _ = Reader::new(with_magic.as_slice()).count();
        let _ = jsonl::Reader::new(bytes.as_slice()).take(1000).count();
    }
}
