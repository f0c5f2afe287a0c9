//! Stages are stopped (SIGSTOP): one that hangs is killed and comes back, one that only waits is left alone.

mod support;

use support::{Bench, STAGES, number, pids, scan, signal, text_of};

#[test]
fn a_stage_that_hangs_is_killed_and_comes_back() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1", "--set", "supervision.hang_s=2"]);
    let mut before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    for index in [2, 1] {
        let stage = STAGES[index];
        signal(before[index], "STOP");
        let after = bench.wait_for(stage, |status| pids(status).filter(|now| now[index] != before[index]));
        for other in (0..4).filter(|&other| other != index) {
            assert_eq!(after[other], before[other], "{} only waited for {stage}", STAGES[other]);
        }
        let seen = bench.wait_for("a scan", scan);
        before = bench.wait_for("more scans", |status| pids(status).filter(|_| scan(status) >= Some(seen + 3)));
    }
    let output = running.stop();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    assert!(text_of(&output).contains("tracker has said nothing for"), "{}", text_of(&output));
    let report = bench.report();
    let restarts = STAGES.map(|stage| report.processes[stage].restarts);
    assert_eq!(restarts, [0, 1, 1, 0]);
    assert!(report.books.iter().all(common::report::Book::balances), "{:?}", report.books);
}

#[test]
fn a_recorder_that_waits_for_its_disk_costs_nothing_in_lossless_mode() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1", "--set", "supervision.hang_s=2"]);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    signal(before[3], "STOP");
    // The chain stands still behind it, nobody speaks any more, and nobody is killed.
    bench.wait_for("silence behind it", |status| {
        (number(status, "radar-chain", "restarts").is_some() && number(status, "radar-sim", "scan").is_none())
            .then_some(())
    });
    signal(before[3], "CONT");
    let seen = bench.wait_for("a scan", scan);
    let after = bench.wait_for("more scans", |status| pids(status).filter(|_| scan(status) >= Some(seen + 3)));
    assert_eq!(after, before);
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    assert_eq!(bench.report().lost(), 0);
}

#[test]
fn the_watchdog_tells_a_silent_upstream_from_own_slowness() {
    let bench = Bench::new();
    let limits = ["--set", "supervision.hang_s=0", "--set", "watchdog.silence_s=0.5"];
    let running = bench.start(&[&["--scans", "0", "--speed", "1"][..], &limits].concat());
    let stages = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    signal(stages[0], "STOP");
    let says = |process: &'static str, condition| {
        bench.wait_for(process, move |status| (status.get(process)?.get("condition")? == condition).then_some(()));
    };
    says("plot-extractor", "upstream silent");
    says("tracker", "upstream silent");
    signal(stages[0], "CONT");
    says("tracker", "fine");
    running.stop();
    let report = bench.report();
    assert!(report.processes["tracker"].silences >= 1 && report.processes["tracker"].slow_steps == 0);
}

#[test]
fn an_overloaded_stage_does_not_hang() {
    let bench = Bench::new();
    // A false alarm in every tenth cell: the extractor never catches up with the source, which has nothing else to do.
    let overload = ["--scans", "2000", "--speed", "max", "--no-record", "--set", "extractor.pfa=0.1"];
    let output = bench.run(&[&overload[..], &["--set", "supervision.hang_s=2"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!(STAGES.map(|stage| report.processes[stage].restarts), [0; 4]);
    assert_eq!(report.lost(), 0);
}

#[test]
fn a_stage_that_hangs_at_the_end_is_killed_and_the_books_are_closed() {
    let bench = Bench::new();
    // Scans of four seconds: the last one is seen before it is over.
    let limits = ["--set", "supervision.hang_s=0", "--set", "supervision.drain_s=4"];
    let running = bench.start(&[&["--scans", "3", "--speed", "0.06"][..], &limits].concat());
    let stages = bench.wait_for("the last scan", |status| pids(status).filter(|_| scan(status) == Some(2)));
    signal(stages[2], "STOP");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    assert!(text_of(&output).contains("tracker has not ended within 4 s"), "{}", text_of(&output));
    let report = bench.report();
    assert!(report.books.iter().all(common::report::Book::balances), "{:?}", report.books);
    assert!(report.messages["plots"] > 16, "{:?}", report.messages);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}
