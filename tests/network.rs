//! A radar on the network: whole chains that listen to it, and `radar-chain asterix dump`.

mod support;

use std::io::{BufRead, BufReader};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use asterix::report::{Service, ServiceMessage, SourceId, TargetReport, TimeOfDay};
use asterix::tables::{CAT034_1_29, CAT048_1_32};
use asterix::{BlockWriter, cat034, cat048};
use support::{Bench, output, signal, text_of};

const RADAR: SourceId = SourceId { sac: 25, sic: 7 };
const TURN_S: f64 = 0.5;
/// Range and azimuth, as a share of a turn, of two targets that stand still.
const TARGETS: [(f64, f64); 2] = [(8000.0, 0.2), (15_000.0, 0.7)];

/// A port at which nothing listened a moment ago.
fn free_port() -> u16 {
    UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port()
}

/// A socket that sends to groups on the loopback alone.
fn sender() -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a sender");
    rustix::net::sockopt::set_ip_multicast_if(&socket, &Ipv4Addr::LOCALHOST).expect("groups on the loopback");
    socket
}

fn time_of_day() -> TimeOfDay {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_secs_f64();
    TimeOfDay { steps: (since_1970 % 86_400.0 * 128.0) as u32, period: TimeOfDay::DAY }
}

/// What the radar sends as the antenna comes to sector `sector` of 32.
fn sector(sector: u32) -> Vec<u8> {
    let turned = f64::from(sector) / 32.0;
    let (service, azimuth_rad) = match sector {
        0 => (Service::North, None),
        _ => (Service::Sector, Some(turned * std::f64::consts::TAU)),
    };
    let message = ServiceMessage {
        source: Some(RADAR),
        service,
        time_of_day: Some(time_of_day()),
        azimuth_rad,
        turn_s: Some(TURN_S),
    };
    let mut datagram = Vec::new();
    // The reports of the sector that the beam has left come first.
    for (range_m, at) in TARGETS {
        if (turned - 1.0 / 32.0..turned).contains(&at) {
            let report = TargetReport {
                source: Some(RADAR),
                time_of_day: Some(time_of_day()),
                primary: true,
                polar: Some((range_m, at * std::f64::consts::TAU)),
                ..TargetReport::default()
            };
            let mut block = BlockWriter::new(CAT048_1_32, &mut datagram);
            block.record(|record| cat048::write(&report, record)).expect("it can be written");
        }
    }
    let mut block = BlockWriter::new(CAT034_1_29, &mut datagram);
    block.record(|record| cat034::write(&message, record)).expect("it can be written");
    datagram
}

/// A radar that turns until it is told to stop; two lines carry the same, with garbage in between.
fn turn(lines: [SocketAddr; 2], stop: &AtomicBool) {
    let (socket, start) = (sender(), Instant::now());
    for count in 0_u32.. {
        let due = start + Duration::from_secs_f64(f64::from(count) / 32.0 * TURN_S);
        thread::sleep(due.saturating_duration_since(Instant::now()));
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let datagram = sector(count % 32);
        for line in lines {
            socket.send_to(&datagram, line).expect("sent");
            socket.send_to(&[48, 0, 200, 0xf0, 1], line).expect("sent");
        }
    }
}

fn config(bench: &Bench, listen: &[String]) -> PathBuf {
    let path = bench.path("listen.toml");
    let listen: Vec<String> = listen.iter().map(|name| format!("{name:?}")).collect();
    let text = format!(
        "[site]\nname = \"radar\"\nsac = 25\nsic = 7\n[run]\nsource = \"plot-source\"\nmode = \"real-time\"\nscans = 20\n\
         [plot_source]\nlisten = [{}]\nscan_period_s = 2.0\nsigma_range_m = 10.0\n",
        listen.join(", ")
    );
    std::fs::write(&path, text).expect("a configuration");
    path
}

#[test]
fn a_radar_on_two_lines_gives_its_tracks_once() {
    let bench = Bench::new();
    let lines = [(); 2].map(|()| SocketAddr::from(([239, 255, 86, 68], free_port())));
    let config = config(&bench, &lines.map(|line| format!("udp://{line}?interface=lo")));
    let stop = Arc::new(AtomicBool::new(false));
    let radar = thread::spawn({
        let stop = stop.clone();
        move || turn(lines, &stop)
    });
    let output = bench.start_config(&config, &[]).end();
    stop.store(true, Ordering::Relaxed);
    radar.join().expect("the radar ends");
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!(report.scans, 20);
    let tracking = serde_json::to_value(&report.tracking).expect("JSON");
    let tracks = &tracking["tracks"];
    assert_eq!((tracks["count"].as_u64(), tracks["alive"].as_u64()), (Some(2), Some(2)), "{tracks}");
    let rejected = &report.processes["plot-source"].rejected;
    assert!(rejected["bad_header"] > 1000, "{rejected:?}");
}

#[test]
fn what_cannot_be_listened_to_is_one_line() {
    let bench = Bench::new();
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let busy = format!("udp://{}", taken.local_addr().expect("an address"));
    for (name, text) in [
        (busy.as_str(), "Address already in use"),
        ("udp://239.255.86.68:8600?interface=absent0", "no interface `absent0`"),
        ("tcp://127.0.0.1:8600", "expected udp://ADDRESS:PORT"),
    ] {
        let config = config(&bench, &[name.to_string()]);
        let output = bench.start_config(&config, &["--no-record"]).end();
        assert_eq!(output.status.code(), Some(2), "{}", text_of(&output));
        let lines = String::from_utf8_lossy(&output.stderr).lines().filter(|line| line.contains(text)).count();
        assert_eq!(lines, 1, "{}", text_of(&output));
    }
}

#[test]
fn doctor_tells_what_a_radar_says_and_proposes_a_configuration() {
    let line = SocketAddr::from(([239, 255, 86, 69], free_port()));
    let stop = Arc::new(AtomicBool::new(false));
    let radar = thread::spawn({
        let stop = stop.clone();
        move || turn([line, line], &stop)
    });
    let hear = |source: &str| {
        let mut doctor = Command::new(env!("CARGO_BIN_EXE_radar-chain"));
        output(doctor.args(["doctor", "--duration", "3s", "--source", source]))
    };
    let source = format!("udp://{line}?interface=lo");
    let heard = hear(&source);
    stop.store(true, Ordering::Relaxed);
    radar.join().expect("the radar ends");
    assert!(heard.status.success(), "{}", text_of(&heard));
    let text = String::from_utf8_lossy(&heard.stdout);
    let (told, proposal) = text.split_once("A configuration to begin with:").expect("a proposal");
    assert!(told.contains("SAC 25 SIC 7") && told.contains("100 % primary"), "{told}");
    let sites = common::config::parse_sites(Path::new("proposal"), proposal, &[]).expect("a configuration");
    assert_eq!((sites.first().site.source_id(), &sites.first().plot_source.listen), (25 << 8 | 7, &vec![source]));
    let silent = hear(&format!("udp://127.0.0.1:{}", free_port()));
    assert_eq!(silent.status.code(), Some(1), "{}", text_of(&silent));
    assert!(text_of(&silent).contains("no radar was heard"), "{}", text_of(&silent));
}

fn dump(source: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_radar-chain"));
    command.args(["asterix", "dump", source]);
    command
}

fn dumped(path: &Path) -> (Output, usize) {
    let output = output(&mut dump(&path.display().to_string()));
    let lines = output.stdout.split(|&octet| octet == b'\n').filter(|line| !line.is_empty());
    let records: Vec<serde_json::Value> = lines.map(|line| serde_json::from_slice(line).expect("JSON")).collect();
    let count = records.len();
    (output, count)
}

#[test]
fn files_are_dumped_and_damage_is_told() {
    let capture = Path::new(env!("CARGO_MANIFEST_DIR")).join("asterix/tests/data/cat034-cat048-doppler-60s.pcapng");
    let (whole, records) = dumped(&capture);
    assert_eq!((whole.status.code(), records, whole.stderr.len()), (Some(0), 92, 0), "{}", text_of(&whole));

    let bench = Bench::new();
    let blocks: Vec<Vec<u8>> = (0..64).map(|count| sector(count % 32)).collect();
    let mut bytes = blocks.concat();
    let damaged = bench.path("damaged.ast");
    bytes.remove(100);
    std::fs::write(&damaged, &bytes).expect("a file");
    let (output, records) = dumped(&damaged);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), records), (Some(1), 67), "{}", text_of(&output));
    assert!(said.lines().count() == 1 && said.contains("bytes could not be read, in 1 places: byte 9"), "{said}");

    for (name, content) in [("empty.ast", &b""[..]), ("text.txt", b"no radar\n"), ("zeros.ast", &[0; 100])] {
        let path = bench.path(name);
        std::fs::write(&path, content).expect("a file");
        let (output, records) = dumped(&path);
        assert_eq!((output.status.code(), records), (Some(2), 0), "{}", text_of(&output));
        assert!(
            String::from_utf8_lossy(&output.stderr).contains("is not an ASTERIX recording"),
            "{}",
            text_of(&output)
        );
    }
    let absent = dumped(&bench.path("absent.ast")).0;
    assert_eq!(absent.status.code(), Some(2), "{}", text_of(&absent));
}

#[test]
fn a_dump_of_the_network_ends_with_a_signal() {
    let line = SocketAddr::from(([127, 0, 0, 1], free_port()));
    let mut process = dump(&format!("udp://{line}")).stdout(Stdio::piped()).spawn().expect("the command");
    let stop = Arc::new(AtomicBool::new(false));
    let radar = thread::spawn({
        let stop = stop.clone();
        move || turn([line, line], &stop)
    });
    let mut lines = BufReader::new(process.stdout.take().expect("its output")).lines();
    // Both lines are one socket, so that malformed datagrams have come before the last of these.
    for _ in 0..8 {
        let line = lines.next().expect("a record").expect("text");
        assert!(line.starts_with("{\"offset\":3,\"category\":"), "{line}");
    }
    signal(process.id(), "INT");
    let rest = lines.count();
    stop.store(true, Ordering::Relaxed);
    radar.join().expect("the radar ends");
    let status = process.wait().expect("its end");
    assert_eq!(status.code(), Some(1), "after {rest} more records");
}

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("plot-source/tests/data").join(name)
}

/// A capture of UDP packets, one for each block of a recording.
fn capture(recording: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xd4, 0xc3, 0xb2, 0xa1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 1, 0, 0, 0];
    let mut rest = recording;
    while let [_, high, low, ..] = *rest {
        let (block, after) = rest.split_at(usize::from(high) << 8 | usize::from(low));
        let length = |headers: usize| (block.len() + headers) as u16;
        bytes.extend([0; 8]); // when: not used where the records say it
        bytes.extend([u32::from(length(42)).to_le_bytes(); 2].concat());
        bytes.extend([[2; 12].as_slice(), &[8, 0, 0x45, 0]].concat());
        bytes.extend(
            [&length(28).to_be_bytes(), [0, 0, 0, 0, 8, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2].as_slice()].concat(),
        );
        bytes.extend([&[0x9c, 0x40, 0x21, 0xdc], length(8).to_be_bytes().as_slice(), &[0, 0], block].concat());
        rest = after;
    }
    bytes
}

/// A surface radar and the cooperative sensor that scores it, from files, from captures and over the network, give one score.
#[test]
fn a_recorded_pair_gives_one_score_by_every_way() {
    let pair = ["lebl-smr-30s.ast", "lebl-mlat-30s.ast"].map(sample);
    let score = |bench: &Bench| {
        let tracking = bench.report().tracking;
        let count = |of: Option<u64>| of.expect("scored by truth");
        let counts = [tracking.truth_points, tracking.id_changes, tracking.false_tracks].map(count);
        (counts, tracking.truth_share.expect("a share"), tracking.distance_p50_m.expect("a distance"))
    };
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/smr.toml");
    let run = |files: &[PathBuf; 2]| {
        let bench = Bench::new();
        let [radar, truth] = files.each_ref().map(|file| file.display().to_string());
        let keys = [format!("plot_source.file={radar}"), format!("plot_source.truth={truth}")];
        let ended = bench.start_config(&config, &["--set", &keys[0], "--set", &keys[1]]).end();
        assert!(ended.status.success(), "{}", text_of(&ended));
        score(&bench)
    };
    let from_files = run(&pair);
    let bench = Bench::new();
    let captures = ["radar.pcap", "truth.pcap"].map(|name| bench.path(name));
    for (file, into) in pair.iter().zip(&captures) {
        std::fs::write(into, capture(&std::fs::read(file).expect("a recording"))).expect("a capture");
    }
    assert_eq!(run(&captures), from_files);

    let ports = [(); 2].map(|()| format!("udp://127.0.0.1:{}", free_port()));
    let keys = [
        format!("plot_source.listen=[{:?}]", ports[0]),
        format!("plot_source.truth={}", ports[1]),
        "run.speed=10.0".into(),
    ];
    let set: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
    let listening = bench.start_config(&config, &set);
    bench.wait_for("the radar", |status| support::number(status, "plot-source", "pid"));
    let mut play = Command::new(env!("CARGO_BIN_EXE_radar-chain"));
    play.args(["asterix", "play", "--speed", "10"]);
    for (file, port) in captures.iter().zip(&ports) {
        play.arg(file).arg(port);
    }
    let played = output(&mut play);
    let heard = listening.stop();
    assert!(played.status.success() && heard.status.success(), "{}{}", text_of(&played), text_of(&heard));
    // It takes the radar three turns until it is known, and the last turn has no end: what lies between is the same.
    let report = bench.report();
    let detected = report.detection.plots;
    assert!((70..=87).contains(&detected), "{detected} of 87 plots\n{}", text_of(&heard));
    let ([points, changes, false_tracks], share, distance_m) = score(&bench);
    let what = format!("{points} {changes} {false_tracks} {share} {distance_m}, from files {from_files:?}");
    let (counts, share_of_files, distance_of_files_m) = from_files;
    assert!(points * 10 >= counts[0] * 8, "{what}");
    assert!(changes.abs_diff(counts[1]) <= 1 && false_tracks.abs_diff(counts[2]) <= 1, "{what}");
    assert!((share - share_of_files).abs() < 0.1 && (distance_m - distance_of_files_m).abs() < 2.0, "{what}");
}

/// What cannot be played is one line.
#[test]
fn what_cannot_be_played_is_one_line() {
    let bench = Bench::new();
    let (text, timeless) = (bench.path("notes.txt"), bench.path("timeless.ast"));
    std::fs::write(&text, "no radar\n").expect("a file");
    // A start-of-cycle message without its time.
    std::fs::write(&timeless, [10, 0, 8, 0xc0, 0, 7, 2, 0]).expect("a file");
    let play = |arguments: &[&Path]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_radar-chain"));
        output(command.args(["asterix", "play"]).args(arguments))
    };
    let radar = sample("lebl-smr-30s.ast");
    let here = Path::new("udp://127.0.0.1:9");
    for (arguments, expected) in [
        (&[&*radar, here, &radar][..], "expected udp://ADDRESS:PORT"),
        (&[&radar, Path::new("tcp://127.0.0.1:9")], "expected udp://ADDRESS:PORT"),
        (&[&text, here], "is not an ASTERIX recording: it is a text file"),
        (&[&bench.path("absent.ast"), here], "cannot read"),
        (&[&timeless, here], "expected --speed max"),
        (&[&radar, Path::new("udp://239.1.1.1:9?interface=absent0")], "no interface `absent0`"),
    ] {
        let ended = play(arguments);
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{}", text_of(&ended));
        assert!(said.lines().count() == 1 && said.contains(expected), "{said}");
    }
    for speed in ["0", "-1", "nan", "1e-300"] {
        let ended = play(&[&radar, here, Path::new(&format!("--speed={speed}"))]);
        assert_eq!(ended.status.code(), Some(2), "{}", text_of(&ended));
        assert!(text_of(&ended).contains("a number from 1e-6 to 1e6"), "{}", text_of(&ended));
    }
    assert!(play(&[&timeless, here, Path::new("--speed=max")]).status.success());
}

/// Whoever reads the records may have seen enough.
#[test]
fn a_reader_may_leave() {
    let capture = Path::new(env!("CARGO_MANIFEST_DIR")).join("plot-source/tests/data/lebl-mlat-30s.ast");
    let mut process = dump(&capture.display().to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command");
    drop(process.stdout.take());
    let output = process.wait_with_output().expect("its end");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text_of(&output));
}
