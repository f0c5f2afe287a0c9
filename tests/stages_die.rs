//! Stages are killed while the chain runs: each comes back, the others stay, the loss is told.

mod support;

use common::recording::Recorded;
use common::report::Book;
use serde_json::Value;
use support::{Bench, STAGES, number, pids, scan, signal, text_of};

#[test]
fn every_stage_comes_back_and_the_loss_is_reported() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    let mut before = bench
        .wait_for("all stages at work", |status| pids(status).filter(|_| scan(status).is_some_and(|scan| scan >= 3)));
    for (index, stage) in STAGES.into_iter().enumerate() {
        signal(before[index], "KILL");
        let after = bench.wait_for(stage, |status| pids(status).filter(|now| now[index] != before[index]));
        for other in (0..4).filter(|&other| other != index) {
            assert_eq!(after[other], before[other], "{} has stayed while {stage} was killed", STAGES[other]);
        }
        let seen = bench.wait_for("a scan", scan);
        bench.wait_for("further scans", |status| scan(status).filter(|&now| now >= seen + 3));
        before = after;
    }
    let output = running.stop();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let report = bench.report();
    for stage in STAGES {
        assert_eq!(report.processes[stage].restarts, 1, "{stage}: {}", text_of(&output));
    }
    assert!(!report.comparable);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());

    // Exact books: what was received and what was lost on the way are all results that were
    // published, and every dwell that went into no result is counted.
    let lost =
        |topic: &str, consumer: &str| report.loss.get(topic).and_then(|by| by.get(consumer)).copied().unwrap_or(0);
    assert!(lost("dwells", "plot-extractor") > 0, "the simulator's rest of a scan at least: {:?}", report.loss);
    let (mut dwells_taken, mut last_dwell, mut plots, mut tracks) = (0, 0, 0, 0);
    for path in bench.recordings() {
        let file = std::fs::File::open(path).expect("a recording");
        for message in common::recording::container::Reader::new(std::io::BufReader::new(file)).map_while(Result::ok) {
            match message {
                Recorded::Plots(header, _) => {
                    plots += 1;
                    dwells_taken += header.lineage.taken;
                    last_dwell = header.lineage.last_seq;
                }
                Recorded::Tracks(..) => tracks += 1,
                _ => {}
            }
        }
    }
    assert_eq!((report.messages["plots"], report.messages["tracks"]), (plots, tracks));
    // Dwells of results that the recorder has lost were taken, but no recording shows them.
    let unseen = last_dwell + 1 - dwells_taken - lost("dwells", "plot-extractor");
    assert_eq!(unseen, lost("plots", "recorder") * 8, "{:?}", report.loss);

    // Two files: the one cut by the kill, readable to its last whole chunk, and its successor.
    let recordings = bench.recordings();
    assert_eq!(recordings.len(), 2, "{recordings:?}");
    for path in &recordings {
        let file = std::fs::File::open(path).expect("a recording");
        let reader = common::recording::container::Reader::new(std::io::BufReader::new(file));
        assert!(reader.map_while(Result::ok).count() > 20, "{}", path.display());
    }
}

/// Whoever reads tracks sees the same numbers go on; what the tracker had in hand is lost all the same, and told.
#[test]
fn a_tracker_that_comes_back_goes_on_with_its_tracks() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    let both = |status: &Value| number(status, "tracker", "confirmed").filter(|&confirmed| confirmed == 2);
    bench.wait_for("two confirmed tracks", both);
    let before = bench.wait_for("all stages at work", pids);
    signal(before[2], "KILL");
    bench.wait_for("another tracker", |status| pids(status).filter(|now| now[2] != before[2]));
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("further scans", |status| scan(status).filter(|&now| now >= seen + 6));
    let output = running.stop();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    assert!(text_of(&output).contains("tracker goes on with 2 confirmed tracks"), "{}", text_of(&output));

    let mut numbers = std::collections::BTreeMap::<u64, std::collections::BTreeSet<u64>>::new();
    for path in bench.recordings() {
        let file = std::fs::File::open(path).expect("a recording");
        for message in common::recording::container::Reader::new(std::io::BufReader::new(file)).map_while(Result::ok) {
            if let Recorded::Tracks(header, tracks) = message {
                let confirmed = tracks.iter().filter(|track| track.is_confirmed()).map(|track| track.id);
                numbers.entry(header.session).or_default().extend(confirmed);
            }
        }
    }
    let numbers: Vec<_> = numbers.into_values().collect();
    assert_eq!(numbers.len(), 2, "one session of each tracker: {numbers:?}");
    assert_eq!(numbers[0], numbers[1]);
}

/// A source that publishes plots itself had the rest of its scan in hand.
#[test]
fn what_a_dead_source_of_plots_had_in_hand_is_counted() {
    let bench = Bench::new();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = |key: &str, name: &str| {
        format!("plot_source.{key}='{}'", folder.join("plot-source/tests/data").join(name).display())
    };
    let files = [data("file", "lebl-smr-30s.ast"), data("truth", "lebl-mlat-30s.ast")];
    let arguments = ["--set", &files[0], "--set", &files[1], "--speed", "8"];
    let running = bench.start_config(&folder.join("config/smr.toml"), &arguments);
    let pid = bench.wait_for("scans", |status| {
        let pid = support::number(status, "plot-source", "pid")?;
        scan(status).filter(|&scan| scan >= 4).map(|_| pid)
    });
    signal(pid as u32, "KILL");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let report = bench.report();
    // Thirty scans of 32 sectors: all are received or known to be lost, by both consumers.
    for book in report.books.iter().filter(|book| book.topic == "plots") {
        assert!(book.balances() && book.sent == 30 * 32 && book.lost > 0, "{:?}", report.books);
    }
}

/// In real time the others do not wait for it: what it has missed is in the books all the same.
#[test]
fn a_recorder_that_is_away_until_the_end_counts_what_it_has_missed() {
    let bench = Bench::new();
    let hang = ["--set", "supervision.recorder_hang_s=2.0", "--set", "run.mode=real-time"];
    let running = bench.start(&[&["--scans", "40", "--speed", "4"][..], &hang].concat());
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(8)));
    signal(before[3], "STOP");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let report = bench.report();
    assert!(report.books.iter().all(Book::balances), "{:?}", report.books);
    for (topic, sent) in [("dwells", 40 * 64), ("plots", 40 * 8), ("tracks", 40 * 8), ("truth", 40)] {
        let all: Vec<u64> = report.books.iter().filter(|book| book.topic == topic).map(|book| book.sent).collect();
        assert!(!all.is_empty() && all.iter().all(|&each| each == all[0]), "{topic}: {:?}", report.books);
        // On a busy machine the extractor may miss a sector, of which there are no plots then.
        let least = if matches!(topic, "plots" | "tracks") { sent * 9 / 10 } else { sent };
        assert!((least..=sent).contains(&all[0]), "{topic}: {:?}", report.books);
    }
    assert!(report.lost() > 0);
}

#[test]
fn a_recorder_that_dies_while_the_chain_ends_still_leaves_the_report() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(4)));
    // It stands still, so that the chain is ending when it dies.
    signal(before[3], "STOP");
    signal(running.pid(), "TERM");
    let began = std::time::Instant::now();
    while std::path::Path::new(&format!("/proc/{}", before[0])).exists() && began.elapsed() < support::DEADLINE {
        std::thread::yield_now();
    }
    signal(before[3], "KILL");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    assert!(text_of(&output).contains("recorder ended by signal 9: starting it again"), "{}", text_of(&output));
    assert!(bench.report().scans >= 3, "{}", text_of(&output));
    let drafts = std::fs::read_dir(bench.path("")).expect("the folder").flatten();
    assert!(!drafts.into_iter().any(|entry| entry.file_name().to_string_lossy().ends_with(".tmp")));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn a_source_that_dies_in_its_last_scan_ends_the_run_and_repeats_nothing() {
    let bench = Bench::new();
    // Scans of five seconds: the last one is seen before it is over.
    let running = bench.start(&["--scans", "3", "--speed", "0.05"]);
    let stages = bench.wait_for("the last scan", |status| pids(status).filter(|_| scan(status) == Some(2)));
    signal(stages[0], "KILL");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let report = bench.report();
    assert!(report.books.iter().all(Book::balances), "{:?}", report.books);
    assert!(report.messages["plots"] < 24, "{:?}", report.messages);
    let positions: Vec<u64> = bench
        .recordings()
        .iter()
        .flat_map(|part| common::recording::open(part).expect("a recording"))
        .filter_map(|message| match message.expect("whole") {
            Recorded::Plots(header, _) => Some(header.seq),
            _ => None,
        })
        .collect();
    assert!(positions.is_sorted_by(|a, b| a < b), "{positions:?}");
}

#[test]
fn plots_that_a_dead_extractor_never_sent_are_not_the_trackers_loss() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    signal(before[1], "KILL");
    bench.wait_for("the extractor", |status| pids(status).filter(|now| now[1] != before[1]));
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("further scans", |status| scan(status).filter(|&now| now >= seen + 3));
    running.stop();
    let report = bench.report();
    assert_eq!((report.loss["plots"]["tracker"], report.loss["plots"]["recorder"]), (0, 0), "{:?}", report.loss);
    assert!(report.books.iter().all(Book::balances), "{:?}", report.books);
}
