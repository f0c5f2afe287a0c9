//! Accuracy of rules of fusion (F6).
//!
//! ```text
//! position_m     rms over targets and cycles, mean over runs
//! over_best      the same over that of the radar whose tracks are best in the run
//! over_central   over that of one filter with the measurements of all radars
//! nees           normalised squared error of position and velocity over its dimensions, 1 if consistent
//! ```

use fusion::Settings;
use fusion::comparison::chi_squared;
use fusion::gaussian::{Gaussian, STATE, Vector};
use fusion::local::SiteFrame;
use fusion::registration::Bias;
use fusion::rules::{by_trace, information, intersection, mean};
use fusion::simulation::scenarios::{EQUAL, MIXED};
use fusion::simulation::{Scenario, World};

use crate::parallel::runs;
use crate::{Case, Options, Progress, Results, Row};

/// Targets of a run, cycles, and from which on they count.
const TARGETS: usize = 60;
const CYCLES: u32 = 40;
const SETTLED: u32 = 12;
/// Share of targets that turn, where some do.
const TURNING: f64 = 0.3;

/// Networks of radars.
pub(super) const NETWORKS: [(&str, &[[f64; 3]]); 3] =
    [("three equal", EQUAL.split_at(3).0), ("three mixed", MIXED.split_at(3).0), ("eight mixed", &MIXED)];
/// Flights.
pub(super) const FLIGHTS: [&str; 2] = ["straight", "turning"];
/// Rules, in the order of [`Sums`].
pub(super) const RULES: [&str; 6] =
    ["system", "central", "information", "covariance intersection", "weights 1/tr P", "mean"];

/// Squared errors and normalised ones, of the rules.
#[derive(Debug, Default, Clone, Copy)]
struct Sums {
    squared: [f64; RULES.len()],
    normalised: [f64; RULES.len()],
    count: f64,
}

/// Figures of a run, by rule.
struct Figures {
    position_m: [f64; RULES.len()],
    nees: [f64; RULES.len()],
    best_m: f64,
}

pub(super) fn cases(options: &Options) -> usize {
    options.some_of(&NETWORKS).len() * FLIGHTS.len()
}

pub(super) fn measure(options: &Options, count: u32, progress: &Progress, results: &mut Results) {
    for (network, radars) in options.some_of(&NETWORKS) {
        for flight in FLIGHTS {
            progress.say(format!("{network}, {flight}"));
            let figures = runs(options.threads, count, progress, |run| {
                one_run(radars, flight == "turning", 1000 * options.seed + u64::from(run))
            });
            for (index, rule) in RULES.into_iter().enumerate() {
                let case = Case::new().with("radars", network).with("flight", flight).with("rule", rule);
                let mut row = |metric, of: &dyn Fn(&Figures) -> f64| {
                    results.rows.push(Row::mean(&case, metric, figures.iter().map(of)));
                };
                row("position_m", &|run| run.position_m[index]);
                row("over_best", &|run| run.position_m[index] / run.best_m);
                row("over_central", &|run| run.position_m[index] / run.position_m[1]);
                if figures.iter().all(|run| run.nees[index] > 0.0) {
                    row("nees", &|run| run.nees[index]);
                }
            }
        }
    }
}

fn one_run(radars: &[[f64; 3]], turns: bool, seed: u64) -> Figures {
    let mut scenario = Scenario::circle(radars, TARGETS, seed);
    if turns {
        scenario = scenario.with_turns(TURNING, seed + 1);
    }
    let mut world = World::new(scenario, seed + 2);
    let mut fusion = world.fusion(Bias::zeros(), Settings::default());
    let frames: Vec<SiteFrame> =
        world.scenario().radars.iter().map(|of| SiteFrame::new(&of.position, &world.scenario().centre)).collect();
    let (mut sums, mut score) = (Sums::default(), fusion::simulation::Score::default());
    super::follow(&mut world, &mut fusion, CYCLES, |cycle, world, fusion| {
        if cycle >= SETTLED {
            score.take(world, fusion.system_tracks());
            for target in 0..TARGETS {
                sums.add(world, &frames, target);
            }
        }
    });
    let mut position_m = sums.squared.map(|squared| (squared / sums.count).sqrt());
    let mut nees = sums.normalised.map(|normalised| normalised / sums.count);
    (position_m[0], nees[0]) = (score.fused.rms(), score.nees.mean());
    let best_m = score.local.iter().map(fusion::simulation::Errors::rms).fold(f64::INFINITY, f64::min);
    Figures { position_m, nees, best_m }
}

impl Sums {
    /// Adds what the rules make of the tracks of one target; the system tracks are scored elsewhere.
    fn add(&mut self, world: &World, frames: &[SiteFrame], target: usize) {
        let truth = world.scenario().targets[target].state();
        let now_s = world.time_s();
        let local = |(radar, frame): (usize, &SiteFrame)| {
            world.track(radar, target).at(now_s).map(|of| frame.to_centre(&of, &Bias::zeros()))
        };
        let estimates: Vec<Gaussian> = frames.iter().enumerate().filter_map(local).collect();
        let with_covariance =
            [(1, world.central(target).at(now_s)), (2, information(&estimates)), (3, intersection(&estimates))];
        for (rule, estimate) in with_covariance {
            let Some(estimate) = estimate else { continue };
            self.squared[rule] += squared_m2(&estimate.mean, &truth);
            self.normalised[rule] += chi_squared(&(estimate.mean - truth), estimate.covariance) / STATE as f64;
        }
        for (rule, estimate) in [(4, by_trace(&estimates)), (5, mean(&estimates))] {
            self.squared[rule] += squared_m2(&estimate, &truth);
        }
        self.count += 1.0;
    }
}

fn squared_m2(estimate: &Vector, truth: &Vector) -> f64 {
    (estimate - truth).fixed_rows::<3>(0).norm_squared()
}
