//! Logs in the forms that machines read.

mod support;

use support::{Bench, small_config, text_of};

fn log(form: &str) -> String {
    let bench = Bench::new();
    let mut command = bench.command("run", &small_config());
    command.args(["--scans", "3", "--set", "realtime.tracker.cpus=[1000]"]);
    let output = command.env("RADAR_LOG", "info").env("RADAR_LOG_FORMAT", form).output().expect("a run");
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn json_lines_are_objects_with_level_and_message() {
    let text = log("json");
    let object = |line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
    let lines: Vec<serde_json::Value> = text.lines().map(object).collect();
    let started = lines.iter().filter(|line| line["message"] == "started" && line["level"] == "INFO").count();
    assert_eq!(started, 5, "{text}");
    let warned = lines.iter().find(|line| line["level"] == "WARN").expect("a warning");
    assert!(warned["message"].as_str().is_some_and(|said| said.contains("realtime.cpus refused")), "{warned}");
    assert!(warned["timestamp"].is_string() && warned["target"].is_string(), "{warned}");
}

#[test]
fn journal_lines_begin_with_their_severity() {
    let text = log("journal");
    assert!(text.lines().all(|line| line.starts_with('<')), "{text}");
    assert!(text.lines().any(|line| line.starts_with("<4>") && line.contains("realtime.cpus refused")), "{text}");
    assert_eq!(text.lines().filter(|line| line.starts_with("<6>") && line.contains("started")).count(), 5, "{text}");
}

/// Stages that are started by hand say what they wait for, when it has come, and where the files are.
#[test]
fn stages_started_by_hand_say_what_they_wait_for_and_what_they_leave() {
    use std::io::{BufRead, BufReader, Read};
    let bench = Bench::new();
    let start = |stage: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_radar-chain"));
        command.current_dir(bench.path("")).args(["stage", stage, "--config"]).arg(small_config());
        command.args(["--ipc-prefix", bench.prefix(), "--set", "watchdog.silence_s=0.3"]);
        command.args(["--set", &format!("ipc.root='{}'", bench.path("").display())]);
        command.stderr(std::process::Stdio::piped()).spawn().expect("a stage")
    };
    let mut recorder = start("recorder");
    let mut tracker = start("tracker");
    let mut lines = BufReader::new(tracker.stderr.take().expect("its log"));
    let mut said = String::new();
    while !said.contains("waiting for input") {
        assert!(lines.read_line(&mut said).expect("a line") > 0, "{said}");
    }
    let others = ["plot-extractor", "radar-sim"].map(start);
    for mut other in others {
        assert!(other.wait().expect("its end").success());
    }
    assert!(tracker.wait().expect("its end").success() && recorder.wait().expect("its end").success());
    lines.read_to_string(&mut said).expect("the rest");
    assert!(said.contains("input has begun"), "{said}");
    let mut left = String::new();
    recorder.stderr.take().expect("its log").read_to_string(&mut left).expect("the rest");
    let recording = bench.recordings().remove(0);
    let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
    assert!(left.contains(&format!("recorded to recordings/{name}")) && left.contains("report report.json"), "{left}");
    // Named after the time of its start in UTC, as those of a launcher.
    let parts: Vec<usize> = name.split(['-', '.']).map(str::len).collect();
    assert!(name.starts_with("small-20") && name.ends_with(".000.mcap"), "{name}");
    assert_eq!(parts, ["small", "20261130", "170928", "232", "000", "mcap"].map(str::len), "{name}");
}
