//! Observers cost the chain nothing, and what they lose is known exactly.

mod support;

use std::process::{Command, Stdio};
use std::time::Instant;

use common::ipc::{Station, Subscriber};
use common::messages::{Dwells, Message, Plots, Tracks, Truth};
use common::report::Report;
use support::{Bench, DEADLINE, difference, signal, small_config, text_of};

/// A subscriber that takes one message and then stands still.
struct StandingStill<M: Message> {
    subscriber: Subscriber<M>,
    received: u64,
}

impl<M: Message> StandingStill<M> {
    fn new(station: &Station) -> Self {
        Self { subscriber: station.subscriber().expect("a subscriber"), received: 0 }
    }

    /// Takes the first message if it is there. Until it first looks, an observer is not connected, and its full queue is passed over uncounted.
    fn has_first(&mut self) -> bool {
        if self.received == 0 {
            self.received += u64::from(self.subscriber.receive().expect("a message").is_some());
        }
        self.received > 0
    }

    /// Of `sent` messages those that it has not got are those that the report says it has lost.
    fn check(mut self, report: &Report, sent: u64) {
        while self.subscriber.receive().expect("what is in the queue").is_some() {
            self.received += 1;
        }
        let topic = M::TOPIC.name();
        let lost = report.observers.get(topic).and_then(|by| by.get("spectator")).copied().unwrap_or(0);
        assert_eq!(self.received + lost, sent, "{topic}: {} received, {lost} lost", self.received);
        assert!(lost > 0, "{topic}: its queue never filled");
    }
}

#[test]
fn an_observer_of_each_topic_that_stands_still_costs_nothing_and_its_loss_is_exact() {
    let scans = 60;
    let arguments = ["--scans", "60"];
    let quiet = Bench::new();
    let undisturbed = quiet.run(&arguments);
    assert!(undisturbed.status.success(), "{}", text_of(&undisturbed));

    let bench = Bench::new();
    let domain = [format!("ipc.prefix={}", bench.prefix()), format!("ipc.root='{}'", bench.path("").display())];
    let chain = common::config::load(Some(&small_config()), &domain).expect("a valid configuration");
    // There before the chain is.
    let station = Station::enter("spectator", &chain).expect("a domain");
    let (mut dwells, mut plots) = (StandingStill::<Dwells>::new(&station), StandingStill::<Plots>::new(&station));
    let (mut tracks, mut truth) = (StandingStill::<Tracks>::new(&station), StandingStill::<Truth>::new(&station));
    let running = bench.start(&arguments);
    let began = Instant::now();
    // All of them each time: each connects as soon as its publisher is there.
    while [dwells.has_first(), plots.has_first(), tracks.has_first(), truth.has_first()] != [true; 4] {
        assert!(began.elapsed() < DEADLINE, "no messages");
    }
    let output = running.end();
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!((report.scans, report.lost(), report.comparable), (scans, 0, true), "{}", text_of(&output));
    dwells.check(&report, scans * 64);
    plots.check(&report, scans * 8);
    tracks.check(&report, scans * 8);
    truth.check(&report, scans);
    assert_eq!(difference(&quiet, &bench), None);
    assert!(text_of(&output).contains("observer spectator has missed"), "{}", text_of(&output));
    station.domain().remove();
}

/// The example as a process that is stopped: the chain ends without it, and names it.
#[test]
fn a_stopped_process_is_named_with_its_loss() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "1600", "--speed", "25"]);
    bench.wait_for("scans", |status| support::scan(status).filter(|&scan| scan >= 2));
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_radar-chain")).with_file_name("examples/observer");
    let mut observer = Command::new(program)
        .args(["--ipc-prefix", bench.prefix(), "--set"])
        .arg(format!("ipc.root='{}'", bench.path("").display()))
        .arg("--config")
        .arg(small_config())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the example is built with the tests");
    let mut line = String::new();
    let stdout = observer.stdout.take().expect("its output");
    std::io::BufRead::read_line(&mut std::io::BufReader::new(stdout), &mut line).expect("a track");
    assert!(line.contains("m/s"), "{line}");
    signal(observer.id(), "STOP");
    let lost = bench.wait_for("its loss in the status", |status| {
        status.get("tracker")?.get("observers")?.get("tracks")?.get("observer")?.as_u64()
    });
    assert!(lost > 0);
    let output = running.end();
    signal(observer.id(), "CONT");
    let _ = observer.kill();
    let _ = observer.wait();
    assert!(output.status.success(), "{}", text_of(&output));
    let report = bench.report();
    assert_eq!(report.lost(), 0);
    assert!(report.observers["tracks"]["observer"] >= lost);
}
