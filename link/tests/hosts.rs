//! A site on one host, its tracks on another: two chains with a link between them.

#[path = "../../tests/support/mod.rs"]
mod support;

use std::io::copy;
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::Output;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use common::recording::{self, Recorded};
use common::topic::Topic;
use common::topology::{LINK_IN, LINK_OUT};
use support::{Bench, Running, number, output, signal, text_of};

/// A port that nobody has.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port()
}

/// The chain that gets the tracks of the small radar.
fn start_receiver(bench: &Bench, port: u16, more: &[&str]) -> Running {
    let config = bench.path("there.toml");
    let text = format!(
        "[site]\nname = \"small\"\n[run]\nsource = \"link\"\nscans = 0\n[link]\nlisten = [\"tcp/127.0.0.1:{port}\"]\n"
    );
    std::fs::write(&config, text).expect("a configuration");
    let running = bench.start_config(&config, more);
    bench.wait_for("the receiver", |status| number(status, LINK_IN, "pid"));
    running
}

/// The chain of the small radar, which sends its tracks.
fn start_sender(bench: &Bench, port: u16, more: &[&str]) -> Running {
    let connect = format!("link.connect=['tcp/127.0.0.1:{port}']");
    let arguments = ["--set", "site.name=small", "--set", "link.send=['truth','tracks']", "--set", &connect];
    bench.start(&[&arguments, more].concat())
}

fn recorded(bench: &Bench, topic: Topic) -> Vec<Recorded> {
    let read = |part: PathBuf| recording::open(&part).expect("a recording");
    let messages = bench.recordings().into_iter().flat_map(read).map(|message| message.expect("readable"));
    let mut messages: Vec<Recorded> = messages.filter(|message| message.by_ref().topic() == topic).collect();
    for message in &mut messages {
        message.header_mut().make_comparable();
        message.header_mut().forget_upstream(); // plots are not sent
    }
    messages
}

/// Position of each message in its stream.
fn positions(messages: &[Recorded]) -> Vec<u64> {
    messages.iter().map(|message| message.by_ref().seq()).collect()
}

fn succeeded(result: &Output) {
    assert!(result.status.success(), "{}", text_of(result));
}

#[test]
fn another_host_has_the_same_tracks() {
    let (here, there, port) = (Bench::new(), Bench::new(), free_port());
    let receiver = start_receiver(&there, port, &[]);
    succeeded(&start_sender(&here, port, &["--scans", "20", "--speed", "max"]).end());
    let result = receiver.end();
    succeeded(&result);
    for topic in [Topic::Tracks, Topic::Truth] {
        let (sent, received) = (recorded(&here, topic), recorded(&there, topic));
        assert!(sent.len() >= 20);
        assert_eq!(positions(&sent), positions(&received));
        assert!(sent == received, "{} differ", topic.name());
    }
    assert_eq!(there.report().lost(), 0, "{}", text_of(&result));
}

/// In lossless mode a chain waits for the link, and an end of it that dies loses nothing.
#[test]
fn ends_that_are_killed_go_on() {
    let (here, there, port) = (Bench::new(), Bench::new(), free_port());
    let receiver = start_receiver(&there, port, &[]);
    let sender = start_sender(&here, port, &["--scans", "0", "--speed", "8"]);
    let pid = there.wait_for("tracks there", |status| {
        number(status, LINK_IN, "scan").filter(|&scan| scan > 5).and(number(status, LINK_IN, "pid"))
    });
    signal(pid as u32, "KILL");
    let scan = there.wait_for("another receiver", |status| {
        let again = number(status, LINK_IN, "pid").is_some_and(|now| now != pid);
        number(status, LINK_IN, "scan").filter(|&scan| again && scan > 8)
    });
    let pid = here.wait_for("the sender", |status| number(status, LINK_OUT, "pid"));
    signal(pid as u32, "KILL");
    there.wait_for("tracks again", |status| number(status, LINK_IN, "scan").filter(|&now| now > scan + 4));
    let result = sender.stop();
    assert_eq!(result.status.code(), Some(1), "a stage was restarted: {}", text_of(&result));
    let result = receiver.end();
    assert_eq!(result.status.code(), Some(1), "a stage was restarted: {}", text_of(&result));

    let (sent, received) = (positions(&recorded(&here, Topic::Tracks)), positions(&recorded(&there, Topic::Tracks)));
    let mut once = received.clone();
    once.sort_unstable();
    once.dedup();
    // What the sender that died had taken and not sent is counted there, as of any stage that dies.
    let missing = sent.iter().filter(|seq| once.binary_search(seq).is_err()).count() as u64;
    assert!(missing <= there.report().lost(), "{missing} missing: {}", text_of(&result));
    assert!(missing < 64 && sent.len() > 300, "{missing} of {}", sent.len());
}

/// A wire between two hosts that can be cut.
struct Wire {
    connections: Arc<Mutex<Option<Vec<TcpStream>>>>,
}

impl Wire {
    fn new(from: u16, to: u16) -> Self {
        let connections: Arc<Mutex<Option<Vec<TcpStream>>>> = Arc::new(Mutex::new(Some(Vec::new())));
        let (socket, open) = (TcpListener::bind(("127.0.0.1", from)).expect("a port"), Arc::clone(&connections));
        thread::spawn(move || {
            for here in socket.incoming().map_while(Result::ok) {
                let mut open = open.lock().unwrap_or_else(PoisonError::into_inner);
                let (Some(open), Ok(there)) = (open.as_mut(), TcpStream::connect(("127.0.0.1", to))) else { continue };
                for (mut a, mut b) in [(&here, &there), (&there, &here)].map(|(a, b)| (clone(a), clone(b))) {
                    thread::spawn(move || copy(&mut a, &mut b).and_then(|_| b.shutdown(Shutdown::Both)));
                }
                open.extend([here, there]);
            }
        });
        Self { connections }
    }

    fn cut(&self) {
        let mut open = self.connections.lock().unwrap_or_else(PoisonError::into_inner);
        open.take().into_iter().flatten().for_each(|connection| drop(connection.shutdown(Shutdown::Both)));
    }

    fn mend(&self) {
        self.connections.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default();
    }
}

fn clone(stream: &TcpStream) -> TcpStream {
    stream.try_clone().expect("a connection")
}

/// In real time nobody waits for a wire that is cut: the newest messages arrive when it is mended, the others are counted.
#[test]
fn a_wire_that_is_cut_holds_nobody_up() {
    let (here, there, port) = (Bench::new(), Bench::new(), free_port());
    let wire_port = free_port();
    let wire = Wire::new(wire_port, port);
    let real_time = ["--set", "run.mode=real-time"];
    let receiver = start_receiver(&there, port, &real_time);
    let few = ["--set", "link.window=16", "--scans", "0", "--speed", "2"];
    let sender = start_sender(&here, wire_port, &[&real_time[..], &few].concat());
    let received =
        |scan: u64| there.wait_for("tracks there", |status| number(status, LINK_IN, "scan").filter(|&now| now >= scan));
    let before = received(4);
    wire.cut();
    let still = here
        .wait_for("the radar to go on", |status| number(status, "tracker", "scan").filter(|&scan| scan > before + 12));
    wire.mend();
    received(still + 4);
    succeeded(&sender.stop());
    let result = receiver.end();
    assert_ne!(result.status.code(), Some(2), "{}", text_of(&result));
    let (sent, received) = (positions(&recorded(&here, Topic::Tracks)), positions(&recorded(&there, Topic::Tracks)));
    let (first, last) = (received[0], received[received.len() - 1]);
    let between = sent.iter().filter(|seq| (first..=last).contains(seq)).count();
    assert!(received.is_sorted_by(|a, b| a < b));
    let missing = (between - received.len()) as u64;
    assert!(missing > 0, "16 messages cannot hold 12 scans");
    assert_eq!(there.report().loss["tracks"]["recorder"], missing, "{}", text_of(&result));
}

/// Three radars, each on its own host, and the centre on a fourth: its picture is that of one host that has them all.
#[test]
fn radars_on_their_own_hosts_give_the_centre_the_same_picture() {
    let config = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../config/fusion.toml"));
    let (together, apart) = (Bench::new(), Bench::new());
    let result = output(together.command("run", &config).args(["--speed", "max", "--scans", "12"]));
    succeeded(&result);
    let ports = ["west", "east", "south"].map(|site| (site, free_port()));
    let mut linked = vec!["--scans".to_owned(), "0".to_owned()];
    for (site, port) in &ports {
        linked.extend(["--set".to_owned(), format!("site.{site}.run.source=link")]);
        linked.extend(["--set".to_owned(), format!("site.{site}.link.listen=['tcp/127.0.0.1:{port}']")]);
    }
    let centre = apart.start_config(&config, &linked.iter().map(String::as_str).collect::<Vec<_>>());
    let of_site = |bench: &Bench, site: &str| -> PathBuf {
        let mut all = bench.recordings().into_iter();
        let is_its = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(site));
        all.find(is_its).expect("a recording of the site")
    };
    // Each radar's host tracks what its radar has seen, and sends the tracks.
    thread::scope(|scope| {
        for (site, port) in &ports {
            let seen = of_site(&together, site);
            scope.spawn(move || {
                let (host, connect) = (Bench::new(), format!("link.connect=['tcp/127.0.0.1:{port}']"));
                let mut command = host.bare("run");
                command.arg("--replay").arg(seen);
                succeeded(&output(command.args(["--set", "link.send=['truth','tracks']", "--set", &connect])));
            });
        }
    });
    let result = centre.end();
    succeeded(&result);
    let picture = |bench: &Bench| -> Vec<Recorded> {
        let messages = recording::open(&of_site(bench, "centre")).expect("a recording");
        let mut messages: Vec<Recorded> = messages.map(|message| message.expect("readable")).collect();
        messages.retain(|message| [Topic::SystemTracks, Topic::Tracks].contains(&message.by_ref().topic()));
        for message in &mut messages {
            message.header_mut().make_comparable();
        }
        messages.sort_by_key(|message| (message.by_ref().topic(), message.by_ref().seq()));
        messages
    };
    let (here, there) = (picture(&together), picture(&apart));
    assert!(here.len() >= 12 * 9, "{}", here.len());
    assert_eq!(positions(&here), positions(&there));
    assert!(here == there, "the picture differs");
}
