//! Antennas that do not turn clockwise.

mod harness;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use common::config::TrackerConfig;
use common::plots::{Plot, PlotsHeader};
use common::tracks::Track;
use common::turning::Turning as Antenna;
use harness::{EPOCH_NS, FLEET, SECTORS, Target, Turning, messages};
use nalgebra::Vector3;
use tracker::Tracker;

type Stream = Vec<(PlotsHeader, Vec<Plot>)>;

fn run(stream: &Stream) -> Vec<Vec<Track>> {
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("a valid configuration");
    let mut tracks = Vec::new();
    let each = stream.iter().map(|(header, plots)| {
        assert_eq!(tracker.process_plots(header, plots, &mut tracks).rejected.total(), 0);
        tracks.clone()
    });
    each.collect()
}

/// What a radar tells that turns the other way and sees the mirrored world.
fn mirrored(mut stream: Stream) -> Stream {
    for (header, plots) in &mut stream {
        header.flags |= Antenna::CounterClockwise.flags();
        for plot in plots {
            plot.azimuth_rad = (TAU - plot.azimuth_rad).rem_euclid(TAU);
        }
    }
    stream
}

fn hovering(_: f64) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(1200.0, -700.0, 150.0), Vector3::zeros())
}

fn hovering_mirrored(_: f64) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(-1200.0, -700.0, 150.0), Vector3::zeros())
}

fn across_north(time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
    let velocity = Vector3::new(20.0, 0.0, 0.0);
    (Vector3::new(-300.0, 900.0, 100.0) + velocity * time_s, velocity)
}

fn back_across_north(time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
    let velocity = Vector3::new(-20.0, 3.0, 0.0);
    (Vector3::new(300.0, 1500.0, 0.0) + velocity * time_s, velocity)
}

/// Along north, a little to the right and to the left of it.
fn about_north(time_s: f64) -> (Vector3<f64>, Vector3<f64>) {
    let side = if time_s.rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
    (Vector3::new(2.0 * side, 3000.0 - 15.0 * time_s, 0.0), Vector3::new(0.0, -15.0, 0.0))
}

/// The mirrored world gives the mirrored tracks, message by message.
#[test]
fn an_antenna_that_turns_counter_clockwise_gives_the_mirrored_tracks() {
    for full in [true, false] {
        let radar = Turning { full, false_plots: 0, ..Turning::default() };
        let stream = messages(radar, &[across_north, hovering, back_across_north], 40);
        let (usual, other) = (run(&stream), run(&mirrored(stream)));
        let mut compared = 0;
        for (usual, other) in usual.iter().zip(&other) {
            let what = |track: &Track| (track.id, track.state_code, track.hits, track.misses);
            assert_eq!(usual.iter().map(what).collect::<Vec<_>>(), other.iter().map(what).collect::<Vec<_>>());
            for (a, b) in usual.iter().zip(other) {
                let (here, there) = (Vector3::from(a.position_m()), Vector3::from(b.position_m()));
                let distance_m = (Vector3::new(-here.x, here.y, here.z) - there).norm();
                assert!(distance_m < 0.05 && a.time_ns.abs_diff(b.time_ns) < 100_000, "{distance_m} m: {a:?}");
                compared += 1;
            }
        }
        assert!(compared > 3 * 36, "{compared}");
    }
}

/// The same among many targets and false plots, but for bins of the clutter map, which begin at north whichever way the antenna turns.
#[test]
fn a_mirrored_fleet_is_followed_as_well() {
    let stream = messages(Turning::default(), &FLEET, 40);
    let followed = |out: &[Vec<Track>]| {
        let last = &out[out.len() - SECTORS as usize..];
        last.iter().flatten().filter(|track| track.is_confirmed()).count()
    };
    let (usual, other) = (followed(&run(&stream)), followed(&run(&mirrored(stream))));
    assert!(usual > 30 && usual.abs_diff(other) <= 2, "{usual} {other}");
}

/// What an antenna that stands reports, once in a period of 1 s and all at once: places without errors.
fn standing(targets: &[Target], periods: u32) -> Stream {
    let mut stream = Stream::new();
    for (mut header, _) in messages(Turning { full: false, false_plots: 0, ..Turning::default() }, &[], periods) {
        header.flags |= Antenna::Standing.flags();
        let is_last = header.sector + 1 == SECTORS;
        (header.covered_from_rad, header.covered_to_rad) = (0.0, if is_last { TAU } else { 0.0 });
        let time_s = f64::from(header.scan) + 0.5;
        let plot = |target: &Target| {
            let (place, _) = target(time_s);
            Plot {
                time_ns: EPOCH_NS + (time_s * 1e9) as u64,
                range_m: place.norm(),
                azimuth_rad: place.x.atan2(place.y).rem_euclid(TAU),
                sigma_range_m: 10.0,
                sigma_azimuth_rad: 0.002,
                cell_count: 1,
                ..Plot::default()
            }
        };
        let plots = if header.sector == SECTORS / 2 { targets.iter().map(plot).collect() } else { Vec::new() };
        stream.push((header, plots));
    }
    stream
}

/// North is no special place for an antenna that stands: one track for each target, updated once in each period.
#[test]
fn an_antenna_that_stands_gives_a_track_for_each_target() {
    let targets: [Target; 4] = [across_north, back_across_north, about_north, hovering];
    let out = run(&standing(&targets, 60));
    let mut times: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
    for track in out.iter().flatten() {
        assert_eq!(track.misses, 0, "{track:?}");
        times.entry(track.id).or_default().push(track.time_ns);
    }
    assert_eq!(times.len(), targets.len(), "{times:?}");
    for times in times.values() {
        assert_eq!(times.len(), 59);
        assert!(times.windows(2).all(|pair| (pair[1] - pair[0]).abs_diff(1_000_000_000) < 10_000_000), "{times:?}");
    }
    assert!(out.iter().enumerate().all(|(message, tracks)| tracks.is_empty() || message % 32 == 31));
}

/// Tracks live on where an antenna goes on turning the other way, or stops and sees all.
#[test]
fn tracks_go_on_where_the_antenna_turns_otherwise() {
    let radar = Turning { full: false, false_plots: 0, ..Turning::default() };
    let clockwise = messages(radar, &[hovering], 60);
    let counter = mirrored(messages(radar, &[hovering_mirrored], 60));
    let still = standing(&[hovering], 60);
    let changes = [(&clockwise, &counter), (&counter, &clockwise), (&clockwise, &still), (&still, &counter)];
    for (nth, (before, after)) in changes.into_iter().enumerate() {
        let stream: Stream = before
            .iter()
            .filter(|it| it.0.scan < 30)
            .chain(after.iter().filter(|it| it.0.scan >= 30))
            .cloned()
            .collect();
        let out = run(&stream);
        let numbers: BTreeSet<u64> = out.iter().flatten().map(|track| track.id).collect();
        assert_eq!(numbers.len(), 1, "change {nth}: {numbers:?}");
        let last = out.iter().flatten().next_back().expect("a track");
        assert!(last.is_confirmed() && last.hits >= 55, "change {nth}: {last:?}");
    }
}
