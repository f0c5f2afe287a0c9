//! The dwells of a turn: what the header of each says.

use std::f64::consts::TAU;

use common::config::RadarConfig;
use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR};

use crate::spoke::Spoke;

/// Dwells and sectors of a radar with one elevation and one Doppler cell.
#[derive(Debug, Clone)]
pub(crate) struct Schedule {
    dwells_per_scan: u32,
    sectors_per_scan: u32,
    elevation_step_rad: f64,
    range_rate_step_mps: f64,
}

impl Schedule {
    /// That of a configuration.
    pub(crate) fn new(radar: &RadarConfig) -> Self {
        Self {
            dwells_per_scan: radar.dwells_per_scan,
            sectors_per_scan: radar.sectors_per_scan,
            elevation_step_rad: radar.elevation_step_deg.to_radians(),
            range_rate_step_mps: radar.range_rate_step_mps,
        }
    }

    fn sector_of(&self, dwell: u32) -> u32 {
        (u64::from(dwell) * u64::from(self.sectors_per_scan) / u64::from(self.dwells_per_scan)) as u32
    }

    /// The header of the dwell at the position `seq` of the schedule, which is the spoke measured at `time_ns`.
    pub(crate) fn header(&self, seq: u64, time_ns: u64, scan_period_s: f64, spoke: &Spoke) -> DwellHeader {
        let dwells_per_scan = self.dwells_per_scan;
        let scan = (seq / u64::from(dwells_per_scan)) as u32;
        let dwell = (seq % u64::from(dwells_per_scan)) as u32;
        let sector = self.sector_of(dwell);
        let ends_scan = dwell + 1 == dwells_per_scan;
        let ends_sector = ends_scan || self.sector_of(dwell + 1) != sector;
        let azimuth_step_rad = TAU / f64::from(dwells_per_scan);
        DwellHeader {
            seq,
            time_ns,
            azimuth_rad: (f64::from(dwell) + 0.5) * azimuth_step_rad,
            azimuth_step_rad,
            elevation_first_rad: 0.0,
            elevation_step_rad: self.elevation_step_rad,
            range_rate_first_mps: 0.0,
            range_rate_step_mps: self.range_rate_step_mps,
            range_first_m: spoke.range_first_m,
            range_step_m: spoke.range_step_m,
            scan_period_s,
            scan,
            dwell,
            dwells_per_scan,
            sector,
            sectors_per_scan: self.sectors_per_scan,
            elevations: 1,
            dopplers: 1,
            ranges: spoke.cells as u32,
            flags: if ends_sector { END_OF_SECTOR } else { 0 } | if ends_scan { END_OF_SCAN } else { 0 },
            source_id: spoke.source_id,
            full_scale: spoke.packing.full_scale(),
            ..DwellHeader::default()
        }
    }
}
