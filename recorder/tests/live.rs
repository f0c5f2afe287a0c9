//! The recorder as a real process: this test is the rest of the chain.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use common::config::{self, ChainConfig};
use common::ipc::{Publisher, Station};
use common::message::{END_OF_SCAN, END_OF_STREAM, Lineage, Stamps};
use common::messages::{Message, Plots, Tracks, Truth};
use common::plots::{Plot, PlotsHeader};
use common::recording::Recorded;
use common::report::Report;
use common::time::monotonic_ns;
use common::topic::Topic;
use common::tracks::{CONFIRMED, Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget, VISIBLE};

const SECTORS: u64 = 8;
/// A test that takes longer has run into a deadlock.
const DEADLOCK: Duration = Duration::from_secs(20);

/// iceoryx2 has one domain per process: the tests of this file share it, one after the other.
static DOMAIN: Mutex<()> = Mutex::new(());

/// Measurement time of a position, ns UTC.
fn time_ns(seq: u64) -> u64 {
    1_700_000_000_000_000_000 + (seq + 1) * 1_000_000_000 / SECTORS
}

/// A chain of this test, in a folder of its own.
struct Chain {
    _alone: MutexGuard<'static, ()>,
    folder: tempfile::TempDir,
    settings: Vec<String>,
    config: ChainConfig,
    station: Station,
}

impl Chain {
    fn new() -> Self {
        let alone = DOMAIN.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = tempfile::tempdir().expect("a folder");
        let path = |file: &str| folder.path().join(file).display().to_string();
        let settings = vec![
            format!("ipc.prefix=recorder-test-{}", std::process::id()),
            format!("recorder.directory={}", path("recordings")),
            format!("recorder.report={}", path("report.json")),
            "run.id=test".to_string(),
            format!("radar.sectors_per_scan={SECTORS}"),
            // The rest of the chain is this test: no stage but the recorder reads what it publishes.
            "run.source=replay".to_string(),
            "replay.topics=[\"plots\", \"tracks\", \"truth\"]".to_string(),
        ];
        let config = config::load(None, &settings).expect("a valid configuration");
        let station = Station::enter("test", &config).expect("a domain");
        Self { _alone: alone, folder, settings, config, station }
    }

    /// A recorder with more settings.
    fn recorder(&self, more: &[&str]) -> Recorder {
        let mut command = Command::new(env!("CARGO_BIN_EXE_recorder"));
        for setting in self.settings.iter().map(String::as_str).chain(more.iter().copied()) {
            command.args(["--set", setting]);
        }
        Recorder(command.spawn().expect("the recorder starts"))
    }

    fn part(&self, number: u32) -> PathBuf {
        self.folder.path().join(format!("recordings/{}-test.{number:03}.mcap", self.config.site.name))
    }

    fn report(&self) -> Report {
        let text = std::fs::read_to_string(self.folder.path().join("report.json")).expect("a report");
        serde_json::from_str(&text).expect("a report of this version")
    }
}

impl Drop for Chain {
    fn drop(&mut self) {
        self.station.domain().remove();
    }
}

/// The publishers of a chain whose one target stands still and is tracked.
struct Stages {
    plots: Publisher<Plots>,
    tracks: Publisher<Tracks>,
    truth: Publisher<Truth>,
}

impl Stages {
    fn new(station: &Station) -> Self {
        let stages = Self {
            plots: station.publisher(Plots::MOST).expect("a publisher"),
            tracks: station.publisher(Tracks::MOST).expect("a publisher"),
            truth: station.publisher(Truth::MOST).expect("a publisher"),
        };
        stages.tracks.wait_for_consumers().expect("the recorder comes");
        stages
    }

    /// Waits until everything has been taken.
    fn linger(&self) {
        self.truth.linger();
        self.plots.linger();
        self.tracks.linger();
    }

    /// Publishes positions `from..to` of a run that ends at `end`.
    fn publish(&self, from: u64, to: u64, end: u64) {
        for seq in from..to {
            let (scan, sector) = ((seq / SECTORS) as u32, (seq % SECTORS) as u32);
            let time_ns = time_ns(seq);
            let last_of_scan = if u64::from(sector) == SECTORS - 1 { END_OF_SCAN } else { 0 };
            let flags = last_of_scan | if seq + 1 == end { END_OF_STREAM } else { 0 };
            let state = [1000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 50.0, 0.0, 0.0];
            if last_of_scan != 0 {
                let header = TruthHeader {
                    seq: scan.into(),
                    time_ns,
                    scan_period_s: 1.0,
                    scan,
                    flags,
                    ..TruthHeader::default()
                };
                let target =
                    TruthTarget { time_ns: time_ns - 1, target_id: 1, state, flags: VISIBLE, ..TruthTarget::default() };
                self.truth.publish(&header, &[target], |_| {}).expect("published");
            }
            let now = monotonic_ns();
            let stamps = Stamps { source_out_ns: now, plots_out_ns: now, ..Stamps::default() };
            let lineage = Lineage { published_before: seq, ..Lineage::default() };
            let plots = PlotsHeader {
                seq,
                session: 3,
                time_ns,
                lineage,
                scan,
                sector,
                flags,
                stamps,
                ..PlotsHeader::default()
            };
            self.plots.publish(&plots, &[Plot { time_ns, ..Plot::default() }], |_| {}).expect("published");
            let lineage = Lineage {
                session: 3,
                first_seq: seq,
                last_seq: seq,
                taken: 1,
                taken_in_session: seq + 1,
                published_before: seq,
            };
            let tracks = TracksHeader {
                seq,
                session: 4,
                time_ns,
                scan,
                sector,
                flags,
                stamps,
                lineage,
                ..TracksHeader::default()
            };
            let track = Track { time_ns: time_ns - 1, id: 1, state_code: CONFIRMED, state, ..Track::default() };
            let elements: &[Track] = if last_of_scan == 0 { &[] } else { &[track] };
            let published = self.tracks.publish(&tracks, elements, |header| {
                header.stamps.tracker_in_ns = now;
                header.stamps.tracks_out_ns = monotonic_ns();
            });
            published.expect("published");
        }
    }
}

/// A recorder that does not outlive its test.
struct Recorder(Child);

impl Recorder {
    fn kill(&mut self) {
        self.0.kill().expect("killed");
        self.wait();
    }

    fn wait(&mut self) -> ExitStatus {
        let began = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().expect("a child") {
                return status;
            }
            assert!(began.elapsed() < DEADLOCK, "the recorder does not end");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn recorder(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_recorder")).args(arguments).output().expect("the recorder starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn name(path: &Path) -> &str {
    path.to_str().expect("text")
}

#[test]
fn a_whole_run_is_recorded_and_reported() {
    let chain = Chain::new();
    let mut child = chain.recorder(&[]);
    let end = 20 * SECTORS;
    let stages = Stages::new(&chain.station);
    stages.publish(0, end, end);
    stages.linger();
    assert_eq!(child.wait().code(), Some(0));

    let report = chain.report();
    assert_eq!((report.scans, report.messages["tracks"], report.messages["plots"]), (20, end, end));
    assert_eq!(report.lost(), 0);
    assert!(report.comparable);
    assert_eq!((report.latency_us["track"].n, report.latency_us["scan"].n), (end, 20));
    assert_eq!((report.tracking.targets, report.tracking.confirmed), (Some(1), Some(1)));
    assert!(report.tracking.position_rmse_m.is_some_and(|rmse| rmse < 1e-6));
    assert!(report.processes.contains_key("recorder"));

    let file = chain.part(0);
    let (code, text, _) = recorder(&["info", name(&file)]);
    assert!(code == Some(0) && text.contains("whole") && text.contains("run      test part 0"), "{text}");

    let out = chain.folder.path().join("export");
    let (code, text, errors) = recorder(&["export", name(&file), "--format", "jsonl", "--out", name(&out)]);
    assert_eq!(code, Some(0), "{text}{errors}");
    let lines = out.join("tracks.jsonl");
    assert_eq!(std::fs::read_to_string(&lines).expect("a file").lines().count() as u64, end);
    // The other form of the same messages is equal, and differs by the last digit of one of them.
    let text = |topic: &str| std::fs::read_to_string(out.join(format!("{topic}.jsonl"))).expect("a file");
    let all = ["plots", "tracks", "truth"].map(text).concat();
    let other = chain.folder.path().join("all.jsonl");
    std::fs::write(&other, &all).expect("written");
    let (code, text, errors) = recorder(&["diff", name(&file), name(&other)]);
    assert_eq!((code, text.as_str()), (Some(0), "equal\n"), "{errors}");
    std::fs::write(&other, all.replacen("\"state\":[1000.0,", "\"state\":[1000.0000000000001,", 1)).expect("written");
    let (code, text, errors) = recorder(&["diff", name(&file), name(&other)]);
    assert!(code == Some(1) && text.contains("1000.0000000000001"), "{text}{errors}");
    let (code, _, _) = recorder(&["export", name(&file), "--topics", "tracks,health", "--out", name(&out)]);
    assert_eq!(code, Some(0));
    let table = std::fs::read_to_string(out.join("tracks.csv")).expect("a file");
    assert_eq!(table.lines().count(), 21);
    let width = |line: &str| line.split(',').count();
    assert!(table.lines().all(|line| width(line) == width(table.lines().next().unwrap_or_default())), "{table}");
}

#[test]
fn a_part_of_a_recording_goes_out_again_and_nothing_before_it_counts_as_lost() {
    let chain = Chain::new();
    let end = 20 * SECTORS;
    {
        let mut child = chain.recorder(&[]);
        let stages = Stages::new(&chain.station);
        stages.publish(0, end, end);
        stages.linger();
        assert_eq!(child.wait().code(), Some(0));
    }
    let mut child = chain.recorder(&["run.id=again", "run.first_scan=5"]);
    let file = chain.part(0);
    // Scan 5 begins 5 s after the first message; 9.9 s after it is in scan 9.
    let mut arguments = vec!["replay", name(&file), "--topics", "plots,tracks,truth", "--from", "5", "--to", "9.9"];
    arguments.extend(["--speed", "max", "--ipc-prefix", &chain.config.ipc.prefix]);
    let (code, _, errors) = recorder(&arguments);
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("--set run.first_scan=5"), "{errors}");
    assert_eq!(child.wait().code(), Some(0));

    let report = chain.report();
    let again = 5 * SECTORS;
    assert_eq!((report.messages["plots"], report.messages["tracks"], report.messages["truth"]), (again, again, 5));
    assert_eq!(report.lost(), 0, "{:?}", report.loss);
    // What went out is what was recorded, but for stamps and the mark at the end.
    let of_window = |path: &Path| -> Vec<(Topic, u64, usize)> {
        let messages = common::recording::open(path).expect("a recording").map(|message| message.expect("a message"));
        let described = messages.filter(|message| !matches!(message, Recorded::HealthReports(..))).map(|message| {
            let message = message.by_ref();
            (message.topic(), message.time_ns(), message.len())
        });
        let mut described: Vec<_> = described.collect();
        described.sort_unstable();
        described
    };
    let mut recorded = of_window(&file);
    let (start, stop) = (time_ns(5 * SECTORS), time_ns(10 * SECTORS - 1));
    recorded.retain(|&(_, time_ns, _)| (start..=stop).contains(&time_ns));
    let folder = file.parent().expect("a folder");
    assert_eq!(of_window(&folder.join(format!("{}-again.000.mcap", chain.config.site.name))), recorded);

    let (code, _, errors) = recorder(&["replay", name(&file), "--from", "1000"]);
    assert!(code == Some(2) && errors.contains("holds no whole scan of plots of this time"), "{errors}");
}

#[test]
fn stages_started_by_hand_replay_a_run_and_leave_it_as_it_was() {
    let chain = Chain::new();
    let end = 10 * SECTORS;
    {
        let mut child = chain.recorder(&[]);
        let stages = Stages::new(&chain.station);
        stages.publish(0, end, end);
        stages.linger();
        assert_eq!(child.wait().code(), Some(0));
    }
    let folder = chain.folder.path();
    let file = chain.part(0);
    let content = |path: &Path| std::fs::read(path).expect("a file");
    let before = (content(&file), content(&folder.join("report.json")));

    let (code, text, errors) = recorder(&["config", name(&file), "--replay"]);
    assert_eq!(code, Some(0), "{errors}");
    let config = folder.join("replay.toml");
    std::fs::write(&config, text).expect("written");
    // This test has no tracker: the recorded tracks go out again.
    let by_hand = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_recorder"));
        command.current_dir(folder).args(arguments).args(["--config", name(&config)]);
        command.args(["--set", "replay.topics=[\"plots\", \"tracks\", \"truth\"]"]);
        command.args(["--ipc-prefix", &chain.config.ipc.prefix]);
        command
    };
    let mut child = Recorder(by_hand(&[]).spawn().expect("the recorder starts"));
    let replay = by_hand(&["replay", name(&file), "--speed", "max"]).output().expect("the replay starts");
    assert_eq!(replay.status.code(), Some(0), "{}", String::from_utf8_lossy(&replay.stderr));
    assert_eq!(child.wait().code(), Some(0));

    assert!((content(&file), content(&folder.join("report.json"))) == before, "the old run is as it was");
    let files = std::fs::read_dir(folder.join("recordings")).expect("a folder").count();
    assert_eq!(files, 2, "nothing lies beside the old run and its report");
    let text = std::fs::read_to_string(folder.join("replay/report.json")).expect("a report");
    let report: Report = serde_json::from_str(&text).expect("a report of this version");
    assert_eq!((report.messages["plots"], report.messages["tracks"], report.lost()), (end, end, 0));
    let again = report.recording.expect("a recording");
    let (code, text, errors) = recorder(&["diff", name(&file), name(&folder.join(again))]);
    assert_eq!(code, Some(0), "{text}{errors}");
}

#[test]
fn a_recorder_killed_and_restarted_reports_the_whole_run_and_its_own_loss() {
    let chain = Chain::new();
    let mut child = chain.recorder(&[]);
    let end = 60 * SECTORS;
    let stages = Stages::new(&chain.station);
    stages.publish(0, 20 * SECTORS, end);
    std::thread::sleep(Duration::from_millis(1300)); // a chunk is closed at least once a second
    stages.publish(20 * SECTORS, 30 * SECTORS, end);
    child.kill();

    // What was written before the kill can be read.
    let (code, text, _) = recorder(&["info", name(&chain.part(0))]);
    assert!(code == Some(0) && text.contains("cut: readable up to its last whole chunk"), "{text}");

    let mut child = chain.recorder(&[]);
    stages.publish(30 * SECTORS, end, end);
    stages.linger();
    assert_eq!(child.wait().code(), Some(0));

    let report = chain.report();
    for topic in ["plots", "tracks"] {
        let (received, lost) = (report.messages[topic], report.loss[topic]["recorder"]);
        assert_eq!(received + lost, end, "{topic}: {received} received, {lost} lost");
        // Lost are the open chunk and what waited in the dead recorder's queue: 20 scans were safe, 30 came later.
        assert!(received >= 50 * SECTORS - 40 && lost > 0, "{topic}: {received} received, {lost} lost");
    }
    assert_eq!(report.loss["plots"]["tracker"], 0);
    assert_eq!(report.processes["recorder"].restarts, 1);
    assert!(!report.comparable);
    let (code, text, _) = recorder(&["info", name(&chain.part(1))]);
    assert!(code == Some(0) && text.contains("part 1") && text.contains("whole"), "{text}");
}

#[test]
fn a_folder_that_cannot_be_written_is_one_line_and_exit_code_2() {
    let chain = Chain::new();
    let file = chain.folder.path().join("taken");
    std::fs::write(&file, "a file").expect("written");
    let setting = format!("recorder.directory={}", file.display());
    let mut arguments: Vec<&str> = chain.settings.iter().flat_map(|set| ["--set", set.as_str()]).collect();
    arguments.extend(["--set", &setting]);
    let (code, _, errors) = recorder(&arguments);
    assert_eq!(code, Some(2), "{errors}");
    assert!(errors.lines().count() == 1 && errors.contains("taken"), "{errors}");
}

#[test]
fn bad_files_are_one_line_and_exit_code_2() {
    let folder = tempfile::tempdir().expect("a folder");
    let garbage = folder.path().join("garbage");
    std::fs::write(&garbage, [0xff; 64]).expect("written");
    let damaged = folder.path().join("damaged.mcap");
    std::fs::write(&damaged, b"\x89MCAP0\r\n\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff").expect("written");
    for file in [folder.path(), Path::new("/nowhere.mcap"), &garbage, &damaged] {
        for command in ["info", "diff"] {
            let second = if command == "diff" { vec![name(file)] } else { vec![] };
            let (code, _, errors) = recorder(&[vec![command, name(file)], second].concat());
            assert_eq!(code, Some(2), "{command} {}: {errors}", file.display());
            assert!(errors.lines().count() == 1 && errors.contains(name(file)), "{errors}");
        }
    }
}
