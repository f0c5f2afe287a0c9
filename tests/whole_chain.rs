//! The chain from launch to report, with real processes.

mod support;

use common::recording::{container, jsonl};
use common::topic::Topic;
use plot_extractor::PlotExtractor;
use recorder::diff::first_difference;
use support::{Bench, text_of};
use tracker::Tracker;
use tracker::orders::Orders;

fn messages(
    path: &std::path::Path,
) -> impl Iterator<Item = Result<common::recording::Recorded, common::recording::RecordingError>> {
    let file = std::fs::File::open(path).expect("a recording");
    container::Reader::new(std::io::BufReader::new(file))
}

#[test]
fn a_run_ends_by_itself_loses_nothing_and_leaves_nothing() {
    let bench = Bench::new();
    let output = bench.run(&[]);
    assert!(output.status.success(), "{}", text_of(&output));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
    let report = bench.report();
    assert_eq!((report.scans, report.lost(), report.comparable), (12, 0, true), "{}", text_of(&output));
    assert_eq!(report.messages["plots"], 12 * 8);
    assert_eq!(report.messages["tracks"], 12 * 8);
    assert_eq!(report.messages["truth"], 12);
    assert_eq!((report.tracking.targets, report.tracking.confirmed), (Some(2), Some(2)));
    assert_eq!(report.latency_us["end_to_end"].n, 12 * 8);
    for process in ["radar-sim", "plot-extractor", "tracker", "recorder"] {
        assert!(report.processes[process].pid > 0, "{process}");
    }
    let recordings = bench.recordings();
    assert_eq!(recordings.len(), 1);
    assert!(messages(&recordings[0]).all(|message| message.is_ok()));
}

/// The same seed gives the same plots and tracks, byte by byte except stamps, at any speed; another seed does not.
#[test]
fn results_depend_on_the_seed_and_not_on_the_speed() {
    let benches = [Bench::new(), Bench::new(), Bench::new()];
    let runs: [&[&str]; 3] = [&["--speed", "max"], &["--speed", "5"], &["--seed", "4"]];
    for (bench, arguments) in benches.iter().zip(runs) {
        let output = bench.run(arguments);
        assert!(output.status.success(), "{}", text_of(&output));
    }
    let recording = |bench: &Bench| bench.recordings().remove(0);
    let difference = |a: &Bench, b: &Bench| {
        first_difference(messages(&recording(a)), messages(&recording(b))).expect("whole recordings")
    };
    assert_eq!(difference(&benches[0], &benches[1]), None);
    assert!(difference(&benches[0], &benches[2]).is_some());
}

#[test]
fn the_user_can_stop_a_run_in_order() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "4"]);
    bench.wait_for("three scans", |status| support::number(status, "tracker", "scan").filter(|&scan| scan >= 3));
    let output = running.stop();
    assert!(output.status.success(), "{}", text_of(&output));
    assert_eq!(bench.report().lost(), 0);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
    assert_eq!(bench.status(), None, "no chain is left to be seen");
}

#[test]
fn nothing_is_recorded_when_not_wanted() {
    let bench = Bench::new();
    let output = bench.run(&["--no-record", "--report", "r/other.json"]);
    assert!(output.status.success(), "{}", text_of(&output));
    assert!(bench.path("r/other.json").exists());
    assert!(!bench.path("recordings").exists());
}

#[test]
fn in_real_time_mode_nothing_waits_and_every_loss_is_counted() {
    let bench = Bench::new();
    let output = bench.run(&["--set", "run.mode=real-time", "--scans", "20"]);
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert!(!report.comparable);
    let lost =
        |topic: &str, consumer: &str| report.loss.get(topic).and_then(|by| by.get(consumer)).copied().unwrap_or(0);
    // What the recorder has seen of the tracks and what it knows to have missed is all there was,
    // but for what the queue lost at the very end.
    let tracks = report.messages["tracks"] + lost("tracks", "recorder") + lost("plots", "tracker");
    assert!(tracks <= 20 * 8, "{report:?}");
    assert!(report.scans > 0);
}

/// Recorded dwells through the extractor, and recorded plots through the tracker, give what was recorded of them.
#[test]
fn batch_runs_repeat_the_chain() {
    let bench = Bench::new();
    let output = bench.run(&["--set", "recorder.dwells=true"]);
    assert!(output.status.success(), "{}", text_of(&output));
    let recording = bench.recordings().remove(0);
    let chain = common::config::load(Some(&support::small_config()), &[]).expect("valid configuration");

    let replayed = |topic: Topic, lines: &[u8]| {
        let recorded =
            messages(&recording).filter(|message| message.as_ref().is_ok_and(|m| m.by_ref().topic() == topic));
        let again = jsonl::Reader::new(lines);
        first_difference(recorded, again).expect("whole recordings")
    };
    let mut lines = Vec::new();
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut out = jsonl::Writer::new(&mut lines);
    let summary = plot_extractor::replay::replay(messages(&recording), &mut extractor, &mut out).expect("a replay");
    out.finish().expect("written");
    assert_eq!((summary.dwells, summary.rejected), (12 * 64, 0));
    assert_eq!(replayed(Topic::Plots, &lines), None);

    let mut lines = Vec::new();
    let mut tracker = Tracker::new(&chain.tracker, 1).expect("valid configuration");
    let mut out = jsonl::Writer::new(&mut lines);
    let summary =
        tracker::replay::replay(messages(&recording), &mut tracker, Orders::default(), &mut out).expect("a replay");
    out.finish().expect("written");
    assert_eq!(summary.messages, 12 * 8);
    assert_eq!(replayed(Topic::Tracks, &lines), None);
}
