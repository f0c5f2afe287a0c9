//! Several radars in one chain: one launcher, one recorder, one report.

mod support;

use std::path::PathBuf;

use common::recording::container;
use common::report::{Book, ChainReport, SitesReport};
use common::topic::Topic;
use recorder::diff::first_difference;
use support::{Bench, number, output, signal, text_of};

fn two_radars() -> PathBuf {
    support::small_config().with_file_name("two-small.toml")
}

fn report(bench: &Bench) -> SitesReport {
    let text = std::fs::read_to_string(bench.path("report.json")).expect("a report");
    match ChainReport::from_json(&text) {
        Some(ChainReport::Several(report)) => report,
        other => panic!("expected the report of several sites: {other:?}"),
    }
}

/// The recorded tracks of a site in all parts of its run.
fn tracks(
    bench: &Bench,
    site: &str,
) -> impl Iterator<Item = Result<common::recording::Recorded, common::recording::RecordingError>> {
    let of_site = |file: &PathBuf| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(site));
    let parts: Vec<PathBuf> = bench.recordings().into_iter().filter(of_site).collect();
    assert!(!parts.is_empty(), "no recording of {site}");
    let read = |part: PathBuf| {
        container::Reader::new(std::io::BufReader::new(std::fs::File::open(part).expect("a recording")))
    };
    parts
        .into_iter()
        .flat_map(read)
        .filter(|message| message.as_ref().is_ok_and(|message| message.by_ref().topic() == Topic::Tracks))
}

#[test]
fn two_radars_track_the_same_targets_each_from_where_it_stands() {
    let bench = Bench::new();
    let output = output(&mut bench.command("run", &two_radars()));
    assert!(output.status.success(), "{}", text_of(&output));
    let report = report(&bench);
    assert_eq!((report.schema, report.scans, report.comparable), (2, 12, true), "{}", text_of(&output));
    assert_eq!(report.sites.keys().collect::<Vec<_>>(), ["north", "south"]);
    for (name, site) in &report.sites {
        assert_eq!((site.scans, site.lost()), (12, 0), "{name}");
        assert_eq!((site.tracking.targets, site.tracking.confirmed), (Some(2), Some(2)), "{name}");
        assert_eq!(site.tracking.false_tracks, Some(0), "{name}");
        assert!(site.books.iter().all(Book::balances), "{name}: {:?}", site.books);
        assert_eq!(site.latency_us["end_to_end"].n, 12 * 8, "{name}");
    }
    for process in ["north/tracker", "south/radar-sim", "recorder", "radar-chain"] {
        assert!(report.processes[process].pid > 0, "{process}");
    }
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}

/// The radars draw noise of their own: their tracks are near the same truth, but not equal.
#[test]
fn one_site_of_several_can_be_run_alone_and_gives_the_same() {
    let benches = [Bench::new(), Bench::new()];
    let both = output(&mut benches[0].command("run", &two_radars()));
    let alone = output(benches[1].command("run", &two_radars()).args(["--site", "south"]));
    assert!(both.status.success() && alone.status.success(), "{}\n{}", text_of(&both), text_of(&alone));
    let difference = |a, b| first_difference(a, b).expect("whole recordings");
    assert_eq!(difference(tracks(&benches[0], "south"), tracks(&benches[1], "south")), None);
    assert!(difference(tracks(&benches[0], "north"), tracks(&benches[0], "south")).is_some());
    assert_eq!(benches[1].report().config.map(|config| config.site.name), Some("south".into()));
}

/// Any stage of one site can be killed: the other site goes on as if nothing had happened.
#[test]
fn the_death_of_a_stage_of_one_site_leaves_the_other_byte_for_byte() {
    let quiet = Bench::new();
    let arguments = ["--scans", "60", "--speed", "4"];
    let undisturbed = output(quiet.command("run", &two_radars()).args(["--scans", "60", "--speed", "max"]));
    assert!(undisturbed.status.success(), "{}", text_of(&undisturbed));
    for stage in ["radar-sim", "plot-extractor", "tracker"] {
        let bench = Bench::new();
        let running = bench.start_config(&two_radars(), &arguments);
        let pid = bench.wait_for("scans", |status| {
            let north = status.get("north")?;
            number(north, "tracker", "scan").filter(|&scan| scan >= 4)?;
            number(north, stage, "pid")
        });
        signal(pid as u32, "KILL");
        let output = running.end();
        assert_eq!(output.status.code(), Some(1), "a stage was restarted: {}", text_of(&output));
        let report = report(&bench);
        assert_eq!(report.processes[&format!("north/{stage}")].restarts, 1);
        assert_eq!((report.sites["south"].lost(), report.sites["south"].comparable), (0, true), "{stage}");
        assert!(report.sites["north"].books.iter().all(Book::balances), "{stage}: {:?}", report.sites["north"].books);
        let difference = first_difference(tracks(&quiet, "south"), tracks(&bench, "south")).expect("whole recordings");
        assert_eq!(difference, None, "{stage}");
    }
}

#[test]
fn a_site_that_is_not_there_is_refused_with_those_that_are() {
    let bench = Bench::new();
    let output = output(bench.command("run", &two_radars()).args(["--site", "east"]));
    assert_eq!(output.status.code(), Some(2), "{}", text_of(&output));
    assert!(text_of(&output).contains("key `site` is east, expected one of north, south"), "{}", text_of(&output));
}
