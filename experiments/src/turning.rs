//! A radar that turns without cells: one true target in, `plots` messages out, for experiments on tracking alone.
//!
//! Detection and decision statistics follow (C4) with known noise; errors of plots are normal with the standard errors
//! that they state. False plots are a Poisson process of F per cell over a sector that goes with the target.

use std::f64::consts::TAU;

use common::amplitude::Detector;
use common::angle;
use common::config::Swerling;
use common::geometry::{Polar, range_rate_mps};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::random::{Purpose, generator};
use common::units::{NS_PER_S, from_db};
use nalgebra::Vector3;
use radar_sim::fluctuation;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, Poisson, StandardNormal};

/// Start of measurement time, ns.
const EPOCH_NS: u64 = 1_700_000_000_000_000_000;
/// Time of a turn, s.
pub const PERIOD_S: f64 = 1.0;
/// Messages in a turn.
const SECTORS: u32 = 32;
/// Cells of \[L22\] (C1): range, azimuth, elevation, range rate.
const CELL: [f64; 4] = [69.3, 0.006_04, 0.006_04, 34.6];
/// Standard errors of plots: half of those of a single cell (C1), as interpolation has them at 15 dB.
const SIGMA: [f64; 4] = [10.0, 0.000_87, 0.000_87, 5.0];
/// The volume with false plots: first range, cells in range, azimuth, elevation and range rate.
const FIRST_RANGE_M: f64 = 200.0;
const VOLUME: [u32; 4] = [70, 130, 8, 6];

/// Cells that are looked at in a turn: 70 in range (4.85 km), 130 in azimuth (45°), 8 in elevation (2.8°), 6 in range rate.
pub const CELLS: u32 = VOLUME[0] * VOLUME[1] * VOLUME[2] * VOLUME[3];

/// A target that moves straight, from a turn on.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// At the start of turn `first_scan`, east, north, up; m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// First turn in which it is there.
    pub first_scan: u32,
}

impl Target {
    /// A target at a random place in the volume, away from north and the edges, at 10…40 m/s in a random direction.
    pub fn somewhere(first_scan: u32, rng: &mut impl Rng) -> Self {
        let place = Polar {
            range_m: rng.random_range(1000.0..4000.0),
            azimuth_rad: rng.random_range(1.0..5.2),
            elevation_rad: 0.5 * f64::from(VOLUME[2]) * CELL[2],
        };
        let (speed, course) = (rng.random_range(10.0..40.0), rng.random_range(0.0..TAU));
        let velocity_mps = Vector3::new(speed * course.sin(), speed * course.cos(), 0.0);
        Self { position_m: place.to_enu(), velocity_mps, first_scan }
    }

    /// Position at a time after the start of the first turn, s.
    fn at(&self, time_s: f64) -> Vector3<f64> {
        self.position_m + self.velocity_mps * (time_s - f64::from(self.first_scan) * PERIOD_S)
    }

    /// Position at a measurement time.
    pub fn position_at(&self, time_ns: u64) -> Vector3<f64> {
        self.at((time_ns as f64 - EPOCH_NS as f64) / NS_PER_S)
    }

    /// When the beam passes it in `scan`, s.
    fn passage_s(&self, scan: u32) -> f64 {
        let start_s = f64::from(scan) * PERIOD_S;
        // The beam is far faster than the target: each step gains more than a digit.
        (0..5).fold(start_s + 0.5 * PERIOD_S, |time_s, _| {
            start_s + Polar::from_enu(&self.at(time_s)).azimuth_rad / TAU * PERIOD_S
        })
    }
}

/// Number of the turn of a measurement time.
pub fn scan_of(time_ns: u64) -> u32 {
    (time_ns.saturating_sub(EPOCH_NS) as f64 / NS_PER_S / PERIOD_S) as u32
}

/// What the radar and its target are like.
#[derive(Debug, Clone, Copy)]
pub struct Turning {
    /// Seed of all draws.
    pub seed: u64,
    /// Number of the run.
    pub run: u32,
    /// F per cell.
    pub pfa: f64,
    /// Kind of target.
    pub swerling: Swerling,
    /// Its mean signal-to-noise ratio, dB.
    pub snr_db: f64,
}

impl Turning {
    /// The messages of `scans` turns.
    ///
    /// # Panics
    /// Unless F lies between 0 and 1, both excluded.
    pub fn messages(&self, target: &Target, scans: u32) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let detector = Detector::new(self.pfa, 0);
        let false_plots = Poisson::new(self.pfa * f64::from(CELLS)).expect("a positive number of false plots");
        let mut all: Vec<(PlotsHeader, Vec<Plot>)> =
            (0..scans).flat_map(|scan| (0..SECTORS).map(move |sector| (self.header(scan, sector), vec![]))).collect();
        for scan in 0..scans {
            let mut rng = generator(self.seed, Purpose::Measurement, self.run, scan);
            if scan >= target.first_scan {
                let time_s = target.passage_s(scan);
                let q = self.target_power(scan, &mut rng);
                if q > detector.threshold {
                    let position = target.at(time_s);
                    let rate = range_rate_mps(&position, &target.velocity_mps);
                    let plot = measured(time_s, &Polar::from_enu(&position), rate, q, &mut rng);
                    into_sector(&mut all, scan, plot);
                }
            }
            let middle_rad = Polar::from_enu(&target.at(target.passage_s(scan))).azimuth_rad;
            let count: f64 = false_plots.sample(&mut rng);
            for _ in 0..count as u64 {
                let (place, rate) = somewhere(middle_rad, &mut rng);
                let excess: f64 = Exp1.sample(&mut rng);
                let time_s = (f64::from(scan) + place.azimuth_rad / TAU) * PERIOD_S;
                into_sector(&mut all, scan, measured(time_s, &place, rate, detector.threshold + excess, &mut rng));
            }
        }
        if let Some((header, _)) = all.last_mut() {
            header.flags |= END_OF_STREAM;
        }
        all
    }

    /// |s + n|² of a cell with the target (C2).
    fn target_power(&self, scan: u32, rng: &mut impl Rng) -> f64 {
        let power = from_db(self.snr_db) * fluctuation::power(self.swerling, self.seed, scan, self.run);
        let mut noise = || std::f64::consts::FRAC_1_SQRT_2 * normal(rng);
        (power.sqrt() + noise()).powi(2) + noise().powi(2)
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

/// A place in the volume, and a range rate.
fn somewhere(middle_rad: f64, rng: &mut impl Rng) -> (Polar, f64) {
    let [ranges, azimuths, elevations, rates] = VOLUME.map(f64::from);
    let place = Polar {
        range_m: FIRST_RANGE_M + CELL[0] * ranges * rng.random::<f64>(),
        azimuth_rad: angle::wrap(middle_rad + CELL[1] * azimuths * (rng.random::<f64>() - 0.5)),
        elevation_rad: CELL[2] * elevations * rng.random::<f64>(),
    };
    (place, CELL[3] * rates * (rng.random::<f64>() - 0.5))
}

/// The plot of something at a place, with errors.
fn measured(time_s: f64, place: &Polar, rate_mps: f64, q: f64, rng: &mut impl Rng) -> Plot {
    let mut error = |axis: usize| SIGMA[axis] * normal(rng);
    Plot {
        time_ns: EPOCH_NS + (time_s * NS_PER_S) as u64,
        range_m: (place.range_m + error(0)).max(1.0),
        azimuth_rad: angle::wrap(place.azimuth_rad + error(1)),
        elevation_rad: place.elevation_rad + error(2),
        range_rate_mps: rate_mps + error(3),
        sigma_range_m: SIGMA[0] as f32,
        sigma_azimuth_rad: SIGMA[1] as f32,
        sigma_elevation_rad: SIGMA[2] as f32,
        sigma_range_rate_mps: SIGMA[3] as f32,
        statistic: q.sqrt() as f32,
        cell_count: 1,
        flags: HAS_ELEVATION | HAS_RANGE_RATE | HAS_STATISTIC,
        ..Plot::default()
    }
}

/// Into the message of its azimuth.
fn into_sector(all: &mut [(PlotsHeader, Vec<Plot>)], scan: u32, plot: Plot) {
    let sector = ((plot.azimuth_rad / TAU * f64::from(SECTORS)) as u32).min(SECTORS - 1);
    all[(scan * SECTORS + sector) as usize].1.push(plot);
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Detections and false plots of 200 runs are as many as (C4) and F say, within five standard errors.
    #[test]
    fn plots_are_as_many_as_they_should_be() {
        let (scans, runs, pfa) = (10, 200, 1e-4);
        for swerling in crate::fluctuation::ALL {
            let (mut detected, mut false_plots) = (0.0, 0.0);
            for run in 0..runs {
                let radar = Turning { seed: 5, run, pfa, swerling, snr_db: 12.0 };
                let target = Target::somewhere(0, &mut generator(5, Purpose::Trajectory, run, 0));
                for plot in radar.messages(&target, scans).iter().flat_map(|(_, plots)| plots) {
                    let error = Polar::from_enu(&target.position_at(plot.time_ns)).range_m - plot.range_m;
                    let azimuth = Polar::from_enu(&target.position_at(plot.time_ns)).azimuth_rad;
                    let of_target = error.abs() < 60.0 && angle::difference(azimuth, plot.azimuth_rad).abs() < 0.006;
                    *(if of_target { &mut detected } else { &mut false_plots }) += 1.0;
                }
            }
            let trials = f64::from(scans * runs);
            let pd = Detector::new(pfa, 0).target(swerling, from_db(12.0)).detection_probability;
            assert!((detected / trials - pd).abs() < 5.0 * (pd * (1.0 - pd) / trials).sqrt() + 2e-3, "{detected} {pd}");
            let expected = trials * pfa * f64::from(CELLS);
            assert!((false_plots - expected).abs() < 5.0 * expected.sqrt(), "{false_plots} of {expected}");
        }
    }
}
