//! The command lines and the environment of the systemd units of a simulated chain, run by a service manager of this test:
//! it needs neither a systemd that can be booted nor root, and has no sandbox. `deploy.rs` has the real one.

mod support;

use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use common::config::Source;
use common::report::Report;
use common::topology::{Role, STAGES, Stage};
use support::{DEADLINE, UNITS, signal};

/// The lines of a unit and of the drop-in for all units of the chain.
struct Unit {
    lines: Vec<String>,
}

impl Unit {
    fn read(stage: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("deploy/systemd");
        let files = [format!("radar-chain-{stage}.service"), "radar-chain-.service.d/10-sandbox.conf".into()];
        let lines = files.iter().flat_map(|file| {
            let text = std::fs::read_to_string(folder.join(file)).expect("a unit");
            text.lines().map(str::to_string).collect::<Vec<_>>()
        });
        Self { lines: lines.collect() }
    }

    fn values(&self, key: &str) -> impl Iterator<Item = &str> {
        self.lines.iter().filter_map(move |line| line.strip_prefix(key)?.strip_prefix('='))
    }

    fn value(&self, key: &str) -> &str {
        self.values(key).next().unwrap_or_else(|| panic!("the unit has no {key}"))
    }
}

/// Where this test has what the units find under `/`.
struct Places(tempfile::TempDir);

impl Places {
    fn new() -> Self {
        let places = Self(tempfile::tempdir().expect("temporary folder"));
        for folder in ["/run/radar-chain", "/var/lib/radar-chain", "/etc/radar-chain", "/usr/local/bin"] {
            std::fs::create_dir_all(places.of(folder)).expect("a folder");
        }
        std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_radar-chain"), places.of("/usr/local/bin/radar-chain"))
            .expect("a link");
        let chain = Path::new(env!("CARGO_MANIFEST_DIR")).join("deploy/chain.toml");
        let chain = std::fs::read_to_string(chain).expect("the configuration of the units");
        // Any free port: another chain may run on this machine.
        let chain = places.moved(&chain).replace("127.0.0.1:9464", "127.0.0.1:0");
        std::fs::write(places.of("/etc/radar-chain/chain.toml"), chain).expect("a configuration");
        places
    }

    fn of(&self, path: &str) -> PathBuf {
        self.0.path().join(path.trim_start_matches('/'))
    }

    /// Text of a unit with its folders here.
    fn moved(&self, text: &str) -> String {
        ["/usr/local/bin/", "/etc/radar-chain/", "/run/radar-chain", "/var/lib/radar-chain"]
            .into_iter()
            .fold(text.to_string(), |text, path| text.replace(path, &format!("{}{path}", self.0.path().display())))
    }
}

/// A process as a service manager sees it.
struct Service<'a> {
    stage: &'static str,
    unit: Unit,
    places: &'a Places,
    notices: UnixDatagram,
    child: Child,
    ready: bool,
    fed: bool,
    status: String,
    restarts: u32,
    ended: Option<ExitStatus>,
}

impl<'a> Service<'a> {
    fn start(stage: &'static str, places: &'a Places) -> Self {
        let unit = Unit::read(stage);
        assert_eq!(unit.value("Type"), "notify");
        let notices = UnixDatagram::bind(places.of(&format!("{stage}.notify"))).expect("a socket");
        notices.set_nonblocking(true).expect("a socket that does not block");
        let child = Self::spawn(stage, &unit, places);
        Self {
            stage,
            unit,
            places,
            notices,
            child,
            ready: false,
            fed: false,
            status: String::new(),
            restarts: 0,
            ended: None,
        }
    }

    /// Runs `ExecStart` in the environment that systemd gives a service of this unit.
    fn spawn(stage: &str, unit: &Unit, places: &Places) -> Child {
        let line = places.moved(unit.value("ExecStart"));
        let watchdog_s: u64 = unit.value("WatchdogSec").parse().expect("seconds");
        let mut command = Command::new("sh");
        command
            .args(["-c", "umask $1 && shift && exec \"$@\"", "sh", unit.value("UMask")])
            .args(line.split(' '))
            .current_dir("/")
            .env_clear()
            .env("PATH", "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin")
            .env("LANG", "C.UTF-8")
            .env("USER", unit.value("User"))
            .env("INVOCATION_ID", "0123456789abcdef0123456789abcdef")
            .env("RUNTIME_DIRECTORY", places.of("/run").join(unit.value("RuntimeDirectory")))
            .env("NOTIFY_SOCKET", places.of(&format!("{stage}.notify")))
            .env("WATCHDOG_USEC", (watchdog_s * 1_000_000).to_string())
            .envs(unit.values("Environment").map(|pair| pair.split_once('=').expect("NAME=VALUE")))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        if let Some(state) = unit.values("StateDirectory").next() {
            command.env("STATE_DIRECTORY", places.of("/var/lib").join(state));
        }
        command.spawn().expect("starting a stage")
    }

    /// Hears what the process says, and starts it again as `Restart=on-failure` would.
    fn attend(&mut self) {
        let mut notice = [0; 4096];
        while let Ok(length) = self.notices.recv(&mut notice) {
            for line in String::from_utf8_lossy(&notice[..length]).lines() {
                match line.split_once('=') {
                    Some(("READY", "1")) => self.ready = true,
                    Some(("WATCHDOG", "1")) => self.fed = true,
                    Some(("STATUS", status)) => self.status = status.to_string(),
                    _ => {}
                }
            }
        }
        if self.ended.is_some() {
            return;
        }
        let Some(status) = self.child.try_wait().expect("the state of a child") else { return };
        assert_eq!(self.unit.value("Restart"), "on-failure");
        let left_alone = self.unit.value("RestartPreventExitStatus").split(' ').map(|code| code.parse().ok());
        if status.success() || (status.code().is_some() && left_alone.into_iter().any(|code| code == status.code())) {
            self.ended = Some(status);
            return;
        }
        let pause = self.unit.value("RestartSec").strip_suffix("ms").expect("milliseconds");
        std::thread::sleep(Duration::from_millis(pause.parse().expect("a number")));
        (self.ready, self.fed) = (false, false);
        self.status.clear();
        self.child = Self::spawn(self.stage, &self.unit, self.places);
        self.restarts += 1;
    }

    /// The scan that it says it is at.
    fn scan(&self) -> Option<u32> {
        self.status.strip_prefix("scan ")?.split(',').next()?.parse().ok()
    }
}

impl Drop for Service<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Attends to all services until the condition holds.
fn wait_for<T>(services: &mut [Service<'_>], what: &str, condition: impl Fn(&[Service<'_>]) -> Option<T>) -> T {
    let began = Instant::now();
    while began.elapsed() < DEADLINE {
        services.iter_mut().for_each(Service::attend);
        if let Some(found) = condition(services) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let state = services.iter().map(|one| format!("{}: {:?}, {:?}", one.stage, one.status, one.ended));
    panic!("waited {DEADLINE:?} for {what}: {:?}", state.collect::<Vec<_>>());
}

fn tracked(services: &[Service<'_>]) -> Option<u32> {
    services.iter().find(|one| one.stage == "tracker")?.scan()
}

#[test]
fn the_units_lines_start_restart_after_a_kill_and_stop_in_order_without_systemd() {
    let places = Places::new();
    let mut services = Vec::new();
    for stage in UNITS {
        services.push(Service::start(stage, &places));
        wait_for(&mut services, stage, |services| services.last().filter(|one| one.ready).map(|_| ()));
    }
    wait_for(&mut services, "scans", |services| tracked(services).filter(|&scan| scan >= 3));
    for (index, stage) in UNITS.into_iter().enumerate() {
        wait_for(&mut services, "word to the watchdog", |services| services[index].fed.then_some(()));
        signal(services[index].child.id(), "KILL");
        wait_for(&mut services, stage, |services| {
            (services[index].restarts == 1 && services[index].ready).then_some(())
        });
        // Keeper and recorder tell scans only after others have; the tracker shows that the chain works.
        let seen = wait_for(&mut services, "a scan", tracked);
        wait_for(&mut services, "more scans", |services| tracked(services).filter(|&now| now >= seen.max(3) + 2));
    }
    for index in (0..UNITS.len()).rev() {
        services.iter_mut().for_each(Service::attend);
        // What is downstream of one that has ended may have ended by itself.
        if services[index].ended.is_none() {
            signal(services[index].child.id(), "TERM");
        }
        let ended = wait_for(&mut services, "its end", |services| services[index].ended);
        assert!(ended.success(), "{}: {ended}", UNITS[index]);
    }
    assert!(services.iter().all(|one| one.restarts == 1));
    drop(services);

    let chain = common::config::load(Some(&places.of("/etc/radar-chain/chain.toml")), &[]).expect("a configuration");
    let left = common::ipc::Domain::remains(&chain.ipc);
    assert!(left.is_empty(), "{left:?}");
    let report = std::fs::read(places.of("/var/lib/radar-chain/report.json")).expect("a report");
    let report: Report = serde_json::from_slice(&report).expect("a report");
    support::is_of_one_run(&report);
    for part in std::fs::read_dir(places.of("/var/lib/radar-chain/recordings")).expect("recordings") {
        let part = part.expect("an entry").path();
        if part.extension().is_none_or(|end| end != "mcap") {
            continue;
        }
        let whole = common::recording::open(&part).expect("a recording").map_while(Result::ok).count();
        assert!(whole > 20, "{}: {whole} messages", part.display());
    }
}

/// Every stage of the table that a chain of one site can be started with has a unit, which starts after the stages that it waits for.
#[test]
fn the_units_are_those_of_the_table_of_stages() {
    let chain = common::config::ChainConfig::default();
    let of_one_site = || STAGES.iter().filter(|stage| !stage.reads_other_sites());
    let started = of_one_site().filter(|stage| stage.role != Role::Source(Source::Replay));
    for stage in started {
        let unit = Unit::read(stage.name);
        let command = unit.value("ExecStart");
        assert!(command.starts_with(&format!("/usr/local/bin/radar-chain stage {} ", stage.name)), "{command}");
        assert_eq!(command.contains("--resume scan"), stage.is_source(), "{command}");
        let after = unit.value("After");
        // An observer waits for nobody: the display sends commands when the tracker is there.
        let waits = !stage.is_observer();
        let reads = |consumer: &&Stage| waits && stage.outputs.iter().any(|&topic| consumer.requires(topic, &chain));
        for consumer in of_one_site().filter(reads) {
            assert!(after.contains(&format!("radar-chain-{}.service", consumer.name)), "{}: {after}", stage.name);
        }
        for other in of_one_site().filter(|other| other.is_source() && stage.is_source() && other.name != stage.name) {
            let conflict = format!("radar-chain-{}.service", other.name);
            let has_unit = other.role != Role::Source(Source::Replay);
            assert!(!has_unit || unit.value("Conflicts").contains(&conflict), "{}", stage.name);
        }
    }
}
