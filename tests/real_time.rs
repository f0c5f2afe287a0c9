//! Real-time mode and real-time care.

mod support;

use common::report::Book;
use support::{Bench, STAGES, number, pids, scan, signal, text_of};

#[test]
fn a_slow_consumer_loses_messages_and_every_one_is_counted() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1", "--set", "run.mode=real-time"]);
    let stages = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    // The extractor stands still long enough for its queue of 32 dwells to overflow several times.
    for _ in 0..3 {
        let seen = bench.wait_for("the source", |status| number(status, "radar-sim", "scan"));
        signal(stages[1], "STOP");
        bench.wait_for("the source goes on", |status| {
            number(status, "radar-sim", "scan").filter(|&now| now >= seen + 3)
        });
        signal(stages[1], "CONT");
        let seen = bench.wait_for("a scan", scan);
        bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 2));
    }
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    let report = bench.report();
    assert!(report.loss["dwells"]["plot-extractor"] > 3 * 64, "{:?}", report.loss);
    assert!(report.books.len() >= 5 && report.books.iter().all(Book::balances), "{:?}", report.books);
}

/// A line of `/proc/PID/status`.
fn kernel_says(pid: u32, name: &str) -> String {
    let text = std::fs::read_to_string(format!("/proc/{pid}/status")).expect("a living process");
    let line = text.lines().find(|line| line.starts_with(name)).expect("a line");
    line.split(':').nth(1).expect("a value").trim().to_string()
}

#[test]
fn settings_are_granted_or_reported_as_refused() {
    let bench = Bench::new();
    let running = bench.start(&[
        "--scans",
        "0",
        "--speed",
        "1",
        "--set",
        "realtime.tracker.cpus=[0]",
        "--set",
        "realtime.tracker.lock_memory=true",
        "--set",
        "realtime.tracker.scheduling=fifo",
        "--set",
        "realtime.tracker.wait=poll",
        "--set",
        "realtime.recorder.cpus=[1000]",
    ]);
    let stages = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    let refused = bench.wait_for("the status", |status| status.get("tracker")?.get("refused")?.as_array().cloned());
    let is_refused = |setting: &str| refused.iter().any(|name| name == setting);
    assert!(!is_refused("cpus"), "there is a processor 0");
    assert_eq!(kernel_says(stages[2], "Cpus_allowed_list"), "0");
    let locked_kib = kernel_says(stages[2], "VmLck").split(' ').next().and_then(|kib| kib.parse::<u64>().ok());
    assert_eq!(locked_kib > Some(1000), !is_refused("lock_memory"), "locked memory: {locked_kib:?} KiB");
    // Field 41 of stat is the scheduling class; 1 is SCHED_FIFO. The name, in brackets, may hold spaces.
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", stages[2])).expect("a living process");
    let class = stat.rsplit(')').next().expect("fields").split_whitespace().nth(38).expect("a class").to_string();
    assert_eq!(class == "1", !is_refused("scheduling"), "class {class}");
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!(report.processes["recorder"].refused, ["cpus"]);
    assert!(text_of(&output).contains("realtime.cpus refused"), "{}", text_of(&output));
    assert_eq!(report.lost(), 0);
    assert!(STAGES.iter().all(|stage| report.processes[*stage].files > 0));
}

#[test]
fn polling_changes_no_result() {
    let [sleeping, polling] = [Bench::new(), Bench::new()];
    let poll = ["realtime.plot_extractor.wait=poll", "realtime.tracker.wait=poll", "realtime.recorder.wait=poll"];
    let poll: Vec<&str> = poll.iter().flat_map(|key| ["--set", key]).collect();
    for (bench, arguments) in [(&sleeping, &[][..]), (&polling, &poll)] {
        let output = bench.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    }
    let read = |bench: &Bench| {
        let messages = common::recording::open(&bench.recordings()[0]).expect("a recording");
        messages.map(|message| message.expect("whole")).collect::<Vec<_>>()
    };
    let tracks = |bench: &Bench| -> Vec<_> {
        let messages = read(bench).into_iter();
        messages
            .filter_map(|message| match message {
                common::recording::Recorded::Tracks(_, tracks) => Some(tracks),
                _ => None,
            })
            .collect()
    };
    let (a, b) = (tracks(&sleeping), tracks(&polling));
    assert!(!a.is_empty() && a == b);
}
