//! What is wrong is said in one line that names it, with the right exit code, and nothing is left behind.

mod support;

use std::path::PathBuf;

use support::{Bench, output, small_config, text_of};

/// Runs with `arguments` and `config`; expects exit code 2 and one line with all of `words`.
fn refused(bench: &Bench, config: &std::path::Path, arguments: &[&str], words: &[&str]) {
    let result = output(bench.command("run", config).args(arguments));
    let all = text_of(&result);
    assert_eq!(result.status.code(), Some(2), "{all}");
    let errors = String::from_utf8_lossy(&result.stderr);
    let lines: Vec<&str> = errors.lines().filter(|line| line.contains(": ")).collect();
    assert_eq!(lines.len(), 1, "{all}");
    for word in words {
        assert!(lines[0].contains(word), "`{word}` is missing in: {all}");
    }
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
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
