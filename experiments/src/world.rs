//! The world of the plot-level experiments: a target's plots and false plots, drawn as \[L22\] does.
//!
//! ```text
//! cells        δ_r 69.3 m, δ_β = δ_ε 0.346°, δ_ṙ 34.6 m/s;  errors σ = δ/(2√3), normal          (C1)
//! target       measured in every scan, detected if q > t₀; noise power known                   (C4)
//! false plots  Poisson with F per cell, uniform over the cells; q − t₀ exponential
//! ```

use common::amplitude::Detector;
use common::angle;
use common::config::Swerling;
use common::geometry::{Polar, range_rate_mps};
use common::random::{Purpose, generator};
use common::units::from_db;
use nalgebra::Vector3;
use radar_sim::motion::Kinematics;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, Poisson, StandardNormal};
use tracker::gate::Radar;
use tracker::measurement::{COORDINATES, Measurement};

use crate::trajectory::{SCANS, Trajectory};

/// Standard errors of r, β, ε, ṙ (C1).
pub const SIGMA: [f64; COORDINATES] = [20.0, 0.1 * RADIANS, 0.1 * RADIANS, 10.0];
const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// The radar of \[L22\].
pub fn radar() -> Radar {
    Radar {
        variance: SIGMA.map(|sigma| sigma * sigma),
        cell: SIGMA.map(|sigma| sigma * 12.0_f64.sqrt()),
        measured: [true; COORDINATES],
    }
}

/// What surrounds the target and how strong it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// F; 0 for no false plots and certain detection.
    pub pfa: f64,
    /// S, dB.
    pub snr_db: f64,
    /// Fluctuation.
    pub swerling: Swerling,
}

impl Conditions {
    /// The detector of known noise; without false plots one of its own that everything passes.
    pub fn detector(&self) -> Detector {
        Detector::new(if self.pfa > 0.0 { self.pfa } else { 1e-3 }, 0)
    }
}

/// A target in one scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Truth.
    pub truth: Kinematics,
    /// Its plot, whether detected or not.
    pub plot: Measurement,
    /// Whether it is detected.
    pub detected: bool,
}

/// A target's plots at k = −1, 0, 1, … `SCANS`: index 0 is k = −1. Detection of the first two is certain.
pub fn sights(trajectory: Trajectory, conditions: &Conditions, seed: u64, run: u32) -> Vec<Sight> {
    let motion = trajectory.motion(seed, run);
    (0..SCANS + 2)
        .map(|scan| {
            let truth = motion.at(f64::from(scan));
            let mut rng = generator(seed, Purpose::Measurement, run, scan);
            let plot = measure(&truth, conditions, &mut rng);
            let certain = conditions.pfa <= 0.0 || scan < 2;
            Sight { truth, plot, detected: certain || plot.power > conditions.detector().threshold }
        })
        .collect()
}

/// One measurement of a target.
pub fn measure(truth: &Kinematics, conditions: &Conditions, rng: &mut impl Rng) -> Measurement {
    let place = Polar::from_enu(&truth.position_m);
    let rate = range_rate_mps(&truth.position_m, &truth.velocity_mps);
    let mut normal = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
    let polar = [
        (place.range_m + normal(SIGMA[0])).max(1.0),
        angle::wrap(place.azimuth_rad + normal(SIGMA[1])),
        place.elevation_rad + normal(SIGMA[2]),
        rate + normal(SIGMA[3]),
    ];
    plot(polar, power(conditions, rng))
}

/// q of a target: |s + n|² with unit noise power.
pub fn power(conditions: &Conditions, rng: &mut impl Rng) -> f64 {
    let mut exponential = || <Exp1 as Distribution<f64>>::sample(&Exp1, rng);
    let snr = from_db(conditions.snr_db);
    let signal = match conditions.swerling {
        Swerling::Zero => snr,
        Swerling::One => snr * exponential(),
        Swerling::Three => 0.5 * snr * (exponential() + exponential()),
    };
    let mut normal = || <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
    let (i, q) = (signal.sqrt() + normal() * 0.5_f64.sqrt(), normal() * 0.5_f64.sqrt());
    i * i + q * q
}

/// A plot of the radar's errors.
pub fn plot(polar: [f64; COORDINATES], power: f64) -> Measurement {
    let place = Polar { range_m: polar[0], azimuth_rad: polar[1], elevation_rad: polar[2] };
    Measurement {
        time_ns: 0,
        position: place.to_enu().into(),
        polar,
        variance: SIGMA.map(|sigma| sigma * sigma),
        power,
        measured: [true; COORDINATES],
        has_power: true,
    }
}

/// A box in (r, β, ε, ṙ): where false plots are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Centre.
    pub centre: [f64; COORDINATES],
    /// Half widths.
    pub half: [f64; COORDINATES],
}

impl Region {
    /// The smallest box that holds both.
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        let mut joined = *self;
        for i in 0..COORDINATES {
            let shift = if i == 1 {
                angle::difference(other.centre[i], self.centre[i])
            } else {
                other.centre[i] - self.centre[i]
            };
            let low = (-self.half[i]).min(shift - other.half[i]);
            let high = self.half[i].max(shift + other.half[i]);
            joined.half[i] = 0.5 * (high - low);
            joined.centre[i] = self.centre[i] + 0.5 * (high + low);
        }
        joined
    }

    /// Whether a place lies inside.
    pub fn holds(&self, polar: &[f64; COORDINATES]) -> bool {
        (0..COORDINATES).all(|i| {
            let offset = if i == 1 { angle::difference(polar[i], self.centre[i]) } else { polar[i] - self.centre[i] };
            offset.abs() <= self.half[i]
        })
    }

    /// Resolution cells inside.
    pub fn cells(&self, radar: &Radar) -> f64 {
        (0..COORDINATES).map(|i| 2.0 * self.half[i] / radar.cell[i]).product()
    }
}

/// Appends false plots above `threshold` of known noise.
pub fn add_false_plots(region: &Region, threshold: f64, rng: &mut impl Rng, plots: &mut Vec<Measurement>) {
    let expected = region.cells(&radar()) * (-threshold).exp();
    let Ok(number) = Poisson::new(expected) else { return };
    for _ in 0..number.sample(rng) as u64 {
        let polar: [f64; COORDINATES] =
            std::array::from_fn(|i| region.centre[i] + region.half[i] * rng.random_range(-1.0..1.0));
        let q = threshold + <Exp1 as Distribution<f64>>::sample(&Exp1, rng);
        if polar[0] > 0.0 {
            plots.push(plot([polar[0], angle::wrap(polar[1]), polar[2], polar[3]], q));
        }
    }
}

/// Distance between a place and the truth, m.
pub fn distance_m(position: [f64; 3], truth: &Kinematics) -> f64 {
    (Vector3::from(position) - truth.position_m).norm()
}
