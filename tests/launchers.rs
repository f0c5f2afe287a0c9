//! Launchers die, and two of them meet.

mod support;

use support::{Bench, number, output, pids, scan, text_of};

const ENDLESS: [&str; 4] = ["--scans", "0", "--speed", "1"];

#[test]
fn stages_outlive_their_launcher_and_a_new_one_takes_over() {
    let bench = Bench::new();
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    // Without a configuration, status is that of the chain in the domain.
    let bare = output(bench.bare("status").arg("--json"));
    assert!(bare.status.success() && text_of(&bare).contains("plot-extractor"), "{}", text_of(&bare));
    first.kill();
    let seen = bench.wait_for("a scan without a launcher", scan);
    let orphans = bench.wait_for("more scans", |status| pids(status).filter(|_| scan(status) >= Some(seen + 4)));
    assert_eq!(orphans, before, "the stages go on");

    let other = bench.run(&["--scans", "0", "--speed", "2"]);
    assert_eq!(other.status.code(), Some(2), "{}", text_of(&other));
    assert!(text_of(&other).contains("with another configuration"), "{}", text_of(&other));

    let second = bench.start(&ENDLESS);
    let launcher = u64::from(second.pid());
    let adopted = bench.wait_for("the new launcher", |status| {
        pids(status).filter(|_| number(status, "radar-chain", "pid") == Some(launcher))
    });
    assert_eq!(adopted, before, "the new launcher starts nothing anew");
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 4));
    let output = second.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    assert!(text_of(&output).contains("taking over a chain"), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!((report.lost(), report.scans > 10), (0, true));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn what_died_without_a_launcher_is_started_by_the_next() {
    let bench = Bench::new();
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    first.kill();
    support::signal(before[2], "KILL");
    let second = bench.start(&ENDLESS);
    let after = bench.wait_for("a new tracker", |status| pids(status).filter(|now| now[2] != before[2]));
    assert_eq!([after[0], after[1], after[3]], [before[0], before[1], before[3]]);
    let output = second.stop();
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    assert!(bench.report().books.iter().all(common::report::Book::balances), "{:?}", bench.report().books);
}

/// A tracker that a dead launcher has started and that is slow to enter the domain is not started a second time.
#[test]
fn a_stage_that_is_slow_to_enter_the_domain_is_not_doubled() {
    let bench = Bench::new();
    let patient = [&ENDLESS[..], &["--set", "supervision.hang_s=0"]].concat();
    let first = bench.start(&patient);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    first.kill();
    // In its place a process with its command line that becomes it only when it is let go.
    let go = bench.path("go");
    let script = format!(
        "until [ -e '{}' ]; do sleep 0.02; done; exec '{}' stage \"$@\"",
        go.display(),
        env!("CARGO_BIN_EXE_radar-chain")
    );
    std::fs::write(bench.path("stage"), script).expect("a script");
    let mut slow = std::process::Command::new("sh")
        .current_dir(bench.path(""))
        .args(["stage", "tracker", "--config"])
        .arg(bench.root().join("chain.toml"))
        .spawn()
        .expect("a process");
    support::signal(before[2], "KILL");
    let second = bench.start(&patient);
    let launcher = u64::from(second.pid());
    // Long enough for it to have started what it misses.
    bench.wait_for("the new launcher at work", |status| {
        let here = number(status, "radar-chain", "pid") == Some(launcher);
        number(status, "radar-chain", "seq").filter(|&seq| here && seq >= 12)
    });
    std::fs::write(&go, "").expect("a file");
    let seen = bench.wait_for("a scan", scan);
    let after = bench.wait_for("more scans", |status| pids(status).filter(|_| scan(status) >= Some(seen + 4)));
    assert_eq!(after, [before[0], before[1], slow.id(), before[3]], "the slow one is the tracker");
    let output = second.stop();
    assert!(bench.report().books.iter().all(common::report::Book::balances), "{}", text_of(&output));
    slow.wait().expect("its end");
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

/// A service that was left half made keeps a launcher from taking over: it ends the stages and starts the chain again.
#[test]
fn a_chain_with_a_half_made_service_is_started_again() {
    let bench = Bench::new();
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(2)));
    first.kill();
    let services = std::fs::read_dir(bench.root().join("services")).expect("services").flatten();
    for service in services {
        std::fs::write(service.path(), "").expect("our own file");
    }
    let second = bench.start(&ENDLESS);
    let launcher = u64::from(second.pid());
    let after = bench.wait_for("the chain again", |status| {
        let here = number(status, "radar-chain", "pid") == Some(launcher);
        pids(status).filter(|_| here && scan(status) >= Some(2))
    });
    assert!(before.iter().all(|pid| !after.contains(pid)), "{before:?} {after:?}");
    let output = second.stop();
    assert!(text_of(&output).contains("starting the chain again"), "{}", text_of(&output));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

/// The system sends SIGHUP to a stage that stands still when its launcher dies: that is no reason to end.
#[test]
fn a_stage_that_stands_still_when_its_launcher_dies_goes_on() {
    let bench = Bench::new();
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(2)));
    support::signal(before[0], "STOP");
    first.kill();
    support::signal(before[0], "CONT");
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| pids(status).filter(|&now| now == before && scan(status) >= Some(seen + 4)));
    let second = bench.start(&ENDLESS);
    let launcher = u64::from(second.pid());
    bench.wait_for("the new launcher", |status| {
        Some(()).filter(|()| number(status, "radar-chain", "pid") == Some(launcher))
    });
    let output = second.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
}

/// What others have put where the lock of a domain belongs is not followed, waited for or believed.
#[test]
fn a_lock_that_is_no_file_of_ours_is_refused() {
    let bench = Bench::new();
    let lock = bench.root().with_extension("lock");
    let elsewhere = bench.path("elsewhere");
    std::os::unix::fs::symlink(&elsewhere, &lock).expect("a link");
    let refused = |words: &str| {
        let run = bench.run(&["--scans", "2"]);
        assert_eq!(run.status.code(), Some(2), "{}", text_of(&run));
        assert!(text_of(&run).contains(words), "{}", text_of(&run));
        std::fs::remove_file(&lock).expect("it is still there");
    };
    refused("is no regular file");
    assert!(!elsewhere.exists(), "the link was not followed");
    assert!(std::process::Command::new("mkfifo").arg(&lock).status().expect("mkfifo").success());
    refused("is no regular file");
    std::os::unix::fs::symlink(bench.path(""), bench.root()).expect("a link");
    let run = bench.run(&["--scans", "2"]);
    assert_ne!(run.status.code(), Some(0), "{}", text_of(&run));
    assert!(text_of(&run).contains("it is no folder"), "{}", text_of(&run));
    assert!(!bench.path("chain.toml").exists() && !bench.path("iceoryx2.toml").exists());
}

#[test]
fn of_two_launchers_one_is_refused() {
    let bench = Bench::new();
    // At the same moment, and again while the winner runs.
    let pair = [bench.start(&ENDLESS), bench.start(&ENDLESS)];
    let winner =
        bench.wait_for("a scan", |status| number(status, "radar-chain", "pid").filter(|_| scan(status) >= Some(2)));
    let [mut winners, mut losers] = [Vec::new(), Vec::new()];
    for running in pair {
        if u64::from(running.pid()) == winner { &mut winners } else { &mut losers }.push(running);
    }
    let third = bench.run(&ENDLESS);
    for refused in losers.into_iter().map(support::Running::end).chain([third]) {
        assert_eq!(refused.status.code(), Some(2), "{}", text_of(&refused));
        assert!(text_of(&refused).contains("a chain is already running in the domain"), "{}", text_of(&refused));
    }
    for output in winners.into_iter().map(support::Running::stop) {
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    }
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn a_launcher_that_cannot_take_over_leaves_the_stages_alone() {
    let bench = Bench::new();
    let port = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let metrics = format!("metrics.listen=\"{}\"", port.local_addr().expect("its address"));
    let with_metrics = [&ENDLESS[..], &["--set", &metrics]].concat();
    drop(port);
    let first = bench.start(&with_metrics);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
    first.kill();
    let address = metrics.trim_start_matches("metrics.listen=").trim_matches('"').to_string();
    let taken = std::net::TcpListener::bind(&address).expect("the port of the dead launcher");
    let refused = bench.run(&with_metrics);
    assert_eq!(refused.status.code(), Some(2), "{}", text_of(&refused));
    drop(taken);
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 2));
    let second = bench.start(&with_metrics);
    let launcher = u64::from(second.pid());
    let adopted = bench.wait_for("the new launcher", |status| {
        pids(status).filter(|_| number(status, "radar-chain", "pid") == Some(launcher))
    });
    assert_eq!(adopted, before);
    second.stop();
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn one_prefix_in_two_folders_is_two_chains() {
    let (bench, other) = (Bench::new(), Bench::new());
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(2)));
    let second = support::output(other.in_domain_of(&bench).args(["--scans", "4"]));
    assert_eq!(second.status.code(), Some(0), "{}", text_of(&second));
    let seen = bench.wait_for("a scan", scan);
    let after = bench.wait_for("more scans", |status| pids(status).filter(|_| scan(status) >= Some(seen + 2)));
    assert_eq!(after, before);
    let output = first.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
}
