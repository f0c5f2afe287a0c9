//! Clocks that are set, pauses, turns that take other times than configured: measurement time never goes back, and the
//! tracker follows the same five targets before, during and after.

mod synthetic;

use std::collections::BTreeSet;

use common::config::TrackerConfig;
use common::message::END_OF_SCAN;
use common::tracks::{CONFIRMED, Track};
use plot_source::Source;
use synthetic::{MIDNIGHT_NS, Recorder, chain, messages, open};
use tracker::Tracker;

/// Turns after which all targets are tracked.
const TO_CONFIRM: u32 = 8;
/// The clock at the start, s of the day.
const START_S: f64 = 36_000.0;

/// What the tracker made of a recording: the numbers of all confirmed tracks, and how many there were after each scan.
struct Followed {
    numbers: BTreeSet<u64>,
    confirmed: Vec<u32>,
}

fn source(recorder: &Recorder, turns: u32) -> Source {
    open(&chain(), &recorder.blocks(turns).concat()).expect("a recording")
}

fn follow(source: Source) -> Followed {
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("a valid configuration");
    let mut followed = Followed { numbers: BTreeSet::new(), confirmed: Vec::new() };
    let mut tracks: Vec<Track> = Vec::new();
    let mut last_ns = 0;
    for (header, plots) in messages(source) {
        assert!(header.time_ns > last_ns, "measurement time goes on");
        last_ns = header.time_ns;
        let begin_ns = header.time_ns as f64 - header.scan_period_s * 1e9;
        assert!(plots.iter().all(|plot| {
            (begin_ns..header.time_ns as f64 + header.scan_period_s * 1e8).contains(&(plot.time_ns as f64))
        }));
        let processed = tracker.process_plots(&header, &plots, &mut tracks);
        followed.numbers.extend(tracks.iter().filter(|track| track.state_code == CONFIRMED).map(|track| track.id));
        if header.has(END_OF_SCAN) {
            followed.confirmed.push(processed.confirmed);
        }
    }
    followed
}

/// The five targets have five tracks from the first turns to the last, and there are no others.
#[track_caller]
fn assert_followed(source: Source, turns: u32) {
    let notes = source.notes().join("\n");
    let followed = follow(source);
    assert_eq!(followed.confirmed.len(), turns as usize, "{notes}");
    let late = &followed.confirmed[TO_CONFIRM as usize..];
    assert!(followed.numbers.len() == 5 && late.iter().all(|&count| count == 5), "{notes}\n{:?}", followed.confirmed);
}

fn has_note(source: &Source, text: &str) -> bool {
    source.notes().iter().any(|note| note.contains(text))
}

#[test]
fn a_clock_that_is_set_is_bridged() {
    for turn_s in [0.8, 1.0, 4.0] {
        for by_s in
            [-20_000.0, -3600.0, -60.0, -5.4, -4.0, -1.0, -0.4, -0.1, 0.1, 0.4, 1.0, 4.0, 5.4, 60.0, 3600.0, 20_000.0]
        {
            for at_turn in [20.0, 20.3, 20.97] {
                let at_s = at_turn * turn_s;
                let clock_s = |true_s: f64| START_S + true_s + if true_s < at_s { 0.0 } else { by_s };
                let recorder = Recorder { turn_s: &|_| turn_s, clock_s: &clock_s, ..Recorder::default() };
                let source = source(&recorder, 40);
                let said = format!("clock steps 1: {by_s:+.1}");
                let found = source.notes().iter().any(|note| note.contains(&said[..said.len() - 1]));
                assert!(found, "{turn_s} s a turn, set by {by_s} s at turn {at_turn}: {:?}", source.notes());
                assert_followed(source, 40);
            }
        }
    }
}

#[test]
fn every_step_is_counted() {
    let clock_s = |true_s: f64| START_S + true_s - 2.3 * (true_s / 10.0).floor();
    let source = source(&Recorder { clock_s: &clock_s, ..Recorder::default() }, 60);
    assert!(has_note(&source, "clock steps 5: -2."), "{:?}", source.notes());
    assert_followed(source, 60);
}

#[test]
fn leap_seconds_and_midnight_are_no_news_for_tracks() {
    let to_midnight = |true_s: f64| 86_380.0 + true_s;
    let midnight = |true_s: f64| to_midnight(true_s) % 86_400.0;
    let inserted = |true_s: f64| {
        let time_s = to_midnight(true_s);
        if time_s < 86_401.0 { time_s } else { time_s - 86_401.0 }
    };
    let repeated =
        |true_s: f64| if to_midnight(true_s) < 86_400.0 { to_midnight(true_s) } else { midnight(true_s - 1.0) };
    let clocks: [(&dyn Fn(f64) -> f64, bool); 3] = [(&midnight, false), (&inserted, true), (&repeated, true)];
    for (clock_s, steps) in clocks {
        let source = source(&Recorder { clock_s, ..Recorder::default() }, 40);
        assert_eq!(has_note(&source, "clock steps 1: -1.0"), steps, "{:?}", source.notes());
        assert_eq!(source.notes().is_empty(), !steps);
        let (last, _) = messages(source).last().expect("messages");
        assert_eq!(last.time_ns, MIDNIGHT_NS + (86_380 + 40) * 1_000_000_000);
        assert_followed(self::source(&Recorder { clock_s, ..Recorder::default() }, 40), 40);
    }
}

#[test]
fn the_turn_is_that_of_the_messages() {
    type Turn<'a> = &'a dyn Fn(u32) -> f64;
    let turns: [Turn; 4] =
        [&|_| 4.0, &|_| 0.5, &|turn| if turn < 20 { 1.0 } else { 2.5 }, &|turn| 1.0 + 0.05 * f64::from(turn)];
    for turn_s in turns {
        let source = source(&Recorder { turn_s, ..Recorder::default() }, 45);
        assert!(has_note(&source, "`plot_source.scan_period_s` says 1"), "{:?}", source.notes());
        assert!(!has_note(&source, "clock steps") && !has_note(&source, "pauses"), "{:?}", source.notes());
        assert_followed(source, 45);
    }
}

#[test]
fn reports_without_time_have_that_of_the_antenna() {
    let source = source(&Recorder { has_times: false, ..Recorder::default() }, 40);
    assert!(has_note(&source, "reports without time 200"), "{:?}", source.notes());
    assert_followed(source, 40);
}

/// Half an hour without a byte: the tracks end, new ones begin; a few turns: they live on.
#[test]
fn tracks_end_in_a_long_pause() {
    for paused in [3, 1800] {
        let recorder = Recorder { recorded: &|turn| !(20..20 + paused).contains(&turn), ..Recorder::default() };
        let source = source(&recorder, 40 + paused);
        assert!(has_note(&source, &format!("pauses 1: {paused}.0")), "{:?}", source.notes());
        assert!(!has_note(&source, "clock steps"), "{:?}", source.notes());
        let followed = follow(source);
        let resumed = followed.confirmed.len() - 20;
        if paused == 3 {
            assert_eq!((followed.numbers.len(), followed.confirmed[resumed]), (5, 5), "{:?}", followed.confirmed);
        } else {
            assert_eq!((followed.numbers.len(), followed.confirmed[resumed]), (10, 0), "{:?}", followed.confirmed);
        }
    }
}

/// As a table of times of the day, in the order in which the plots were made.
fn table(recorder: &Recorder, turns: u32) -> Source {
    let true_clock = Recorder { clock_s: &|true_s| true_s, has_service: true, ..*recorder };
    let whole = open(&chain(), &true_clock.blocks(turns).concat()).expect("a recording");
    let mut plots: Vec<_> = messages(whole).flat_map(|(_, plots)| plots).collect();
    plots.sort_by_key(|plot| plot.time_ns);
    let row = |plot: &common::plots::Plot| {
        let time_s = (recorder.clock_s)((plot.time_ns - MIDNIGHT_NS) as f64 * 1e-9);
        format!("{time_s},{},{}\n", plot.range_m, plot.azimuth_rad.to_degrees())
    };
    let rows: String = plots.iter().map(row).collect();
    open(&chain(), format!("time_s,range_m,azimuth_deg\n{rows}").as_bytes()).expect("a table")
}

/// Without north markers the turn is found again after a step of the clock, in ASTERIX as in tables.
#[test]
fn a_clock_that_is_set_is_bridged_without_north_markers() {
    for turn_s in [1.0, 2.5, 4.0] {
        for by_turns in [-900.4, -25.6, -15.05, -0.5, -0.3, 0.35, 0.5, 900.4] {
            for at_turn in [30.0, 30.3, 30.97] {
                let (at_s, by_s) = (at_turn * turn_s, by_turns * turn_s);
                let clock_s = |true_s: f64| START_S + true_s + if true_s < at_s { 0.0 } else { by_s };
                let turn = |_| turn_s;
                let recorder = Recorder { turn_s: &turn, clock_s: &clock_s, has_service: false, ..Recorder::default() };
                for source in [source(&recorder, 60), table(&recorder, 60)] {
                    let scene = format!("{turn_s} s a turn, set by {by_s} s at turn {at_turn}: {:?}", source.notes());
                    assert!(has_note(&source, "clock steps 1: "), "{scene}");
                    assert_eq!(source.rejected().total(), 0, "{scene}");
                    let followed = follow(source);
                    assert!(followed.confirmed.len().abs_diff(60) <= 1, "{scene}: {}", followed.confirmed.len());
                    let late = &followed.confirmed[TO_CONFIRM as usize..];
                    assert!(followed.numbers.len() == 5 && late.iter().all(|&count| count == 5), "{scene}: {late:?}");
                }
            }
        }
    }
}

/// Times of the day in a table go on over midnight.
#[test]
fn a_table_passes_midnight() {
    let clock_s = |true_s: f64| (86_380.0 + true_s) % 86_400.0;
    let source = table(&Recorder { clock_s: &clock_s, ..Recorder::default() }, 40);
    assert!(!has_note(&source, "clock steps") && !has_note(&source, "pauses"), "{:?}", source.notes());
    let (last, _) =
        messages(table(&Recorder { clock_s: &clock_s, ..Recorder::default() }, 40)).last().expect("messages");
    let end_ns = MIDNIGHT_NS + (86_380 + 40) * 1_000_000_000;
    assert!(last.time_ns.abs_diff(end_ns) < 2_000_000_000, "{}", last.time_ns);
    assert_followed(source, 40);
}
