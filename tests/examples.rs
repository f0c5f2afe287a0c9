//! The examples against live chains. Those in Python need packages of PyPI, `iceoryx2` or `requests` and `websockets`; without
//! them their tests say that they are left out, except where `CI` is set.

mod support;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use support::{Bench, output, python_lacks, small_config, text_of};

fn python(example: &str, bench: &Bench) -> Command {
    let mut command = Command::new("python3");
    command.arg(script(example));
    command.args(["--prefix", bench.prefix(), "--root"]).arg(bench.path(""));
    command
}

fn script(example: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/python").join(example)
}

fn is_left_out() -> bool {
    python_lacks("iceoryx2", "pip install iceoryx2==0.10.0")
}

#[test]
fn an_observer_in_python_sees_the_tracks() {
    if is_left_out() {
        return;
    }
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "8"]);
    bench.wait_for("tracks", |status| support::number(status, "tracker", "confirmed").filter(|&tracks| tracks == 2));
    let mut observer = python("observer.py", &bench);
    observer.args(["small", "--seconds", "60"]).env("PYTHONUNBUFFERED", "1").stdout(Stdio::piped());
    let mut observer = observer.spawn().expect("python3");
    let speeds: Vec<f64> = BufReader::new(observer.stdout.take().expect("its output"))
        .lines()
        .map(|line| line.expect("a line"))
        .filter_map(|line| line.strip_suffix(" m/s")?.split_whitespace().next_back()?.parse().ok())
        .take(20)
        .collect();
    observer.kill().expect("the observer");
    observer.wait().expect("the observer");
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
    // The targets fly at 18 and 21 m/s.
    assert!(speeds.len() == 20 && speeds.iter().all(|speed| (10.0..30.0).contains(speed)), "{speeds:?}");
    assert_eq!(bench.report().lost(), 0);
}

/// Tracks over HTTP and WebSocket, with the packages `requests` and `websockets`.
#[test]
fn a_program_in_python_reads_tracks_over_http() {
    if python_lacks("requests, websockets", "pip install requests websockets") {
        return;
    }
    let bench = Bench::new();
    let display = ["--set", "display.enabled=true", "--set", "display.listen='127.0.0.1:0'"];
    let running = bench.start(&[&["--scans", "0", "--speed", "4"], &display[..]].concat());
    bench.wait_for("tracks", |status| support::number(status, "tracker", "confirmed").filter(|&tracks| tracks == 2));
    let picture = std::fs::read_to_string(bench.root().join(display::process::ADDRESS_FILE)).expect("its address");
    let mut reader = Command::new("python3");
    let reader = reader
        .arg(script("tracks_over_http.py"))
        .arg(picture.trim())
        .env("PYTHONUNBUFFERED", "1")
        .stdout(Stdio::piped());
    let mut reader = reader.spawn().expect("python3");
    let lines: Vec<String> = BufReader::new(reader.stdout.take().expect("its output"))
        .lines()
        .map(|line| line.expect("a line"))
        .take(20)
        .collect();
    reader.kill().expect("the reader");
    reader.wait().expect("the reader");
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
    let is_track = |line: &String| line.starts_with("small track ") && line.ends_with(" m north");
    assert!(lines.len() == 20 && lines.iter().all(is_track), "{lines:?}");
}

#[test]
fn a_plot_source_in_python_drives_a_chain() {
    if !is_left_out() {
        drives_a_chain(&[], |bench, _| {
            let mut source = python("plot_source.py", bench);
            source.args(["--speed", "0"]);
            source
        });
    }
}

/// The same with the example in Rust, which the tests have built.
#[test]
fn the_plot_source_in_rust_drives_a_chain() {
    drives_a_chain(&["--speed", "max"], |bench, config| {
        let program = Path::new(env!("CARGO_BIN_EXE_radar-chain")).with_file_name("examples/plot_source");
        let mut source = Command::new(program);
        source.args(["--ipc-prefix", bench.prefix(), "--set"]).arg(format!("ipc.root='{}'", bench.path("").display()));
        source.arg("--config").arg(config).args(["--set", "run.speed=max"]);
        source
    });
}

fn drives_a_chain(arguments: &[&str], source: impl FnOnce(&Bench, &Path) -> Command) {
    let bench = Bench::new();
    let config = small_config().with_file_name("../../examples/plot_source.toml");
    let running = bench.start_config(&config, arguments);
    bench.wait_for("a chain without a source", |status| status.get("tracker").map(|_| ()));
    let source = output(&mut source(&bench, &config));
    assert!(source.status.success(), "{}", text_of(&source));
    let ended = running.end();
    assert!(ended.status.success(), "{}", text_of(&ended));
    let report = bench.report();
    assert_eq!((report.scans, report.lost(), report.messages["plots"]), (30, 0, 30 * 16), "{}", text_of(&ended));
    assert_eq!(report.detection.plots, 30 * 2, "one of each target and scan");
}
