//! Radar video through a whole chain: every dwell is taken, recorded, replayed to the same plots, and drawn.

mod support;

use std::io::Read;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use asterix::recording::Recording;
use common::report::Report;
use flate2::read::GzDecoder;
use support::{Bench, output, text_of};

/// The preset, and six seconds of a HALO radar in the bench's folder.
fn halo(bench: &Bench) -> (PathBuf, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let packed = std::fs::read(root.join("video-source/tests/data/halo-6s.pcap.gz")).expect("the capture");
    let mut bytes = Vec::new();
    GzDecoder::new(&packed[..]).read_to_end(&mut bytes).expect("gzip");
    let file = bench.path("halo.pcap");
    std::fs::write(&file, bytes).expect("the capture unpacked");
    (root.join("config/halo.toml"), format!("video_source.file={}", file.display()))
}

#[test]
fn a_capture_of_a_ships_radar() {
    let bench = Bench::new();
    let (config, file) = halo(&bench);
    let dwells = ["--set", "recorder.dwells=true"];
    let result = output(bench.command("run", &config).args(["--speed", "max", "--set", &file]).args(dwells));
    // Its last packet begins a datagram that does not end: everything else is used, and the run ends with 1.
    assert_eq!(result.status.code(), Some(1), "{}", text_of(&result));
    assert!(text_of(&result).contains("parts that could not be read"), "{}", text_of(&result));
    let report = bench.report();
    assert_eq!(report.lost(), 0, "{}", text_of(&result));
    assert!(report.detection.plots > 500, "{}", text_of(&result));

    let recording = bench.recordings().remove(0);
    let plan = bench.path("plan.svg");
    let mut picture = std::process::Command::new(env!("CARGO_BIN_EXE_radar-chain"));
    let drawn = output(picture.arg("picture").arg(&recording).arg("--out").arg(&plan));
    assert!(drawn.status.success(), "{}", text_of(&drawn));
    let svg = std::fs::read_to_string(&plan).expect("a plan");
    assert!(svg.contains("data:image/png;base64,") && svg.contains("class=\"plot\""));

    let again = Bench::new();
    let replay = format!("replay.file={}", recording.display());
    let topics = ["run.source=replay", "replay.topics=['dwells']", "replay.of=video-source"];
    let mut command = again.command("run", &config);
    command.args(["--speed", "max", "--set", &replay]).args(topics.iter().flat_map(|topic| ["--set", topic]));
    let replayed = output(&mut command);
    assert!(replayed.status.success(), "{}", text_of(&replayed));
    assert_eq!(again.report().detection.plots, report.detection.plots);
}

/// Dwells that the extractor has received.
fn dwells_of(report: &Report) -> u64 {
    let received = report.books.iter().filter(|book| (&*book.topic, &*book.consumer) == ("dwells", "plot-extractor"));
    received.map(|book| book.received).sum()
}

/// The same radar from the network, four times as fast, gives the plots of its capture.
#[test]
fn a_ships_radar_that_is_listened_to() {
    const TIMES: f64 = 4.0;
    let (of_file, live) = (Bench::new(), Bench::new());
    let (config, file) = halo(&of_file);
    output(of_file.command("run", &config).args(["--speed", "max", "--set", &file]));
    let expected = of_file.report();

    let port = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port();
    let listen = format!("video_source.listen=['udp://127.0.0.1:{port}']");
    let running = live.start_config(&config, &["--speed", "4", "--set", &listen]);
    // It sends nothing on before its consumers are there, and hears nothing meanwhile.
    for stage in ["video-source", "plot-extractor", "tracker", "recorder"] {
        live.wait_for(stage, |status| support::number(status, stage, "pid"));
    }
    let bytes = std::fs::read(of_file.path("halo.pcap")).expect("the capture");
    let capture = Recording::whole(&bytes);
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a sender");
    let (began, first_ns) = (Instant::now(), capture.datagrams[0].time_ns.expect("a capture has times"));
    for datagram in &capture.datagrams {
        let after_ns = datagram.time_ns.unwrap_or(first_ns).saturating_sub(first_ns);
        let due = began + Duration::from_nanos((after_ns as f64 / TIMES) as u64);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        sender.send_to(&datagram.bytes, ("127.0.0.1", port)).expect("sent");
    }
    // The last dwell is held back until the end is known.
    let dwells = dwells_of(&expected);
    live.wait_for("all dwells", |status| {
        support::number(status, "video-source", "messages_out").filter(|&sent| sent + 1 >= dwells)
    });
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
    let report = live.report();
    assert_eq!((report.lost(), dwells_of(&report)), (0, dwells), "{}", text_of(&ended));
    assert_eq!(report.detection.plots, expected.detection.plots, "{}", text_of(&ended));
}

#[test]
fn what_cannot_be_listened_to_is_one_line() {
    let bench = Bench::new();
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let busy = format!("udp://{}", taken.local_addr().expect("an address"));
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/halo.toml");
    for (keys, expected) in [
        (vec![format!("video_source.listen=['{busy}']")], "Address already in use"),
        (vec!["video_source.listen=['radar']".into()], "`radar` is no endpoint on a network"),
        (
            vec![format!("video_source.listen=['{busy}']"), "video_source.file=x.pcap".into()],
            "are both set, expected one",
        ),
        (vec![], "keys `video_source.file` and `video_source.listen` are empty"),
    ] {
        let mut command = bench.command("run", &config);
        let ended = output(command.args(keys.iter().flat_map(|key| ["--set", key])));
        assert_eq!(ended.status.code(), Some(2), "{}", text_of(&ended));
        let said = String::from_utf8_lossy(&ended.stderr).lines().filter(|line| line.contains(expected)).count();
        assert_eq!(said, 1, "{}", text_of(&ended));
    }
}
