//! Fusion of simulated tracks against the truth: accuracy, consistency, association, registration.

use common::geodesy::Position;
use fusion::motion::Motion;
use fusion::registration::Bias;
use fusion::simulation::{Filter, Outcome, Radar, Scenario, Score, Target, Turn, World, normal};
use fusion::{Fusion, Settings};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};

type Draws = chacha20::ChaCha8Rng;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const CENTRE: Position = Position { latitude_deg: 50.0, longitude_deg: 30.0, height_m: 150.0 };
const EQUAL: [[f64; 3]; 8] = [[50.0, 0.1 * DEGREE, 0.1 * DEGREE]; 8];
const MIXED: [[f64; 3]; 8] = [
    [30.0, 0.05 * DEGREE, 0.08 * DEGREE],
    [80.0, 0.2 * DEGREE, 0.2 * DEGREE],
    [150.0, 0.15 * DEGREE, 0.3 * DEGREE],
    [50.0, 0.1 * DEGREE, 0.1 * DEGREE],
    [100.0, 0.2 * DEGREE, 0.2 * DEGREE],
    [50.0, 0.15 * DEGREE, 0.15 * DEGREE],
    [150.0, 0.1 * DEGREE, 0.2 * DEGREE],
    [60.0, 0.12 * DEGREE, 0.12 * DEGREE],
];

/// Radars on a circle about the centre, aircraft all over it.
fn scenario(radars: &[[f64; 3]], targets: usize, seed: u64) -> Scenario {
    let mut rng = Draws::seed_from_u64(seed);
    let radar = |(i, &sigma): (usize, &[f64; 3])| {
        let angle = std::f64::consts::TAU * i as f64 / radars.len() as f64;
        let place = [60_000.0 * angle.sin(), 60_000.0 * angle.cos()];
        Radar::near(&CENTRE, place, sigma, [5.0, 6.0, 4.0, 10.0][i % 4])
    };
    Scenario {
        centre: CENTRE,
        radars: radars.iter().enumerate().map(radar).collect(),
        targets: (0..targets).map(|_| Target::any(&mut rng, 120_000.0)).collect(),
        noise: 0.5,
        filter: Filter::Straight { noise: 0.5 },
        cycle_s: 5.0,
    }
}

/// Runs a scenario; scores count after `settle` cycles.
fn run(world: &mut World, fusion: &mut Fusion, settle: u32, cycles: u32) -> (Score, Outcome) {
    let (mut score, mut outcome) = (Score::default(), Outcome::default());
    for cycle in 0..cycles {
        world.advance(|site, report| fusion.take(site, &report, report.time_ns));
        fusion.cycle(world.time_ns());
        if cycle >= settle {
            outcome = score.take(world, fusion.system_tracks());
        }
    }
    (score, outcome)
}

/// `share` of the targets turn once, at 1 g.
fn turning(mut scenario: Scenario, share: f64, seed: u64) -> Scenario {
    let mut rng = Draws::seed_from_u64(seed);
    for target in &mut scenario.targets {
        if rng.random::<f64>() < share {
            let from_s = rng.random_range(60.0..120.0);
            let right_mps2 = if rng.random::<bool>() { 10.0 } else { -10.0 };
            target.turn = Some(Turn { right_mps2, from_s, to_s: from_s + 20.0 });
        }
    }
    scenario.filter = Filter::Manoeuvring(Motion { noise: [0.5, 500.0], stay_s: [120.0, 15.0] });
    scenario
}

/// Standard deviations of biases: 60 m, 0.1°, 0.1°.
fn unknown() -> Bias {
    Bias::new(60.0, 0.1 * DEGREE, 0.1 * DEGREE, 0.0)
}

fn biased(mut scenario: Scenario, seed: u64) -> Scenario {
    let mut rng = Draws::seed_from_u64(seed);
    for radar in &mut scenario.radars {
        radar.bias = unknown().map(|sigma| sigma * normal(&mut rng));
    }
    scenario
}

#[test]
fn several_radars_see_better_than_the_best_of_them() {
    for (what, radars, ratio) in
        [("three equal", &EQUAL[..3], 0.75), ("three mixed", &MIXED[..3], 0.87), ("eight mixed", &MIXED[..], 0.75)]
    {
        let straight = scenario(radars, 60, 1);
        for (what, scenario) in [(what, straight.clone()), ("turning", turning(straight, 0.3, 2))] {
            let mut world = World::new(scenario, 2);
            let mut fusion = world.fusion(Bias::zeros(), Settings::default());
            let (score, outcome) = run(&mut world, &mut fusion, 12, 40);
            let (over_best, over_central, nees) =
                (score.over_best(), score.fused.rms() / score.central.rms(), score.nees.mean());
            println!(
                "{what}: {:.1} m, over best {over_best:.3}, over central {over_central:.3}, NEES/6 {nees:.3}",
                score.fused.rms()
            );
            assert_eq!((outcome.perfect, outcome.systems), (60, 60), "{what}");
            assert!(over_best <= ratio, "{what}: {over_best}");
            if what == "turning" {
                assert!((0.8..2.5).contains(&nees), "{what}: {nees}");
            } else {
                assert!(over_central <= 1.03, "{what}: {over_central}");
                assert!((0.8..1.2).contains(&nees), "{what}: {nees}");
            }
        }
    }
}

#[test]
fn biases_are_found_and_tracks_of_one_target_come_together() {
    for (radars, targets) in [(&EQUAL[..3], 200), (&EQUAL[..], 1000)] {
        let mut world = World::new(biased(scenario(radars, targets, 3), 5), 7);
        let mut fusion = world.fusion(unknown(), Settings::default());
        let (_, outcome) = run(&mut world, &mut fusion, 30, 60);
        let perfect = Outcome { systems: targets, perfect: targets, wrong: 0, attached: targets * radars.len() };
        assert_eq!(outcome, perfect);
        for (site, radar) in world.scenario().radars.iter().enumerate() {
            let residual = fusion.registration().bias(site) - radar.bias;
            println!("residual {:.2} m, {:.4}°, {:.4}°", residual[0], residual[1] / DEGREE, residual[2] / DEGREE);
            assert!(residual[0].abs() <= 10.0, "{residual}");
            assert!(residual[1].abs().max(residual[2].abs()) <= 0.015 * DEGREE, "{residual}");
        }
    }
}

#[test]
fn members_of_formations_are_told_apart() {
    let (mut perfect, mut targets) = (0_u32, 0);
    for seed in 1..4 {
        let mut of = biased(scenario(&EQUAL[..3], 200, seed), 50 + seed);
        let mut rng = Draws::seed_from_u64(90 + seed);
        // 25 formations of four, 100 to 250 m from one to the next, among a hundred others.
        for formation in of.targets[100..].chunks_mut(4) {
            for member in 1..formation.len() {
                let (angle, apart_m) = (rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(100.0..250.0));
                let offset = apart_m * Vector3::new(angle.sin(), angle.cos(), 0.0);
                formation[member] = formation[member - 1];
                formation[member].position_m += offset;
            }
        }
        (of.noise, of.filter) = (0.01, Filter::Straight { noise: 0.01 });
        let mut world = World::new(of, 7);
        let mut fusion = world.fusion(unknown(), Settings::default());
        let (_, outcome) = run(&mut world, &mut fusion, 30, 60);
        println!("{outcome:?}");
        perfect += outcome.perfect as u32;
        targets += 200;
    }
    assert!(f64::from(perfect) >= 0.98 * f64::from(targets), "{perfect} of {targets}");
}
