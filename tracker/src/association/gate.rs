//! Association gates in (r, β, ε, ṙ) and what they hold (T9)-(T11), (T13).
//!
//! ```text
//! a plot lies in the gate when |Δ_i| ≤ α √(p*_i + σ_i²) for all measured coordinates i    (T9)
//! V = Π 2h_i · r*² cos ε*  with h_i = α √(p*_i + σ_i²) for the radar's nominal σ          (T11)
//! P_G = erf(α/√2)^n, or for component j in the gate of another: Π of normal integrals          (T13)
//! ```

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use common::angle;

use crate::filter::Expectation;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// The gate of one component.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gate {
    /// (r*, β*, ε*, ṙ*).
    pub centre: [f64; COORDINATES],
    /// p*: predicted variances of the four.
    pub predicted: [f64; COORDINATES],
    /// How fast the centre moves along the mean motion, per s.
    pub drift: [f64; COORDINATES],
    /// h: half widths for a plot of nominal errors.
    pub half: [f64; COORDINATES],
    /// cos ε*.
    pub cos_elevation: f64,
    /// α.
    pub alpha: f64,
}

impl Gate {
    /// Around what a component expects in `lane`; `alpha` is that of the expectation.
    pub fn new(expected: &Expectation, lane: usize, alpha: f64) -> Self {
        Self {
            centre: expected.centre.map(|row| row.0[lane]),
            predicted: expected.variance.map(|row| row.0[lane]),
            drift: expected.drift.map(|row| row.0[lane]),
            half: expected.half.map(|row| row.0[lane]),
            cos_elevation: expected.cos_elevation.0[lane],
            alpha,
        }
    }

    /// Δ: where `measurement` lies from the centre, 0 in coordinates that were not measured.
    /// `offset_s` is the plot's time minus the prediction's: the centre moves until then.
    pub fn offset(&self, measurement: &Measurement, offset_s: f64) -> [f64; COORDINATES] {
        std::array::from_fn(|i| {
            if !measurement.measured[i] {
                0.0
            } else if i == 1 {
                angle::difference(measurement.polar[i], self.centre[i] + self.drift[i] * offset_s)
            } else {
                measurement.polar[i] - self.centre[i] - self.drift[i] * offset_s
            }
        })
    }

    /// Whether a plot at Δ = `offset` with the errors of `measurement` lies inside (T9).
    pub fn holds(&self, offset: &[f64; COORDINATES], measurement: &Measurement) -> bool {
        let square = self.alpha * self.alpha;
        offset[1].abs() <= FRAC_PI_2
            && (0..COORDINATES).all(|i| offset[i] * offset[i] <= square * (self.predicted[i] + measurement.variance[i]))
    }

    /// Sum of squared normalised offsets: the distance of the nearest-neighbour rule.
    pub fn distance(&self, offset: &[f64; COORDINATES], measurement: &Measurement) -> f64 {
        (0..COORDINATES)
            .filter(|&i| measurement.measured[i])
            .map(|i| offset[i] * offset[i] / (self.predicted[i] + measurement.variance[i]))
            .sum()
    }

    /// V of (T11), m³·m/s.
    pub fn volume(&self, radar: &Radar) -> f64 {
        radar.volume(|i| 2.0 * self.half[i], self.centre[0], self.cos_elevation)
    }

    /// U of (T20): resolution cells in the gate.
    pub fn cells(&self, radar: &Radar) -> f64 {
        (0..COORDINATES).filter(|&i| radar.measured[i]).map(|i| 2.0 * self.half[i] / radar.cell[i]).product()
    }

    /// Probability that a target of the component whose gate is `other` falls into this one (T13).
    pub fn probability(&self, other: &Self, radar: &Radar) -> f64 {
        let centre = other.centre;
        let mut product = 1.0;
        for i in (0..COORDINATES).filter(|&i| radar.measured[i]) {
            let sd = (other.predicted[i] + radar.variance[i]).sqrt();
            let shift = if i == 1 { angle::difference(self.centre[i], centre[i]) } else { self.centre[i] - centre[i] };
            product *= 0.5
                * (libm::erf((shift + self.half[i]) / (sd * SQRT_2))
                    - libm::erf((shift - self.half[i]) / (sd * SQRT_2)));
        }
        product.clamp(0.0, 1.0)
    }
}

/// P_G of a gate of half width α standard deviations in each of `dimensions` coordinates.
pub fn own_probability(alpha: f64, dimensions: usize) -> f64 {
    libm::erf(alpha / SQRT_2).powf(dimensions as f64)
}
