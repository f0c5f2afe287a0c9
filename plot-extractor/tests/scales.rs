//! A radar that changes the scale of its range, or the number of its cells, in the middle of a turn.

mod marine;

use std::f64::consts::TAU;

use common::config::ChainConfig;
use common::plots::Plot;
use marine::{DWELLS, take};
use plot_extractor::PlotExtractor;

/// The change comes between these dwells, in the middle of an echo.
const CHANGE: u32 = 100;
const TARGET_M: f64 = 1200.0;

/// Plots of a turn with an echo that is nine dwells wide at one range, in whichever cell that is.
fn plots((step_before_m, ranges_before): (f64, u32), (step_m, ranges): (f64, u32)) -> Vec<Plot> {
    let mut chain = ChainConfig::default();
    chain.radar.pulse_width_m = 10.0;
    chain.radar.beamwidth_azimuth_deg = 4.0;
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut found = Vec::new();
    for dwell in 0..DWELLS {
        let (range_step_m, ranges) = if dwell < CHANGE { (step_before_m, ranges_before) } else { (step_m, ranges) };
        let mut amplitudes = vec![1.0_f32; ranges as usize];
        if dwell.abs_diff(CHANGE) < 5 {
            amplitudes[(TARGET_M / range_step_m).round() as usize] = 40.0;
        }
        take(&mut extractor, (0, dwell), range_step_m, &amplitudes, &mut found);
    }
    found
}

/// The echo is cut into one plot of each scale, both at its range; without a change it is one.
#[test]
fn each_scale_gives_plots_at_their_ranges() {
    for (before, after, count) in [
        ((10.0, 300), (10.0, 300), 1),
        ((10.0, 300), (20.0, 300), 2),
        ((20.0, 300), (10.0, 300), 2),
        ((10.0, 300), (10.0, 200), 2),
        ((10.0, 200), (5.0, 600), 2),
    ] {
        let plots = plots(before, after);
        assert_eq!(plots.len(), count, "{before:?} {after:?}: {plots:?}");
        for plot in &plots {
            assert!((plot.range_m - TARGET_M).abs() < 10.0, "{before:?} {after:?}: {} m", plot.range_m);
            let beside_rad = plot.azimuth_rad - f64::from(CHANGE) * TAU / f64::from(DWELLS);
            assert!(beside_rad.abs() < 6.0_f64.to_radians(), "{before:?} {after:?}: {beside_rad}");
        }
    }
}
