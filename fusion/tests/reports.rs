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
    world_of(5.0, 5.0)
}

/// With this time of a cycle and of a turn, s.
fn world_of(cycle_s: f64, period_s: f64) -> World {
    let mut rng = chacha20::ChaCha8Rng::seed_from_u64(4);
    let sigma = [50.0, 0.1 * DEGREE, 0.1 * DEGREE];
    let places = [[0.0, 60_000.0], [52_000.0, -30_000.0], [-52_000.0, -30_000.0]];
    World::new(
        Scenario {
            centre: CENTRE,
            radars: places.map(|place| Radar::near(&CENTRE, place, sigma, period_s)).to_vec(),
            targets: (0..TARGETS).map(|_| Target::any(&mut rng, 120_000.0)).collect(),
            noise: 0.5,
            filter: Filter::Straight { noise: 0.5 },
            cycle_s,
        },
        9,
    )
}

/// Runs the world; `hand` gives the fusion the reports of a cycle, `look` sees what has become of them.
fn run_and_look(
    cycles: u32,
    mut hand: impl FnMut(u32, &mut Fusion, Vec<(usize, Report)>),
    mut look: impl FnMut(u32, &Fusion, &World),
) -> Fusion {
    let mut world = world();
    let mut fusion = world.fusion(Bias::zeros(), Settings::default());
    for cycle in 0..cycles {
        let mut reports = Vec::new();
        world.advance(|site, report| reports.push((site, report)));
        hand(cycle, &mut fusion, reports);
        fusion.cycle(world.time_ns());
        look(cycle, &fusion, &world);
    }
    fusion
}

fn run(cycles: u32, hand: impl FnMut(u32, &mut Fusion, Vec<(usize, Report)>)) -> Fusion {
    run_and_look(cycles, hand, |_, _, _| ())
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

/// A site at the centre with these limits of range and elevation.
fn radar(range_m: [f64; 2], elevation_rad: [f64; 2]) -> Site {
    Site { position: CENTRE, range_m, elevation_rad, period_s: 5.0, bias: Bias::zeros() }
}

/// For how long a system track lives, s, after a site that goes on without it or falls silent has reported a target 100 m north and 300 m up for the last time.
fn lives_s(site: Site, goes_on: bool) -> u32 {
    let mut fusion = Fusion::new(&CENTRE, &[site], Settings::default());
    let s = |seconds: u32| (1000 + u64::from(seconds)) * 1_000_000_000;
    let mean = Vector::new(0.0, 100.0, 300.0, 0.0, 0.0, 0.0);
    let posterior = Gaussian { mean, covariance: Matrix::identity() };
    let report = Report { id: 1, time_ns: s(0), posterior, prediction: None, confirmed: true, ended: false };
    fusion.take(0, &report, s(0));
    fusion.cycle(s(0));
    fusion.take(0, &Report { time_ns: s(1), ended: goes_on, ..report }, s(1));
    for cycle in 1..1000 {
        if goes_on {
            fusion.hear(0, s(cycle));
        }
        fusion.cycle(s(cycle));
        if fusion.system_tracks().all(|system| system.ended) {
            return cycle;
        }
    }
    panic!("it never ends");
}

#[test]
fn what_no_radar_can_see_now_lives_longer() {
    let settings = Settings::default();
    let (all_m, all_rad) = ([0.0, 1e5], Site::ALL_ELEVATIONS_RAD);
    let is_about = |lives_s: u32, expected_s: f64| (f64::from(lives_s) - expected_s).abs() <= 2.0;
    assert!(is_about(lives_s(radar(all_m, all_rad), true), settings.coast_s));
    for (what, site, goes_on) in [
        ("above the beams", radar(all_m, [0.0, 20.0 * DEGREE]), true),
        ("nearer than the first range", radar([500.0, 1e5], all_rad), true),
        ("farther than the last", radar([0.0, 200.0], all_rad), true),
        ("silent", radar(all_m, all_rad), false),
    ] {
        assert!(is_about(lives_s(site, goes_on), settings.hidden_s), "{what}: {}", lives_s(site, goes_on));
    }
}

#[test]
fn what_is_no_estimate_or_of_another_time_is_refused_and_counted() {
    let site = radar([0.0, 1e5], Site::ALL_ELEVATIONS_RAD);
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

/// Runs the world; from the cycle `from` on, `change` spoils the reports of site 1. Returns the fusion, how many system tracks there were at
/// most after the start, and how far one of them was from its target, m.
fn with_change(from: u32, change: impl Fn(&mut Report)) -> (Fusion, usize, f64) {
    let (mut most, mut farthest_m) = (0, 0.0_f64);
    let hand = |cycle: u32, fusion: &mut Fusion, mut reports: Vec<(usize, Report)>| {
        for (_, report) in reports.iter_mut().filter(|(site, _)| cycle >= from && *site == 1) {
            change(report);
        }
        hand_all(fusion, &reports);
    };
    let fusion = run_and_look(40, hand, |cycle, fusion, world| {
        let systems: Vec<_> = fusion.system_tracks().filter(|system| !system.ended).collect();
        if cycle >= 12 {
            most = most.max(systems.len());
            for system in systems {
                let target = &world.scenario().targets[system.contributors[0].id as usize];
                farthest_m = farthest_m.max((system.estimate.position() - target.position_m).norm());
            }
        }
    });
    (fusion, most, farthest_m)
}

/// Moves a report as a bias of range does, m.
fn farther(report: &mut Report, by_m: f64) {
    for estimate in [Some(&mut report.posterior), report.prediction.as_mut()].into_iter().flatten() {
        let outward = estimate.position().normalize() * by_m;
        let mut position = estimate.mean.fixed_rows_mut::<3>(0);
        position += outward;
    }
}

#[test]
fn a_kilometre_of_bias_at_one_site_is_found_and_leaves_the_picture_right() {
    let undisturbed_m = with_change(0, |_| ()).2;
    for from in [0, 20] {
        let (fusion, most, farthest_m) = with_change(from, |report| farther(report, 1000.0));
        assert_right(&fusion, 3);
        let found = fusion.registration().bias(1);
        assert!((found[0] - 1000.0).abs() < 50.0, "changed in cycle {from}: {found}");
        assert_eq!([0, 1, 2].map(|site| fusion.counts(site).realigned > 0), [false, true, false]);
        assert_eq!(most, TARGETS, "changed in cycle {from}");
        assert!(farthest_m < 1.2 * undisturbed_m, "changed in cycle {from}: {farthest_m} m, else {undisturbed_m} m");
    }
}

#[test]
fn a_clock_two_seconds_wrong_is_found_and_leaves_the_picture_right() {
    let undisturbed_m = with_change(0, |_| ()).2;
    for (from, by_s) in [(0, 2), (20, 2), (20, -2_i64)] {
        let (fusion, most, farthest_m) = with_change(from, |report| {
            report.time_ns = report.time_ns.saturating_add_signed(by_s * 1_000_000_000);
        });
        assert_right(&fusion, 3);
        let found = fusion.registration().bias(1);
        assert!((found[3] + by_s as f64).abs() < 0.3, "{by_s} s wrong from cycle {from} on: {found}");
        assert_eq!([0, 1, 2].map(|site| fusion.counts(site).realigned > 0), [false, true, false]);
        assert_eq!(most, TARGETS, "{by_s} s wrong from cycle {from} on");
        assert!(
            farthest_m < 1.2 * undisturbed_m,
            "{by_s} s from cycle {from} on: {farthest_m} m, else {undisturbed_m} m"
        );
    }
}

#[test]
fn a_site_that_is_right_again_is_found_again() {
    let hand = |cycle: u32, fusion: &mut Fusion, mut reports: Vec<(usize, Report)>| {
        for (_, report) in reports.iter_mut().filter(|(site, _)| (15..40).contains(&cycle) && *site == 1) {
            farther(report, -700.0);
        }
        hand_all(fusion, &reports);
    };
    let fusion = run(60, hand);
    assert_right(&fusion, 3);
    assert_eq!(fusion.counts(1).realigned, 2);
    assert!(fusion.registration().bias(1)[0].abs() < 50.0, "{}", fusion.registration().bias(1));
}

#[test]
fn a_site_that_reports_ten_times_as_often_is_no_other_than_the_rest() {
    let fusion = run(30, |_, fusion, reports| {
        hand_all(fusion, &reports);
        // Between its looks the site tells what it predicts.
        for (site, report) in reports.iter().filter(|(site, _)| *site == 1) {
            for step in 1..10 {
                let posterior = report.posterior.predicted(0.5 * f64::from(step), 0.5);
                let time_ns = report.time_ns + 500_000_000 * step as u64;
                fusion.take(*site, &Report { posterior, prediction: Some(posterior), time_ns, ..*report }, time_ns);
            }
        }
    });
    assert_right(&fusion, 3);
}

/// Radars track already when the fusion begins, with learned biases, at any ratio of cycle and turn: whichever site is wrong, from the
/// beginning or later, is the one that is corrected.
#[test]
fn whichever_site_is_wrong_is_found() {
    let usual = Bias::new(60.0, 0.1 * DEGREE, 0.1 * DEGREE, 0.0);
    for (culprit, later, cycle_s, period_s, gross, clock_s) in [
        (0, false, 5.0, 5.0, Bias::new(1000.0, 0.0, 0.0, 0.0), 0.0),
        (1, false, 1.0, 5.0, Bias::zeros(), 2.0),
        (2, false, 5.0, 5.0, Bias::zeros(), -2.0),
        (0, true, 1.0, 10.0, Bias::new(0.0, 1.0 * DEGREE, 0.0, 0.0), 0.0),
        (1, true, 5.0, 5.0, Bias::new(-1000.0, 0.0, 0.0, 0.0), 0.0),
        (2, true, 1.0, 5.0, Bias::zeros(), 2.0),
    ] {
        let what = format!(
            "site {culprit} later {later}: {:?} {clock_s} s, cycle {cycle_s} s, turn {period_s} s",
            gross.as_slice()
        );
        let mut world = world_of(cycle_s, period_s);
        let ordinary = [40.0, -70.0, 20.0].map(|range_m| Bias::new(range_m, 0.0, 0.0, 0.0));
        for (site, bias) in ordinary.iter().enumerate() {
            world.spoil(site, *bias, 0.0);
        }
        let spoil = |world: &mut World| world.spoil(culprit, ordinary[culprit] + gross, clock_s);
        if !later {
            spoil(&mut world);
        }
        let mut fusion = world.fusion(usual, Settings::default());
        let seconds = |s: f64| (s / cycle_s) as u32;
        for cycle in 0..seconds(700.0) {
            if later && cycle == seconds(250.0) {
                spoil(&mut world);
            }
            world.advance(|site, report| {
                if cycle >= seconds(40.0) {
                    fusion.take(site, &report, report.time_ns);
                }
            });
            fusion.cycle(world.time_ns());
        }
        for site in 0..3 {
            assert_eq!(
                fusion.counts(site).realigned > 0,
                site == culprit,
                "{what}: site {site}: {:?}",
                fusion.counts(site)
            );
            assert!(!fusion.matches_nobody(site), "{what}: site {site}");
            let right = ordinary[site] + if site == culprit { gross } else { Bias::zeros() };
            let error = fusion.registration().bias(site) - right;
            assert!(
                error[0].abs() < 40.0 && error[1].abs() < 0.1 * DEGREE,
                "{what}: site {site}: {:?}",
                error.as_slice()
            );
        }
        let clock_s = fusion.registration().bias(culprit)[3] + clock_s;
        assert!(clock_s.abs() < 0.2, "{what}: {clock_s} s are left");
        assert_right(&fusion, 3);
    }
}
