//! Time of a cycle of fusion: `cargo bench -p fusion`.
//!
//! The source of the method asks for 1000 objects in 5 s and for 64 radars of 200 targets each in 10 s.

use std::time::{Duration, Instant};

use common::geodesy::Position;
use criterion::{Criterion, criterion_group, criterion_main};
use fusion::local::Report;
use fusion::registration::Bias;
use fusion::simulation::{Filter, Radar, Scenario, Target, World};
use fusion::{Fusion, Settings};
use rand::SeedableRng;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const CENTRE: Position = Position { latitude_deg: 50.0, longitude_deg: 30.0, height_m: 150.0 };
/// Cycles until every local track is part of a system track.
const SETTLE: usize = 12;
/// Cycles that are timed.
const TIMED: usize = 20;

/// Radars on a grid, all of which see all targets.
fn world(radars: usize, targets: usize) -> World {
    let mut rng = chacha20::ChaCha8Rng::seed_from_u64(1);
    let side = (radars as f64).sqrt().ceil() as usize;
    let place = |i: usize| [(i % side) as f64, (i / side) as f64].map(|at| 30_000.0 * (at - side as f64 / 2.0));
    let sigma = [50.0, 0.1 * DEGREE, 0.1 * DEGREE];
    World::new(
        Scenario {
            centre: CENTRE,
            radars: (0..radars).map(|i| Radar::near(&CENTRE, place(i), sigma, 5.0)).collect(),
            targets: (0..targets).map(|_| Target::any(&mut rng, 150_000.0)).collect(),
            noise: 0.5,
            filter: Filter::Straight { noise: 0.5 },
            cycle_s: 5.0,
        },
        2,
    )
}

/// Time of a cycle once all is settled.
fn cycles(name: &str, criterion: &mut Criterion, radars: usize, targets: usize) {
    let mut world = world(radars, targets);
    let bias = Bias::new(60.0, 0.1 * DEGREE, 0.1 * DEGREE, 0.0);
    let reports: Vec<(u64, Vec<(usize, Report)>)> = (0..SETTLE + TIMED)
        .map(|_| {
            let mut reports = Vec::new();
            world.advance(|site, report| reports.push((site, report)));
            (world.time_ns(), reports)
        })
        .collect();
    let work = |fusion: &mut Fusion, (now_ns, reports): &(u64, Vec<(usize, Report)>)| {
        for (site, report) in reports {
            fusion.take(*site, report, report.time_ns);
        }
        fusion.cycle(*now_ns);
        std::hint::black_box(fusion.system_tracks().count());
    };
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|rounds| {
            let mut spent = Duration::ZERO;
            let mut left = rounds as usize;
            while left > 0 {
                let mut fusion = world.fusion(bias, Settings::default());
                for cycle in &reports[..SETTLE] {
                    work(&mut fusion, cycle);
                }
                for cycle in &reports[SETTLE..][..left.min(TIMED)] {
                    let began = Instant::now();
                    work(&mut fusion, cycle);
                    spent += began.elapsed();
                }
                left -= left.min(TIMED);
            }
            spent
        });
    });
}

fn benches(criterion: &mut Criterion) {
    cycles("cycle of 1000 objects, 8 radars", criterion, 8, 1000);
    cycles("cycle of 200 objects, 64 radars", criterion, 64, 200);
    cycles("cycle of 10,000 objects, 3 radars", criterion, 3, 10_000);
}

criterion_group! {
    name = cycle;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(5));
    targets = benches
}
criterion_main!(cycle);
