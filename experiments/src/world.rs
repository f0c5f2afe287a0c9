//! The world of the plot-level experiments: a target's plots and false plots, drawn as \[L22\] does.
//!
//! ```text
//! cells        δ_r 69.3 m, δ_β = δ_ε 0.346°, δ_ṙ 34.6 m/s;  errors σ = δ/(2√3), normal          (C1)
//! target       measured in every scan, detected if q > t₀                                      (C4)
//! false plots  Poisson with F per cell, see [`crate::surround`]
//! ```

use common::amplitude::Detector;
use common::angle;
use common::config::Swerling;
use common::geometry::{Polar, range_rate_mps};
use common::random::{Purpose, generator};
use common::tracks::{KIND_CONSTANT_VELOCITY, KIND_HOVER, KIND_MANOEUVRE};
use common::units::from_db;
use nalgebra::Vector3;
use radar_sim::motion::{Kinematics, Segments};
use rand::Rng;
use rand_distr::{Distribution, Exp1, Gamma, StandardNormal};
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

use crate::trajectory::{SCANS, Trajectory};

/// Standard errors of r, β, ε, ṙ (C1).
pub const SIGMA: [f64; COORDINATES] = [20.0, 0.1 * RADIANS, 0.1 * RADIANS, 10.0];
const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// The radar of \[L22\].
pub fn radar() -> Radar {
    Radar {
        range_rate_interval_mps: 0.0,
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
    /// N of the CFAR; 0 for known noise.
    pub reference_cells: u32,
    /// S, dB.
    pub snr_db: f64,
    /// Fluctuation.
    pub swerling: Swerling,
}

impl Conditions {
    /// One target without false plots that is always detected.
    pub const WITHOUT_CLUTTER: Self = Self { pfa: 0.0, reference_cells: 0, snr_db: 16.0, swerling: Swerling::One };

    /// The detector; without false plots any, as no plot is asked for its power.
    pub fn detector(&self) -> Detector {
        Detector::new(if self.pfa > 0.0 { self.pfa } else { 1e-3 }, self.reference_cells)
    }
}

/// A target in one scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// When, s since k = −1.
    pub time_s: f64,
    /// Truth.
    pub truth: Kinematics,
    /// Its plot, whether detected or not.
    pub plot: Measurement,
    /// Whether it is detected.
    pub detected: bool,
    /// What it did since the scan before, `KIND_…` of [`common::tracks`]: the model that is to be found.
    pub kind: u16,
}

/// A target's plots at k = −1, 0, 1, … `SCANS`, a second apart: index 0 is k = −1. Detection of the first two is certain.
pub fn sights(trajectory: Trajectory, conditions: &Conditions, seed: u64, run: u32) -> Vec<Sight> {
    let motion = trajectory.motion(seed, run);
    let threshold = conditions.detector().threshold;
    (0..SCANS + 2)
        .map(|scan| {
            let time_s = f64::from(scan);
            let truth = motion.at(time_s);
            let mut rng = generator(seed, Purpose::Measurement, run, scan);
            let plot = measure(&truth, conditions, &mut rng);
            let certain = conditions.pfa <= 0.0 || scan < 2;
            let kind = kind_before(&motion, time_s);
            Sight { time_s, truth, plot, detected: certain || plot.power > threshold, kind }
        })
        .collect()
}

/// Kind of motion in the second before a time, s; 0 is k = −1.
pub fn kind_before(motion: &Segments, time_s: f64) -> u16 {
    match motion.at((time_s - 0.5).max(0.0)).mode {
        common::truth::HOVER => KIND_HOVER,
        common::truth::MANOEUVRE => KIND_MANOEUVRE,
        _ => KIND_CONSTANT_VELOCITY,
    }
}

/// One measurement of a target.
pub(crate) fn measure(truth: &Kinematics, conditions: &Conditions, rng: &mut impl Rng) -> Measurement {
    plot(scattered(&place(truth), &SIGMA, rng), power(conditions, rng))
}

/// Where the radar would see a target without errors: r, β, ε, ṙ.
pub(crate) fn place(truth: &Kinematics) -> [f64; COORDINATES] {
    let place = Polar::from_enu(&truth.position_m);
    let rate = range_rate_mps(&truth.position_m, &truth.velocity_mps);
    [place.range_m, place.azimuth_rad, place.elevation_rad, rate]
}

/// A place with normal errors of these standard deviations.
pub(crate) fn scattered(
    place: &[f64; COORDINATES],
    sigma: &[f64; COORDINATES],
    rng: &mut impl Rng,
) -> [f64; COORDINATES] {
    let mut normal = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
    let [range, azimuth, elevation, rate] = std::array::from_fn(|i| place[i] + normal(sigma[i]));
    [range.max(1.0), angle::wrap(azimuth), elevation, rate]
}

/// q/q̄ of a target: |s + n|² with unit noise power, over the mean of N reference cells if there are any.
pub(crate) fn power(conditions: &Conditions, rng: &mut impl Rng) -> f64 {
    let mut exponential = || <Exp1 as Distribution<f64>>::sample(&Exp1, rng);
    let snr = from_db(conditions.snr_db);
    let signal = match conditions.swerling {
        Swerling::Zero => snr,
        Swerling::One => snr * exponential(),
        Swerling::Three => 0.5 * snr * (exponential() + exponential()),
    };
    let mut normal = || <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
    let (i, q) = (signal.sqrt() + normal() * 0.5_f64.sqrt(), normal() * 0.5_f64.sqrt());
    let noise = match conditions.reference_cells {
        0 => 1.0,
        cells => Gamma::new(f64::from(cells), f64::from(cells).recip()).expect("a positive shape").sample(rng),
    };
    (i * i + q * q) / noise
}

/// A plot of the radar's errors.
pub fn plot(polar: [f64; COORDINATES], power: f64) -> Measurement {
    let place = Polar { range_m: polar[0], azimuth_rad: polar[1], elevation_rad: polar[2] };
    Measurement {
        time_ns: 0,
        position: place.to_enu().into(),
        polar,
        cos_elevation: polar[2].cos(),
        variance: SIGMA.map(|sigma| sigma * sigma),
        power,
        measured: [true; COORDINATES],
        has_power: true,
        is_common: false,
        crowd: 0.0,
    }
}

/// Coordinate `i` of one place minus that of another; azimuths are wrapped.
pub(crate) fn offset(a: f64, b: f64, i: usize) -> f64 {
    if i == 1 { angle::difference(a, b) } else { a - b }
}

/// Distance between a place and the truth, m.
pub fn distance_m(position: [f64; 3], truth: &Kinematics) -> f64 {
    (Vector3::from(position) - truth.position_m).norm()
}
