//! Logs in the forms that machines read.

mod support;

use support::{Bench, text_of};

fn log(form: &str) -> String {
    let bench = Bench::new();
    let mut command = bench.command("run", &support::small_config());
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
