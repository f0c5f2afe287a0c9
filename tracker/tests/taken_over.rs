//! A tracker that dies and is started again: its confirmed tracks go on under their numbers, by every family, and end where that is right.

mod harness;

use std::collections::BTreeMap;

use common::config::{Association, Estimator, TrackerConfig};
use common::plots::{Plot, PlotsHeader};
use common::tracks::{TERMINATED, Track};
use harness::{FLEET, SECTORS, Target, Turning, messages};
use nalgebra::Vector3;
use tracker::Tracker;

/// Number of the first track of the tracker that is started again.
const NEXT: u64 = 1_000_001;

/// In three directions, north among them; the second target turns gently.
const TARGETS: [Target; 3] = [
    |t| (Vector3::new(20.0 - 6.0 * t, 1500.0, 120.0), Vector3::new(-6.0, 0.0, 0.0)),
    |t| {
        let (sine, cosine) = (0.01 * t).sin_cos();
        (Vector3::new(-3500.0 + 1500.0 * cosine, 900.0 + 1500.0 * sine, 200.0), 15.0 * Vector3::new(-sine, cosine, 0.0))
    },
    |t| (Vector3::new(1500.0, -1800.0 + 5.0 * t, 250.0), Vector3::new(0.0, 5.0, 0.0)),
];

type Messages = Vec<(PlotsHeader, Vec<Plot>)>;

/// What was last told of each track that is alive.
fn follow(tracker: &mut Tracker, messages: &[(PlotsHeader, Vec<Plot>)], last: &mut BTreeMap<u64, Track>) {
    let mut told = Vec::new();
    for (header, plots) in messages {
        tracker.process_plots(header, plots, &mut told);
        for track in &told {
            if track.state_code == TERMINATED {
                last.remove(&track.id)
            } else {
                last.insert(track.id, *track)
            };
        }
    }
}

fn confirmed(tracks: &BTreeMap<u64, Track>) -> BTreeMap<u64, Track> {
    tracks.iter().filter(|(_, track)| track.is_confirmed()).map(|(id, track)| (*id, *track)).collect()
}

/// The confirmed tracks after these messages.
fn confirmed_by(config: &TrackerConfig, messages: &[(PlotsHeader, Vec<Plot>)]) -> BTreeMap<u64, Track> {
    let mut last = BTreeMap::new();
    follow(&mut Tracker::new(config, 1).expect("valid"), messages, &mut last);
    confirmed(&last)
}

/// The confirmed tracks at the end, with and without a tracker that dies after `dies` messages and one that begins after `again`.
fn with_and_without(
    config: &TrackerConfig,
    messages: &Messages,
    dies: usize,
    again: usize,
) -> [BTreeMap<u64, Track>; 2] {
    let undisturbed = confirmed_by(config, messages);
    let mut last = BTreeMap::new();
    follow(&mut Tracker::new(config, 1).expect("valid"), &messages[..dies], &mut last);
    let mut next = Tracker::new(config, NEXT).expect("valid");
    next.take_over(last.values().copied().collect());
    follow(&mut next, &messages[again..], &mut last);
    [undisturbed, confirmed(&last)]
}

/// Distance of two positions in standard deviations of the first.
fn distance(a: &Track, b: &Track) -> f64 {
    use common::tracks::pack;
    (0..3)
        .map(|axis| (a.state[3 * axis] - b.state[3 * axis]).powi(2) / a.covariance[pack(3 * axis, 3 * axis)])
        .sum::<f64>()
        .sqrt()
}

#[test]
fn tracks_of_every_family_go_on_under_their_numbers() {
    let plots = messages(Turning { false_plots: 10, ..Turning::default() }, &TARGETS, 45);
    let sectors = SECTORS as usize;
    for estimator in Estimator::ALL {
        for association in [Association::PdaStatistics, Association::Mht] {
            let config = TrackerConfig { estimator, association, ..TrackerConfig::default() };
            // In a sector of no track, of the first track, and two turns later in the middle of a turn.
            for (dies, again) in [
                (30 * sectors + 3, 30 * sectors + 4),
                (30 * sectors, 30 * sectors + 1),
                (30 * sectors + 3, 32 * sectors + 20),
            ] {
                let what = format!("{estimator:?} {association:?}, {dies} to {again}");
                let [undisturbed, taken_over] = with_and_without(&config, &plots, dies, again);
                assert_eq!(undisturbed.len(), TARGETS.len(), "{what}");
                let numbers = |tracks: &BTreeMap<u64, Track>| tracks.keys().copied().collect::<Vec<_>>();
                assert_eq!(numbers(&taken_over), numbers(&undisturbed), "{what}");
                for (id, track) in &undisturbed {
                    let other = &taken_over[id];
                    assert!(distance(track, other) < 1.0, "{what}: {id} {}", distance(track, other));
                    assert_eq!(other.age_scans, track.age_scans, "{what}: {id}");
                    assert!(other.hits + 3 >= track.hits && other.existence > 0.99, "{what}: {id} {other:?}");
                }
            }
        }
    }
}

/// Forty targets in pairs, many due at once: all tracks are there a turn later, and no other is confirmed.
#[test]
fn a_fleet_goes_on() {
    let plots = messages(Turning::default(), &FLEET, 32);
    let split = 30 * SECTORS as usize;
    let config = TrackerConfig::default();
    let before = confirmed_by(&config, &plots[..split]);
    assert!(before.len() > 35, "{}", before.len());
    let mut next = Tracker::new(&config, NEXT).expect("valid");
    next.take_over(before.values().copied().collect());
    let mut after = BTreeMap::new();
    follow(&mut next, &plots[split..], &mut after);
    let numbers = |tracks: &BTreeMap<u64, Track>| tracks.keys().copied().collect::<Vec<_>>();
    assert_eq!(numbers(&confirmed(&after)), numbers(&before));
}

/// As every track whose target is not seen for so long.
#[test]
fn tracks_end_after_a_long_absence_and_say_so() {
    let plots = messages(Turning::default(), &TARGETS, 60);
    let sectors = SECTORS as usize;
    let config = TrackerConfig::default();
    let again = (30 + config.confirmed_misses as usize + 2) * sectors;
    let before = confirmed_by(&config, &plots[..30 * sectors]);
    assert_eq!(before.len(), TARGETS.len());
    let mut next = Tracker::new(&config, NEXT).expect("valid");
    next.take_over(before.values().copied().collect());
    let (mut told, mut ended) = (Vec::new(), Vec::new());
    for (header, plots) in &plots[again..] {
        next.process_plots(header, plots, &mut told);
        ended.extend(
            told.iter().filter(|track| track.state_code == TERMINATED && track.id < NEXT).map(|track| track.id),
        );
    }
    ended.sort_unstable();
    assert_eq!(ended, before.keys().copied().collect::<Vec<_>>());
    assert_eq!(next.tracks().iter().filter(|track| track.life.is_confirmed()).count(), TARGETS.len());
}

#[test]
fn foreign_tracks_are_left() {
    let plots = messages(Turning::default(), &TARGETS, 31);
    let split = 30 * SECTORS as usize;
    let config = TrackerConfig::default();
    let before = confirmed_by(&config, &plots[..split]);
    let after = |change: &dyn Fn(&mut Track)| {
        let mut tracks: Vec<Track> = before.values().copied().collect();
        tracks.iter_mut().for_each(change);
        let mut next = Tracker::new(&config, NEXT).expect("valid");
        next.take_over(tracks);
        let mut told = Vec::new();
        let (header, plots) = &plots[split];
        next.process_plots(header, plots, &mut told).confirmed as usize
    };
    assert_eq!(after(&|_| {}), before.len());
    assert_eq!(after(&|track| track.estimator += 1), 0, "another family's");
    assert_eq!(after(&|track| track.id += NEXT), 0, "numbers that this tracker will give");
    assert_eq!(after(&|track| track.time_ns += 3_600_000_000_000), 0, "an hour ahead: another recording");
    assert_eq!(after(&|track| track.state[0] = f64::NAN), 0, "no position");
    assert_eq!(after(&|track| track.covariance[0] = -1.0), 0, "no covariance");
    assert_eq!(after(&|track| track.state_code = common::tracks::TENTATIVE), 0, "not believed");
}
