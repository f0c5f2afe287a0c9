//! Outputs of whole chains: read by foreign programs, taken back by another chain, and to peers that are slow, away or
//! gone. The foreign programs are packages of PyPI; without them their test says that it is left out, except where `CI`
//! is set.

mod support;

use std::f64::consts::TAU;
use std::fmt::Write;
use std::io::{BufRead, BufReader, Read};
use std::net::{Ipv4Addr, TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use common::messages::Recorded;
use common::plots::Plot;
use common::tracks::{CONFIRMED, Track};
use serde_json::Value;
use support::{Bench, python_lacks, text_of};

const POSITION: &str = "site.position={ latitude_deg = 50.45, longitude_deg = 30.52, height_m = 120.0 }";

#[test]
fn foreign_programs_read_every_output_and_find_the_same_tracks() {
    if python_lacks(
        "asterix.generated, pynmea2, takproto, sapient_msg_pydantic",
        "pip install: see tests/judges/outputs.py",
    ) {
        return;
    }
    let bench = Bench::new();
    let mut judge = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/judges/outputs.py"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3");
    let mut said = BufReader::new(judge.stdout.take().expect("its output"));
    let mut ports = String::new();
    said.read_line(&mut ports).expect("ports");
    let ports: Value = serde_json::from_str(&ports).expect("JSON");
    let to = |name: &str, scheme: &str| format!("outputs.{name}.to={scheme}://127.0.0.1:{}", ports[name]);
    let keys = [
        POSITION.to_string(),
        to("json", "udp"),
        to("asterix", "udp"),
        to("plots", "udp"),
        "outputs.plots.format=asterix".into(),
        "outputs.plots.send=plots".into(),
        to("cot", "udp"),
        "outputs.cot.class=drone".into(),
        to("nmea", "udp"),
        to("sapient", "tcp"),
    ];
    let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
    let ended = bench.run(&[&["--scans", "60", "--speed", "4", "--no-record"], &arguments[..]].concat());
    assert!(ended.status.success(), "{}", text_of(&ended));
    drop(judge.stdin.take());
    let mut verdict = String::new();
    said.read_to_string(&mut verdict).expect("a verdict");
    eprintln!("{verdict}");
    assert!(judge.wait().expect("the judge").success(), "{verdict}");
    let report = bench.report();
    assert_eq!((report.lost(), report.processes["outputs"].restarts), (0, 0));
}

#[test]
fn a_peer_that_is_away_and_one_that_stalls_leave_the_chain_alone() {
    let bench = Bench::new();
    let away = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port");
    let stalls = TcpListener::bind("127.0.0.1:0").expect("a port");
    let stalled = stalls.local_addr().expect("an address");
    let held = std::thread::spawn(move || stalls.accept().expect("a connection").0);
    let keys = [
        format!("outputs.json.to=tcp://{away}"),
        format!("outputs.nmea.to=tcp://{stalled}"),
        "outputs.nmea.queue_bytes=65536".into(),
        POSITION.into(),
    ];
    let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
    let ended = bench.run(&[&["--scans", "40", "--speed", "8"], &arguments[..]].concat());
    assert!(ended.status.success(), "{}", text_of(&ended));
    drop(held.join().expect("the peer"));
    let report = bench.report();
    assert_eq!(report.lost(), 0);
    let text = text_of(&ended);
    assert!(text.contains(&format!("output `json`: tcp://{away}: Connection refused")), "{text}");
    let observers = serde_json::to_value(&report.observers).expect("JSON");
    assert!(observers["tracks"]["json"].as_u64().is_some_and(|lost| lost > 0), "{observers}");
}

#[test]
fn whoever_connects_hears_the_tracks() {
    let bench = Bench::new();
    let at = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port");
    let to = format!("outputs.json.to=tcp-listen://{at}");
    let running = bench.start(&["--scans", "0", "--speed", "8", "--set", &to]);
    bench.wait_for("tracks", |status| support::number(status, "tracker", "confirmed").filter(|&tracks| tracks == 2));
    let stream = TcpStream::connect(at).expect("a connection");
    let lines = BufReader::new(stream).lines().take(20);
    for line in lines {
        let line: Value = serde_json::from_str(&line.expect("a line")).expect("JSON");
        assert!(line["site"] == "small" && line["east_m"].is_f64() && line.get("latitude_deg").is_none(), "{line}");
    }
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
}

#[test]
fn what_cannot_be_used_is_one_line() {
    let bench = Bench::new();
    for (keys, expected) in [
        (vec!["outputs.json.to=here".to_string()], "expected udp://ADDRESS:PORT".to_string()),
        (vec!["outputs.cot.to=udp://127.0.0.1:9".into()], "expected a position: output `cot`".into()),
        (
            vec![POSITION.into(), "outputs.sapient.to=tcp://127.0.0.1:9".into(), "outputs.sapient.node_id=x".into()],
            "key `outputs.sapient.node_id` is x, expected a UUID".into(),
        ),
    ] {
        let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
        let ended = bench.run(&[&["--scans", "1", "--no-record"], &arguments[..]].concat());
        let lines = String::from_utf8_lossy(&ended.stderr).lines().filter(|line| line.contains(&expected)).count();
        assert_eq!(lines, 1, "{}", text_of(&ended));
        let repeated = text_of(&ended).contains("the run was without outputs");
        assert_eq!(repeated, ended.status.success(), "{}", text_of(&ended));
    }
}

/// Its frames are dropped and counted; the others are sent.
#[test]
fn an_output_whose_port_is_taken_is_reported_and_the_others_go_on() {
    let bench = Bench::new();
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let busy = format!("outputs.json.to=tcp-listen://{}", taken.local_addr().expect("an address"));
    let free = format!("outputs.asterix.to=udp://{}", receiver.local_addr().expect("an address"));
    let ended = bench.run(&["--set", &busy, "--set", &free]);
    assert!(ended.status.success(), "{}", text_of(&ended));
    let said = text_of(&ended);
    assert_eq!(
        said.lines().filter(|line| line.contains("Address already in use") && line.contains("trying again")).count(),
        1,
        "{said}"
    );
    let observers = serde_json::to_value(&bench.report().observers).expect("JSON");
    assert!(observers["tracks"]["json"].as_u64() > Some(0), "{observers}");
    receiver.set_nonblocking(true).expect("set");
    assert!(receiver.recv(&mut [0; 2048]).is_ok(), "{said}");
}

/// A turn of the radar whose plots are sent and taken back, s, and how many there are.
const TURN_S: f64 = 1.0;
const TURNS: u32 = 60;
/// From here on both chains know all targets, measurement time of the day, s.
const KNOWN_S: f64 = 36_020.0;
const END_S: f64 = 36_058.0;
/// Targets: range m, bearing rad, speed east and north m/s.
const TARGETS: [(f64, f64, f64, f64); 5] = [
    (9000.0, 0.4, 30.0, -60.0),
    (14_000.0, 1.7, 120.0, 40.0),
    (20_000.0, 3.0, -90.0, 90.0),
    (26_000.0, 4.1, 0.0, 0.0),
    (30_000.0, 5.6, 150.0, -120.0),
];

/// Plots of all turns as a table; errors of up to 10 m and 0.05°.
fn table() -> String {
    let mut text = String::from("time_s,range_m,azimuth_deg\n");
    let mut count = 0.0_f64;
    for turn in 0..TURNS {
        for (range_m, bearing_rad, east_mps, north_mps) in TARGETS {
            count += 1.0;
            let since_s = (f64::from(turn) + bearing_rad / TAU) * TURN_S;
            let east_m = range_m * bearing_rad.sin() + east_mps * since_s;
            let north_m = range_m * bearing_rad.cos() + north_mps * since_s;
            let azimuth_rad = east_m.atan2(north_m).rem_euclid(TAU);
            let time_s = 36_000.0 + (f64::from(turn) + azimuth_rad / TAU) * TURN_S;
            let range_m = east_m.hypot(north_m) + 10.0 * (count * 12.9898).sin();
            let azimuth_deg = azimuth_rad.to_degrees() + 0.05 * (count * 78.233).sin();
            writeln!(text, "{time_s:.6},{range_m:.3},{azimuth_deg:.6}").expect("a text");
        }
    }
    text
}

/// Time of the day, s.
fn of_day_s(time_ns: u64) -> f64 {
    (time_ns % common::units::DAY_NS) as f64 * 1e-9
}

/// Plots and confirmed tracks of a recording, while all targets are known.
fn known(bench: &Bench) -> (Vec<Plot>, Vec<Track>) {
    let (mut plots, mut tracks) = (Vec::new(), Vec::new());
    for path in bench.recordings() {
        for message in common::recording::open(&path).expect("a recording") {
            match message.expect("readable") {
                Recorded::Plots(_, of_sector) => plots.extend(of_sector),
                Recorded::Tracks(_, of_sector) => tracks.extend(of_sector),
                _ => {}
            }
        }
    }
    let is_known = |time_ns: u64| (KNOWN_S..END_S).contains(&of_day_s(time_ns));
    plots.retain(|plot: &Plot| is_known(plot.time_ns));
    tracks.retain(|track: &Track| is_known(track.time_ns) && track.state_code == CONFIRMED);
    (plots, tracks)
}

/// Plots that go out as categories 048 and 034 over two lines of multicast, with garbage in between, and come back as those of a
/// radar give the tracks of the direct path, but for the rounding of the format.
#[test]
fn plots_taken_back_from_the_network_give_the_tracks_of_the_direct_path() {
    let (sender, receiver) = (Bench::new(), Bench::new());
    let lines = [(); 2].map(|()| {
        let port = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port();
        format!("239.255.86.70:{port}")
    });
    let write = |bench: &Bench, name: &str, text: &str| {
        let path = bench.path(name);
        std::fs::write(&path, text).expect("a file");
        path
    };
    let config = |plots: &str| {
        format!(
            "[site]\nname = \"radar\"\nsac = 25\nsic = 7\n\
             [run]\nsource = \"plot-source\"\nmode = \"lossless\"\nscans = 0\nspeed = 4.0\n\
             [plot_source]\n{plots}\nscan_period_s = 1.0\ncoverage_range_m = 60000.0\n\
             sigma_range_m = 10.0\nsigma_azimuth_deg = 0.05\n\
             [tracker]\nstart_speed_mps = 300.0\n"
        )
    };
    let heard = lines.each_ref().map(|line| format!("\"udp://{line}?interface=lo\"")).join(", ");
    let listens = write(&receiver, "listen.toml", &config(&format!("listen = [{heard}]")));
    let receiving = receiver.start_config(&listens, &[]);
    receiver.wait_for("the radar", |status| support::number(status, "plot-source", "pid"));

    let table = write(&sender, "plots.csv", &table());
    let sends = write(&sender, "send.toml", &config(&format!("file = \"{}\"", table.display())));
    let mut arguments = Vec::new();
    for (name, line) in ["a", "b"].iter().zip(&lines) {
        for key in [format!("to=udp://{line}"), "format=asterix".into(), "send=plots".into()] {
            arguments.extend(["--set".into(), format!("outputs.{name}.{key}")]);
        }
    }
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let stop = Arc::new(AtomicBool::new(false));
    let garbage = std::thread::spawn({
        let (stop, line) = (stop.clone(), lines[0].clone());
        move || send_garbage(&line, &stop)
    });
    let sent = sender.start_config(&sends, &arguments).end();
    stop.store(true, Ordering::Relaxed);
    let malformed = garbage.join().expect("its count");
    let received = receiving.stop();
    assert!(sent.status.success() && received.status.success(), "{}{}", text_of(&sent), text_of(&received));

    let (direct, taken_back) = (known(&sender), known(&receiver));
    assert_eq!((direct.0.len(), taken_back.0.len()), (5 * 38, 5 * 38), "{}", text_of(&received));
    for (plot, back) in direct.0.iter().zip(&taken_back.0) {
        assert!((plot.range_m - back.range_m).abs() <= 1852.0 / 512.0 + 1e-6, "{plot:?} {back:?}");
        assert!((plot.azimuth_rad - back.azimuth_rad).abs() <= TAU / 131_072.0 + 1e-9, "{plot:?} {back:?}");
        assert!((of_day_s(plot.time_ns) - of_day_s(back.time_ns)).abs() <= 1.0 / 128.0, "{plot:?} {back:?}"); // cut, not rounded
    }
    assert_eq!(direct.1.len(), taken_back.1.len());
    let mut farthest_m = 0.0_f64;
    for (track, back) in direct.1.iter().zip(&taken_back.1) {
        let apart_m = (track.state[0] - back.state[0]).hypot(track.state[3] - back.state[3]);
        farthest_m = farthest_m.max(apart_m);
    }
    eprintln!("tracks apart by {farthest_m:.2} m at most; {malformed} malformed datagrams");
    // Half steps: 3.6 m of range, 1.4 m across at 30 km, 190 m/s in 1/128 s.
    assert!(farthest_m < 6.5, "{farthest_m} m");
    let rejected = &receiver.report().processes["plot-source"].rejected;
    // The system may drop some of them where it has little room for datagrams.
    assert!((malformed / 2..=malformed).contains(&rejected["bad_header"]), "{malformed}: {rejected:?}");
}

/// Sends 10,000 datagrams a second that are no blocks, until it is told to stop; says how many.
fn send_garbage(line: &str, stop: &AtomicBool) -> u64 {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a sender");
    rustix::net::sockopt::set_ip_multicast_if(&socket, &Ipv4Addr::LOCALHOST).expect("groups on the loopback");
    let (start, mut sent) = (Instant::now(), 0_u64);
    while !stop.load(Ordering::Relaxed) {
        while (sent as f64) < 10_000.0 * start.elapsed().as_secs_f64() {
            socket.send_to(&[48, 0, 200, 0xf0, sent as u8], line).expect("sent");
            sent += 1;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    sent
}
