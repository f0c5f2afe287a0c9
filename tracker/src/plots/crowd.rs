//! Plots of one azimuth in one turn, when they are more than targets can be: a strobe, another radar's pulses.
//!
//! ```text
//! crowd = (M − 3) / cells of the box about the M plots of three cells of azimuth,   for M of at least 8
//! ```
//!
//! The clutter map knows where such plots have been; this says that they are here now.

use crate::constants::FEW;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// Plots that make one.
const CROWD: usize = 8;

/// Marks plots with the crowd about them, plots per cell: those from the `first` on, at rising `angles_rad`, and those beside it.
pub(super) fn mark(angles_rad: &[f64], plots: &mut [Measurement], first: usize, radar: &Radar) {
    let Some(&angle_rad) = angles_rad.get(first) else { return };
    let cell_of = |angle_rad: f64| (angle_rad / radar.cell[1]).floor();
    // The first plot of an azimuth cell.
    let start_of = |cell: f64| angles_rad.partition_point(|angle| cell_of(*angle) < cell);
    let mut cell = cell_of(angle_rad) - 1.0;
    let (mut before, mut here, mut next) = (start_of(cell - 1.0), start_of(cell), start_of(cell + 1.0));
    // An angle so large that cells cannot be told apart has none.
    while here < plots.len() && cell + 1.0 > cell {
        let after = next + angles_rad[next..].partition_point(|angle| cell_of(*angle) < cell + 2.0);
        let beam = before..after;
        let crowd = if beam.len() < CROWD { 0.0 } else { (beam.len() - FEW) as f64 / cells(&plots[beam], radar) };
        for plot in &mut plots[here..next] {
            plot.crowd = crowd as f32;
        }
        // To the next cell that holds a plot.
        cell = if next < after {
            cell + 1.0
        } else {
            angles_rad.get(after).map_or(f64::INFINITY, |angle| cell_of(*angle))
        };
        (before, here, next) = (start_of(cell - 1.0), next.max(start_of(cell)), start_of(cell + 1.0));
    }
}

/// Resolution cells in the box about some plots, three cells of azimuth wide.
fn cells(plots: &[Measurement], radar: &Radar) -> f64 {
    let mut cells = 3.0;
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
        mark(angles_rad, &mut plots, 0, &RADAR);
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

    proptest! {
        /// As the definition says, plot by plot.
        #[test]
        fn marks_are_those_of_the_definition(places in prop::collection::vec((0.0..3.0_f64, 100.0..5000.0_f64), 0..60)) {
            let mut places = places;
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (angles, ranges): (Vec<f64>, Vec<f64>) = places.iter().copied().unzip();
            for (k, crowd) in marked(&angles, &ranges).into_iter().enumerate() {
                let cell = |angle: f64| (angle / RADAR.cell[1]).floor();
                let beam: Vec<f64> = places.iter().filter(|place| (cell(place.0) - cell(angles[k])).abs() < 1.5).map(|place| place.1).collect();
                let span = beam.iter().copied().fold(0.0, f64::max) - beam.iter().copied().fold(f64::INFINITY, f64::min);
                let expected = if beam.len() < CROWD { 0.0 } else { (beam.len() - FEW) as f64 / (3.0 * (1.0 + span / RADAR.cell[0])) };
                prop_assert!((f64::from(crowd) - expected).abs() < 1e-6, "{} {}", crowd, expected);
            }
        }
    }
}
