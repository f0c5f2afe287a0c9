//! Where ground clutter is: lowest beams, filters about zero, first ranges.

use common::config::{ChainConfig, RadarConfig};
use common::plots::Plot;

/// Clutter matters down to this far below noise, dB.
const CLUTTER_MARGIN_DB: f64 = 10.0;

/// The region, and how much of all cells it is.
#[derive(Debug)]
pub(super) struct ClutterRegion {
    range_m: f64,
    elevation_rad: f64,
    range_rate_mps: f64,
    /// Share of all cells that lies in it.
    pub(super) share: f64,
}

impl ClutterRegion {
    pub(super) fn new(config: &ChainConfig) -> Self {
        let (radar, clutter) = (&config.radar, &config.sim.clutter);
        if clutter.range_m <= 0.0 {
            return Self { range_m: 0.0, elevation_rad: 0.0, range_rate_mps: 0.0, share: 0.0 };
        }
        // A Gaussian skirt of half-power width w is A dB down at w/2 · √(A / 3.01 dB).
        let reach = |width: f64| 0.5 * width * ((clutter.cnr_db + CLUTTER_MARGIN_DB).max(0.0) / 3.01).sqrt();
        let window = f64::from(config.extractor.guard_cells + config.extractor.reference_cells);
        let mut region = Self {
            range_m: clutter.range_m + window * radar.range_step_m,
            elevation_rad: (reach(radar.beamwidth_elevation_deg) + radar.elevation_step_deg).to_radians(),
            range_rate_mps: reach(radar.doppler_width_mps) + 0.5 * radar.range_rate_step_mps,
            share: 0.0,
        };
        region.share = region.share_of(radar);
        region
    }

    fn share_of(&self, radar: &RadarConfig) -> f64 {
        let share = |count: u32, inside: &dyn Fn(f64) -> bool| {
            (0..count).filter(|&index| inside(f64::from(index))).count() as f64 / f64::from(count)
        };
        let range = share(radar.ranges, &|cell| radar.range_first_m + radar.range_step_m * cell <= self.range_m);
        let elevation = share(radar.elevations, &|beam| {
            (radar.elevation_first_deg + radar.elevation_step_deg * beam).to_radians() <= self.elevation_rad
        });
        let rate = share(radar.dopplers, &|filter| {
            (radar.range_rate_first_mps() + radar.range_rate_step_mps * filter).abs() <= self.range_rate_mps
        });
        range * elevation * rate
    }

    pub(super) fn holds(&self, plot: &Plot) -> bool {
        plot.range_m <= self.range_m
            && plot.elevation_rad <= self.elevation_rad
            && plot.range_rate_mps.abs() <= self.range_rate_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_clutter_all_cells_count() {
        let mut config = ChainConfig::default();
        config.sim.clutter.range_m = 0.0;
        assert!(ClutterRegion::new(&config).share.abs() < 1e-12);
        config.sim.clutter.range_m = 1000.0;
        let share = ClutterRegion::new(&config).share;
        assert!(share > 0.0 && share < 0.1, "{share}");
    }
}
