//! Radar reports to the `plots` messages of a scan, one per sector.
//!
//! Within a turn, time and azimuth go together (see [`crate::rotation`]), but reports are in
//! order of neither. A sector holds the reports of its azimuth interval, whatever their time
//! says; as all reports of a turn are at hand, each interval is complete when it is published.

use std::f64::consts::TAU;

use common::config::PlotSourceConfig;
use common::message::{END_OF_SCAN, TRUNCATED};
use common::plots::{MAX_PLOTS, Plot, PlotsHeader};
use common::units::seconds_between;

/// A target report in measurement time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// When the beam passed the target, ns UTC.
    pub time_ns: u64,
    /// Slant range, m.
    pub range_m: f64,
    /// Azimuth after registration, rad, in [0, 2π).
    pub azimuth_rad: f64,
}

/// What all plots of a radar have in common.
#[derive(Debug, Clone)]
pub struct SectorLayout {
    sectors: u32,
    plot: Plot,
    header: PlotsHeader,
}

impl SectorLayout {
    /// From the configuration of the radar, which calls itself `source_id` (SAC and SIC).
    pub fn new(source_id: u32, config: &PlotSourceConfig) -> Self {
        let plot = Plot {
            sigma_range_m: config.sigma_range_m as f32,
            sigma_azimuth_rad: config.sigma_azimuth_deg.to_radians() as f32,
            cell_count: 1,
            source_id,
            ..Plot::default()
        };
        let header = PlotsHeader {
            sectors_per_scan: config.sectors_per_scan,
            cell_range_m: config.cell_range_m,
            cell_azimuth_rad: config.cell_azimuth_deg.to_radians(),
            source_id,
            ..PlotsHeader::default()
        };
        Self { sectors: config.sectors_per_scan, plot, header }
    }

    /// The messages of scan number `scan`, which lasted over `bounds_ns`, in the order of sectors.
    pub fn messages(&self, scan: u32, bounds_ns: (u64, u64), reports: &[Sighting]) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let mut sectors = vec![Vec::new(); self.sectors as usize];
        for report in reports {
            let sector = (report.azimuth_rad / TAU * f64::from(self.sectors)) as usize;
            sectors[sector.min(self.sectors as usize - 1)].push(Plot {
                time_ns: report.time_ns,
                range_m: report.range_m,
                azimuth_rad: report.azimuth_rad,
                ..self.plot
            });
        }
        (0..self.sectors).zip(sectors).map(|(sector, plots)| self.message(scan, sector, bounds_ns, plots)).collect()
    }

    fn message(&self, scan: u32, sector: u32, bounds_ns: (u64, u64), mut plots: Vec<Plot>) -> (PlotsHeader, Vec<Plot>) {
        plots.sort_by(|a, b| (a.azimuth_rad, a.range_m).partial_cmp(&(b.azimuth_rad, b.range_m)).expect("no NaN"));
        let left_out = plots.len().saturating_sub(MAX_PLOTS);
        plots.truncate(MAX_PLOTS);
        let end_of_scan = if sector + 1 == self.sectors { END_OF_SCAN } else { 0 };
        let truncated = if left_out > 0 { TRUNCATED } else { 0 };
        let turned = f64::from(sector + 1) / f64::from(self.sectors);
        let period_ns = bounds_ns.1 - bounds_ns.0;
        let header = PlotsHeader {
            seq: u64::from(scan) * u64::from(self.sectors) + u64::from(sector),
            time_ns: bounds_ns.0 + (period_ns as f64 * turned) as u64,
            covered_from_rad: TAU * f64::from(sector) / f64::from(self.sectors),
            covered_to_rad: TAU * turned,
            scan_period_s: seconds_between(bounds_ns.0, bounds_ns.1),
            detections: (plots.len() + left_out) as u64,
            scan,
            sector,
            flags: end_of_scan | truncated,
            left_out: left_out as u32,
            ..self.header
        };
        (header, plots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::ChainConfig;

    #[test]
    fn every_report_is_in_the_sector_of_its_azimuth_and_every_sector_is_there() {
        let config = ChainConfig::default();
        let layout = SectorLayout::new(7, &config.plot_source);
        let report = |azimuth_rad| Sighting { time_ns: 7, range_m: 100.0, azimuth_rad };
        let messages = layout.messages(3, (1_000, 2_000), &[report(TAU - 1e-9), report(0.3), report(0.21)]);
        assert_eq!(messages.len(), 32);
        for (index, (header, plots)) in messages.iter().enumerate() {
            assert_eq!((header.seq, header.sector as usize), (96 + index as u64, index));
            assert_eq!(header.has(END_OF_SCAN), index == 31);
            let covered = header.covered_from_rad..header.covered_to_rad;
            assert!(plots.iter().all(|plot| covered.contains(&plot.azimuth_rad) && plot.target_id == 0));
        }
        assert_eq!(messages[1].1.iter().map(|plot| plot.azimuth_rad).collect::<Vec<_>>(), [0.21, 0.3]);
        assert_eq!((messages[0].0.time_ns, messages[31].0.time_ns), (1_031, 2_000));
    }
}
