//! /dev/shm too small at the start, and filled by others later: in a namespace with a /dev/shm of its own.

mod support;

use std::path::Path;
use std::process::Command;

use support::{Bench, output, small_config, text_of};

/// Runs a script in which `$CHAIN` is the program with a small /dev/shm; none where no namespace can be made.
fn in_small_memory(bench: &Bench, mib: u32, script: &str) -> Option<std::process::Output> {
    let root = rustix::process::geteuid().is_root();
    let unshare: &[&str] = if root { &["--mount"] } else { &["--mount", "--map-root-user"] };
    let possible = output(Command::new("unshare").args(unshare).args(["sh", "-c", "mount -t tmpfs none /dev/shm"]));
    if !possible.status.success() {
        assert!(std::env::var_os("CI").is_none(), "checks before landing need namespaces: {}", text_of(&possible));
        eprintln!("no namespace can be made here: not tested");
        return None;
    }
    let script = format!("set -e; mount -t tmpfs -o size={mib}m none /dev/shm; {script}");
    let mut command = Command::new("unshare");
    // A guard against hanging, not a measurement.
    command.args(unshare).args(["timeout", "300", "bash", "-c", &script]).current_dir(bench.path(""));
    command.env("CHAIN", env!("CARGO_BIN_EXE_radar-chain")).env("CONFIG", small_config());
    command.env("ROOT", bench.path("")).env("PREFIX", bench.prefix());
    Some(output(&mut command))
}

const RUN: &str =
    r#""$CHAIN" run --config "$CONFIG" --ipc-prefix "$PREFIX" --set "ipc.root='$ROOT'" --set run.speed=1.0"#;

/// Whether there is no free page.
const FULL: &str = r#"[ "$(df --output=avail /dev/shm | tail -1)" -eq 0 ]"#;

#[test]
fn too_small_at_the_start_is_one_line() {
    let bench = Bench::new();
    let Some(refused) = in_small_memory(&bench, 2, RUN) else { return };
    assert_eq!(refused.status.code(), Some(2), "{}", text_of(&refused));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("/dev/shm has") && said.trim().lines().count() == 1, "{said}");
}

/// Runs a command in the folder of `bench` under a limit that `ulimit` sets.
fn limited(limit: &str, command: &std::process::Command, bench: &Bench) -> std::process::Output {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<String> = words.map(|word| format!("'{}'", word.to_string_lossy().replace('\'', "'\\''"))).collect();
    let script = format!("ulimit {limit} && exec {}", words.join(" "));
    output(std::process::Command::new("sh").current_dir(bench.path("")).args(["-c", &script]))
}

#[test]
fn too_few_open_files_are_refused_and_a_low_limit_is_raised() {
    let bench = Bench::new();
    let mut command = bench.command("run", &small_config());
    command.args(["--scans", "4", "--no-record"]);
    let refused = limited("-n 100", &command, &bench);
    assert_eq!(refused.status.code(), Some(2), "{}", text_of(&refused));
    assert!(text_of(&refused).contains("100 open files are allowed"), "{}", text_of(&refused));
    let raised = limited("-S -n 40", &command, &bench);
    assert_eq!(raised.status.code(), Some(0), "{}", text_of(&raised));
    let enough = limited("-n 208", &command, &bench);
    assert_eq!(enough.status.code(), Some(0), "{}", text_of(&enough));
}

/// With little address space a stage cannot map the memory of the one before it: it must not go on without its messages.
#[test]
fn a_publisher_that_cannot_be_mapped_is_told() {
    let bench = Bench::new();
    let mut command = bench.command("run", &small_config());
    command.args(["--scans", "4", "--no-record", "--set", "supervision.max_restarts=2"]);
    let run = limited("-v 72000", &command, &bench);
    assert_eq!(run.status.code(), Some(3), "{}", text_of(&run));
    assert!(text_of(&run).contains("cannot be mapped"), "{}", text_of(&run));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

#[test]
fn filled_by_others_it_stops_nothing() {
    let bench = Bench::new();
    // Full to the last page while the chain runs: what it needs was reserved at its start.
    let script = format!(
        r#"
        {RUN} --scans 40 2>err & chain=$!
        until "$CHAIN" status --config "$CONFIG" --ipc-prefix "$PREFIX" --set "ipc.root='$ROOT'" | grep -q '2 tracks confirmed'; do :; done
        until {FULL}; do dd if=/dev/zero bs=4k >>/dev/shm/ballast || true; done 2>/dev/null
        kill -0 $chain # it is still running
        wait $chain
        "#
    );
    let Some(ran) = in_small_memory(&bench, 64, &script) else { return };
    assert_eq!(ran.status.code(), Some(0), "{}", text_of(&ran));
    assert_eq!((bench.report().scans, bench.report().lost()), (40, 0));
    assert!(!Path::new(&bench.root()).exists());
}

#[test]
fn a_stage_that_dies_while_it_is_full_comes_back_when_there_is_room() {
    let bench = Bench::new();
    // Whatever becomes free is taken at once, so that the extractor fails for want of room, unless it was faster.
    let script = format!(
        r#"
        status() {{ "$CHAIN" status --json --config "$CONFIG" --ipc-prefix "$PREFIX" --set "ipc.root='$ROOT'"; }}
        number() {{ status | sed -n "/^  \"$1\": {{/,/^  }}/s/^    \"$2\": \([0-9]*\).*/\1/p"; }}
        {RUN} --scans 0 2>err & chain=$!
        until [ "$(number tracker scan)" -ge 3 ]; do :; done 2>/dev/null
        extractor=$(number plot-extractor pid)
        while [ ! -e room ]; do dd if=/dev/zero bs=4k >>/dev/shm/ballast || true; done 2>/dev/null & filler=$!
        until {FULL}; do :; done
        kill -9 $extractor
        for _ in $(seq 100); do [ "$(grep -c 'plot-extractor ended' err)" -ge 3 ] && break; sleep 0.1; done
        touch room; wait $filler; rm /dev/shm/ballast
        until [ -n "$(number plot-extractor pid)" ]; do :; done
        seen=$(number tracker scan)
        until [ "$(number tracker scan)" -ge $((seen + 4)) ]; do :; done 2>/dev/null
        kill $chain; wait $chain
        "#
    );
    let Some(ran) = in_small_memory(&bench, 64, &script) else { return };
    assert_eq!(ran.status.code(), Some(1), "{}", text_of(&ran));
    let report = bench.report();
    // Lives that ended before they said a word are not in the report.
    assert!(report.processes["plot-extractor"].restarts >= 1, "{:?}", report.processes["plot-extractor"]);
    assert!(report.books.iter().all(common::report::Book::balances), "{:?}", report.books);
    assert!(!Path::new(&bench.root()).exists());
}
