//! Radars of all categories, up to the tracks.

mod synthetic;

use std::collections::BTreeSet;
use std::path::Path;

use common::config::{ChainConfig, TrackerConfig};
use common::plots::{ARTIFICIAL, HAS_RANGE_RATE, HAS_STATISTIC};
use common::tracks::{CONFIRMED, Track};
use plot_source::Source;
use synthetic::{Dialect, Recorder, block, chain, messages, open};
use tracker::Tracker;

const TURNS: u32 = 40;

/// Numbers of the confirmed tracks of a recording.
fn confirmed(source: Source, config: &TrackerConfig) -> BTreeSet<u64> {
    let mut tracker = Tracker::new(config, 1).expect("a valid configuration");
    let mut tracks: Vec<Track> = Vec::new();
    let mut numbers = BTreeSet::new();
    for (header, plots) in messages(source) {
        tracker.process_plots(&header, &plots, &mut tracks);
        numbers.extend(tracks.iter().filter(|track| track.state_code == CONFIRMED).map(|track| track.id));
    }
    numbers
}

fn coarse() -> ChainConfig {
    let mut chain = chain();
    chain.plot_source.sigma_range_m = 5.0; // a step is 14.5 m at most
    chain
}

/// Whatever the categories: one track for each of the five targets, and no turn lost.
#[test]
fn every_dialect_gives_the_same_tracks() {
    for dialect in [Dialect::Surface, Dialect::Monoradar, Dialect::Old] {
        for has_service in [true, false] {
            let blocks = Recorder { dialect, has_service, ..Recorder::default() }.blocks(TURNS);
            let source = open(&coarse(), &blocks.concat()).expect("a recording");
            let notes = source.notes().join("\n");
            assert_eq!(notes.contains("no north markers"), !has_service, "{notes}");
            assert!((TURNS..=TURNS + 1).contains(&source.scans()), "{} scans\n{notes}", source.scans());
            assert_eq!(confirmed(source, &TrackerConfig::default()).len(), 5, "{notes}");
        }
    }
}

/// Times of category 001 have lost their upper bits, of which category 002 tells the whole.
#[test]
fn truncated_times_are_completed() {
    let clock_s = |true_s: f64| 40_000.0 + true_s * 60.0; // 40 minutes, over several periods of 512 s
    let recorder = Recorder { dialect: Dialect::Old, turn_s: &|_| 1.0, clock_s: &clock_s, ..Recorder::default() };
    let mut chain = coarse();
    chain.plot_source.scan_period_s = 60.0;
    let source = open(&chain, &recorder.blocks(TURNS).concat()).expect("a recording");
    assert!(source.notes().iter().all(|note| !note.contains("clock steps")), "{:?}", source.notes());
    let (last, _) = messages(source).last().expect("messages");
    let expected_ns = synthetic::MIDNIGHT_NS + 40_000 * 1_000_000_000 + u64::from(TURNS) * 60 * 1_000_000_000;
    assert!(last.time_ns.abs_diff(expected_ns) < 100_000_000, "{}", last.time_ns);
}

/// A capture of a real radar: two targets, amplitudes, and range rates that do not fit the ranges of one of them.
#[test]
fn a_capture_gives_two_tracks() {
    let mut chain = ChainConfig::default();
    chain.plot_source.date = "2025-02-20".into();
    chain.plot_source.scan_period_s = 2.0;
    chain.plot_source.sigma_range_m = 10.0;
    let bytes = include_bytes!("../../asterix/tests/data/cat034-cat048-doppler-60s.pcapng");
    let source = Source::decode(&chain, (Path::new("radar.pcapng"), bytes), None).expect("a recording");
    assert_eq!((source.records(), source.scans()), (92, 31));
    assert!(source.notes().iter().any(|note| note.contains("range rates do not fit")), "{:?}", source.notes());
    let again = Source::decode(&chain, (Path::new("radar.pcapng"), bytes), None).expect("a recording");
    let plots: Vec<_> = messages(again).flat_map(|(_, plots)| plots).collect();
    assert_eq!(plots.len(), 62);
    assert!(plots.iter().all(|plot| plot.has(HAS_STATISTIC) && !plot.has(HAS_RANGE_RATE)));
    let config = TrackerConfig { start_speed_mps: 250.0, ..TrackerConfig::default() };
    assert_eq!(confirmed(source, &config).len(), 2);
}

/// Simulated, test and monitor reports are left out and counted, or become plots that say so.
#[test]
fn artificial_reports_are_dropped_or_marked() {
    let mut blocks = Recorder { dialect: Dialect::Monoradar, ..Recorder::default() }.blocks(TURNS);
    // The same report with SIM, RAB, and TST in the first extension.
    let artificial: [&[u8]; 3] = [&[0x30], &[0x22], &[0x21, 0x80]];
    for descriptor in artificial {
        let report = [&[0xf0, 0, 7, 0x46, 0x63, 0x90][..], descriptor, &[0x01, 0x00, 0x20, 0x00]].concat();
        blocks.push(block(48, &report));
    }
    let plots = |chain: &ChainConfig| {
        let source = open(chain, &blocks.concat()).expect("a recording");
        let rejected = source.rejected().of(common::health::Reject::FixedMonitor);
        let marked = messages(source).flat_map(|(_, plots)| plots).filter(|plot| plot.has(ARTIFICIAL)).count();
        (rejected, marked)
    };
    assert_eq!(plots(&coarse()), (3, 0));
    let mut chain = coarse();
    chain.plot_source.use_simulated = true;
    chain.plot_source.use_test = true;
    assert_eq!(plots(&chain), (1, 2));
    chain.plot_source.use_monitors = true;
    assert_eq!(plots(&chain), (0, 3));
}

/// The plots of a radar as a table give the tracks of its recording; so do those of which only the scan's time is known.
#[test]
fn tables_of_plots_give_the_same_tracks() {
    let bytes = Recorder::default().blocks(TURNS).concat();
    let plots: Vec<_> = messages(open(&chain(), &bytes).expect("a recording")).flat_map(|(_, plots)| plots).collect();
    let table = |time_s: fn(f64) -> f64| {
        let rows = plots.iter().map(|plot| {
            let time_s = time_s((plot.time_ns - synthetic::MIDNIGHT_NS) as f64 * 1e-9);
            format!("{time_s},{},{}\n", plot.range_m, plot.azimuth_rad.to_degrees())
        });
        format!("time_s,range_m,azimuth_deg\n{}", rows.collect::<String>())
    };
    for (time_s, note) in
        [(|time_s| time_s, "no north markers"), (f64::floor, "the antenna stands")] as [(fn(f64) -> f64, &str); 2]
    {
        let source = open(&chain(), table(time_s).as_bytes()).expect("a table");
        assert!(source.notes().iter().any(|text| text.contains(note)), "{:?}", source.notes());
        assert!(source.exit_code() == std::process::ExitCode::SUCCESS);
        assert_eq!(confirmed(source, &TrackerConfig::default()).len(), 5, "{note}");
    }
    let damaged = table(|time_s| time_s).replacen(",9", ",x", 1);
    let source = open(&chain(), damaged.as_bytes()).expect("a table");
    assert!(source.notes().iter().any(|note| note.contains("1 lines could not be read")), "{:?}", source.notes());
    assert_eq!(source.rejected().of(common::health::Reject::BadPlot), 1);
}

/// An antenna that turns the other way is said; every north marker of the recording is right.
#[test]
fn a_recording_of_an_antenna_that_turns_back_is_said() {
    let mut blocks = Recorder { dialect: Dialect::Monoradar, ..Recorder::default() }.blocks(TURNS);
    let says = |blocks: &[Vec<u8>]| {
        let source = open(&coarse(), &blocks.concat()).expect("a recording");
        source.notes().iter().any(|note| note.contains("counter-clockwise"))
    };
    assert!(!says(&blocks));
    for report in blocks.iter_mut().filter(|block| block[0] == 48) {
        let azimuth = u16::from_be_bytes([report[12], report[13]]).wrapping_neg();
        report.splice(12.., azimuth.to_be_bytes());
    }
    assert!(says(&blocks));
}

/// A line whose time is years from the others costs neither memory nor time, wherever it stands.
#[test]
fn a_table_may_have_a_line_of_another_year() {
    for turns in [2, 60] {
        for stray_s in [1.0, 2.9e9] {
            let mut lines = vec!["time_s,range_m,azimuth_deg".to_string()];
            let begin_s = 1_714_867_200;
            lines.extend((0..turns).map(|turn| format!("{},{},90", begin_s + turn, 5000 + 10 * turn)));
            lines.push(format!("{stray_s},5000,90"));
            let source = open(&coarse(), lines.join("\n").as_bytes()).expect("a table");
            assert!(source.scans() < 200, "{turns} {stray_s}: {} scans", source.scans());
        }
    }
}
