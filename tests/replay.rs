//! Recordings replayed through the present stages give what was recorded, byte for byte but for stamps.

mod support;

use std::path::{Path, PathBuf};

use common::recording::{Messages, Recorded, open, parts_from};
use common::topic::Topic;
use recorder::diff::first_difference;
use support::{Bench, output, small_config, text_of};

/// What a replay has to repeat.
const COMPARED: &[Topic] = &[Topic::Plots, Topic::Tracks, Topic::Truth];

/// The messages of a run, all its parts.
fn messages(path: &Path, topics: &'static [Topic]) -> Messages {
    let messages = parts_from(path).into_iter().flat_map(|part| open(&part).expect("a recording"));
    Box::new(messages.filter(|message| message.as_ref().map_or(true, |m| topics.contains(&m.by_ref().topic()))))
}

/// Records a run, replays it from `topics` on at each speed, and compares plots, tracks and truth.
fn repeat(config: &Path, arguments: &[&str], topics: &[&str], speeds: &[&str]) {
    let bench = Bench::new();
    let result = output(bench.command("run", config).args(arguments));
    assert!(result.status.success(), "{}", text_of(&result));
    let recorded = bench.recordings().remove(0);
    for topic in topics {
        for speed in speeds {
            let folder = bench.path(&format!("again-{topic}-{speed}"));
            let again = replay(&bench, &recorded, topic, &["--speed", speed], &folder);
            let difference = first_difference(messages(&recorded, COMPARED), messages(&again, COMPARED));
            assert_eq!(difference.expect("whole recordings"), None, "{topic} at {speed}");
        }
    }
}

fn replay(bench: &Bench, recorded: &Path, topic: &str, arguments: &[&str], folder: &Path) -> PathBuf {
    let mut command = bench.bare("run");
    command.arg("--replay").arg(recorded).args(arguments).args(["--report", "again.json"]).arg("--record").arg(folder);
    command.args(["--set", "recorder.dwells=false", "--set", &format!("replay.topics=[\"{topic}\", \"truth\"]")]);
    let result = output(&mut command);
    assert!(result.status.success(), "{topic} {arguments:?}: {}", text_of(&result));
    let mut parts: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    parts.sort();
    parts.remove(0)
}

#[test]
fn a_small_radar_repeats_from_dwells_and_from_plots() {
    repeat(&small_config(), &["--set", "recorder.dwells=true"], &["dwells", "plots"], &["max", "1"]);
}

#[test]
fn many_false_plots_repeat() {
    let arguments = ["--set", "recorder.dwells=true", "--set", "extractor.pfa=1e-3", "--seed", "9"];
    repeat(&small_config(), &arguments, &["dwells", "plots"], &["max", "1"]);
}

#[test]
fn the_drones_repeat() {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/uav.toml");
    let arguments = ["--scans", "5", "--speed", "max", "--set", "recorder.dwells=true"];
    repeat(&config, &arguments, &["dwells", "plots"], &["max", "1"]);
}

#[test]
fn a_real_radar_repeats() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = |name: &str| root.join("plot-source/tests/data").join(name).display().to_string();
    let radar = format!("plot_source.file={}", data("lebl-smr-30s.ast"));
    let truth = format!("plot_source.truth={}", data("lebl-mlat-30s.ast"));
    repeat(&root.join("config/smr.toml"), &["--set", &radar, "--set", &truth], &["plots"], &["max", "1"]);
}

#[test]
fn a_window_is_replayed_in_whole_scans() {
    let bench = Bench::new();
    let result = bench.run(&["--set", "recorder.dwells=true"]);
    assert!(result.status.success(), "{}", text_of(&result));
    let recorded = bench.recordings().remove(0);
    // A scan takes a quarter of a second: the first whole one from 0.6 s on is the third, 1.3 s lie in the fifth.
    let window = ["--speed", "max", "--from", "0.6", "--to", "1.3"];
    let wanted: Vec<_> = plots(&recorded).filter(|(scan, ..)| (3..=5).contains(scan)).collect();
    assert_eq!(wanted.len(), 3 * 8, "sectors of three scans");
    for topic in ["dwells", "plots"] {
        let again = replay(&bench, &recorded, topic, &window, &bench.path(topic));
        assert_eq!(plots(&again).collect::<Vec<_>>(), wanted, "from {topic}");
        assert_eq!(bench.report_at("again.json").lost(), 0, "what lies before the window is not lost");
    }
}

/// Plots of a run: scan, position in the schedule, and every digit. Counts of the session begin anew in a window.
fn plots(path: &Path) -> impl Iterator<Item = (u32, u64, String)> {
    messages(path, &[Topic::Plots]).filter_map(|message| match message.expect("a whole recording") {
        Recorded::Plots(header, plots) => Some((header.scan, header.seq, format!("{plots:?}"))),
        _ => None,
    })
}
