//! The tracker as a whole, over turns of a simulated radar without cells.

mod harness;

use std::collections::{BTreeMap, BTreeSet};

use common::config::{Association, Clutter, GateRule, Logic, TrackerConfig};
use common::health::Reject;
use common::plots::{Plot, PlotsHeader};
use common::tracks::{STATE, TERMINATED, Track, pack};
use harness::{EPOCH_NS, FLEET, SECTORS, Target, Turning, messages};
use nalgebra::Vector3;
use pulp::Arch;
use tracker::Tracker;
use tracker::filter::Machine;

type Stream = Vec<(PlotsHeader, Vec<Plot>)>;

/// All tracks that each message brought up to date.
fn run(config: &TrackerConfig, stream: &Stream) -> Vec<Vec<Track>> {
    follow(Tracker::new(config, 1).expect("valid"), stream)
}

fn follow(mut tracker: Tracker, stream: &Stream) -> Vec<Vec<Track>> {
    let mut tracks = Vec::new();
    stream
        .iter()
        .map(|(header, plots)| {
            tracker.process_plots(header, plots, &mut tracks);
            tracks.clone()
        })
        .collect()
}

/// Distances between confirmed tracks and a target by track id, at the tracks' own times.
fn distances(out: &[Vec<Track>], target: Target) -> BTreeMap<u64, Vec<f64>> {
    let mut all: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for track in out.iter().flatten().filter(|track| track.is_confirmed()) {
        let time_s = (track.time_ns as f64 - EPOCH_NS as f64) / 1e9;
        let error = Vector3::from(track.position_m()) - target(time_s).0;
        all.entry(track.id).or_default().push(error.norm());
    }
    all
}

fn straight(from: [f64; 3], velocity: [f64; 3], t: f64) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::from(from) + Vector3::from(velocity) * t, Vector3::from(velocity))
}

fn eastward_across_north(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    straight([-300.0, 900.0, 100.0], [20.0, 0.0, 0.0], t)
}
fn westward_across_north(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    straight([300.0, 900.0, 100.0], [-20.0, 0.0, 0.0], t)
}
fn hovering(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    straight([1200.0, -700.0, 150.0], [0.0; 3], t)
}
fn close_past_the_antenna(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    straight([-450.0, 60.0, 40.0], [15.0, 0.0, 0.0], t)
}

#[test]
fn one_track_per_target_once_per_turn() {
    for target in [eastward_across_north, westward_across_north, hovering, close_past_the_antenna] {
        let radar = Turning { false_plots: 0, ..Turning::default() };
        let out = run(&TrackerConfig::default(), &messages(radar, &[target], 60));
        let found = distances(&out, target);
        assert_eq!(found.len(), 1, "{found:?}");
        let times: Vec<u64> = out.iter().flatten().map(|track| track.time_ns).collect();
        assert!(times.len() >= 57, "{} updates in 60 turns", times.len());
        for pair in times.windows(2) {
            let step_s = (pair[1] as f64 - pair[0] as f64) / 1e9;
            assert!(step_s > 0.5 && step_s < 1.5, "a turn of {step_s} s");
        }
        let worst = found.values().flatten().copied().fold(0.0, f64::max);
        assert!(worst < 40.0, "{worst} m");
    }
}

#[test]
fn tracks_go_out_with_the_sector_that_completes_their_gates() {
    let stream = messages(Turning::default(), &[hovering], 40);
    for ((header, _), tracks) in stream.iter().zip(run(&TrackerConfig::default(), &stream)) {
        for track in tracks.iter().filter(|track| track.is_confirmed() && track.hits > 6 && track.misses == 0) {
            let late_s = (header.time_ns as f64 - track.time_ns as f64) / 1e9;
            assert!((0.0..2.5 / f64::from(SECTORS)).contains(&late_s), "{late_s} s behind the beam");
        }
    }
}

#[test]
fn targets_among_false_plots_and_nothing_else() {
    let radar = Turning { fluctuates: true, snr: 300.0, false_plots: 25, ..Turning::default() };
    let targets: [Target; 3] = [eastward_across_north, hovering, close_past_the_antenna];
    let out = run(&TrackerConfig::default(), &messages(radar, &targets, 60));
    let mut ids = BTreeMap::new();
    for target in targets {
        let near = distances(&out, target)
            .into_iter()
            .filter(|(_, errors)| errors.iter().sum::<f64>() / (errors.len() as f64) < 60.0);
        for (id, errors) in near {
            ids.insert(id, errors.len());
        }
    }
    let confirmed = out.iter().flatten().filter(|track| track.is_confirmed()).map(|track| track.id);
    assert!(confirmed.clone().all(|id| ids.contains_key(&id)), "false tracks");
    assert!(ids.len() == 3 && ids.values().all(|&scans| scans > 50), "{ids:?}");
}

#[test]
fn every_rule_and_the_planar_radar_hold_their_target() {
    let default = TrackerConfig::default();
    let variants = [
        TrackerConfig { gate_rule: GateRule::Widest, ..default.clone() },
        TrackerConfig { gate_rule: GateRule::Union, ..default.clone() },
        TrackerConfig { association: Association::Pda, ..default.clone() },
        TrackerConfig { association: Association::Nearest, ..default.clone() },
        TrackerConfig { association: Association::Strongest, ..default.clone() },
        TrackerConfig { association: Association::Mht, ..default.clone() },
        TrackerConfig { logic: Logic::MOfN, ..default.clone() },
        TrackerConfig { joint_association: false, ..default },
    ];
    for config in variants {
        for full in [true, false] {
            let radar = Turning { full, false_plots: 5, ..Turning::default() };
            let flat: Target = |t| straight([900.0, 600.0, 0.0], [-12.0, 5.0, 0.0], t);
            let out = run(&config, &messages(radar, &[flat], 40));
            let longest = distances(&out, flat).into_values().map(|errors| errors.len()).max();
            assert!(longest > Some(30), "{config:?} full {full}: {longest:?}");
            if !full {
                assert!(
                    out.iter().flatten().all(|track| track.position_m()[2] == 0.0 && track.velocity_mps()[2] == 0.0)
                );
            }
        }
    }
}

#[test]
fn the_order_of_plots_in_a_message_does_not_matter_and_runs_repeat() {
    let targets = [&FLEET[..], &[hovering, eastward_across_north]].concat();
    let stream = messages(Turning { false_plots: 400, ..Turning::default() }, &targets, 20);
    let reordered = |reorder: fn(&mut [Plot])| {
        let mut stream = stream.clone();
        for (_, plots) in &mut stream {
            reorder(plots);
        }
        stream
    };
    let by_azimuth = reordered(|plots| plots.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad)));
    let by_range = reordered(|plots| plots.sort_by(|a, b| a.range_m.total_cmp(&b.range_m)));
    let reversed = reordered(<[Plot]>::reverse);
    let config = TrackerConfig::default();
    let same = |a: &[Vec<Track>], b: &[Vec<Track>]| {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| {
            // The indices of plots are the only thing that may follow the order.
            let weights = |track: &Track| track.used.map(|used| (used.weight.to_bits(), used.gates));
            weights(a) == weights(b) && *a == Track { best_plot_index: a.best_plot_index, used: a.used, ..*b }
        })
    };
    let once = run(&config, &stream);
    assert_eq!(once, run(&config, &stream));
    for stream in [by_azimuth, by_range, reversed] {
        assert!(same(&once, &run(&config, &stream)));
    }
}

/// One lane after the other or eight at once, pairs that share their plots included.
#[test]
fn tracks_are_the_same_whatever_the_width_of_vectors() {
    let radar = Turning { fluctuates: true, snr: 300.0, false_plots: 200, ..Turning::default() };
    let stream = messages(radar, &FLEET, 60);
    let default = TrackerConfig::default();
    let variants = [
        TrackerConfig { association: Association::Pda, clutter: Clutter::NonParametric, ..default.clone() },
        TrackerConfig { gate_rule: GateRule::MostProbable, ..default.clone() },
        TrackerConfig { joint_association: false, ..default.clone() },
        default,
    ];
    for config in variants {
        let tracker = || Tracker::new(&config, 1).expect("valid");
        let (grouped, single) = (follow(tracker(), &stream), follow(tracker().on(Machine::on(Arch::Scalar)), &stream));
        let confirmed = |tracks: &Vec<Track>| tracks.iter().filter(|track| track.is_confirmed()).count();
        assert!(grouped.iter().any(|tracks| confirmed(tracks) > 20), "{config:?}");
        assert_eq!(
            grouped.iter().map(Vec::len).collect::<Vec<usize>>(),
            single.iter().map(Vec::len).collect::<Vec<usize>>()
        );
        for (a, b) in grouped.iter().flatten().zip(single.iter().flatten()) {
            let facts = |track: &Track| (track.id, track.state_code, track.gate_code, track.plots_in_gate, track.hits);
            assert_eq!(facts(a), facts(b));
            assert!(a.time_ns.abs_diff(b.time_ns) <= 2, "{} {}", a.time_ns, b.time_ns);
            assert_eq!((a.best_plot_seq, a.best_plot_index), (b.best_plot_seq, b.best_plot_index));
            // A pass agrees to 10⁻¹² (`batch`); rounding, and a nanosecond in the time of a passage, grow from scan to scan.
            let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-6 * (b.abs() + scale);
            for i in 0..STATE {
                let deviation = b.covariance[pack(i, i)].sqrt();
                assert!(close(a.state[i], b.state[i], deviation), "{} {} {i}", a.id, a.time_ns);
                for j in i..STATE {
                    let scale = deviation * b.covariance[pack(j, j)].sqrt();
                    assert!(close(a.covariance[pack(i, j)], b.covariance[pack(i, j)], scale), "{} {i} {j}", a.id);
                }
            }
            let numbers = |track: &Track| [track.existence, track.weight_none, track.weight_best, track.snr_db.into()];
            for (a, b) in numbers(a).into_iter().zip(numbers(b)) {
                assert!(close(a, b, 1.0), "{a} {b}");
            }
        }
    }
}

#[test]
fn late_lost_and_impossible_input_is_survived() {
    let mut stream = messages(Turning::default(), &[hovering], 60);
    stream[40].1.push(Plot { range_m: f64::NAN, ..Plot::default() });
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("valid");
    let mut tracks = Vec::new();
    let (mut bad, mut late, mut confirmed) = (0, 0, BTreeMap::new());
    for (index, (header, plots)) in stream.iter().enumerate() {
        // Some sectors and five whole turns are lost, one message comes twice.
        if index % 50 == 7 || (20 * 32..25 * 32).contains(&index) {
            continue;
        }
        let taken = tracker.process_plots(header, plots, &mut tracks);
        bad += taken.rejected.of(Reject::BadPlot);
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            *confirmed.entry(track.id).or_insert(0) += 1;
        }
        if index == 100 {
            late = tracker
                .process_plots(header, &[plots.as_slice(), &[Plot::default()]].concat(), &mut tracks)
                .rejected
                .of(Reject::Late);
            assert!(tracks.is_empty());
        }
    }
    assert_eq!((bad, late), (1, 1 + stream[100].1.len() as u64));
    assert_eq!(confirmed.len(), 1, "{confirmed:?}");
    let broken = PlotsHeader { scan_period_s: f64::NAN, ..stream[0].0 };
    assert_eq!(tracker.process_plots(&broken, &[], &mut tracks).rejected.of(Reject::BadHeader), 1);
}

#[test]
fn a_new_session_keeps_the_tracks_and_time_going_back_ends_them() {
    let stream = messages(Turning::default(), &[hovering], 40);
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("valid");
    let mut tracks = Vec::new();
    for (index, (header, plots)) in stream.iter().enumerate() {
        // A restarted source that counts its scans from 0 again.
        let restarted = index >= 20 * 32;
        let header = if restarted {
            PlotsHeader { session: 2, scan: header.scan - 20, seq: header.seq - 20 * 32, ..*header }
        } else {
            *header
        };
        tracker.process_plots(&header, plots, &mut tracks);
    }
    let alive = tracker.tracks().iter().find(|track| track.life.is_confirmed()).expect("kept");
    assert!(alive.life.age >= 38 && alive.life.hits >= 38, "{:?}", alive.life);
    tracker.process_plots(&PlotsHeader { session: 3, ..stream[0].0 }, &[], &mut tracks);
    assert!(!tracks.is_empty() && tracks.iter().all(|track| track.state_code == TERMINATED));
    assert!(tracker.tracks().is_empty());
}

#[test]
fn the_end_of_the_stream_brings_out_what_waits() {
    let just_west_of_north: Target = |t| straight([-2.0, 1500.0, 200.0], [0.0; 3], t);
    let stream = messages(Turning::default(), &[just_west_of_north], 20);
    let out = run(&TrackerConfig::default(), &stream);
    let last = out.last().expect("messages");
    assert!(last.iter().any(Track::is_confirmed), "the last passage is published");
    let end_ns = stream.last().expect("messages").0.time_ns;
    assert!(last.iter().all(|track| end_ns - track.time_ns < 100_000_000));
}

/// The score of a track (T20.6) is its existence: it must not drop a weak target that is detected in half of the scans, and must not
/// follow noise once the target has gone.
#[test]
fn no_visible_target_is_dropped_and_no_lost_one_is_kept() {
    const GONE: u32 = 150;
    let config = TrackerConfig::default();
    let (mut followed, mut dropped, mut kept) = (0, 0, Vec::new());
    for (seed, snr) in (1..=12).flat_map(|seed| [(seed, 20.0), (seed, 60.0)]) {
        let radar = Turning { seed, snr, fluctuates: true, ..Turning::default() };
        let mut stream = messages(radar, &[hovering], GONE + 60);
        let at = hovering(0.0).0;
        for (header, plots) in &mut stream {
            if header.scan >= GONE {
                plots.retain(|plot| (plot.range_m - at.norm()).abs() > 200.0);
            }
        }
        let mut ends = BTreeMap::new();
        for track in run(&config, &stream).iter().flatten().filter(|track| track.is_confirmed()) {
            let scan = (track.time_ns - EPOCH_NS) / 1_000_000_000;
            ends.insert(track.id, scan);
        }
        followed += ends.len();
        dropped += ends.values().filter(|&&scan| scan < u64::from(GONE) - 1).count();
        kept.extend(ends.into_values().filter_map(|scan| scan.checked_sub(u64::from(GONE))));
    }
    assert!(followed >= 24, "{followed} tracks of 24 targets");
    assert!(dropped <= 1, "{dropped} tracks of visible targets dropped");
    assert!(kept.iter().all(|&scans| scans <= 30), "scans that tracks outlived their targets: {kept:?}");
}

/// Share of the scans from the thirtieth on, of twelve runs at F = 10⁻⁴, in which a confirmed track is with its weak target.
fn followed_share(target: Target, snr: f64, fluctuates: bool) -> f64 {
    let (runs, scans, settling) = (12, 120, 30);
    let mut followed = 0;
    for seed in 1..=runs {
        let radar = Turning { seed, snr, fluctuates, pfa: 1e-4, false_plots: 1460, ..Turning::default() };
        let out = run(&TrackerConfig::default(), &messages(radar, &[target], scans));
        let mut turns = BTreeSet::new();
        for track in out.iter().flatten().filter(|track| track.is_confirmed()) {
            let time_s = (track.time_ns as f64 - EPOCH_NS as f64) / 1e9;
            if (Vector3::from(track.position_m()) - target(time_s).0).norm() < 100.0 {
                turns.insert(time_s as u32);
            }
        }
        followed += turns.range(settling..scans).count();
    }
    followed as f64 / f64::from(runs as u32 * (scans - settling))
}

fn outward(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    straight([1200.0, 700.0, 150.0], [12.0, 0.0, 0.0], t)
}

/// 10 dB, D = 0.62, and 8 dB, D = 0.28, where the flying one, too, is without a track for half of the time. Until it has a track,
/// the plots of a hovering target fall into one bin of the clutter map.
#[test]
fn a_weak_target_is_followed_when_it_hovers_as_when_it_flies() {
    let (hovers, flies) = (followed_share(hovering, 10.0, false), followed_share(outward, 10.0, false));
    assert!(hovers > 0.97 && flies > 0.97, "steady: {hovers}, flying {flies}");
    let (hovers, flies) = (followed_share(hovering, 6.3, true), followed_share(outward, 6.3, true));
    assert!(flies > 0.4 && hovers > 0.85 * flies, "fluctuating: {hovers}, flying {flies}");
}

/// λ of a plot of 40 dB is beyond all bounds, so that nothing but sharing keeps others than the target's own track from it.
#[test]
fn strong_targets_among_many_false_plots_keep_one_track_each() {
    let eight: Vec<Target> = FLEET[..16].iter().step_by(2).copied().collect();
    for (targets, snr_db) in [(&[hovering as Target][..], 30), (&[hovering], 40), (&eight, 25), (&eight, 35)] {
        for seed in 1..=3 {
            let snr = 10.0_f64.powf(f64::from(snr_db) / 10.0);
            let radar = Turning { seed, snr, fluctuates: true, pfa: 1e-4, false_plots: 2500, ..Turning::default() };
            let stream = messages(radar, targets, 80);
            let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("valid");
            let (mut tracks, mut ids) = (Vec::new(), BTreeSet::new());
            for (header, plots) in &stream {
                tracker.process_plots(header, plots, &mut tracks);
                ids.extend(tracks.iter().filter(|track| track.is_confirmed()).map(|track| track.id));
            }
            let store = tracker.tracks();
            let confirmed: Vec<usize> = store.alive().filter(|&place| store[place].life.is_confirmed()).collect();
            let case = format!("{} targets, {snr_db} dB, seed {seed}", targets.len());
            assert_eq!(confirmed.len(), targets.len(), "{case}");
            for target in targets {
                let near = |place: &&usize| {
                    let time_s = (store[**place].time_ns as f64 - EPOCH_NS as f64) / 1e9;
                    let position = store.states.posterior(**place).moments().position();
                    (Vector3::from(position) - target(time_s).0).norm() < 40.0
                };
                let own: Vec<u32> = confirmed.iter().filter(near).map(|&place| store[place].life.hits).collect();
                assert!(own.len() == 1 && own[0] > 70, "{case}: {own:?} hits");
            }
            assert!(ids.len() <= targets.len() + targets.len() / 4, "{case}: {} tracks were confirmed", ids.len());
        }
    }
}

/// Scan in which two drones have come together, and in which they part.
const TOGETHER: f64 = 30.0;
const PARTING: f64 = 40.0;

/// Drones that come near each other north of the antenna, fly side by side for ten scans, a quarter of a cell apart, and go on to the other's
/// side, or stay.
fn drone<const SIDE: i32, const STAY: bool>(t: f64) -> (Vector3<f64>, Vector3<f64>) {
    let side = f64::from(SIDE);
    let (apart, closing) = if t < TOGETHER {
        (8.0 + 8.0 * (TOGETHER - t), -8.0)
    } else if t < PARTING || STAY {
        (8.0, 0.0)
    } else {
        (8.0 - 8.0 * (t - PARTING), -8.0)
    };
    (Vector3::new(-400.0 + 12.0 * t, 1500.0 + side * apart, 150.0), Vector3::new(12.0, side * closing, 0.0))
}

/// Numbers of the confirmed tracks by scan.
fn confirmed_by_scan(stream: &Stream) -> BTreeMap<u32, BTreeSet<u64>> {
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("valid");
    let (mut tracks, mut scans) = (Vec::new(), BTreeMap::new());
    for (header, plots) in stream {
        tracker.process_plots(header, plots, &mut tracks);
        let confirmed = tracker.tracks().iter().filter(|track| track.life.is_confirmed()).map(|track| track.id);
        scans.insert(header.scan, confirmed.collect());
    }
    scans
}

/// A radar that gives one plot of two drones within a cell.
fn unresolved(seed: u64) -> Turning {
    Turning { seed, snr: 40.0, fluctuates: true, pfa: 1e-5, false_plots: 250, merges: true, ..Turning::default() }
}

/// Two drones that the radar does not resolve for some fifteen scans give one plot, and keep two tracks.
#[test]
fn drones_that_cross_in_one_cell_keep_their_tracks() {
    let (mut kept, mut others) = (0, 0);
    for seed in 1..=20 {
        let scans = confirmed_by_scan(&messages(unresolved(seed), &[drone::<1, false>, drone::<-1, false>], 65));
        let before = &scans[&25];
        kept += u32::from(before.len() == 2 && *before == scans[&60]);
        others += scans.values().flatten().collect::<BTreeSet<_>>().len() - 2;
    }
    assert!(kept >= 17 && others <= 3, "{kept} of 20 pairs kept their tracks, {others} other tracks");
}

/// Two tracks that were confirmed in different places and have had nothing but plots in common since are one.
#[test]
fn tracks_that_never_part_again_become_one() {
    let mut left = Vec::new();
    for seed in 1..=10 {
        let scans = confirmed_by_scan(&messages(unresolved(seed), &[drone::<1, true>, drone::<-1, true>], 150));
        assert_eq!(scans[&25].len(), 2, "seed {seed}");
        left.push(scans[&148].len());
    }
    assert!(left.iter().all(|&tracks| tracks == 1), "{left:?}");
}
