//! The threshold of a scan (T20.2): looking at plots above t only is the same as a detector whose own threshold is t.

use std::f64::consts::TAU;

use common::amplitude::{Detector, FalsePower};
use common::config::{Association, Clutter, Swerling, TrackerConfig};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::random::{Purpose, generator};
use rand::RngExt;
use tracker::association::one_track::OneTrack;
use tracker::association::scan::{Member, Outcome};
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::TwoPlots;
use tracker::filter::uav::Uav;
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

const CELL: [f64; COORDINATES] = [69.3, 0.006, 0.006, 34.6];
const PFA: f64 = 0.1;

fn plot(range_m: f64, azimuth_rad: f64, range_rate_mps: f64, power: f64) -> Measurement {
    let plot = Plot {
        range_m,
        azimuth_rad,
        elevation_rad: 0.11,
        range_rate_mps,
        sigma_range_m: 20.0,
        sigma_azimuth_rad: 0.0017,
        sigma_elevation_rad: 0.0017,
        sigma_range_rate_mps: 10.0,
        statistic: power.sqrt() as f32,
        flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
        ..Plot::default()
    };
    Measurement::from_plot(&plot).expect("possible")
}

/// A track that has not been seen for a scan: its gate holds thousands of cells.
fn prediction() -> OneTrack {
    let filter =
        Uav { noise: [1.0, 1.0, 7.0], jerk_share: 1.0, axes: 3, stay: 0.9, start_probability: [0.33, 0.34, 0.33] };
    let mut track = OneTrack::new(Box::new(filter));
    let [previous, last] = [900.0, 880.0].map(|range_m| plot(range_m, 1.1, -22.0, 9.0));
    track.start(&TwoPlots { previous: &previous, last: &last, step_s: 1.0 });
    (0..2).for_each(|_| track.predict(1.0));
    track
}

/// One scan with a detector of `pfa`, by `rules`, and the position east after it.
fn scan(rules: &Rules, pfa: f64, plots: &[Measurement]) -> (Outcome, f64) {
    let radar = Radar {
        variance: CELL.map(|cell| cell * cell / 12.0),
        cell: CELL,
        measured: [true; COORDINATES],
        range_rate_interval_mps: 0.0,
    };
    let target = Detector::new(pfa, 0).target(Swerling::One, 25.0);
    let per_cell =
        |plot: &Measurement| pfa / (CELL.iter().product::<f64>() * plot.polar[0].powi(2) * plot.cos_elevation);
    let surroundings = Surroundings {
        radar: &radar,
        detection_probability: target.detection_probability,
        target: Some(&target),
        shares: &[],
        clutter: |plot: &Measurement| FalsePlots { density: per_cell(plot), power: FalsePower::default() },
    };
    let mut track = prediction();
    let outcome = track.update(Member { time_ns: 0, plots, surroundings }, &radar, rules);
    (outcome, track.state().moments().position()[0])
}

#[test]
fn a_raised_threshold_is_as_the_detectors_own() {
    for association in [Association::PdaStatistics, Association::Pda, Association::Nearest, Association::Strongest] {
        for clutter in [Clutter::Parametric, Clutter::NonParametric] {
            let config = TrackerConfig { association, clutter, ..TrackerConfig::default() };
            let rules = Rules::new(&config);
            let t = scan(&rules, PFA, &[]).0.selection.threshold;
            let detector = Detector::new(PFA, 0);
            let raised = detector.noise_survival(t);
            assert!(raised < PFA / 10.0, "F {PFA} → {raised}");
            // The target's plot and forty others, all above t.
            let mut rng = generator(5, Purpose::Test, 0, 0);
            let mut plots = vec![plot(855.0, 1.102, -18.0, t + 3.0)];
            for _ in 0..40 {
                let mut near = |spread: f64| rng.random_range(-spread..spread);
                let (range_m, azimuth_rad, range_rate_mps) = (840.0 + near(120.0), 1.1 + near(0.1), -22.0 + near(40.0));
                plots.push(plot(range_m, azimuth_rad.rem_euclid(TAU), range_rate_mps, t + near(1.0).abs() + 0.1));
            }
            let found = scan(&rules, PFA, &plots);
            let own = scan(&Rules { gate_false_plots: 0.0, ..rules }, raised, &plots);
            let both = |of: fn(&(Outcome, f64)) -> f64| [of(&found), of(&own)];
            for (what, [found, own]) in [
                ("weight of none", both(|(outcome, _)| outcome.weight_none)),
                ("evidence of existence", both(|(outcome, _)| outcome.existence_ratio)),
                ("east", both(|(_, east)| *east)),
            ] {
                let same = (found - own).abs() <= 1e-6 * own.abs();
                assert!(same, "{association:?}, {clutter:?}, {what}: {found} and {own}");
            }
        }
    }
}
