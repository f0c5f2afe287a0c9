//! Every family of filters under every association rule: the seam holds for whole trackers.

mod harness;

use common::config::{Association, Clutter, Estimator, GateRule, Logic, TrackerConfig};
use common::tracks::{
    ESTIMATOR_ADAPTIVE_BANDWIDTH, ESTIMATOR_ADAPTIVE_GRID, ESTIMATOR_CV, ESTIMATOR_IMM_TURN, ESTIMATOR_IMM_UAV,
    ESTIMATOR_MULTI_ALTERNATIVE, ESTIMATOR_SWITCHING_GRID, KIND_CONSTANT_VELOCITY, KIND_COORDINATED_TURN, KIND_HOVER,
    KIND_MANOEUVRE, KIND_MEAN_ACCELERATION, KIND_NONE, Track, estimator_name, kind_name, pack,
};
use harness::{EPOCH_NS, FLEET, Target, Turning, messages};
use nalgebra::Vector3;
use pulp::Arch;
use tracker::Tracker;
use tracker::filter::Machine;

/// Straight flights, far apart.
const STRAIGHT: [Target; 3] = [
    |t| (Vector3::new(900.0 - 6.0 * t, 1500.0, 120.0), Vector3::new(-6.0, 0.0, 0.0)),
    |t| (Vector3::new(-2000.0, 900.0 + 8.0 * t, 200.0), Vector3::new(0.0, 8.0, 0.0)),
    |t| (Vector3::new(1500.0, -1800.0 + 5.0 * t, 250.0), Vector3::new(0.0, 5.0, 0.0)),
];

/// Tracks of the last scan.
fn last_scan(config: &TrackerConfig, radar: Turning, targets: &[Target], scans: u32) -> Vec<Track> {
    last_scan_on(Machine::default(), config, radar, targets, scans)
}

fn last_scan_on(
    machine: Machine,
    config: &TrackerConfig,
    radar: Turning,
    targets: &[Target],
    scans: u32,
) -> Vec<Track> {
    let mut tracker = Tracker::new(config, 1).expect("valid").on(machine);
    let (mut tracks, mut last) = (Vec::new(), Vec::new());
    for (header, plots) in &messages(radar, targets, scans) {
        tracker.process_plots(header, plots, &mut tracks);
        if header.scan + 1 == scans {
            last.extend(tracks.iter().copied());
        }
    }
    last
}

fn assert_followed(tracks: &[Track], targets: &[Target], axes: usize, what: &str) {
    let confirmed: Vec<&Track> = tracks.iter().filter(|track| track.is_confirmed()).collect();
    assert_eq!(confirmed.len(), targets.len(), "{what}");
    for target in targets {
        let near = |track: &&&Track| {
            let (position, velocity) = target((track.time_ns - EPOCH_NS) as f64 / 1e9);
            let off = |ours: [f64; 3], truth: Vector3<f64>| {
                (0..axes).map(|axis| (ours[axis] - truth[axis]).powi(2)).sum::<f64>().sqrt()
            };
            off(track.position_m(), position) < 30.0 && off(track.velocity_mps(), velocity) < 6.0
        };
        assert_eq!(confirmed.iter().filter(near).count(), 1, "{what}");
    }
}

#[test]
fn every_family_follows_by_every_rule() {
    let default = TrackerConfig::default;
    for estimator in Estimator::ALL {
        for association in [
            Association::PdaStatistics,
            Association::Pda,
            Association::Nearest,
            Association::Strongest,
            Association::Mht,
        ] {
            for (gate_rule, clutter, joint_association) in [
                (GateRule::Union, Clutter::Parametric, true),
                (GateRule::MostProbable, Clutter::Parametric, false),
                (GateRule::Widest, Clutter::NonParametric, true),
            ] {
                let config =
                    TrackerConfig { estimator, association, gate_rule, clutter, joint_association, ..default() };
                let tracks = last_scan(&config, Turning { false_plots: 10, ..Turning::default() }, &STRAIGHT, 40);
                let what = format!("{estimator:?} {association:?} {gate_rule:?} {clutter:?}");
                assert_followed(&tracks, &STRAIGHT, 3, &what);
            }
        }
    }
}

/// Forty targets at once, by the machine's vectors and by vectors of one: the same tracks up to rounding.
#[test]
fn vectors_of_every_family_do_what_one_track_does() {
    for estimator in Estimator::ALL {
        let config = TrackerConfig { estimator, ..TrackerConfig::default() };
        let [vectors, scalars] = [Machine::default(), Machine::on(Arch::Scalar)]
            .map(|machine| last_scan_on(machine, &config, Turning::default(), &FLEET, 30));
        assert_eq!(vectors.len(), scalars.len(), "{estimator:?}");
        assert!(vectors.len() > 20, "{estimator:?}: {}", vectors.len());
        for (a, b) in vectors.iter().zip(&scalars) {
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            assert_eq!((a.id, a.state_code), (b.id, b.state_code), "{estimator:?}");
            assert!(a.state.iter().zip(&b.state).all(|(a, b)| close(*a, *b)), "{estimator:?}: {a:?} {b:?}");
            assert!(a.model_probability.iter().zip(&b.model_probability).all(|(a, b)| close(*a, *b)), "{estimator:?}");
        }
    }
}

/// A radar that measures range and azimuth only: targets in the plane.
#[test]
fn every_family_follows_in_the_plane() {
    let plane: [Target; 2] = [
        |t| (Vector3::new(900.0 - 6.0 * t, 1500.0, 0.0), Vector3::new(-6.0, 0.0, 0.0)),
        |t| (Vector3::new(-2000.0, 900.0 + 8.0 * t, 0.0), Vector3::new(0.0, 8.0, 0.0)),
    ];
    for estimator in Estimator::ALL {
        let config = TrackerConfig { estimator, logic: Logic::MOfN, ..TrackerConfig::default() };
        let radar = Turning { full: false, false_plots: 3, ..Turning::default() };
        let tracks = last_scan(&config, radar, &plane, 40);
        let near: Vec<Track> = tracks.into_iter().filter(|track| track.age_scans > 20).collect();
        assert_followed(&near, &plane, 2, &format!("{estimator:?}"));
        assert!(near.iter().all(|track| track.state[6..].iter().all(|z| *z == 0.0)), "{estimator:?}");
    }
}

/// A circle in the plane at 2 °/s to port and another to starboard: the turn filters find the rates.
#[test]
fn turn_filters_find_the_rate() {
    const RATE: f64 = 0.034_906_585;
    let circles: [Target; 2] = [
        |t| {
            let (sine, cosine) = (RATE * t).sin_cos();
            (Vector3::new(3000.0 + 400.0 * cosine, 400.0 * sine, 0.0), 14.0 * Vector3::new(-sine, cosine, 0.0))
        },
        |t| {
            let (sine, cosine) = (RATE * t).sin_cos();
            (Vector3::new(-3000.0 + 400.0 * cosine, -400.0 * sine, 0.0), 14.0 * Vector3::new(-sine, -cosine, 0.0))
        },
    ];
    for estimator in [Estimator::ImmTurn, Estimator::AdaptiveGrid, Estimator::SwitchingGrid] {
        let config = TrackerConfig { estimator, logic: Logic::MOfN, ..TrackerConfig::default() };
        let radar = Turning { full: false, ..Turning::default() };
        let tracks = last_scan(&config, radar, &circles, 90);
        assert_followed(&tracks, &circles, 2, &format!("{estimator:?}"));
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            let models = track.model_probability.iter().zip(&track.model_parameter);
            let rate: f64 = models.map(|(probability, rate)| probability * rate).sum();
            let turn = if track.state[0] > 0.0 { RATE } else { -RATE };
            assert!((rate - turn).abs() < 0.5 * RATE, "{estimator:?}: {rate} of {turn} rad/s");
        }
    }
}

/// What messages say of the filter.
#[test]
fn messages_name_the_filter_and_its_models() {
    for (estimator, code, known, kinds) in [
        (Estimator::ImmUav, ESTIMATOR_IMM_UAV, 9, &[KIND_HOVER, KIND_CONSTANT_VELOCITY, KIND_MANOEUVRE][..]),
        (Estimator::Cv, ESTIMATOR_CV, 6, &[KIND_CONSTANT_VELOCITY][..]),
        (Estimator::ImmTurn, ESTIMATOR_IMM_TURN, 6, &[KIND_COORDINATED_TURN; 5][..]),
        (Estimator::AdaptiveGrid, ESTIMATOR_ADAPTIVE_GRID, 6, &[KIND_COORDINATED_TURN; 3][..]),
        (Estimator::SwitchingGrid, ESTIMATOR_SWITCHING_GRID, 6, &[KIND_COORDINATED_TURN; 3][..]),
        (Estimator::MultiAlternative, ESTIMATOR_MULTI_ALTERNATIVE, 9, &[KIND_MEAN_ACCELERATION; 5][..]),
        (Estimator::AdaptiveBandwidth, ESTIMATOR_ADAPTIVE_BANDWIDTH, 9, &[KIND_MANOEUVRE][..]),
    ] {
        let config = TrackerConfig { estimator, ..TrackerConfig::default() };
        let tracks = last_scan(&config, Turning::default(), &STRAIGHT, 30);
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            assert_eq!((track.estimator, track.known, usize::from(track.models)), (code, known, kinds.len()));
            assert_eq!(&track.model_kind[..kinds.len()], kinds);
            assert!(track.model_kind[kinds.len()..].iter().all(|kind| *kind == KIND_NONE));
            assert!((track.model_probability.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(kinds.iter().all(|kind| track.probability_of(*kind) > 0.0 && kind_name(*kind).is_some()));
            // A scan with a plot makes the position better known than before it.
            let p = |packed: &[f64]| packed[pack(0, 0)] + packed[pack(3, 3)] + packed[pack(6, 6)];
            assert!(track.misses > 0 || p(&track.covariance) < p(&track.predicted_covariance));
            let off = track.state[0] - track.predicted_state[0];
            assert!(off.abs() < 6.0 * track.predicted_covariance[pack(0, 0)].sqrt(), "{off}");
            if known == 6 {
                let beyond = |i: usize| track.state[i] == 0.0 && track.covariance[pack(i, i)] == 0.0;
                assert!([2, 5, 8].into_iter().all(beyond));
                if kinds.len() == 1 {
                    assert_eq!((track.model_state, track.model_covariance), (track.state, track.covariance));
                }
            }
            if kinds[0] == KIND_COORDINATED_TURN {
                let rates = &track.model_parameter[..kinds.len()];
                assert!(rates.windows(2).all(|pair| pair[0] < pair[1]) && rates[0] < 0.0, "{rates:?}");
            }
        }
        let name = estimator_name(code).expect("a name");
        assert_eq!(serde_json::to_value(estimator).expect("text"), name, "as the configuration spells it");
    }
}
