//! A radar that turns without cells: targets' plots and false plots in, `plots` messages out, for experiments on whole trackers.
//!
//! Detection and decision statistics follow (C4) with known noise; errors of plots are normal with the standard errors
//! that they state. False plots are a Poisson process of F per cell over a volume.

use std::f64::consts::TAU;

use common::amplitude::Detector;
use common::angle;
use common::geometry::Polar;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::units::NS_PER_S;
use radar_sim::motion::Segments;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, Poisson};
use tracker::plots::measurement::COORDINATES;

use crate::world::{Conditions, place, power, scattered};

/// Start of measurement time, ns.
pub const EPOCH_NS: u64 = 1_700_000_000_000_000_000;
/// Time of a turn, s.
pub const PERIOD_S: f64 = 1.0;
/// Messages in a turn.
const SECTORS: u32 = 32;
/// Cells of \[L22\] (C1): range, azimuth, elevation, range rate.
pub const CELL: [f64; COORDINATES] = [69.3, 0.006_04, 0.006_04, 34.6];

/// Where there are false plots.
#[derive(Debug, Clone, Copy)]
pub struct Volume {
    /// Its middle: range, azimuth, elevation, range rate.
    pub middle: [f64; COORDINATES],
    /// Cells on each axis.
    pub cells: [u32; COORDINATES],
}

impl Volume {
    /// Cells in all.
    pub fn size(&self) -> f64 {
        self.cells.iter().copied().map(f64::from).product()
    }

    fn somewhere(&self, rng: &mut impl Rng) -> [f64; COORDINATES] {
        let [range, azimuth, elevation, rate] =
            std::array::from_fn(|i| self.middle[i] + CELL[i] * f64::from(self.cells[i]) * (rng.random::<f64>() - 0.5));
        [range.max(1.0), angle::wrap(azimuth), elevation, rate]
    }
}

/// The messages of a turn with the plots that lie in each of them.
pub type Turn = Vec<(PlotsHeader, Vec<Plot>)>;

/// What the radar's plots are like.
#[derive(Debug, Clone, Copy)]
pub struct Turning {
    /// F per cell.
    pub pfa: f64,
    /// Standard errors of plots, which they state: range, azimuth, elevation, range rate.
    pub sigma: [f64; COORDINATES],
}

impl Turning {
    /// The plot of a target in turn `scan`, if it is detected.
    pub fn target(&self, scan: u32, motion: &Segments, conditions: &Conditions, rng: &mut impl Rng) -> Option<Plot> {
        let time_s = passage_s(scan, motion);
        let power = power(conditions, rng);
        let polar = scattered(&place(&motion.at(time_s)), &self.sigma, rng);
        (power > conditions.detector().threshold).then(|| self.plot(time_s, &polar, power))
    }

    /// Appends the false plots of turn `scan`.
    ///
    /// # Panics
    /// Unless F lies between 0 and 1, both excluded.
    pub fn false_plots(&self, scan: u32, volume: &Volume, rng: &mut impl Rng, plots: &mut Vec<Plot>) {
        let threshold = Detector::new(self.pfa, 0).threshold;
        let number = Poisson::new(self.pfa * volume.size()).expect("a positive number of false plots").sample(rng);
        for _ in 0..number as u64 {
            let polar = volume.somewhere(rng);
            let excess: f64 = Exp1.sample(rng);
            let time_s = (f64::from(scan) + polar[1] / TAU) * PERIOD_S;
            plots.push(self.plot(time_s, &polar, threshold + excess));
        }
    }

    /// A plot at a place.
    pub fn plot(&self, time_s: f64, polar: &[f64; COORDINATES], power: f64) -> Plot {
        Plot {
            time_ns: EPOCH_NS + (time_s * NS_PER_S) as u64,
            range_m: polar[0],
            azimuth_rad: polar[1],
            elevation_rad: polar[2],
            range_rate_mps: polar[3],
            sigma_range_m: self.sigma[0] as f32,
            sigma_azimuth_rad: self.sigma[1] as f32,
            sigma_elevation_rad: self.sigma[2] as f32,
            sigma_range_rate_mps: self.sigma[3] as f32,
            statistic: power.sqrt() as f32,
            cell_count: 1,
            flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
            ..Plot::default()
        }
    }

    /// The messages of turn `scan`, `ends` if no other follows.
    pub fn messages(&self, scan: u32, ends: bool, plots: &[Plot]) -> Turn {
        let mut all: Turn = (0..SECTORS).map(|sector| (self.header(scan, sector), Vec::new())).collect();
        for plot in plots {
            let sector = ((plot.azimuth_rad / TAU * f64::from(SECTORS)) as u32).min(SECTORS - 1);
            all[sector as usize].1.push(*plot);
        }
        if let Some((header, _)) = all.last_mut().filter(|_| ends) {
            header.flags |= END_OF_STREAM;
        }
        all
    }

    fn header(&self, scan: u32, sector: u32) -> PlotsHeader {
        let at = |sectors: u32| TAU * f64::from(sectors) / f64::from(SECTORS);
        let end_s = (f64::from(scan) + f64::from(sector + 1) / f64::from(SECTORS)) * PERIOD_S;
        PlotsHeader {
            seq: u64::from(scan * SECTORS + sector),
            session: 1,
            time_ns: EPOCH_NS + (end_s * NS_PER_S) as u64,
            covered_from_rad: at(sector),
            covered_to_rad: at(sector + 1),
            scan_period_s: PERIOD_S,
            pfa: self.pfa,
            cell_range_m: CELL[0],
            cell_azimuth_rad: CELL[1],
            cell_elevation_rad: CELL[2],
            cell_range_rate_mps: CELL[3],
            scan,
            sector,
            sectors_per_scan: SECTORS,
            flags: if sector + 1 == SECTORS { END_OF_SCAN } else { 0 },
            ..PlotsHeader::default()
        }
    }
}

/// When the beam passes a target in turn `scan`, s; for targets away from north.
pub fn passage_s(scan: u32, motion: &Segments) -> f64 {
    let start_s = f64::from(scan) * PERIOD_S;
    // The beam is far faster than the target: each step gains more than a digit.
    (0..5).fold(start_s + 0.5 * PERIOD_S, |time_s, _| {
        start_s + Polar::from_enu(&motion.at(time_s).position_m).azimuth_rad / TAU * PERIOD_S
    })
}

/// A measurement time since the start of the first turn, s.
pub fn seconds(time_ns: u64) -> f64 {
    time_ns.saturating_sub(EPOCH_NS) as f64 / NS_PER_S
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};
    use common::units::from_db;
    use nalgebra::Vector3;

    const RADAR: Turning = Turning { pfa: 1e-4, sigma: [10.0, 0.000_87, 0.000_87, 5.0] };

    /// Detections and false plots of 2000 turns are as many as (C4) and F say, within five standard errors; all lie in the message
    /// of their azimuth and time.
    #[test]
    fn plots_are_as_many_and_where_they_should_be() {
        let turns = 2000;
        let volume = Volume { middle: [1500.0, 2.0, 0.1, 0.0], cells: [30, 100, 8, 6] };
        let motion = Segments::straight(Vector3::new(1500.0, -800.0, 100.0), Vector3::new(-0.5, 0.2, 0.0));
        for swerling in crate::fluctuation::ALL {
            let conditions = Conditions { pfa: RADAR.pfa, reference_cells: 0, snr_db: 12.0, swerling };
            let (mut detected, mut false_plots) = (0.0, 0.0);
            for scan in 0..turns {
                let mut rng = generator(5, Purpose::Test, scan, 0);
                let mut plots: Vec<Plot> = RADAR.target(scan, &motion, &conditions, &mut rng).into_iter().collect();
                detected += plots.len() as f64;
                false_plots -= plots.len() as f64;
                RADAR.false_plots(scan, &volume, &mut rng, &mut plots);
                for (header, plots) in RADAR.messages(scan, false, &plots) {
                    false_plots += plots.len() as f64;
                    for plot in &plots {
                        let covered = header.covered_from_rad..header.covered_to_rad;
                        assert!(
                            covered.contains(&plot.azimuth_rad) && seconds(plot.time_ns) as u32 == scan,
                            "{plot:?}"
                        );
                    }
                }
            }
            let trials = f64::from(turns);
            let pd = Detector::new(RADAR.pfa, 0).target(swerling, from_db(12.0)).detection_probability;
            assert!((detected / trials - pd).abs() < 5.0 * (pd * (1.0 - pd) / trials).sqrt() + 2e-3, "{detected} {pd}");
            let expected = trials * RADAR.pfa * volume.size();
            assert!((false_plots - expected).abs() < 5.0 * expected.sqrt(), "{false_plots} of {expected}");
        }
    }
}
