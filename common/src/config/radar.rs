//! `[radar]`: scan and resolution cells of the simulated radar.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative, positive, require, within};
use crate::dwell::MAX_CELLS;

/// A stacked-beam radar that turns: every dwell is one azimuth step with all elevation
/// beams, Doppler and range cells. Defaults are \[L22\]'s cells: σ = δ/(2√3) gives 20 m, 0.1° and 10 m/s (C1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RadarConfig {
    /// Time of one turn, s.
    pub scan_period_s: f64,
    /// Azimuth steps in a turn.
    pub dwells_per_scan: u32,
    /// Sectors in a turn: plots and tracks are published once per sector.
    pub sectors_per_scan: u32,
    /// Elevation beams.
    pub elevations: u32,
    /// Centre of the lowest beam, degrees.
    pub elevation_first_deg: f64,
    /// Between beams, degrees.
    pub elevation_step_deg: f64,
    /// Doppler cells; the cell at index dopplers/2 is centred at zero.
    pub dopplers: u32,
    /// Width of a Doppler cell, m/s.
    pub range_rate_step_mps: f64,
    /// Range cells.
    pub ranges: u32,
    /// Centre of the first range cell, m.
    pub range_first_m: f64,
    /// Width of a range cell, m.
    pub range_step_m: f64,
    /// Two-way half-power width of the antenna beam in azimuth, degrees.
    pub beamwidth_azimuth_deg: f64,
    /// Two-way half-power width of the antenna beam in elevation, degrees.
    pub beamwidth_elevation_deg: f64,
    /// Half-power width of the compressed pulse, m.
    pub pulse_width_m: f64,
    /// Half-power width of the Doppler filter, m/s.
    pub doppler_width_mps: f64,
    /// Signal-to-noise ratio of 1 m² at 1 km in the centre of the beam, dB (radar equation).
    pub snr_1m2_1km_db: f64,
    /// What it measures too much in range, m: a systematic error, for fusion to find.
    pub range_bias_m: f64,
    /// The same in azimuth, degrees.
    pub azimuth_bias_deg: f64,
    /// The same in elevation, degrees.
    pub elevation_bias_deg: f64,
}

impl Default for RadarConfig {
    fn default() -> Self {
        Self {
            scan_period_s: 1.0,
            dwells_per_scan: 1040,
            sectors_per_scan: 32,
            elevations: 58,
            elevation_first_deg: 0.173,
            elevation_step_deg: 0.346,
            dopplers: 6,
            range_rate_step_mps: 34.6,
            ranges: 70,
            range_first_m: 234.6,
            range_step_m: 69.3,
            beamwidth_azimuth_deg: 0.5,
            beamwidth_elevation_deg: 0.5,
            pulse_width_m: 90.0,
            doppler_width_mps: 45.0,
            snr_1m2_1km_db: 62.0,
            range_bias_m: 0.0,
            azimuth_bias_deg: 0.0,
            elevation_bias_deg: 0.0,
        }
    }
}

/// The cells of a dwell in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadarGrid {
    /// Elevation beams.
    pub elevations: usize,
    /// Doppler cells.
    pub dopplers: usize,
    /// Range cells.
    pub ranges: usize,
}

impl RadarGrid {
    /// Cells in a dwell.
    pub fn cells(&self) -> usize {
        self.elevations * self.dopplers * self.ranges
    }
}

impl RadarConfig {
    /// The cells of a dwell.
    pub fn grid(&self) -> RadarGrid {
        RadarGrid {
            elevations: self.elevations as usize,
            dopplers: self.dopplers as usize,
            ranges: self.ranges as usize,
        }
    }

    /// Range rate at the centre of the first Doppler cell, m/s.
    pub fn range_rate_first_mps(&self) -> f64 {
        -f64::from(self.dopplers / 2) * self.range_rate_step_mps
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let valid = (1e-3..=1e4).contains(&self.scan_period_s);
        require("radar.scan_period_s", self.scan_period_s, valid, "a number from 0.001 to 10000")?;
        within("radar.dwells_per_scan", self.dwells_per_scan.into(), 4..=65_536)?;
        within("radar.sectors_per_scan", self.sectors_per_scan.into(), 1..=u64::from(self.dwells_per_scan))?;
        within("radar.elevations", self.elevations.into(), 1..=1024)?;
        within("radar.dopplers", self.dopplers.into(), 1..=1024)?;
        within("radar.ranges", self.ranges.into(), 8..=65_536)?;
        let expected = format!("at most {MAX_CELLS} cells in a dwell (elevations × dopplers × ranges)");
        require("radar.ranges", self.ranges, self.grid().cells() <= MAX_CELLS, &expected)?;
        let top_deg = self.elevation_first_deg + self.elevation_step_deg * f64::from(self.elevations);
        let within_sky = self.elevation_first_deg > -90.0 && top_deg < 90.0;
        require("radar.elevation_first_deg", self.elevation_first_deg, within_sky, "all beams between -90° and 90°")?;
        positive("radar.elevation_step_deg", self.elevation_step_deg)?;
        let valid = (1e-3..=1e6).contains(&self.range_rate_step_mps);
        require("radar.range_rate_step_mps", self.range_rate_step_mps, valid, "a number from 0.001 to 1000000")?;
        positive("radar.range_step_m", self.range_step_m)?;
        not_negative("radar.range_first_m", self.range_first_m)?;
        positive("radar.beamwidth_azimuth_deg", self.beamwidth_azimuth_deg)?;
        positive("radar.beamwidth_elevation_deg", self.beamwidth_elevation_deg)?;
        positive("radar.pulse_width_m", self.pulse_width_m)?;
        positive("radar.doppler_width_mps", self.doppler_width_mps)?;
        require("radar.snr_1m2_1km_db", self.snr_1m2_1km_db, self.snr_1m2_1km_db.is_finite(), "a finite number")
    }
}
