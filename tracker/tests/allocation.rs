//! Nothing is allocated per scan once the buffers have grown.

mod harness;

use allocation_counter::measure;
use common::config::TrackerConfig;
use harness::{FLEET, SECTORS, Target, Turning, messages};
use nalgebra::Vector3;
use tracker::Tracker;
use tracker::batch::{Bank, Kernel, Offer, Scan};
use tracker::gate::Radar;
use tracker::imm::transition;
use tracker::measurement::Measurement;
use tracker::motion::Motion;
use tracker::start::two_plots;

const TARGETS: [Target; 2] = [
    |time_s| (Vector3::new(800.0 - 5.0 * time_s, 1500.0, 120.0), Vector3::new(-5.0, 0.0, 0.0)),
    |time_s| (Vector3::new(-2000.0, 900.0 + 8.0 * time_s, 200.0), Vector3::new(0.0, 8.0, 0.0)),
];

/// Real messages, with false plots that start and end tracks; the first half of the run is for growing.
#[test]
fn a_tracker_in_steady_state_allocates_nothing() {
    nothing_is_allocated(&TARGETS);
}

/// The same with many tracks due at once, which are updated in groups.
#[test]
fn nor_does_one_that_updates_groups() {
    nothing_is_allocated(&FLEET);
}

fn nothing_is_allocated(targets: &[Target]) {
    let scans = 120;
    let stream = messages(Turning { false_plots: 10, ..Turning::default() }, targets, scans);
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("valid");
    let mut tracks = Vec::new();
    let (grown, rest) = stream.split_at((scans / 2 * SECTORS) as usize);
    for (header, plots) in grown {
        tracker.take(header, plots, &mut tracks);
    }
    let mut alive = 0;
    let counted = measure(|| {
        for (header, plots) in rest {
            alive += tracker.take(header, plots, &mut tracks).alive;
        }
    });
    let least = 0.9 * targets.len() as f64 * rest.len() as f64;
    assert!(f64::from(alive) >= least, "{alive}");
    assert_eq!(counted.count_total, 0, "{counted:?} in {} messages", rest.len());
}

#[test]
fn a_bank_allocates_nothing() {
    let sigma = [20.0, 0.0017, 0.0017, 10.0_f64];
    let variance = sigma.map(|sigma| sigma * sigma);
    let radar = Radar { variance, cell: sigma.map(|sigma| 3.5 * sigma), measured: [true; 4] };
    let motion = Motion { noise: [1.0, 1.0, 7.0], axes: 3 };
    let plots: Vec<Measurement> = (0..1000)
        .map(|k| {
            let place = common::geometry::Polar {
                range_m: 2000.0 + f64::from(k),
                azimuth_rad: 0.006 * f64::from(k),
                elevation_rad: 0.1,
            };
            Measurement {
                time_ns: 0,
                position: place.to_enu().into(),
                polar: [place.range_m, place.azimuth_rad, place.elevation_rad, 0.0],
                variance,
                power: 20.0,
                measured: [true; 4],
                has_power: true,
            }
        })
        .collect();
    let gains = vec![1e9; plots.len()];
    let chain = transition(0.9, 1.0);
    let mut bank = Bank::new(Kernel::new(motion, radar, 3.0, 0.0));
    for plot in &plots {
        bank.push(&two_plots(plot, plot, 1.0, &motion, [0.33, 0.34, 0.33]));
    }
    let mut candidates = 0;
    let mut scan = || {
        bank.scan(
            &Scan { plots: &plots, gains: &gains, time_ns: 0, dt_s: 1.0, transition: &chain },
            |_, _| Offer { threshold: 0.0, detection_probability: 0.9 },
            |passed| candidates += passed.plots[0].len(),
        );
    };
    (0..3).for_each(|_| scan());
    let counted = measure(|| (0..10).for_each(|_| scan()));
    assert_eq!(counted.count_total, 0, "{counted:?}");
    assert!(candidates > 1000);
}
