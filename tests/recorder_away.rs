//! Real-time mode while the recorder stands still or its disk is full: tracks are those of an undisturbed run,
//! and what is missing in the recording is recorded and reported exactly.

mod support;

use std::collections::BTreeMap;
use std::io::{BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::ipc::Station;
use common::message::Stamps;
use common::messages::Tracks;
use common::recording::Recorded;
use common::report::{Book, Report};
use common::topic::Topic;
use common::tracks::{Track, TracksHeader};
use recorder::verify::Verification;
use support::{Bench, number, output, signal, small_config, text_of};

const SCANS: u32 = 150;
/// Sectors of a scan of the small radar.
const SECTORS: u64 = 8;
/// A guard against hanging, not a measurement.
const DEADLINE: Duration = Duration::from_secs(120);

/// Headers and tracks by position in the schedule, in a form that compares every digit.
type BySector = BTreeMap<u64, String>;

/// A message without what differs from run to run.
fn described(header: &TracksHeader, tracks: &[Track]) -> String {
    let mut header = *header;
    (header.session, header.stamps, header.lineage.session) = (0, Stamps::default(), 0);
    format!("{header:?} {tracks:?}")
}

/// What an undisturbed run gives.
fn undisturbed() -> BySector {
    let bench = Bench::new();
    let output = bench.run(&["--scans", &SCANS.to_string(), "--speed", "max"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    tracks_of(&bench.recordings())
}

fn tracks_of(parts: &[PathBuf]) -> BySector {
    let messages = parts.iter().flat_map(|part| common::recording::open(part).expect("a recording"));
    let tracks = messages.map_while(Result::ok).filter_map(|message| match message {
        Recorded::Tracks(header, tracks) => Some((header.seq, described(&header, &tracks))),
        _ => None,
    });
    tracks.collect()
}

/// Takes all tracks of a running chain until it ends, and calls `at` with each scan.
fn observe(bench: &Bench, mut at: impl FnMut(u32)) -> BySector {
    let began = Instant::now();
    let file = bench.root().join("chain.toml");
    while !file.exists() && began.elapsed() < DEADLINE {
        std::thread::sleep(Duration::from_millis(5));
    }
    let chain = common::config::load(Some(&file), &[]).expect("the chain's configuration");
    let station = Station::enter("observer", &chain).expect("a place in the domain");
    let tracks = station.subscriber::<Tracks>().expect("tracks");
    let mut seen = BySector::new();
    while seen.keys().next_back() != Some(&(u64::from(SCANS) * SECTORS - 1)) {
        assert!(began.elapsed() < DEADLINE, "the last tracks seen are {:?}", seen.keys().next_back());
        while let Some(message) = tracks.receive().expect("a queue") {
            seen.insert(message.header().seq, described(message.header(), message.elements()));
            at(message.header().scan);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    seen
}

/// Everything observed is as in the undisturbed run. The observer joins a chain that runs already and looks once a
/// millisecond, so it may miss the first scans, and a few sectors on a busy machine.
fn assert_undisturbed(seen: &BySector) {
    let wanted = undisturbed();
    assert_eq!(wanted.len() as u64, u64::from(SCANS) * SECTORS);
    assert!(seen.len() * 10 > wanted.len() * 9, "{} of {} seen", seen.len(), wanted.len());
    for (seq, tracks) in seen {
        assert_eq!(tracks, &wanted[seq], "sector {seq}");
    }
}

/// Books balance; recordings hold what the report says and verify without a finding, gaps included.
fn assert_exact(bench: &Bench, parts: &[PathBuf]) -> Report {
    let report = bench.report();
    assert!(report.books.iter().all(Book::balances), "{:?}", report.books);
    let in_gaps = |topic: Topic| report.gaps.iter().filter(|gap| gap.topic == topic).map(|gap| gap.count).sum::<u64>();
    let recorded = tracks_of(parts).len() as u64;
    assert_eq!(recorded + in_gaps(Topic::Tracks), u64::from(SCANS) * SECTORS, "{:?}", report.gaps);
    let lost = |topic: &str| report.loss[topic].values().sum::<u64>();
    assert_eq!(in_gaps(Topic::Tracks), lost("tracks"));
    assert_eq!(report.loss["plots"]["tracker"], 0);
    let mut verification = Verification::default();
    for part in parts {
        let file = std::fs::File::open(part).expect("a recording");
        let length = file.metadata().expect("a length").len();
        verification.file(&part.display().to_string(), length, BufReader::new(file));
    }
    let (text, findings) = verification.finish();
    assert_eq!(findings, 0, "{text}");
    report
}

#[test]
fn a_recorder_that_stands_still_costs_no_track() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", &SCANS.to_string(), "--speed", "1", "--set", "run.mode=real-time"]);
    let recorder = bench.wait_for("the recorder", |status| number(status, "recorder", "pid")) as u32;
    let mut stopped = false;
    let seen = observe(&bench, |scan| {
        // 120 scans of a quarter of a second: half a minute.
        if (15..135).contains(&scan) && !stopped {
            signal(recorder, "STOP");
            stopped = true;
        } else if scan >= 135 && stopped {
            signal(recorder, "CONT");
            stopped = false;
        }
    });
    let output = running.end();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    assert_undisturbed(&seen);
    let report = assert_exact(&bench, &bench.recordings());
    // 120 scans less what its queue held.
    assert!(report.loss["tracks"]["recorder"] > 110 * SECTORS, "{:?}", report.loss);
}

#[test]
fn a_full_disk_costs_no_track() {
    let Some(space) = Space::new() else { return };
    let bench = &space.bench;
    let mut space_enlarged = false;
    let mut chain = space.start(&["--scans", &SCANS.to_string(), "--speed", "1", "--set", "run.mode=real-time"]);
    let seen = observe(bench, |scan| {
        if scan >= 40 && !space_enlarged {
            // The script in the namespace gives the disk room when it reads a line.
            writeln!(chain.stdin.as_mut().expect("piped"), "room").expect("the script listens");
            space_enlarged = true;
        }
    });
    let output = chain.wait_with_output().expect("the end of the chain");
    let said = text_of(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the recording is interrupted, the chain goes on"), "{said}");
    assert_undisturbed(&seen);
    let report = assert_exact(bench, &bench.recordings());
    assert!(report.loss["tracks"]["recording"] > SECTORS, "{:?}", report.loss);
    assert_eq!(report.loss["tracks"]["recorder"], 0);
}

/// A bench whose folder of recordings is a small disk of its own.
struct Space {
    bench: Bench,
}

impl Space {
    /// None where a user may not make namespaces.
    fn new() -> Option<Self> {
        let possible = output(&mut unshare("mount -t tmpfs none /mnt"));
        if possible.status.success() {
            return Some(Self { bench: Bench::new() });
        }
        let needed = std::env::var_os("CI").is_some();
        assert!(!needed, "checks before landing need namespaces: {}", text_of(&possible));
        eprintln!("no namespace can be made here: not tested");
        None
    }

    /// Starts the small radar; when a line comes on its standard input the disk is enlarged. The recordings are copied
    /// out of the namespace at the end.
    fn start(&self, arguments: &[&str]) -> Child {
        let folder = self.bench.path("recordings");
        std::fs::create_dir_all(&folder).expect("a folder");
        let chain = self.bench.command("run", &small_config());
        let program = chain.get_program().to_string_lossy().into_owned();
        let all = chain.get_args().map(|argument| argument.to_string_lossy().into_owned());
        let quoted: Vec<String> =
            all.chain(arguments.iter().map(ToString::to_string)).map(|text| quote(&text)).collect();
        let (disk, kept) = (folder.display(), self.bench.path("kept"));
        let script = format!(
            "mount -t tmpfs -o size=120k none {disk} && {{ {program} {} & chain=$!; read line; mount -o remount,size=64m {disk}; \
             wait $chain; code=$?; mkdir {kept}; cp {disk}/* {kept}; umount {disk}; cp {kept}/* {disk}; exit $code; }}",
            quoted.join(" "),
            kept = kept.display()
        );
        let mut command = unshare(&script);
        command.current_dir(self.bench.path("")).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().expect("a shell")
    }
}

fn quote(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// A shell in a mount namespace of its own.
fn unshare(script: &str) -> Command {
    let mut command = Command::new("unshare");
    command.arg("--mount").args((!rustix::process::geteuid().is_root()).then_some("--map-root-user"));
    command.args(["bash", "-c", script]);
    command
}
