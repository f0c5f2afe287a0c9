//! How far a plot lies from a target, and how far a target's echo reaches.

use common::angle;
use common::geometry::{Polar, range_rate_mps};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, Plot, PlotsHeader};
use common::truth::TruthTarget;
use common::units::seconds_between;
use nalgebra::Vector3;

/// A plot of a target is not farther than this on any axis, standard errors.
const GATE_SIGMAS: f64 = 6.0;
/// Nor than this, cells, if that is more.
const GATE_CELLS: f64 = 1.5;
/// Skirts of an echo in azimuth and elevation, rad.
const SKIRT_RAD: f64 = 1.5 * std::f64::consts::PI / 180.0;
/// Skirts of an echo in range, cells.
const SKIRT_CELLS: f64 = 4.0;
/// A plot minus a target at the time of the plot, by axis.
pub(super) struct Offset {
    by_axis: [f64; 4],
    elevated: bool,
}

impl Offset {
    pub(super) fn new(plot: &Plot, target: &TruthTarget, rate_span_mps: f64) -> Self {
        let dt_s = seconds_between(target.time_ns, plot.time_ns);
        let velocity = Vector3::from(target.velocity_mps());
        let position = Vector3::from(target.position_m()) + velocity * dt_s;
        let place = Polar::from_enu(&position);
        let rate = plot.range_rate_mps - range_rate_mps(&position, &velocity);
        let folded = if rate_span_mps > 0.0 { rate - rate_span_mps * (rate / rate_span_mps).round() } else { rate };
        Self {
            by_axis: [
                plot.range_m - place.range_m,
                angle::difference(plot.azimuth_rad, place.azimuth_rad),
                plot.elevation_rad - place.elevation_rad,
                folded,
            ],
            elevated: plot.has(HAS_ELEVATION),
        }
    }

    pub(super) fn within_skirts(&self, cells: &PlotsHeader) -> bool {
        let [range, azimuth, elevation, _] = self.by_axis.map(f64::abs);
        range <= SKIRT_CELLS * cells.cell_range_m && azimuth <= SKIRT_RAD && (!self.elevated || elevation <= SKIRT_RAD)
    }

    /// Errors over standard errors of the axes that the plot has; `None` if one is out of the gate.
    pub(super) fn normalised(&self, plot: &Plot, cells: &PlotsHeader) -> Option<[Option<f64>; 4]> {
        let measured = [true, true, plot.has(HAS_ELEVATION), plot.has(HAS_RANGE_RATE)];
        let sigmas = [plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps];
        let widths = [cells.cell_range_m, cells.cell_azimuth_rad, cells.cell_elevation_rad, cells.cell_range_rate_mps];
        let mut normalised = [None; 4];
        for axis in (0..4).filter(|&axis| measured[axis]) {
            let sigma = f64::from(sigmas[axis]);
            if self.by_axis[axis].abs() > (GATE_SIGMAS * sigma).max(GATE_CELLS * widths[axis]) {
                return None;
            }
            normalised[axis] = Some(self.by_axis[axis] / sigma);
        }
        Some(normalised)
    }
}

/// Whether the echoes of two targets can cross the threshold in neighbouring cells.
pub(super) fn skirts_touch(a: &TruthTarget, b: &TruthTarget, cells: &PlotsHeader) -> bool {
    let [a, b] = [a, b].map(|target| Polar::from_enu(&Vector3::from(target.position_m())));
    (a.range_m - b.range_m).abs() <= 2.0 * SKIRT_CELLS * cells.cell_range_m
        && angle::difference(a.azimuth_rad, b.azimuth_rad).abs() <= 2.0 * SKIRT_RAD
        && (a.elevation_rad - b.elevation_rad).abs() <= 2.0 * SKIRT_RAD
}

/// Cells near one target, as [`Offset::within_skirts`] counts them.
pub(super) fn skirt_cells(target: &TruthTarget, cells: &PlotsHeader, dopplers: f64) -> f64 {
    let across = |half: f64, cell: f64| if cell > 0.0 { (2.0 * half / cell).round() + 1.0 } else { 1.0 };
    let elevation = Polar::from_enu(&Vector3::from(target.position_m())).elevation_rad;
    // Beams below the horizon do not exist.
    let below = SKIRT_RAD.min(elevation.max(0.0));
    let beams = across(0.5 * (SKIRT_RAD + below), cells.cell_elevation_rad);
    across(SKIRT_RAD, cells.cell_azimuth_rad) * beams * (2.0 * SKIRT_CELLS + 1.0) * dopplers
}
