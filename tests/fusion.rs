//! A chain of three radars with systematic errors, and the centre that fuses their tracks.

mod support;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::recording::Recorded;
use common::report::SitesReport;
use common::topology::FUSION;
use serde_json::Value;
use support::{Bench, number, output, signal, text_of};

fn config() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("config/fusion.toml")
}

fn run(bench: &Bench, arguments: &[&str]) -> Output {
    output(bench.command("run", &config()).args(["--speed", "max"]).args(arguments))
}

fn reports(bench: &Bench) -> SitesReport {
    let text = std::fs::read_to_string(bench.path("report.json")).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

/// What the centre has recorded, without what differs from run to run.
fn recorded(bench: &Bench) -> Vec<Recorded> {
    let recording = reports(bench).sites["centre"].recording.clone().expect("a recording");
    let messages = common::recording::open(&bench.path(&recording)).expect("a recording");
    let comparable = messages.map(|message| {
        let mut message = message.expect("readable");
        message.header_mut().make_comparable();
        message
    });
    comparable.filter(|message| message.by_ref().topic().is_data()).collect()
}

#[test]
fn the_centre_sees_better_than_any_radar_and_finds_their_errors() {
    let bench = Bench::new();
    let result = run(&bench, &[]);
    assert!(result.status.success(), "{}", text_of(&result));
    let reports = reports(&bench);
    let position_m = |site: &str| reports.sites[site].tracking.position_rmse_m.expect("truth");
    let centre = &reports.sites["centre"];
    let tracking = &centre.tracking;
    assert_eq!((tracking.targets, tracking.confirmed, tracking.lost), (Some(6), Some(6), Some(0)));
    assert_eq!((tracking.false_tracks, tracking.id_changes), (Some(0), Some(0)));
    assert!(reports.sites.values().all(|site| site.lost() == 0), "{}", text_of(&result));
    let best_m = ["west", "east", "south"].map(position_m).into_iter().fold(f64::INFINITY, f64::min);
    assert!(position_m("centre") < 0.5 * best_m, "{} m, the best radar {best_m} m", position_m("centre"));
    // Range m, azimuth and elevation rad, as the configuration has them.
    let header = recorded(&bench).into_iter().rev().find_map(|message| match message {
        Recorded::SystemTracks(header, _) => Some(header),
        _ => None,
    });
    let header = header.expect("system tracks");
    for (found, right) in header.biases.iter().zip([[35.0, -0.35, 0.1], [-45.0, 0.5, -0.15], [20.0, 0.2, 0.2]]) {
        let away =
            [found.bias[0] - right[0], found.bias[1].to_degrees() - right[1], found.bias[2].to_degrees() - right[2]];
        assert!(away[0].abs() < 10.0 && away[1].abs() < 0.15 && away[2].abs() < 0.15, "{away:?}");
    }
}

/// Fusion waits for all sites, so its tracks do not depend on who comes first, also where one is far ahead.
#[test]
fn the_same_run_again_gives_the_same_system_tracks() {
    let tracks = |bench: &Bench| {
        let result = run(bench, &["--scans", "20", "--set", "site.south.radar.scan_period_s=7"]);
        assert!(result.status.success(), "{}", text_of(&result));
        let mut messages = recorded(bench);
        messages.sort_by_key(|message| message.by_ref().topic()); // topics come in any order
        messages
    };
    let (bench, again) = (Bench::new(), Bench::new());
    let (first, second) = (tracks(&bench), tracks(&again));
    assert!(first.len() > 1000, "{}", first.len());
    let differs = first.iter().zip(&second).find(|(a, b)| a != b).map(|(a, _)| (a.by_ref().topic(), a.by_ref().seq()));
    assert_eq!((first.len(), differs), (second.len(), None), "two runs of one seed differ");
    let used = &reports(&bench).processes["centre/fusion"];
    assert!(used.rejected.is_empty(), "{:?}", used.rejected);
}

/// In real time nobody waits for a site that says nothing.
#[test]
fn a_radar_that_stands_still_holds_nobody_up() {
    let bench = Bench::new();
    let real_time = ["--scans", "0", "--speed", "2", "--set", "run.mode=real-time", "--set", "fusion.wait_s=0.3"];
    let running = bench.start_config(&config(), &real_time);
    let of = |status: &Value, site: &str, process: &str, key: &str| number(status.get(site)?, process, key);
    let centre = |status: &Value, key: &str| of(status, "centre", FUSION, key);
    bench.wait_for("six system tracks", |status| centre(status, "confirmed").filter(|&tracks| tracks >= 6));
    let pid = bench.wait_for("a radar", |status| of(status, "west", "radar-sim", "pid")) as u32;
    signal(pid, "STOP");
    let still = bench.wait_for("the last scan", |status| of(status, "west", "tracker", "scan"));
    bench.wait_for("the centre to go on", |status| centre(status, "scan").filter(|&scan| scan > still + 12));
    // It is as far as the radars that still turn: no wait adds to the one before.
    bench.wait_for("the centre in time", |status| {
        let (centre, east) = (centre(status, "scan")?, of(status, "east", "tracker", "scan")?);
        (centre + 3 >= east).then_some(())
    });
    let result = running.stop();
    assert_ne!(result.status.code(), Some(3), "{}", text_of(&result));
}

/// A centre that has died goes on at the present cycle with numbers that nobody has had, and no radar has noticed.
#[test]
fn a_centre_that_is_killed_comes_back() {
    let bench = Bench::new();
    let running = bench.start_config(&config(), &["--scans", "0", "--speed", "4"]);
    let of_centre = |status: &Value, key: &str| status.get("centre").and_then(|site| number(site, FUSION, key));
    let all = |status: &Value| of_centre(status, "confirmed").filter(|&confirmed| confirmed >= 6);
    bench.wait_for("six system tracks", all);
    let pid = bench.wait_for("the centre", |status| of_centre(status, "pid"));
    signal(pid as u32, "KILL");
    bench.wait_for("another centre", |status| of_centre(status, "pid").filter(|&now| now != pid));
    bench.wait_for("six system tracks again", all);
    let result = running.stop();
    assert_eq!(result.status.code(), Some(1), "{}", text_of(&result));
    let reports = reports(&bench);
    assert_eq!(reports.processes["centre/fusion"].restarts, 1, "{}", text_of(&result));
    for site in ["west", "east", "south"] {
        assert_eq!(reports.sites[site].lost(), 0, "{site}: {}", text_of(&result));
    }
    let ids: Vec<(u64, u64)> = recorded(&bench)
        .iter()
        .filter_map(|message| match message {
            Recorded::SystemTracks(header, tracks) => Some((header.seq, tracks.iter().map(|track| track.id).max()?)),
            _ => None,
        })
        .collect();
    assert!(ids.windows(2).all(|pair| pair[1].0 > pair[0].0), "cycles are numbered by time");
    assert!(ids.iter().any(|of| of.1 < 1_000_000) && ids.iter().any(|of| of.1 > 1_000_000));
}
