//! Real chains for tests: each in a shared-memory domain and a folder of its own, both
//! removed at the end; conditions are waited for with generous deadlines.
#![allow(dead_code, reason = "each test file uses its part")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use common::recording;
use common::report::{ChainReport, Report};
use recorder::diff::first_difference;
use serde_json::Value;

/// Longest time that anything is waited for: a guard against hanging, not a measurement.
pub(crate) const DEADLINE: Duration = Duration::from_secs(120);

/// Configuration of the small radar.
pub(crate) fn small_config() -> PathBuf {
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    folders.map(|folder| folder.join("tests/config/small.toml")).find(|file| file.exists()).expect("its configuration")
}

/// The launcher: that of this package, or for tests of the link the one that `cargo test --workspace` builds beside.
fn launcher() -> Command {
    let beside = || std::env::current_exe().ok()?.ancestors().nth(2).map(|folder| folder.join("radar-chain"));
    let path = option_env!("CARGO_BIN_EXE_radar-chain").map(PathBuf::from).or_else(beside).expect("a folder");
    assert!(path.exists(), "{} is missing: cargo test --workspace builds it", path.display());
    Command::new(path)
}

/// Whether a test has to be left out, which is said, because Python lacks `modules`; never where `CI` is set. `hint` says how to come by
/// them.
pub(crate) fn python_lacks(modules: &str, hint: &str) -> bool {
    let imported = Command::new("python3").args(["-c", &format!("import {modules}")]).output();
    let present = imported.is_ok_and(|output| output.status.success());
    assert!(present || std::env::var_os("CI").is_none(), "python3 with {modules} is missing ({hint})");
    if !present {
        eprintln!("left out: python3 with {modules} is missing ({hint})");
    }
    !present
}

/// A Chromium by the name of its program; `None`, which is said, where there is none, never where `CI` is set.
pub(crate) fn browser() -> Option<&'static str> {
    let there =
        |browser: &&str| Command::new(browser).arg("--version").output().is_ok_and(|said| said.status.success());
    let found = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(there);
    assert!(found.is_some() || std::env::var_os("CI").is_none(), "checks before landing need Chromium for pages");
    if found.is_none() {
        eprintln!("no Chromium here: the page was not opened");
    }
    found
}

/// A domain and a folder for one test.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
    prefix: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let prefix = format!("t{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        Self { folder: tempfile::tempdir().expect("temporary folder"), prefix }
    }

    pub(crate) fn prefix(&self) -> &str {
        &self.prefix
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `radar-chain COMMAND` in this domain, everything it writes in this folder.
    pub(crate) fn command(&self, command: &str, config: &Path) -> Command {
        let mut process = self.bare(command);
        process.arg("--config").arg(config);
        process
    }

    /// The same without a configuration.
    pub(crate) fn bare(&self, command: &str) -> Command {
        let mut process = launcher();
        process
            .current_dir(self.folder.path())
            .arg(command)
            .args(["--ipc-prefix", &self.prefix])
            .args(["--set", &format!("ipc.root='{}'", self.folder.path().display())])
            // Chains run side by side here, and nobody looks on; the tests of the display say otherwise.
            .args(["--set", "display.enabled=false"])
            .stdin(Stdio::null());
        process
    }

    /// `radar-chain run` of the small radar in this folder, with the prefix of another bench.
    pub(crate) fn in_domain_of(&self, other: &Self) -> Command {
        let mut process = launcher();
        process
            .current_dir(self.folder.path())
            .args(["run", "--no-display", "--ipc-prefix", &other.prefix])
            .args(["--set", &format!("ipc.root='{}'", self.folder.path().display()), "--config"])
            .arg(small_config())
            .stdin(Stdio::null());
        process
    }

    /// Runs the small radar to its end.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        let mut process = self.command("run", &small_config());
        output(process.args(arguments))
    }

    /// Starts the small radar.
    pub(crate) fn start(&self, arguments: &[&str]) -> Running {
        self.start_with(arguments, |command| command)
    }

    /// Starts a chain of another configuration.
    pub(crate) fn start_config(&self, config: &Path, arguments: &[&str]) -> Running {
        let mut command = self.command("run", config);
        let child = command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        Running { child: Some(child.expect("starting the chain")) }
    }

    /// Starts the small radar in an environment of its own.
    pub(crate) fn start_with(&self, arguments: &[&str], prepare: impl FnOnce(&mut Command) -> &mut Command) -> Running {
        let child = prepare(&mut self.command("run", &small_config()))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("starting the chain");
        Running { child: Some(child) }
    }

    /// What the processes of the chain say of themselves.
    pub(crate) fn status(&self) -> Option<Value> {
        let output = self.look();
        if output.status.success() { serde_json::from_slice(&output.stdout).ok() } else { None }
    }

    fn look(&self) -> Output {
        output(self.command("status", &small_config()).arg("--json"))
    }

    /// Waits until the status fulfils a condition and gives what it found.
    pub(crate) fn wait_for<T>(&self, what: &str, condition: impl Fn(&Value) -> Option<T>) -> T {
        let began = Instant::now();
        while began.elapsed() < DEADLINE {
            if let Some(found) = self.status().as_ref().and_then(&condition) {
                return found;
            }
            // Each look is a process of its own, and others measure beside this one.
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("waited {DEADLINE:?} for {what}: {}", text_of(&self.look()));
    }

    pub(crate) fn report(&self) -> Report {
        self.report_at("report.json")
    }

    pub(crate) fn report_at(&self, name: &str) -> Report {
        let text = std::fs::read_to_string(self.path(name)).expect("a report");
        // Read in the crate of the report: each test would compile that anew.
        let Some(ChainReport::One(report)) = ChainReport::from_json(&text) else {
            panic!("a report of one site: {text}")
        };
        *report
    }

    /// Recordings made, in the order of their names.
    pub(crate) fn recordings(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.path("recordings")).expect("recordings");
        let files = entries.map(|entry| entry.expect("entry").path());
        let mut files: Vec<_> = files.filter(|file| file.extension().is_some_and(|end| end == "mcap")).collect();
        files.sort();
        files
    }

    /// Folder of the domain.
    pub(crate) fn root(&self) -> PathBuf {
        self.path(&format!("radar-chain-{}", self.prefix))
    }

    /// Files of the domain that are left.
    pub(crate) fn left_behind(&self) -> Vec<String> {
        let shared = std::fs::read_dir("/dev/shm").expect("shared memory");
        let names = shared.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned());
        let mut left: Vec<String> = names.filter(|name| name.starts_with(&self.prefix)).collect();
        let root = self.root();
        left.extend(root.exists().then(|| root.display().to_string()));
        left
    }
}

/// A chain that runs; it is killed if the test ends before it.
pub(crate) struct Running {
    child: Option<Child>,
}

impl Running {
    pub(crate) fn pid(&self) -> u32 {
        self.child.as_ref().expect("running").id()
    }

    /// Kills the launcher alone.
    pub(crate) fn kill(mut self) {
        let mut child = self.child.take().expect("running");
        child.kill().expect("killing the launcher");
        child.wait().expect("its end");
    }

    /// Waits for the end.
    pub(crate) fn end(mut self) -> Output {
        self.child.take().expect("running").wait_with_output().expect("the end of the chain")
    }

    /// Asks it to stop and waits for the end.
    pub(crate) fn stop(mut self) -> Output {
        signal(self.pid(), "TERM");
        self.child.take().expect("running").wait_with_output().expect("the end of the chain")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            // The second signal makes the launcher end its stages at once.
            signal(child.id(), "TERM");
            signal(child.id(), "TERM");
            let began = Instant::now();
            while began.elapsed() < Duration::from_secs(10) && !matches!(child.try_wait(), Ok(Some(_))) {
                std::thread::sleep(Duration::from_millis(20));
            }
            let _ = child.kill();
            if std::thread::panicking()
                && let Ok(output) = child.wait_with_output()
            {
                eprintln!("the launcher: {}", text_of(&output));
            }
        }
    }
}

/// The first difference between the recordings of two runs, but for stamps and sessions.
pub(crate) fn difference(a: &Bench, b: &Bench) -> Option<String> {
    let messages = |bench: &Bench| recording::open(&bench.recordings().remove(0)).expect("a recording");
    first_difference(messages(a), messages(b)).expect("whole recordings")
}

/// Sends a signal by name.
pub(crate) fn signal(pid: u32, name: &str) {
    let status = Command::new("kill").args([&format!("-{name}"), &pid.to_string()]).status();
    assert!(status.is_ok(), "kill is part of every system");
}

/// Runs a command to its end.
pub(crate) fn output(command: &mut Command) -> Output {
    command.output().expect("running a command")
}

/// What a command wrote, for messages of failed tests.
pub(crate) fn text_of(output: &Output) -> String {
    format!(
        "{}\n{}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

/// The processes that the systemd units run for a simulated chain, in the order in which `After=` has them started.
pub(crate) const UNITS: [&str; 5] = ["keeper", "recorder", "tracker", "plot-extractor", "radar-sim"];

/// Checks the report of a run in which each of them was killed once: one run, whose books balance.
pub(crate) fn is_of_one_run(report: &Report) {
    assert!(report.scans >= 5, "{} scans", report.scans);
    assert_eq!(report.processes["recorder"].restarts, 1);
    assert!(report.books.iter().all(common::report::Book::balances), "{:?}", report.books);
}

/// The stages of a simulated chain.
pub(crate) const STAGES: [&str; 4] = ["radar-sim", "plot-extractor", "tracker", "recorder"];

/// Process identifiers of the stages, when all are there.
pub(crate) fn pids(status: &Value) -> Option<[u32; 4]> {
    let found: Vec<u32> = STAGES.iter().filter_map(|stage| Some(number(status, stage, "pid")? as u32)).collect();
    found.try_into().ok()
}

/// The scan that the tracker is at.
pub(crate) fn scan(status: &Value) -> Option<u64> {
    number(status, "tracker", "scan")
}

/// A number in the status of a process.
pub(crate) fn number(status: &Value, process: &str, key: &str) -> Option<u64> {
    status.get(process)?.get(key)?.as_u64()
}
