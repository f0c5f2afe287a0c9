//! What is wrong is said in one line that names it, with the right exit code, and nothing is left behind.

mod support;

use std::path::PathBuf;

use support::{Bench, output, small_config, text_of};

/// Runs with `arguments` and `config`; expects exit code 2 and one line with all of `words`.
fn refused(bench: &Bench, config: &std::path::Path, arguments: &[&str], words: &[&str]) {
    let result = output(bench.command("run", config).args(arguments));
    is_refusal(&result, words);
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

/// Exit code 2, and one line with all of `words`.
fn is_refusal(result: &std::process::Output, words: &[&str]) {
    let all = text_of(result);
    assert_eq!(result.status.code(), Some(2), "{all}");
    let errors = String::from_utf8_lossy(&result.stderr);
    let lines: Vec<&str> = errors.lines().filter(|line| line.contains(": ")).collect();
    assert_eq!(lines.len(), 1, "{all}");
    for word in words {
        assert!(lines[0].contains(word), "`{word}` is missing in: {all}");
    }
}

#[test]
fn mistakes_in_the_configuration() {
    let bench = Bench::new();
    let config = small_config();
    refused(&bench, &config, &["--set", "extractor.pfaa=1"], &["extractor.pfaa", "unknown field"]);
    refused(&bench, &config, &["--set", "radar.ranges=-5"], &["radar.ranges", "-5"]);
    refused(&bench, &config, &["--set", "extractor.pfa=2"], &["extractor.pfa", "2", "expected"]);
    refused(&bench, &config, &["--set", "nonsense"], &["--set nonsense", "table.key=value"]);
    refused(&bench, &PathBuf::from("missing.toml"), &[], &["missing.toml", "No such file"]);
    refused(&bench, &bench.path(""), &[], &["cannot read configuration file", "directory"]);
    let broken = bench.path("broken.toml");
    std::fs::write(&broken, "[site\nname=1").expect("writing");
    refused(&bench, &broken, &[], &["broken.toml"]);
}

#[test]
fn a_flight_that_is_not_there() {
    let bench = Bench::new();
    let config = bench.path("flight.toml");
    let target =
        "[[sim.targets]]\nname='f'\nmotion='csv'\nfile='none.csv'\nposition_m=[1,2,3]\nsnr_db=20\nswerling='0'\n";
    std::fs::write(&config, target).expect("writing");
    refused(&bench, &config, &[], &["`f`", "none.csv", "No such file"]);
}

#[test]
fn plot_recordings_that_are_none() {
    let bench = Bench::new();
    let run = |file: &str, words: &[&str]| {
        let file = format!("plot_source.file='{file}'");
        refused(&bench, &small_config(), &["--set", "run.source=plot-source", "--set", &file], words);
        let folders = [bench.path(""), bench.path("recordings")];
        let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
        let names: Vec<String> = files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        let is_left = |name: &String| [".tmp", ".mcap", ".report.json"].iter().any(|end| name.ends_with(end));
        assert!(!names.iter().any(is_left), "{names:?}");
    };
    run("none.ast", &["none.ast", "No such file"]);
    run("/tmp", &["/tmp", "directory"]);
    let garbage = bench.path("garbage.ast");
    std::fs::write(&garbage, [0x37_u8; 500]).expect("writing");
    run(&garbage.display().to_string(), &["garbage.ast"]);
}

#[test]
fn places_that_cannot_be_written() {
    let bench = Bench::new();
    std::fs::write(bench.path("file"), "").expect("writing");
    refused(&bench, &small_config(), &["--record", "file/inside"], &["file/inside"]);
    std::fs::create_dir(bench.path("folder")).expect("folder");
    refused(&bench, &small_config(), &["--report", "folder"], &["folder"]);
    // As root a report would take the place of the device.
    refused(&bench, &small_config(), &["--report", "/dev/null"], &["/dev/null", "no regular file"]);
}

#[test]
fn names_that_no_socket_can_have() {
    let bench = Bench::new();
    let root = bench.path("").display().to_string().trim_end_matches('/').to_string();
    let run = |command: &str, root: &str, length: usize| {
        let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_radar-chain"));
        process.current_dir(bench.path("")).arg(command).arg("--config").arg(small_config());
        process.args(["--set", &format!("ipc.root='{root}'"), "--ipc-prefix", &"p".repeat(length)]);
        output(if command == "run" { process.args(["--scans", "2"]) } else { &mut process })
    };
    let most = (42 - root.len()) / 2;
    let longest = run("run", &root, most);
    assert_eq!(longest.status.code(), Some(0), "what is accepted works: {}", text_of(&longest));
    let words = format!("at most {most} characters");
    for command in ["run", "doctor"] {
        is_refusal(&run(command, &root, most + 1), &["ipc.prefix", &words, "ipc.root"]);
        is_refusal(&run(command, &format!("/tmp/{}", "d".repeat(40)), 1), &["ipc.root", "names of sockets"]);
    }
}

#[test]
fn times_and_speeds_that_no_clock_can_count() {
    let bench = Bench::new();
    for key in [
        "supervision.drain_s",
        "supervision.backoff_s",
        "watchdog.silence_s",
        "watchdog.slow_s",
        "soak.interval_s",
        "radar.scan_period_s",
        "tracker.gate_false_plots",
        "run.speed",
    ] {
        for value in ["1e20", "inf"] {
            refused(&bench, &small_config(), &["--set", &format!("{key}={value}")], &[key, "expected"]);
        }
    }
    refused(&bench, &small_config(), &["--set", "run.speed=1e-300"], &["run.speed", "expected"]);
    refused(&bench, &small_config(), &["--set", "radar.scan_period_s=1e-308"], &["radar.scan_period_s", "expected"]);
}

#[test]
fn a_second_chain_in_the_same_domain() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    bench.wait_for("the first chain", |status| support::number(status, "tracker", "pid"));
    let second = bench.run(&["--report", "second.json"]);
    assert_eq!(second.status.code(), Some(2), "{}", text_of(&second));
    assert!(text_of(&second).contains("already running"), "{}", text_of(&second));
    let first = running.stop();
    assert!(first.status.success(), "{}", text_of(&first));
}

#[test]
fn the_effective_configuration_can_be_printed() {
    let bench = Bench::new();
    let printed = output(bench.command("config", &small_config()).args(["--set", "extractor.pfa=1e-4"]));
    let text = String::from_utf8_lossy(&printed.stdout);
    assert!(printed.status.success() && text.contains("pfa = 0.0001") && text.contains("[tracker]"), "{text}");
}

/// Everything that can be read is published, and then the run ends with 1.
#[test]
fn a_recording_with_a_lost_byte() {
    let bench = Bench::new();
    let mut bytes = include_bytes!("../plot-source/tests/data/lebl-smr-30s.ast").to_vec();
    bytes.remove(2000);
    let damaged = bench.path("damaged.ast");
    std::fs::write(&damaged, bytes).expect("writing");
    let file = format!("plot_source.file={}", damaged.display());
    let run = ["--set", "run.source=plot-source", "--set", "run.scans=0", "--speed", "max", "--set", &file];
    let result = output(bench.command("run", &small_config()).args(run));
    let all = text_of(&result);
    assert_eq!(result.status.code(), Some(1), "{all}");
    assert!(all.contains("damaged.ast: ") && all.contains("bytes could not be read, at byte "), "{all}");
    assert!(all.contains("unread_byte") && all.contains("0 messages lost"), "{all}");
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}
