//! The picture of a whole chain: what a program reads over HTTP, and that nobody who looks can disturb the chain.

#[path = "../display/tests/support/mod.rs"]
mod viewer;

mod support;

use std::io::Write;
use std::net::TcpStream;
use std::path::Path;
use std::time::Instant;

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use serde_json::Value;
use support::{Bench, DEADLINE, Running, difference, number, signal, text_of};
use tungstenite::Message;
use viewer::{Live, address_in, connect, get};

/// With a display at any free port.
const WITH_DISPLAY: [&str; 4] = ["--set", "display.enabled=true", "--set", "display.listen='127.0.0.1:0'"];

fn start(bench: &Bench, arguments: &[&str]) -> Running {
    bench.start(&[arguments, &WITH_DISPLAY].concat())
}

fn display_pid(status: &Value) -> Option<u32> {
    number(status, "display", "pid").map(|pid| pid as u32)
}

/// The default scenario over HTTP: eight tracks, and the numbers that `status --json` prints.
#[test]
fn the_eight_drones_are_seen_over_http_and_the_numbers_are_those_of_status() {
    let bench = Bench::new();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/uav.toml");
    let running = bench.start_config(&config, &[&["--scans", "0"], &WITH_DISPLAY[..]].concat());
    let (address, began) = (address_in(&bench.root()), Instant::now());
    let confirmed = || get(address, "/api/v1/sites/uav/tracks?confirmed=true").json().as_array().map_or(0, Vec::len);
    while confirmed() != 8 {
        assert!(began.elapsed() < DEADLINE, "{} tracks", confirmed());
    }
    let mut viewer = Live::open(address);
    viewer.send(r#"{"want": {"video": {"lines": 256, "ranges": 64}, "tracks": true, "plots": true, "truth": true}}"#);
    // The first sector may have begun before anybody looked. A whole one has 32 or 33 of 1040 dwells: parts of 8 or 9 of 256 lines,
    // which are the same in every sector.
    for sector in 0..4 {
        let whole = |of: &Value| {
            let whole = of["type"] == "video" && of["ranges"] == 64 && of["lines"].as_u64() >= Some(8);
            whole.then(|| of["azimuth_step_rad"].as_f64()).flatten()
        };
        let step_rad = viewer.find("a whole sector of video", whole);
        assert!((step_rad - std::f64::consts::TAU / 256.0).abs() < 1e-12, "{step_rad} rad in whole sector {sector}");
    }
    let hop = |tracks: &Value| {
        let stamps = &tracks["stamps_us"];
        Some(stamps["display_out"].as_f64()? - stamps["source_out"].as_f64()?).filter(|&us| us > 0.0)
    };
    viewer.find("the way of the tracks", |message| (message["type"] == "tracks").then(|| hop(message)).flatten());
    viewer.next_of("truth");
    drop(viewer);
    // Each process reports once a second: the same report is the same numbers, whoever shows it.
    let began = Instant::now();
    let mut compared = Vec::new();
    while ["radar-sim", "plot-extractor", "tracker", "recorder", "display"].iter().any(|name| !compared.contains(name))
    {
        assert!(began.elapsed() < DEADLINE, "only {compared:?}");
        let [printed, served] = [bench.status().expect("a status"), get(address, "/api/v1/status").json()];
        for name in ["radar-sim", "plot-extractor", "tracker", "recorder", "display"] {
            let [mut printed, mut served] = [printed[name].clone(), served[name].clone()];
            if printed["seq"] == served["seq"] && printed.is_object() {
                for of in [&mut printed, &mut served] {
                    of["cpu_share"] = Value::Null; // between two reports, which depends on the reports before
                }
                assert_eq!(printed, served);
                compared.push(name);
            }
        }
    }
    let ended = running.stop();
    assert!(ended.status.success() && text_of(&ended).contains("picture: http://127.0.0.1:"), "{}", text_of(&ended));
    let report = bench.report();
    assert!(report.lost() == 0 && !report.observers.contains_key("health"), "{:?}", report.observers);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn a_display_that_is_killed_or_stands_still_changes_no_byte() {
    let quiet = Bench::new();
    assert!(quiet.run(&["--scans", "60"]).status.success());
    let bench = Bench::new();
    let running = start(&bench, &["--scans", "60", "--speed", "2"]);
    let killed = bench.wait_for("a display", display_pid);
    signal(killed, "KILL");
    let again = bench.wait_for("another one", |status| display_pid(status).filter(|&pid| pid != killed));
    signal(again, "STOP");
    let output = running.end();
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!((report.scans, report.lost(), report.comparable), (60, 0, true), "{}", text_of(&output));
    // Once for the kill, and perhaps again: one that says nothing for long is started anew.
    assert!(report.processes["display"].restarts >= 1);
    assert_eq!(difference(&quiet, &bench), None);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn a_display_that_cannot_start_is_told_and_the_chain_goes_on() {
    let bench = Bench::new();
    let mut arguments = vec!["--scans", "12", "--set", "display.token_file='/no such file'"];
    arguments.extend(WITH_DISPLAY);
    let output = bench.run(&arguments);
    assert!(output.status.success(), "{}", text_of(&output));
    assert!(text_of(&output).contains("/no such file") && text_of(&output).contains("goes on without display"));
    assert!(bench.report().comparable);
}

#[test]
fn no_viewer_disturbs_the_chain_or_another_viewer() {
    let quiet = Bench::new();
    assert!(quiet.run(&["--scans", "60"]).status.success());
    let bench = Bench::new();
    let running = start(&bench, &["--scans", "60", "--speed", "1"]);
    let address = address_in(&bench.root());
    let everything = r#"{"want": {"video": {"lines": 1024, "ranges": 512}, "plots": true, "tracks": true, "truth": true, "health": true, "events": true}}"#;
    let (mut awake, mut still, mut flood) = (Live::open(address), Live::open(address), Live::open(address));
    awake.send(everything);
    still.send(everything);
    // As much as it can send; what it is answered it does not read.
    let flooding = std::thread::spawn(move || {
        let began = Instant::now();
        while began.elapsed() < std::time::Duration::from_secs(5) {
            if flood.send_message(Message::text(r#"{"ping": 1, "want": {"tracks": true}}"#)).is_err() {
                break;
            }
        }
        drop(flood);
    });
    for garbage in [&b"\xff\xfe\0garbage"[..], b"POST /api/v1/live HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\nhost: x\r\n"]
    {
        let _ = connect(address).write_all(garbage);
    }
    // More open files than a process may have by itself.
    let limit = getrlimit(Resource::Nofile);
    setrlimit(Resource::Nofile, Rlimit { current: limit.maximum, ..limit }).expect("more open files");
    let idle: Vec<_> = (0..1000).map(|_| TcpStream::connect(address).expect("a connection")).collect();
    for scan in [20, 40, 58] {
        awake.find("tracks", |of| (of["type"] == "tracks" && of["scan"].as_u64() >= Some(scan)).then_some(()));
        awake.next_of("video");
    }
    drop(idle);
    let output = running.end();
    flooding.join().expect("the flood");
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!((report.scans, report.lost(), report.comparable), (60, 0, true), "{}", text_of(&output));
    let display = &report.processes["display"];
    assert!(display.restarts == 0 && display.rejected.get("full").is_some_and(|&refused| refused > 700), "{display:?}");
    assert_eq!(difference(&quiet, &bench), None);
}
