//! Launchers die, and two of them meet.

mod support;

use support::{Bench, number, pids, scan, text_of};

const ENDLESS: [&str; 4] = ["--scans", "0", "--speed", "1"];

#[test]
fn stages_outlive_their_launcher_and_a_new_one_takes_over() {
    let bench = Bench::new();
    let first = bench.start(&ENDLESS);
    let before = bench.wait_for("scans", |status| pids(status).filter(|_| scan(status) >= Some(3)));
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
