//! Each CFAR alone and the whole extraction of a dwell, on simulated dwells of `config/uav.toml`.
//!
//! The limit is reading the amplitudes: 0.33 ns per cell from memory on a machine where a
//! hand-written C kernel needs 0.62 from memory and 0.36 from cache.

use std::convert::Infallible;
use std::hint::black_box;

use common::config::{Cfar, ChainConfig, ExtractorConfig};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use plot_extractor::PlotExtractor;
use plot_extractor::centroid::{self, curvature};
use plot_extractor::cfar::{CaCfar, Detector};
use radar_sim::DwellSimulator;

/// Dwells in turn: 25 MB, more than a second-level cache holds.
const DWELLS: u32 = 260;

fn chain() -> ChainConfig {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/uav.toml");
    common::config::load(Some(file.as_ref()), &[]).expect("valid configuration")
}

fn extract(criterion: &mut Criterion) {
    let chain = chain();
    let mut simulator = DwellSimulator::new(&chain).expect("valid scenario");
    let cells = simulator.cells();
    let dwells: Vec<Vec<f32>> = (0..DWELLS)
        .map(|dwell| {
            let mut amplitudes = vec![0.0; cells];
            simulator.fill(0, dwell, &mut amplitudes);
            amplitudes
        })
        .collect();

    let mut group = criterion.benchmark_group("cfar_ca");
    group.throughput(Throughput::Elements(cells as u64));
    for (name, used) in [("cache", 1), ("memory", dwells.len())] {
        let mut cfar = CaCfar::new(70, 2, 16, chain.extractor.pfa);
        let (mut powers, mut hits) = (vec![0.0; cells], Vec::new());
        let (mut next, mut taken, mut total) = (0, 0, 0);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                hits.clear();
                assert!(cfar.detect(black_box(&dwells[next]), &mut powers, &mut hits));
                next = (next + 1) % used;
                taken += 1;
                total += hits.len();
            });
        });
        assert!(taken == 0 || used == 1 || total > 0, "the scenario has targets in these dwells");
    }
    group.finish();

    let mut group = criterion.benchmark_group("cfar_others");
    group.throughput(Throughput::Elements(cells as u64));
    for (name, cfar) in [("go", Cfar::Go), ("so", Cfar::So), ("os", Cfar::Os), ("clutter-map", Cfar::ClutterMap)] {
        let mut detector = Detector::new(&ExtractorConfig { cfar, ..chain.extractor.clone() }, 70);
        let (mut powers, mut hits) = (vec![0.0; cells], Vec::new());
        let (mut next, mut taken, mut total) = (0, 0, 0);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                hits.clear();
                assert!(detector.detect(next as u32, black_box(&dwells[next]), &mut powers, &mut hits));
                next = (next + 1) % dwells.len();
                taken += 1;
                total += hits.len();
            });
        });
        assert!(taken == 0 || cfar == Cfar::ClutterMap || total > 0, "the scenario has targets in these dwells");
    }
    group.finish();

    let mut group = criterion.benchmark_group("extract_dwell");
    group.throughput(Throughput::Elements(cells as u64));
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let (mut count, mut plots) = (0_u32, 0);
    group.bench_function("memory", |bencher| {
        bencher.iter(|| {
            let number = count % DWELLS;
            let header = simulator.header(count / 1040, count % 1040);
            let taken = extractor.take(&header, black_box(&dwells[number as usize]), 0, |_, found| {
                plots += found.len();
                Ok::<(), Infallible>(())
            });
            assert_eq!(taken, Ok(None));
            count += 1;
        });
    });
    group.finish();
    assert!(count == 0 || plots > 0, "the scenario has targets in these dwells");
}

/// One axis of one plot.
fn interpolate(criterion: &mut Criterion) {
    let kappa = curvature(50.0, 70.0);
    let power = |k: f64| 1.0 + 50.0 * (-kappa * (k - 0.2).powi(2)).exp();
    let powers = [power(-1.0), power(0.0), power(1.0)];
    criterion.bench_function("interpolate", |bencher| {
        bencher.iter(|| {
            let offset = centroid::interpolate(black_box(powers), kappa, 32);
            assert!((offset.cells - 0.2).abs() < 0.5 * offset.sigma);
        });
    });
}

criterion_group!(benches, extract, interpolate);
criterion_main!(benches);
