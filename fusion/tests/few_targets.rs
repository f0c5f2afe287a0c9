//! Three radars of short reach and six drones, as in `config/fusion.toml`, of which one radar's clock becomes wrong and right again.

use std::collections::BTreeMap;

use common::geodesy::Position;
use fusion::local::Report;
use fusion::motion::Motion;
use fusion::registration::Bias;
use fusion::simulation::scenarios::DEGREE;
use fusion::simulation::{Filter, Radar, Scenario, Target, Turn, World};
use fusion::{Fusion, Settings};
use nalgebra::Vector3;

const CENTRE: Position = Position { latitude_deg: 50.442, longitude_deg: 30.545, height_m: 120.0 };
const TARGETS: usize = 6;
/// The site whose clock becomes wrong.
const CULPRIT: usize = 1;
/// Numbers of local tracks after the culprit has begun anew.
const ANEW: u64 = 1000;
/// Reports after which a tracker believes in a track.
const CONFIRMED_AFTER: u32 = 4;
/// Cycles: the clock becomes wrong, is right again, end.
const WRONG: u32 = 40;
const RIGHT: u32 = 100;
const END: u32 = 160;
/// Most cycles with another number of system tracks than targets, at both changes together.
const MOST_ODD: u32 = 16;

fn drones() -> Vec<Target> {
    let of = |position: [f64; 3], velocity: [f64; 3]| Target {
        position_m: Vector3::from(position) + Vector3::new(-1770.0, 890.0, 0.0),
        velocity_mps: velocity.into(),
        turn: None,
    };
    let patrol = Turn { right_mps2: 3.5, from_s: 70.0, to_s: 78.0 };
    vec![
        of([1800.0, -2500.0, 250.0], [0.0, 18.0, 0.0]),
        of([3200.0, -900.0, 320.0], [-16.0, 3.0, 0.0]),
        of([600.0, 900.0, 300.0], [17.0, -12.0, 0.0]),
        of([502.0, 969.0, 300.0], [17.0, -12.0, 0.0]),
        Target { turn: Some(patrol), ..of([900.0, -1900.0, 280.0], [18.0, 0.0, 0.0]) },
        of([1500.0, -1100.0, 220.0], [0.0, 0.1, 0.0]),
    ]
}

fn world(seed: u64, coarser: f64) -> World {
    let sigma = [10.0, 0.1 * DEGREE, 0.14 * DEGREE].map(|sigma| coarser * sigma);
    let places = [[-1770.0, 890.0], [1770.0, 890.0], [0.0, -1890.0]];
    let biases = [[35.0, -0.35, 0.1], [-45.0, 0.5, -0.15], [20.0, 0.2, 0.2]];
    let radar = |(place, [range_m, azimuth_deg, elevation_deg]): ([f64; 2], [f64; 3])| Radar {
        bias: Bias::new(range_m, azimuth_deg * DEGREE, elevation_deg * DEGREE, 0.0),
        range_m: 5000.0,
        ..Radar::near(&CENTRE, place, sigma, 1.0)
    };
    let scenario = Scenario {
        centre: CENTRE,
        radars: places.into_iter().zip(biases).map(radar).collect(),
        targets: drones(),
        noise: 0.05,
        filter: Filter::Manoeuvring(MOTION),
        cycle_s: 1.0,
    };
    World::new(scenario, seed)
}

const MOTION: Motion = Motion { noise: [0.2, 20.0], stay_s: [60.0, 10.0] };

/// What became of the picture.
#[derive(Debug, Default)]
struct Picture {
    /// Cycles with another number of system tracks than targets, after the start.
    odd: u32,
    /// Cycles in which the site was named, by site.
    named: [u32; 3],
    /// Last cycle in which a system track of every target had all sites, before the clock was right again and after.
    whole: [Option<u32>; 2],
    /// Greatest distance of a target to the nearest system track, m, after the start.
    farthest_m: f64,
    realigned: [u64; 3],
}

/// Runs the drones with a clock of the culprit that is `clock_s` ahead for some time; `anew` says whether its tracker begins anew with that.
fn run(seed: u64, coarser: f64, clock_s: f64, anew: bool) -> Picture {
    let mut world = world(seed, coarser);
    let mut fusion = world
        .fusion(Bias::new(40.0, 0.4 * DEGREE, 0.2 * DEGREE, 0.0), Settings { motion: MOTION, ..Settings::default() });
    let bias = world.scenario().radars[CULPRIT].bias;
    let mut picture = Picture::default();
    let mut told: BTreeMap<(usize, u64), u32> = BTreeMap::new();
    let mut numbers = 0;
    for cycle in 0..END {
        for (at, clock_s) in [(WRONG, clock_s), (RIGHT, 0.0)] {
            if cycle == at {
                world.spoil(CULPRIT, bias, clock_s);
                if anew {
                    world.begin_anew(CULPRIT);
                    fusion.forget(CULPRIT);
                    numbers += ANEW;
                }
            }
        }
        world.advance(|site, report| {
            let id = report.id + if site == CULPRIT { numbers } else { 0 };
            let reports = told.entry((site, id)).or_insert(0);
            *reports += 1;
            let confirmed = *reports >= CONFIRMED_AFTER;
            fusion.take(site, &Report { id, confirmed, ..report }, report.time_ns);
        });
        fusion.cycle(world.time_ns());
        look(&mut picture, cycle, &fusion, &world);
    }
    picture.realigned = [0, 1, 2].map(|site| fusion.counts(site).realigned);
    picture
}

fn look(picture: &mut Picture, cycle: u32, fusion: &Fusion, world: &World) {
    let systems: Vec<_> = fusion.system_tracks().filter(|system| !system.ended).collect();
    if cycle < 25 {
        return;
    }
    picture.odd += u32::from(systems.len() != TARGETS);
    for (site, named) in picture.named.iter_mut().enumerate() {
        *named += u32::from(fusion.matches_nobody(site));
    }
    let is_whole = |target: u64| {
        systems
            .iter()
            .any(|system| system.contributors.len() == 3 && system.contributors.iter().all(|of| of.id % ANEW == target))
    };
    if (0..TARGETS as u64).all(is_whole) {
        picture.whole[usize::from(cycle >= RIGHT)] = Some(cycle);
    }
    for target in &world.scenario().targets {
        let distances = systems.iter().map(|system| (system.estimate.position() - target.position_m).norm());
        picture.farthest_m = picture.farthest_m.max(distances.fold(f64::INFINITY, f64::min));
    }
}

/// Whether a clock is ahead or behind, jumps while the tracks go on or comes with new ones, and however well the radars measure: the site is
/// found, no other one is blamed, and there is one system track of each target but for some cycles.
#[test]
fn one_clock_two_seconds_wrong_leaves_the_picture_of_few_targets_right() {
    for (seed, coarser) in [(1, 1.0), (2, 1.0), (1, 2.0), (2, 2.0), (3, 2.0)] {
        for anew in [false, true] {
            let undisturbed = run(seed, coarser, 0.0, anew);
            assert_eq!((undisturbed.odd, undisturbed.named, undisturbed.realigned), (0, [0; 3], [0; 3]));
            for clock_s in [2.0, -2.0, -5.0, -20.0] {
                let picture = run(seed, coarser, clock_s, anew);
                let what = format!("seed {seed}, {coarser} × as coarse, anew {anew}, {clock_s} s: {picture:?}");
                assert_eq!(picture.realigned.map(|times| times > 0), [false, true, false], "{what}");
                assert_eq!([picture.named[0], picture.named[2]], [0, 0], "{what}");
                assert!(picture.odd <= MOST_ODD, "{what}");
                assert_eq!(picture.whole, [Some(RIGHT - 1), Some(END - 1)], "{what}");
                assert!(picture.farthest_m < undisturbed.farthest_m + clock_s.abs() * 18.0, "{what}");
            }
        }
    }
}
