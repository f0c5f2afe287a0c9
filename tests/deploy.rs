//! The systemd units: checked, and run under a real systemd in namespaces of its own.

mod support;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use support::{DEADLINE, UNITS, output, text_of};

fn deploy() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("deploy")
}

fn unit(stage: &str) -> String {
    format!("radar-chain-{stage}.service")
}

/// A root folder with the units and everything they name, for `systemd-analyze`.
fn root() -> Option<tempfile::TempDir> {
    if !Command::new("systemd-analyze").arg("--version").output().is_ok_and(|said| said.status.success()) {
        assert!(std::env::var_os("CI").is_none(), "checks before landing need systemd-analyze");
        eprintln!("no systemd here: the units were not checked");
        return None;
    }
    let root = tempfile::tempdir().expect("temporary folder");
    let copy = |from: &Path, to: &str| {
        let to = root.path().join(to);
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        let copied = output(Command::new("cp").arg("-r").arg(from).arg(&to));
        assert!(copied.status.success(), "{}", text_of(&copied));
    };
    copy(&deploy().join("systemd"), "etc/systemd/system");
    copy(Path::new("/usr/lib/systemd/system"), "usr/lib/systemd/system");
    copy(Path::new(env!("CARGO_BIN_EXE_radar-chain")), "usr/local/bin/radar-chain");
    Some(root)
}

#[test]
fn units_are_clean_and_hardened() {
    let Some(root) = root() else { return };
    let analyze = |verb: &str, more: &[&str], unit: &str| {
        let mut command = Command::new("systemd-analyze");
        command.arg(verb).arg(format!("--root={}", root.path().display())).args(more).arg(unit);
        output(&mut command)
    };
    for stage in UNITS.into_iter().chain(["plot-source", "video-source", "display", "outputs", "link-in", "link-out"]) {
        let verified = analyze("verify", &[], &unit(stage));
        assert!(
            verified.status.success() && verified.stdout.is_empty() && verified.stderr.is_empty(),
            "{}",
            text_of(&verified)
        );
        // The threshold is ten times the exposure: 30 is 3.0.
        let secured = analyze("security", &["--offline=true", "--threshold=30"], &unit(stage));
        assert!(secured.status.success(), "{}", text_of(&secured));
    }
    let verified = analyze("verify", &[], "radar-chain.target");
    assert!(verified.status.success() && verified.stderr.is_empty(), "{}", text_of(&verified));
}

/// A systemd of its own, powered off at the end.
struct Systemd {
    boot: Child,
    pid: String,
}

impl Systemd {
    fn script() -> Command {
        let mut command = Command::new("bash");
        command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/support/systemd.sh"));
        command
    }

    fn boot() -> Option<Self> {
        let mut boot = Self::script()
            .arg("boot")
            .args([Path::new(env!("CARGO_BIN_EXE_radar-chain")), &deploy(), &deploy().join("chain.toml")])
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let mut pid = String::new();
        BufReader::new(boot.stdout.take().expect("piped")).read_line(&mut pid).expect("a line");
        if pid.trim().is_empty() {
            let code = boot.wait().expect("the end of the script").code();
            assert_eq!(code, Some(77), "the script says when no systemd can be booted");
            return None;
        }
        let systemd = Self { boot, pid: pid.trim().to_string() };
        systemd
            .wait_for("systemd to answer", || (systemd.show("test.target", "ActiveState") == "active").then_some(()));
        Some(systemd)
    }

    fn run(&self, command: &[&str]) -> Output {
        output(Self::script().args(["in", &self.pid]).args(command))
    }

    /// A property of a unit.
    fn show(&self, unit: &str, property: &str) -> String {
        let shown = self.run(&["systemctl", "show", "--value", "-p", property, unit]);
        String::from_utf8_lossy(&shown.stdout).trim().to_string()
    }

    fn wait_for<T>(&self, what: &str, condition: impl Fn() -> Option<T>) -> T {
        let began = Instant::now();
        while began.elapsed() < DEADLINE {
            if let Some(found) = condition() {
                return found;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        let journal = self.run(&["journalctl", "--no-pager", "-n", "60"]);
        panic!("waited {DEADLINE:?} for {what}: {}", text_of(&journal));
    }

    /// The scan that a stage says it is at.
    fn scan(&self, stage: &str) -> Option<u32> {
        self.show(&unit(stage), "StatusText").strip_prefix("scan ")?.split(',').next()?.parse().ok()
    }
}

impl Drop for Systemd {
    fn drop(&mut self) {
        let _ = Self::script().args(["off", &self.pid]).output();
        let _ = self.boot.wait();
    }
}

#[test]
fn units_start_restart_after_a_kill_and_stop_in_order() {
    let Some(systemd) = Systemd::boot() else {
        assert!(std::env::var_os("CI").is_none(), "checks before landing need root and a systemd that can be booted");
        eprintln!("no systemd can be booted here: the units were not run");
        return;
    };
    let enabled = systemd.run(&["systemctl", "enable", "--now", "radar-chain.target"]);
    assert!(enabled.status.success(), "{}", text_of(&enabled));
    for stage in UNITS {
        systemd.wait_for(stage, || (systemd.show(&unit(stage), "ActiveState") == "active").then_some(()));
    }
    systemd.wait_for("scans", || systemd.scan("tracker").filter(|&scan| scan >= 3));
    for stage in UNITS {
        let before = systemd.show(&unit(stage), "MainPID");
        let killed = systemd.run(&["systemctl", "kill", "-s", "KILL", "--kill-whom=main", &unit(stage)]);
        assert!(killed.status.success(), "{}", text_of(&killed));
        systemd.wait_for(stage, || {
            let back = systemd.show(&unit(stage), "ActiveState") == "active";
            let pid = systemd.show(&unit(stage), "MainPID");
            (back && pid != before && pid != "0").then_some(())
        });
        assert_eq!(systemd.show(&unit(stage), "NRestarts"), "1", "{stage}");
        // Keeper and recorder tell scans only after others have; the tracker shows that the chain works.
        let seen = systemd.wait_for("a scan", || systemd.scan("tracker"));
        systemd.wait_for("more scans", || systemd.scan("tracker").filter(|&now| now >= seen.max(3) + 2));
    }
    let stopped = systemd.run(&["systemctl", "stop", "radar-chain.target"]);
    assert!(stopped.status.success(), "{}", text_of(&stopped));
    for stage in UNITS {
        let state = ["ActiveState", "Result", "ExecMainStatus"].map(|property| systemd.show(&unit(stage), property));
        assert_eq!(state, ["inactive", "success", "0"], "{stage}");
    }
    let left = systemd.run(&["sh", "-c", "ls /dev/shm /run/radar-chain"]);
    let left = String::from_utf8_lossy(&left.stdout).into_owned();
    assert!(!left.contains("rc_") && !left.contains("radar-chain-radar"), "{left}");
    // One run, three files at most: its beginning and what followed the kill of the recorder.
    let report = systemd.run(&["cat", "/var/lib/radar-chain/report.json"]);
    let report: common::report::Report = serde_json::from_slice(&report.stdout).expect("a report");
    support::is_of_one_run(&report);
}
