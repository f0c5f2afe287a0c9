//! Radar reports to the `plots` messages of a scan, one per sector.
//!
//! Within a turn, time and azimuth go together (see [`crate::rotation`]), but reports are in
//! order of neither. A sector holds the reports of its interval of beam angle, whatever their time
//! says; as all reports of a turn are at hand, each interval is complete when it is published. Of an antenna that stands, a
//! sector holds what came in its share of the period.

use std::f64::consts::TAU;

use common::config::{PlotSourceConfig, SiteConfig};
use common::message::{END_OF_SCAN, TRUNCATED};
use common::plots::{ARTIFICIAL, HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, MAX_PLOTS, Plot, PlotsHeader};
use common::turning::Turning;
use common::units::{NS_PER_S, seconds_between};

use crate::radar::Report;

/// Radius of the earth with which the refraction of a standard atmosphere makes rays straight, m.
const EARTH_M: f64 = 4.0 / 3.0 * 6_371_000.0;
/// A height says nothing of the elevation where its error is larger than this, rad.
const WORST_ELEVATION_RAD: f64 = 0.1;

/// A target report in measurement time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// When the beam passed the target, ns UTC.
    pub time_ns: u64,
    /// What the radar measured.
    pub report: Report,
    /// Decision statistic, if the report has an amplitude.
    pub statistic: Option<f32>,
}

/// What most reports of a radar hold besides range and azimuth: then plots have it, else none does, and scans are all of one kind.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Coordinates {
    reports: usize,
    range_rates: usize,
    heights: usize,
}

impl Coordinates {
    /// Counts a report and what it holds.
    pub fn count(&mut self, has_range_rate: bool, has_height: bool) {
        self.reports += 1;
        self.range_rates += usize::from(has_range_rate);
        self.heights += usize::from(has_height);
    }

    fn are_in_most(self, reports: usize) -> bool {
        2 * reports > self.reports
    }
}

impl<'a> FromIterator<&'a Report> for Coordinates {
    fn from_iter<I: IntoIterator<Item = &'a Report>>(reports: I) -> Self {
        let mut this = Self::default();
        for report in reports {
            this.count(report.range_rate_mps.is_some(), report.height_m.is_some());
        }
        this
    }
}

/// What all plots of a radar have in common.
#[derive(Debug, Clone)]
pub struct SectorLayout {
    sectors: u32,
    turning: Turning,
    plot: Plot,
    header: PlotsHeader,
    sigma_range_rate_mps: f32,
    sigma_height_m: f64,
    uses_identity: bool,
    lag_ns: i64,
    site_height_m: f64,
}

impl SectorLayout {
    /// From the configuration of the radar, which calls itself `source_id` (SAC and SIC), turns so and reports these coordinates.
    pub fn new(
        source_id: u32,
        turning: Turning,
        config: &PlotSourceConfig,
        site: &SiteConfig,
        coordinates: Coordinates,
    ) -> Self {
        let has_range_rate = coordinates.are_in_most(coordinates.range_rates);
        let sigma_height_m = if coordinates.are_in_most(coordinates.heights) { config.sigma_height_m } else { 0.0 };
        // As wide as errors of heights are at the end of coverage, where they are least.
        let sigma_elevation_rad = (sigma_height_m / config.coverage_range_m).min(WORST_ELEVATION_RAD);
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
            cell_elevation_rad: 12.0_f64.sqrt() * sigma_elevation_rad,
            cell_range_rate_mps: if has_range_rate { config.cell_range_rate_mps } else { 0.0 },
            pfa: config.pfa,
            source_id,
            ..PlotsHeader::default()
        };
        Self {
            sectors: config.sectors_per_scan,
            turning,
            plot,
            header,
            sigma_range_rate_mps: if has_range_rate { config.sigma_range_rate_mps as f32 } else { 0.0 },
            sigma_height_m,
            uses_identity: config.use_identity,
            lag_ns: (config.registration.plot_lag_s * NS_PER_S).round() as i64,
            site_height_m: site.position.map_or(0.0, |position| position.height_m),
        }
    }

    /// The plot of a report.
    fn plot(&self, sighting: &Sighting) -> Plot {
        let report = &sighting.report;
        let (range_m, azimuth_rad) = (report.range_m, report.azimuth_rad);
        let time_ns = self.measured_ns(sighting.time_ns);
        let mut plot = Plot { time_ns, range_m, azimuth_rad, ..self.plot };
        if let Some((elevation_rad, sigma_rad)) = report.height_m.and_then(|height_m| self.elevation(range_m, height_m))
        {
            plot.elevation_rad = elevation_rad;
            plot.sigma_elevation_rad = sigma_rad as f32;
            plot.flags |= HAS_ELEVATION;
        }
        if let Some(range_rate_mps) = report.range_rate_mps.filter(|_| self.sigma_range_rate_mps > 0.0) {
            plot.range_rate_mps = range_rate_mps;
            plot.sigma_range_rate_mps = self.sigma_range_rate_mps;
            plot.flags |= HAS_RANGE_RATE;
        }
        if let Some(statistic) = sighting.statistic {
            plot.statistic = statistic;
            plot.flags |= HAS_STATISTIC;
        }
        if report.is_artificial {
            plot.flags |= ARTIFICIAL;
        }
        if self.uses_identity {
            plot.target_id = report.address;
        }
        plot
    }

    /// When the radar measured what it says to be of `time_ns`.
    fn measured_ns(&self, time_ns: u64) -> u64 {
        time_ns.saturating_add_signed(-self.lag_ns)
    }

    /// Elevation of a target at a slant range and a height, and its standard error, rad, if heights are used and say it.
    ///
    /// ```text
    /// h − h₀ = r sin ε + r² cos² ε / 2 R,   here with cos ε = 1 in the small last term
    /// ```
    fn elevation(&self, range_m: f64, height_m: f64) -> Option<(f64, f64)> {
        let sin = (height_m - self.site_height_m) / range_m - range_m / (2.0 * EARTH_M);
        let sigma_rad = self.sigma_height_m / (range_m * (1.0 - sin * sin).sqrt());
        let is_known = self.sigma_height_m > 0.0 && sigma_rad < WORST_ELEVATION_RAD;
        is_known.then(|| (sin.asin(), sigma_rad))
    }

    /// The messages of scan number `scan`, which lasted over `bounds_ns`, in the order of sectors.
    pub fn messages(&self, scan: u32, bounds_ns: (u64, u64), sightings: &[Sighting]) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let mut sectors = vec![Vec::new(); self.sectors as usize];
        for sighting in sightings {
            let turned = match self.turning {
                Turning::Clockwise => sighting.report.azimuth_rad / TAU,
                Turning::CounterClockwise => self.turning.turned(sighting.report.azimuth_rad),
                Turning::Standing => {
                    seconds_between(bounds_ns.0, sighting.time_ns) / seconds_between(bounds_ns.0, bounds_ns.1)
                }
            };
            let sector = (turned * f64::from(self.sectors)) as usize;
            sectors[sector.min(self.sectors as usize - 1)].push(*sighting);
        }
        let numbered = (0..self.sectors).zip(&sectors);
        numbered.map(|(sector, sightings)| self.message(scan, sector, bounds_ns, sightings)).collect()
    }

    /// The message of one sector of scan number `scan`, which lasts over `bounds_ns`.
    pub fn message(
        &self,
        scan: u32,
        sector: u32,
        bounds_ns: (u64, u64),
        sightings: &[Sighting],
    ) -> (PlotsHeader, Vec<Plot>) {
        let mut plots: Vec<Plot> = sightings.iter().map(|sighting| self.plot(sighting)).collect();
        plots.sort_by(|a, b| (a.azimuth_rad, a.range_m).partial_cmp(&(b.azimuth_rad, b.range_m)).expect("no NaN"));
        let left_out = plots.len().saturating_sub(MAX_PLOTS);
        plots.truncate(MAX_PLOTS);
        let end_of_scan = if sector + 1 == self.sectors { END_OF_SCAN } else { 0 };
        let truncated = if left_out > 0 { TRUNCATED } else { 0 };
        let turned = f64::from(sector + 1) / f64::from(self.sectors);
        let covered = match self.turning {
            Turning::Standing if end_of_scan == 0 => [0.0, 0.0],
            Turning::Standing => [0.0, TAU],
            _ => [TAU * f64::from(sector) / f64::from(self.sectors), TAU * turned],
        };
        let period_ns = bounds_ns.1 - bounds_ns.0;
        let header = PlotsHeader {
            seq: u64::from(scan) * u64::from(self.sectors) + u64::from(sector),
            time_ns: self.measured_ns(bounds_ns.0 + (period_ns as f64 * turned) as u64),
            covered_from_rad: covered[0],
            covered_to_rad: covered[1],
            scan_period_s: seconds_between(bounds_ns.0, bounds_ns.1),
            detections: (plots.len() + left_out) as u64,
            scan,
            sector,
            flags: end_of_scan | truncated | self.turning.flags(),
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

    const FULL: Coordinates = Coordinates { reports: 1, range_rates: 1, heights: 1 };

    fn sighting(azimuth_rad: f64) -> Sighting {
        let report = Report { range_m: 100.0, azimuth_rad, ..Report::default() };
        Sighting { time_ns: 7, report, statistic: None }
    }

    /// What a report holds is in its plot and is marked as measured; what it does not hold is neither.
    #[test]
    fn everything_measured_is_in_the_plot() {
        let mut config = ChainConfig::default();
        config.plot_source.sigma_height_m = 50.0;
        config.plot_source.sigma_range_rate_mps = 2.0;
        let layout = SectorLayout::new(7, Turning::Clockwise, &config.plot_source, &config.site, FULL);
        assert_eq!(layout.plot(&sighting(1.0)).flags, 0);
        let (range_m, height_m) = (50_000.0, 6_000.0);
        let mut full = Sighting { statistic: Some(9.0), ..sighting(1.0) };
        full.report = Report {
            range_m,
            range_rate_mps: Some(-120.0),
            height_m: Some(height_m),
            is_artificial: true,
            address: 0x4a_bc_de,
            ..full.report
        };
        let plot = layout.plot(&full);
        assert_eq!(plot.flags, HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC | ARTIFICIAL);
        assert_eq!((plot.range_rate_mps, plot.sigma_range_rate_mps, plot.statistic), (-120.0, 2.0, 9.0));
        // Back to a height over the curved earth: the cosine law of the triangle with the centre of the earth.
        let above_m = (EARTH_M.powi(2) + range_m.powi(2) + 2.0 * EARTH_M * range_m * plot.elevation_rad.sin()).sqrt();
        assert!((above_m - EARTH_M - height_m).abs() < 5.0, "{}", above_m - EARTH_M);
        assert!((f64::from(plot.sigma_elevation_rad) - 50.0 / range_m).abs() < 1e-5);
        assert_eq!(plot.target_id, 0, "who it is is not asked for");
        config.plot_source.use_identity = true;
        let identified = SectorLayout::new(7, Turning::Clockwise, &config.plot_source, &config.site, FULL).plot(&full);
        assert_eq!(identified, Plot { target_id: 0x4a_bc_de, ..plot });
        config.plot_source.registration.plot_lag_s = 5e-9;
        let late = SectorLayout::new(7, Turning::Clockwise, &config.plot_source, &config.site, FULL).plot(&full);
        assert_eq!((identified.time_ns, late.time_ns), (7, 2));
        full.report.range_m = 100.0;
        assert!(!layout.plot(&full).has(HAS_ELEVATION), "a height above the slant range says no elevation");
    }

    #[test]
    fn every_report_is_in_the_sector_of_its_azimuth_and_every_sector_is_there() {
        let config = ChainConfig::default();
        let layout =
            SectorLayout::new(7, Turning::Clockwise, &config.plot_source, &config.site, Coordinates::default());
        let messages = layout.messages(3, (1_000, 2_000), &[TAU - 1e-9, 0.3, 0.21].map(sighting));
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

    /// The sectors of an antenna that turns the other way run from north by west; one that stands has them by time, and covers
    /// all with the last one.
    #[test]
    fn sectors_are_those_of_the_beam() {
        let config = ChainConfig::default();
        let of = |turning| SectorLayout::new(7, turning, &config.plot_source, &config.site, Coordinates::default());
        let messages = of(Turning::CounterClockwise).messages(3, (1_000, 2_000), &[TAU - 0.01, 0.01].map(sighting));
        let counts: Vec<usize> = messages.iter().map(|(_, plots)| plots.len()).collect();
        assert_eq!((counts[0], counts[31], counts.iter().sum::<usize>()), (1, 1, 2));
        assert!((messages[0].1[0].azimuth_rad - (TAU - 0.01)).abs() < 1e-12);
        assert!(messages.iter().all(|(header, _)| header.turning() == Turning::CounterClockwise));
        let seen = [1_001, 1_600].map(|time_ns| Sighting { time_ns, ..sighting(3.0) });
        let messages = of(Turning::Standing).messages(3, (1_000, 2_000), &seen);
        assert_eq!((messages[0].1.len(), messages[19].1.len()), (1, 1));
        assert!(messages[..31].iter().all(|(header, _)| header.covered_to_rad == 0.0 && !header.has(END_OF_SCAN)));
        assert_eq!((messages[31].0.covered_from_rad, messages[31].0.covered_to_rad), (0.0, TAU));
    }
}
