//! Soaks: their files, their verdict, their page in a browser, and their comparison.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::latency_log;
use common::report::Report;
use support::{Bench, output, signal, small_config, text_of};

fn soak(bench: &Bench, out: &str, arguments: &[&str]) -> (std::process::Output, Report) {
    let mut command = bench.command("soak", &small_config());
    command.args(["--out", out, "--set", "soak.interval_s=0.1"]).args(arguments);
    let output = output(&mut command);
    assert!(bench.path(out).join("report.json").exists(), "{}", text_of(&output));
    (output, bench.report_at(&format!("{out}/report.json")))
}

#[test]
fn a_soak_within_its_limits_ends_well_and_leaves_its_files() {
    let bench = Bench::new();
    // Limits that only a broken chain can break: times are for benchmarks.
    let wide = ["--set", "soak.growth_mib=50", "--budget", "end_to_end=60000000@50"];
    let wide: Vec<&str> = wide.into_iter().chain(LATENCIES.iter().flat_map(|key| ["--set", key])).collect();
    let (soaked, report) =
        soak(&bench, "soak", &[&["--duration", "6s", "--speed", "1", "--reference"][..], &wide].concat());
    assert_eq!(soaked.status.code(), Some(0), "{}", text_of(&soaked));
    let soak = report.soak.as_ref().expect("the soak's part");
    assert!(soak.ok && soak.findings.is_empty());
    assert!(report.scans >= 20, "{} scans", report.scans);
    assert!(soak.reference["hop_dwells"].n > 100 && soak.reference["hop_plots"].n > 10, "{:?}", soak.reference);
    assert!(soak.ratio_to_reference["hop_dwells"] > 0.0);
    assert!(soak.growth_mib.contains_key("tracker"), "{:?}", soak.growth_mib);
    assert!(report.books.iter().all(common::report::Book::balances));

    // The intervals of the log are, put together, the histograms of the report.
    let log = std::fs::read_to_string(bench.path("soak/latency.hlog")).expect("a log");
    let merged = latency_log::merged(&latency_log::read(&log));
    for (name, histogram) in merged.named() {
        assert_eq!(histogram.len(), report.latency_us[name].n, "{name}");
    }
    let rows = std::fs::read_to_string(bench.path("soak/resources.csv")).expect("a table");
    assert!(rows.lines().filter(|line| line.contains(",tracker,")).count() >= 10, "{rows}");
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());

    let compare = |later: &Path| {
        let reports = [bench.path("soak/report.json").as_path(), later].map(Path::to_path_buf);
        output(Command::new(env!("CARGO_BIN_EXE_radar-chain")).arg("compare").args(reports))
    };
    let compared = compare(&bench.path("soak/report.json"));
    assert_eq!(compared.status.code(), Some(0), "{}", text_of(&compared));
    assert!(text_of(&compared).contains("not worse (tolerance 10 %)"), "{}", text_of(&compared));
    let missing = compare(&bench.path("nothing.json"));
    assert_eq!(missing.status.code(), Some(2), "{}", text_of(&missing));
    assert!(text_of(&missing).contains("expected the report.json of a soak"), "{}", text_of(&missing));
    look_at(&bench.path("soak/report.html"), &bench.path("shot.png"));
}

const LATENCIES: [&str; 7] = [
    "budget.hop_dwells.limit_us=6e7",
    "budget.extract.limit_us=6e7",
    "budget.hop_plots.limit_us=6e7",
    "budget.track.limit_us=6e7",
    "budget.end_to_end.limit_us=6e7",
    "budget.scan.limit_us=6e7",
    "budget.record.limit_us=6e7",
];

#[test]
fn a_broken_budget_is_told_with_its_scans() {
    let bench = Bench::new();
    let (output, report) = soak(&bench, "soak", &["--scans", "12", "--speed", "4", "--budget", "track=0.001@99.9"]);
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let soak = report.soak.as_ref().expect("the soak's part");
    assert!(soak.findings.iter().any(|finding| finding.starts_with("track: p99.9 is")), "{:?}", soak.findings);
    assert!(text_of(&output).contains("BROKEN track: p99.9"), "{}", text_of(&output));
    assert!(report.misses.iter().any(|miss| miss.latency == "track" && miss.limit_us < 0.01), "{:?}", report.misses);

    let (output, report) =
        self::soak(&bench, "again", &["--scans", "12", "--speed", "4", "--set", "budget.track.limit_us=0.001"]);
    assert_eq!(output.status.code(), Some(1), "{}", text_of(&output));
    let scans: Vec<u32> = report.misses.iter().filter(|miss| miss.latency == "track").map(|miss| miss.scan).collect();
    assert_eq!(scans, (0..12).collect::<Vec<_>>());
}

#[test]
fn a_budget_that_cannot_be_read_is_refused() {
    let bench = Bench::new();
    for wrong in ["end_to_end", "end_to_end=3000", "end_to_end=3000@98", "nothing=1@50", "end_to_end=x@99"] {
        let output = output(bench.command("soak", &small_config()).args(["--budget", wrong]));
        assert_eq!(output.status.code(), Some(2), "{}", text_of(&output));
        assert!(text_of(&output).contains("expected NAME=US@PERCENTILE"), "{}", text_of(&output));
    }
    for wrong in ["soon", "0s"] {
        let output = output(bench.command("soak", &small_config()).args(["--duration", wrong]));
        assert_eq!(output.status.code(), Some(2), "{}", text_of(&output));
    }
}

#[test]
fn memory_that_cannot_be_judged_is_said() {
    let bench = Bench::new();
    let (output, report) = soak(&bench, "soak", &["--scans", "8", "--set", "soak.interval_s=3600"]);
    let soak = report.soak.expect("the soak's part");
    assert!(soak.growth_mib.is_empty() && !soak.not_judged.is_empty(), "{soak:?}");
    assert!(text_of(&output).contains("not checked: memory"), "{}", text_of(&output));
    let page = std::fs::read_to_string(bench.path("soak/report.html")).expect("a page");
    assert!(page.contains("are too short, 10 readings needed") || page.contains("before the first reading"));
}

/// Processes of a domain by what they were called with: those that name its folder.
fn processes(bench: &Bench, word: &str) -> Vec<u32> {
    let domain = format!("radar-chain-{}/", bench.prefix());
    let entries = std::fs::read_dir("/proc").expect("processes").flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_string_lossy().parse::<u32>().ok());
    let called = |pid: &u32| {
        let line = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let line = String::from_utf8_lossy(&line).into_owned();
        line.contains(&domain) && line.split('\0').any(|argument| argument == word)
    };
    pids.filter(called).collect()
}

#[test]
fn a_killed_soak_leaves_no_bare_hops_and_what_a_killed_chain_leaves_is_removed() {
    let bench = Bench::new();
    let mut command = bench.command("soak", &small_config());
    command.args(["--out", "soak", "--duration", "1h", "--speed", "1", "--reference", "--no-record"]);
    let mut soak = command.stderr(Stdio::null()).spawn().expect("a soak");
    bench.wait_for("bare hops", |_| (processes(&bench, "hop").len() == 4).then_some(()));
    soak.kill().expect("killing the launcher");
    soak.wait().expect("its end");
    bench.wait_for("the end of the bare hops", |_| processes(&bench, "hop").is_empty().then_some(()));
    for stage in processes(&bench, "stage") {
        signal(stage, "KILL");
    }
    let began = Instant::now();
    while !processes(&bench, "stage").is_empty() {
        assert!(began.elapsed() < Duration::from_secs(60), "killed stages end");
    }
    assert!(!bench.left_behind().is_empty(), "files of a chain that was killed");
    let again = bench.run(&["--scans", "4"]);
    assert_eq!(again.status.code(), Some(0), "{}", text_of(&again));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

/// Opens the page in a browser, where there is one: it must have drawn itself without an error.
fn look_at(page: &Path, picture: &Path) {
    let Some(browser) = support::browser() else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    let open = |more: &str| {
        Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .arg(format!("--user-data-dir={}", folder.path().display()))
            .args(["--virtual-time-budget=10000", "--window-size=1280,2400", more])
            .arg(format!("file://{}", page.display()))
            .output()
            .expect("a browser")
    };
    let document = String::from_utf8_lossy(&open("--dump-dom").stdout).into_owned();
    assert!(document.contains("data-ready=\"true\""), "not drawn: {}", &document[..document.len().min(2000)]);
    assert!(!document.contains("data-error"), "drawn with an error");
    let drawn = document.matches("<svg").count();
    assert!(drawn >= 4, "{drawn} charts");
    open(&format!("--screenshot={}", picture.display()));
    assert!(std::fs::metadata(picture).is_ok_and(|file| file.len() > 20_000), "a picture of the page");
}

#[test]
fn a_refused_soak_leaves_the_files_of_the_first_alone() {
    let bench = Bench::new();
    let out = ["--out", "soak", "--set", "soak.interval_s=0.2"];
    let mut first = bench.command("soak", &small_config());
    first.args(out).args(["--scans", "40", "--speed", "4"]).stdout(Stdio::piped()).stderr(Stdio::piped());
    let first = first.spawn().expect("a soak");
    bench.wait_for("scans", |status| support::scan(status).filter(|&scan| scan >= 4));
    let refused = output(bench.command("soak", &small_config()).args(out));
    assert_eq!(refused.status.code(), Some(2), "{}", text_of(&refused));
    let ended = first.wait_with_output().expect("its end");
    let said = text_of(&ended);
    assert!(said.contains("results in soak"), "{said}");
    let rows = std::fs::read_to_string(bench.path("soak/resources.csv")).expect("a table");
    assert!(rows.starts_with("t_s,"), "{rows}");
    let log = std::fs::read_to_string(bench.path("soak/latency.hlog")).expect("a log");
    let merged = latency_log::merged(&latency_log::read(&log));
    let report = bench.report_at("soak/report.json");
    assert!(merged.named().all(|(name, histogram)| histogram.len() == report.latency_us[name].n));
}
