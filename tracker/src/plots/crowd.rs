//! Plots of one azimuth in one turn, when they are more than targets can be: a strobe, another radar's pulses.
//!
//! ```text
//! crowd = (M − usual) / cells of the box about the M plots of three cells of azimuth,   for M of at least 8
//! usual = max(3, plots of the last turn · 3 δ_β / 2π)
//! ```
//!
//! The clutter map knows where such plots have been; this says that they are here now. In a sky full of targets all azimuths have many plots,
//! and none has a crowd.

use std::f64::consts::TAU;

use crate::constants::FEW;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// Plots that make one.
const CROWD: usize = 8;
/// Cells of azimuth that it is looked for in.
const BEAM_CELLS: f64 = 3.0;

/// Marks plots with the crowd about them, plots per cell: those from the `first` on, at rising `angles_rad`, and those beside it. `azimuths` is
/// room for the azimuth cells of plots.
pub(super) fn mark(
    angles_rad: &[f64],
    plots: &mut [Measurement],
    first: usize,
    radar: &Radar,
    azimuths: &mut Vec<f64>,
) {
    let (Some(&angle_rad), Some(&newest_rad)) = (angles_rad.get(first), angles_rad.last()) else { return };
    let turn = plots.len() - angles_rad.partition_point(|angle| *angle < newest_rad - TAU);
    let usual = (turn as f64 * BEAM_CELLS * radar.cell[1] / TAU).max(FEW as f64);
    let cell_of = |angle_rad: f64| (angle_rad / radar.cell[1]).floor();
    let first_cell = cell_of(angle_rad);
    // What lies beside the cells that are marked, from two cells before the first plot on.
    let begin = angles_rad.partition_point(|angle| cell_of(*angle) < first_cell - 2.0);
    let plots = &mut plots[begin..];
    azimuths.clear();
    azimuths.extend(angles_rad[begin..].iter().map(|angle| cell_of(*angle)));
    let mut here = azimuths.partition_point(|cell| *cell < first_cell - 1.0);
    let (mut before, mut after) = (0, here);
    // An angle so large that cells cannot be told apart has none.
    while let Some(&cell) = azimuths.get(here).filter(|cell| **cell + 1.0 > **cell) {
        let passed = |from: usize, limit: f64| from + azimuths[from..].iter().take_while(|cell| **cell < limit).count();
        let next = passed(here, cell + 1.0);
        before = passed(before, cell - 1.0);
        after = passed(after.max(next), cell + 2.0);
        let excess = (after - before) as f64 - usual;
        let is_crowd = after - before >= CROWD && excess > 0.0;
        let crowd = if is_crowd { excess / cells(&plots[before..after], radar) } else { 0.0 };
        for plot in &mut plots[here..next] {
            plot.crowd = crowd as f32;
        }
        here = next;
    }
}

/// Resolution cells in the box about some plots of a beam.
fn cells(plots: &[Measurement], radar: &Radar) -> f64 {
    let mut cells = BEAM_CELLS;
    for i in (0..COORDINATES).filter(|&i| i != 1 && radar.measured[i]) {
        let values = plots.iter().map(|plot| plot.polar[i]);
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        cells *= 1.0 + (high - low) / radar.cell[i];
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RADAR: Radar = Radar {
        variance: [1.0; 4],
        cell: [10.0, 0.1, 1.0, 1.0],
        measured: [true, true, false, false],
        range_rate_interval_mps: 0.0,
    };

    fn marked(angles_rad: &[f64], ranges_m: &[f64]) -> Vec<f32> {
        let mut plots: Vec<_> =
            angles_rad.iter().zip(ranges_m).map(|(angle, range)| Measurement::at(*range, *angle)).collect();
        mark(angles_rad, &mut plots, 0, &RADAR, &mut Vec::new());
        plots.iter().map(|plot| plot.crowd).collect()
    }

    #[test]
    fn a_strobe_is_a_crowd_and_a_target_beside_it_is_not() {
        let mut angles = vec![1.05; 20];
        angles.extend([2.05, 3.05]);
        let ranges: Vec<f64> = (0..22).map(|k| 1000.0 + 100.0 * f64::from(k)).collect();
        let crowd = marked(&angles, &ranges);
        // Seventeen plots in three cells of azimuth and 191 of range.
        assert!((f64::from(crowd[7]) - 17.0 / (3.0 * 191.0)).abs() < 1e-6, "{crowd:?}");
        assert_eq!(crowd[20..], [0.0, 0.0]);
    }

    #[test]
    fn where_all_azimuths_have_many_plots_only_more_than_usual_are_a_crowd() {
        // Twenty plots in each of the 62 cells of a turn, then sixty more in one of them.
        let mut angles: Vec<f64> = (0..1240).map(|k| 0.05 + 0.1 * f64::from(k / 20)).collect();
        let ranges: Vec<f64> = (0..1300).map(|k| 1000.0 + 100.0 * f64::from(k % 20)).collect();
        // Sixty in a beam are as many as usual, but for the rest of a cell that is none.
        assert!(marked(&angles, &ranges[..1240]).iter().all(|crowd| f64::from(*crowd) < 1.0 / (3.0 * 191.0)));
        let strobe = angles.partition_point(|angle| *angle < 3.0);
        angles.splice(strobe..strobe, std::iter::repeat_n(3.05, 60));
        let crowd = marked(&angles, &ranges);
        let usual = 1300.0 * 3.0 * 0.1 / TAU;
        assert!((f64::from(crowd[strobe]) - (120.0 - usual) / (3.0 * 191.0)).abs() < 1e-6, "{}", crowd[strobe]);
        assert!(crowd[..strobe - 40].iter().all(|crowd| *crowd == 0.0));
    }

    proptest! {
        /// As the definition says, plot by plot.
        #[test]
        fn marks_are_those_of_the_definition(places in prop::collection::vec((0.0..9.0_f64, 100.0..5000.0_f64), 0..200)) {
            let mut places = places;
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (angles, ranges): (Vec<f64>, Vec<f64>) = places.iter().copied().unzip();
            let newest = angles.last().copied().unwrap_or_default();
            let turn = angles.iter().filter(|angle| **angle >= newest - TAU).count();
            let usual = (turn as f64 * 3.0 * RADAR.cell[1] / TAU).max(FEW as f64);
            for (k, crowd) in marked(&angles, &ranges).into_iter().enumerate() {
                let cell = |angle: f64| (angle / RADAR.cell[1]).floor();
                let beam: Vec<f64> = places.iter().filter(|place| (cell(place.0) - cell(angles[k])).abs() < 1.5).map(|place| place.1).collect();
                let span = beam.iter().copied().fold(0.0, f64::max) - beam.iter().copied().fold(f64::INFINITY, f64::min);
                let excess = (beam.len() as f64 - usual).max(0.0);
                let expected = if beam.len() < CROWD { 0.0 } else { excess / (3.0 * (1.0 + span / RADAR.cell[0])) };
                prop_assert!((f64::from(crowd) - expected).abs() < 1e-6, "{} {}", crowd, expected);
            }
        }
    }
}
