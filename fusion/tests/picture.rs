//! Fusion of simulated tracks against the truth: accuracy, consistency, association, registration.

use fusion::registration::Bias;
use fusion::simulation::scenarios::{DEGREE, EQUAL, MIXED, usual_bias};
use fusion::simulation::{Outcome, Scenario, Score, World};
use fusion::{Fusion, Settings};

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

#[test]
fn several_radars_see_better_than_the_best_of_them() {
    for (what, radars, ratio) in
        [("three equal", &EQUAL[..3], 0.75), ("three mixed", &MIXED[..3], 0.87), ("eight mixed", &MIXED[..], 0.75)]
    {
        let straight = Scenario::circle(radars, 60, 1);
        for (what, scenario) in [(what, straight.clone()), ("turning", straight.with_turns(0.3, 2))] {
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
                assert!((0.8..1.5).contains(&nees), "{what}: {nees}");
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
        let mut world = World::new(Scenario::circle(radars, targets, 3).with_biases(&usual_bias(), 5), 7);
        let mut fusion = world.fusion(usual_bias(), Settings::default());
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
        let of =
            Scenario::circle(&EQUAL[..3], 200, seed).with_biases(&usual_bias(), 50 + seed).with_formations(90 + seed);
        let mut world = World::new(of, 7);
        let mut fusion = world.fusion(usual_bias(), Settings::default());
        let (_, outcome) = run(&mut world, &mut fusion, 30, 60);
        println!("{outcome:?}");
        perfect += outcome.perfect as u32;
        targets += 200;
    }
    assert!(f64::from(perfect) >= 0.98 * f64::from(targets), "{perfect} of {targets}");
}

/// Targets, half of them in formations and seen with turns of 12 s, that have had more than one number, with cycles of this length.
fn renumbered(cycle_s: f64) -> usize {
    let of_seed = |seed| {
        let mut scenario =
            Scenario::circle(&EQUAL[..3], 100, seed).with_biases(&usual_bias(), 50 + seed).with_formations(90 + seed);
        scenario.cycle_s = cycle_s;
        scenario.radars.iter_mut().for_each(|radar| radar.period_s = 12.0);
        let mut world = World::new(scenario, 7);
        let mut fusion = world.fusion(usual_bias(), Settings::default());
        run(&mut world, &mut fusion, 0, (480.0 / cycle_s) as u32).0.renumbered()
    };
    (1..4).map(of_seed).sum()
}

/// Many cycles on the same reports decide nothing that few would not.
#[test]
fn targets_keep_their_numbers_however_short_the_cycle_is() {
    let (often, seldom) = (renumbered(1.0), renumbered(12.0));
    assert!(often <= 2 * seldom, "{often} with cycles of 1 s, {seldom} with cycles of a turn");
}
