//! Simulating one dwell of the default radar: time per dwell and cells per second.
//!
//! The limit is drawing random bits and one logarithm and square root per cell.

use std::hint::black_box;

use common::config::ChainConfig;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use radar_sim::DwellSimulator;

fn sim_dwell(criterion: &mut Criterion) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/uav.toml");
    let chain: ChainConfig = common::config::load(Some(file.as_ref()), &[]).expect("valid configuration");
    let mut simulator = DwellSimulator::new(&chain).expect("valid scenario");
    let mut amplitudes = vec![0.0_f32; simulator.cells()];
    let mut group = criterion.benchmark_group("sim_dwell");
    group.throughput(Throughput::Elements(amplitudes.len() as u64));
    let mut dwell = 0;
    group.bench_function("cells", |bencher| {
        bencher.iter(|| {
            dwell = (dwell + 1) % chain.radar.dwells_per_scan;
            simulator.fill(3, dwell, black_box(&mut amplitudes));
        });
    });
    group.finish();
    let power = amplitudes.iter().map(|&a| f64::from(a * a)).sum::<f64>() / amplitudes.len() as f64;
    assert!((0.9..2.0).contains(&power), "unit noise and some clutter, not {power}");
}

criterion_group!(benches, sim_dwell);
criterion_main!(benches);
