//! Reports that are wrong, late, repeated or in any order, and sites that begin anew.

use common::geodesy::Position;
use fusion::gaussian::{Gaussian, Matrix, Vector};
use fusion::local::Report;
use fusion::registration::Bias;
use fusion::simulation::{Filter, Radar, Scenario, Target, World};
use fusion::{Fusion, Settings, Site};
use rand::SeedableRng;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const CENTRE: Position = Position { latitude_deg: 50.0, longitude_deg: 30.0, height_m: 150.0 };
const TARGETS: usize = 60;
/// Numbers of local tracks after a site has begun anew.
const ANEW: u64 = 10_000;

fn world() -> World {
    let mut rng = chacha20::ChaCha8Rng::seed_from_u64(4);
    let sigma = [50.0, 0.1 * DEGREE, 0.1 * DEGREE];
    let places = [[0.0, 60_000.0], [52_000.0, -30_000.0], [-52_000.0, -30_000.0]];
    World::new(
        Scenario {
            centre: CENTRE,
            radars: places.map(|place| Radar::near(&CENTRE, place, sigma, 5.0)).to_vec(),
            targets: (0..TARGETS).map(|_| Target::any(&mut rng, 120_000.0)).collect(),
            noise: 0.5,
            filter: Filter::Straight { noise: 0.5 },
            cycle_s: 5.0,
        },
        9,
    )
}

/// Runs the world; `hand` gives the fusion the reports of a cycle.
fn run(cycles: u32, mut hand: impl FnMut(u32, &mut Fusion, Vec<(usize, Report)>)) -> Fusion {
    let mut world = world();
    let mut fusion = world.fusion(Bias::zeros(), Settings::default());
    for cycle in 0..cycles {
        let mut reports = Vec::new();
        world.advance(|site, report| reports.push((site, report)));
        hand(cycle, &mut fusion, reports);
        fusion.cycle(world.time_ns());
    }
    fusion
}

fn hand_all(fusion: &mut Fusion, reports: &[(usize, Report)]) {
    for (site, report) in reports {
        fusion.take(*site, report, report.time_ns);
    }
}

/// Every target has one system track, of one local track from each of `sites` radars.
fn assert_right(fusion: &Fusion, sites: usize) {
    let mut owners: Vec<u64> = Vec::new();
    for system in fusion.system_tracks().filter(|system| !system.ended) {
        let mut ids: Vec<u64> = system.contributors.iter().map(|of| of.id % ANEW).collect();
        assert_eq!(ids.len(), sites, "{system:?}");
        ids.dedup();
        assert_eq!(ids.len(), 1, "{system:?}");
        owners.extend(ids);
    }
    owners.sort_unstable();
    assert_eq!(owners, (0..TARGETS as u64).collect::<Vec<_>>());
}

#[test]
fn the_order_in_which_reports_come_does_not_matter() {
    let states = |reversed: bool| -> Vec<Gaussian> {
        let fusion = run(20, |_, fusion, mut reports| {
            if reversed {
                reports.reverse();
            }
            hand_all(fusion, &reports);
        });
        assert_right(&fusion, 3);
        fusion.system_tracks().map(|system| system.estimate).collect()
    };
    assert_eq!(states(false), states(true));
}

#[test]
fn old_reports_sent_again_and_again_change_nothing() {
    let mut earlier: Vec<(usize, Report)> = Vec::new();
    let fusion = run(20, |_, fusion, reports| {
        hand_all(fusion, &reports);
        for _ in 0..5 {
            hand_all(fusion, &earlier);
        }
        earlier = reports;
    });
    assert_right(&fusion, 3);
    assert!((0..3).all(|site| fusion.counts(site).repeated > 4 * 18 * TARGETS as u64));
}

#[test]
fn a_site_that_begins_anew_finds_its_system_tracks_again() {
    let numbers = |fusion: &Fusion| -> Vec<u64> { fusion.system_tracks().map(|system| system.id).collect() };
    let mut before = Vec::new();
    let fusion = run(30, |cycle, fusion, mut reports| {
        if cycle == 20 {
            before = numbers(fusion);
            fusion.forget(1);
        }
        for (site, report) in &mut reports {
            report.id += if cycle >= 20 && *site == 1 { ANEW } else { 0 };
        }
        hand_all(fusion, &reports);
    });
    assert_right(&fusion, 3);
    assert_eq!(numbers(&fusion), before, "no system track has another number");
}

#[test]
fn a_site_that_is_switched_off_leaves_the_picture_to_the_others() {
    let fusion = run(30, |cycle, fusion, mut reports| {
        reports.retain(|(site, _)| cycle < 20 || *site != 2);
        hand_all(fusion, &reports);
    });
    assert_right(&fusion, 2);
}

#[test]
fn what_is_no_estimate_or_of_another_time_is_refused_and_counted() {
    let site = Site { position: CENTRE, range_m: 1e5, period_s: 5.0, bias: Bias::zeros() };
    let mut fusion = Fusion::new(&CENTRE, &[site], Settings::default());
    let s = |seconds: u64| seconds * 1_000_000_000;
    let good = Report {
        id: 1,
        time_ns: s(1000),
        posterior: Gaussian { mean: Vector::repeat(100.0), covariance: Matrix::identity() * 400.0 },
        prediction: None,
        confirmed: true,
        ended: false,
    };
    fusion.take(0, &good, s(1000));
    fusion.cycle(s(1001));
    let with = |change: &dyn Fn(&mut Report)| {
        let mut report = Report { time_ns: s(1003), ..good };
        change(&mut report);
        report
    };
    let mut lopsided = Matrix::identity();
    (lopsided[(0, 1)], lopsided[(1, 0)]) = (2.0, 2.0);
    for covariance in [lopsided, Matrix::identity() * -1.0, Matrix::identity() * 1e-320, Matrix::identity() * 1e30] {
        fusion.take(0, &with(&|report| report.posterior.covariance = covariance), s(1003));
    }
    for mean in [f64::NAN, f64::INFINITY, 1e12] {
        fusion.take(0, &with(&|report| report.posterior.mean[3] = mean), s(1003));
    }
    // Of an hour ahead or behind, by the message or by the track itself.
    fusion.take(0, &with(&|report| report.time_ns = s(4600)), s(4600));
    fusion.take(0, &with(&|report| report.time_ns = s(4600)), s(1003));
    fusion.take(0, &with(&|report| report.time_ns = s(100)), s(100));
    fusion.take(0, &with(&|report| report.time_ns = s(100)), s(1003));
    fusion.cycle(s(1004));
    assert_eq!((fusion.counts(0).unsound, fusion.counts(0).untimely), (7, 4));
    let system: Vec<_> = fusion.system_tracks().map(|system| (system.time_ns, system.estimate.mean[0])).collect();
    assert_eq!(system.len(), 1);
    assert!(system[0].0 == s(1004) && (system[0].1 - 500.0).abs() < 1.0, "{system:?}");
}
