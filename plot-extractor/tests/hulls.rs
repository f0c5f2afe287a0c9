//! Targets longer than a cell: each gives one plot a turn, in its middle, with an error that is as stated.

mod marine;

use common::config::ChainConfig;
use common::plots::Plot;
use common::random::{Purpose, generator};
use marine::{DWELLS, take};
use plot_extractor::PlotExtractor;
use rand::RngExt;

/// Range cells of a marine radar.
const RANGES: u32 = 300;
const RANGE_STEP_M: f64 = 7.5;

fn chain() -> ChainConfig {
    let mut chain = ChainConfig::default();
    chain.radar.pulse_width_m = 10.0;
    chain.radar.beamwidth_azimuth_deg = 1.5;
    chain
}

/// A hull: first range cell and first dwell of it, and how many; parts of cells count by their share of the power.
#[derive(Clone, Copy)]
struct Hull {
    range: (f64, f64),
    dwell: (f64, f64),
    snr: f64,
}

/// How much of a cell lies in an interval.
fn share((first, length): (f64, f64), cell: u32) -> f64 {
    let cell = f64::from(cell);
    ((first + length).min(cell + 0.5) - first.max(cell - 0.5)).clamp(0.0, 1.0)
}

/// All plots of `scans` turns. Cells of the hull are Rayleigh distributed, each anew in every turn.
fn plots(hull: Hull, scans: u32, seed: u64) -> Vec<Plot> {
    let chain = chain();
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut found = Vec::new();
    let mut rng = generator(seed, Purpose::Test, 0, 0);
    for scan in 0..scans {
        for dwell in 0..DWELLS {
            let amplitudes: Vec<f32> = (0..RANGES)
                .map(|range| {
                    let power = 1.0 + hull.snr * share(hull.range, range) * share(hull.dwell, dwell);
                    (power * -f64::ln(1.0 - rng.random::<f64>())).sqrt() as f32
                })
                .collect();
            take(&mut extractor, (scan, dwell), RANGE_STEP_M, &amplitudes, &mut found);
        }
    }
    found
}

/// Sizes in range cells and dwells, everywhere between cells.
#[test]
fn a_hull_is_one_plot_in_its_middle() {
    let (scans, runs) = (1, 24);
    for snr_db in [25.0, 40.0, 60.0] {
        let (mut count, mut sums) = (0, [0.0; 2]);
        for (length, width) in [(2.0, 1.0), (3.0, 1.0), (5.0, 2.0), (10.0, 3.0), (20.0, 5.0), (40.0, 8.0), (60.0, 10.0)]
        {
            for run in 0..runs {
                let mut rng = generator(run, Purpose::Test, 1, 0);
                let mut anywhere = || rng.random::<f64>() - 0.5;
                let range = (99.5 + anywhere(), length + 0.5 * anywhere());
                let dwell = (39.5 + anywhere(), width + 0.5 * anywhere());
                let hull = Hull { range, dwell, snr: 10_f64.powf(snr_db / 10.0) };
                let range_m = RANGE_STEP_M * (range.0 + range.1 / 2.0);
                let azimuth_rad = (dwell.0 + dwell.1 / 2.0 + 0.5).to_radians();
                let mut plots = plots(hull, scans, run);
                plots.retain(|plot| {
                    (plot.range_m - range_m).abs() < RANGE_STEP_M * (length / 2.0 + 3.0)
                        && (plot.azimuth_rad - azimuth_rad).abs() < (width / 2.0 + 3.0).to_radians()
                });
                assert_eq!(plots.len(), scans as usize, "{length} x {width} cells, {snr_db} dB, run {run}");
                count += plots.len();
                for plot in plots {
                    sums[0] += ((plot.range_m - range_m) / f64::from(plot.sigma_range_m)).powi(2);
                    sums[1] += ((plot.azimuth_rad - azimuth_rad) / f64::from(plot.sigma_azimuth_rad)).powi(2);
                }
            }
        }
        let means = sums.map(|sum| sum / count as f64);
        assert!(means.iter().all(|mean| (0.3..1.25).contains(mean)), "{snr_db} dB: {means:?}");
    }
}

/// The hull of 20 cells by 5 dwells fades; it is followed for 20 turns without a second plot beside it.
#[test]
fn a_fading_hull_stays_whole() {
    let hull = Hull { range: (89.5, 20.0), dwell: (37.5, 5.0), snr: 10_f64.powf(2.0) };
    let plots = plots(hull, 20, 7);
    let near: Vec<&Plot> = plots
        .iter()
        .filter(|plot| {
            (plot.range_m - 99.0 * RANGE_STEP_M).abs() < 150.0 && (plot.azimuth_rad - 40.0_f64.to_radians()).abs() < 0.1
        })
        .collect();
    assert_eq!(near.len(), 20);
    for plot in near {
        let to_centre_m = (plot.range_m - 99.0 * RANGE_STEP_M).abs();
        assert!(to_centre_m < 4.0 * f64::from(plot.sigma_range_m), "{plot:?}");
    }
}

/// Two points a few cells apart are not taken for a hull.
#[test]
fn two_targets_are_no_hull() {
    for gap in [6, 12, 18, 30] {
        let chain = chain();
        let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
        let mut found = Vec::new();
        let mut amplitudes = vec![1.0_f32; RANGES as usize];
        (amplitudes[100], amplitudes[100 + gap]) = (30.0, 30.0);
        for dwell in 0..DWELLS {
            let cells = if dwell == 1 { amplitudes.clone() } else { vec![1.0; RANGES as usize] };
            take(&mut extractor, (0, dwell), RANGE_STEP_M, &cells, &mut found);
        }
        assert_eq!(found.len(), 2, "{gap} cells apart");
    }
}
