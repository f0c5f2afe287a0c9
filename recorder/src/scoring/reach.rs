//! How far a track may be from its target: a matter of the radar's cells, the range, and the way a target makes in a scan.

use common::config::RadarConfig;
use common::plots::PlotsHeader;

/// A track of a target is within so many cells of it.
const CELLS: f64 = 3.0;
/// And within this share of the way that the target makes in a scan, if it has begun to turn.
const WAY: f64 = 0.5;

/// Sizes of a radar's resolution cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    range_m: f64,
    azimuth_rad: f64,
    /// 0 for a radar without elevation.
    elevation_rad: f64,
}

impl Reach {
    /// Of the simulated radar.
    pub(super) fn of_radar(radar: &RadarConfig) -> Self {
        let azimuth_deg = radar.beamwidth_azimuth_deg.max(360.0 / f64::from(radar.dwells_per_scan));
        let elevation_deg = radar.beamwidth_elevation_deg.max(radar.elevation_step_deg);
        Self {
            range_m: radar.range_step_m,
            azimuth_rad: azimuth_deg.to_radians(),
            elevation_rad: if radar.elevations > 1 { elevation_deg.to_radians() } else { 0.0 },
        }
    }

    /// Of the radar that sent these plots, if they say.
    pub(super) fn of_plots(header: &PlotsHeader) -> Option<Self> {
        let PlotsHeader { cell_range_m, cell_azimuth_rad, cell_elevation_rad, .. } = *header;
        let reach = Self { range_m: cell_range_m, azimuth_rad: cell_azimuth_rad, elevation_rad: cell_elevation_rad };
        (cell_range_m > 0.0).then_some(reach)
    }

    /// Whether the radar measures elevation.
    pub(super) fn is_elevated(&self) -> bool {
        self.elevation_rad > 0.0
    }

    /// A track that follows a target at `range_m` (m) with `speed_mps` (m/s), seen every `scan_period_s`, is not farther from it
    /// than this, m.
    pub(super) fn gate_m(&self, range_m: f64, speed_mps: f64, scan_period_s: f64) -> f64 {
        let cell_m = self.range_m.hypot(range_m * self.azimuth_rad).hypot(range_m * self.elevation_rad);
        CELLS * cell_m + WAY * speed_mps * scan_period_s
    }
}

/// Time in which the beam passes a target wholly, as a share of a scan.
pub(super) fn beam_scans(radar: &RadarConfig) -> f64 {
    radar.beamwidth_azimuth_deg / 360.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_grows_with_the_cells_the_range_and_the_time_between_looks() {
        let reach = Reach { range_m: 60.0, azimuth_rad: 0.02, elevation_rad: 0.0 };
        assert!((reach.gate_m(4000.0, 0.0, 10.0) - 300.0).abs() < 1e-9);
        assert!((reach.gate_m(4000.0, 200.0, 10.0) - 1300.0).abs() < 1e-9);
        assert!(reach.gate_m(100_000.0, 0.0, 10.0) > 6000.0);
    }
}
