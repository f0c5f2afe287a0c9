//! Nothing is allocated per scan once the buffers have grown.

mod harness;

use allocation_counter::measure;
use common::config::{Association, Clutter, Estimator, GateRule, Logic, TrackerConfig};
use harness::{FLEET, Target, Turning, messages};
use nalgebra::Vector3;
use tracker::Tracker;

const TARGETS: [Target; 2] = [
    |time_s| (Vector3::new(800.0 - 5.0 * time_s, 1500.0, 120.0), Vector3::new(-5.0, 0.0, 0.0)),
    |time_s| (Vector3::new(-2000.0, 900.0 + 8.0 * time_s, 200.0), Vector3::new(0.0, 8.0, 0.0)),
];

/// Every way to associate, with real messages: false plots start and end tracks, targets cross and share plots. Two targets are
/// updated one by one, the fleet in groups. The first twelve runs are for growing; the last brings the same plots again, of a radar that was restarted.
#[test]
fn no_way_to_associate_allocates_in_steady_state() {
    let default = TrackerConfig::default;
    nothing_is_allocated_by([
        default(),
        TrackerConfig { joint_association: false, ..default() },
        TrackerConfig { gate_rule: GateRule::MostProbable, clutter: Clutter::NonParametric, ..default() },
        TrackerConfig { association: Association::Pda, ..default() },
        TrackerConfig { association: Association::Nearest, ..default() },
        TrackerConfig { association: Association::Strongest, ..default() },
        TrackerConfig { association: Association::Mht, ..default() },
        TrackerConfig { logic: Logic::MOfN, ..default() },
    ]);
}

/// As above, of every other family.
#[test]
fn no_family_allocates_in_steady_state() {
    let families = Estimator::ALL.into_iter().flat_map(|estimator| {
        [Association::PdaStatistics, Association::Mht].map(|association| TrackerConfig {
            estimator,
            association,
            ..TrackerConfig::default()
        })
    });
    nothing_is_allocated_by(families.filter(|config| config.estimator != Estimator::ImmUav));
}

fn nothing_is_allocated_by(configs: impl IntoIterator<Item = TrackerConfig>) {
    for config in configs {
        for targets in [&TARGETS[..], &FLEET] {
            nothing_is_allocated(&config, targets);
        }
    }
}

fn nothing_is_allocated(config: &TrackerConfig, targets: &[Target]) {
    let scans = 60;
    let mut stream = messages(Turning { false_plots: 15, ..Turning::default() }, targets, scans);
    let config = &TrackerConfig { start_density: 1e-5, ..config.clone() };
    let mut tracker = Tracker::new(config, 1).expect("valid");
    let mut tracks = Vec::new();
    let mut last_id = 0;
    let later_ns = u64::from(scans) * 1_000_000_000;
    for _ in 0..12 {
        for (header, plots) in &stream {
            tracker.process_plots(header, plots, &mut tracks);
            last_id = tracks.iter().map(|track| track.id).fold(last_id, u64::max);
        }
        for (header, plots) in &mut stream {
            header.session += 1;
            header.time_ns += later_ns;
            for plot in plots {
                plot.time_ns += later_ns;
            }
        }
    }
    let (mut alive, mut started) = (0, 0);
    let counted = measure(|| {
        for (header, plots) in &stream {
            alive += tracker.process_plots(header, plots, &mut tracks).alive;
            for track in &tracks {
                started += u32::from(track.id > last_id);
                last_id = last_id.max(track.id);
            }
        }
    });
    let what = format!("{:?}, {:?}, {} targets", config.estimator, config.association, targets.len());
    let least = 0.8 * targets.len() as f64 * stream.len() as f64;
    assert!(f64::from(alive) >= least && started > 2, "{what}: {alive} {started}");
    assert_eq!(counted.count_total, 0, "{what}: {counted:?} in {} messages", stream.len());
}
