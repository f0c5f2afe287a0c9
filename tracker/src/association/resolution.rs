//! Two targets that the radar may not resolve, and the one plot that they then give (Koch & van Keuk 1997).
//!
//! In each measured coordinate i of (r, β, ε, ṙ), with the cell δ_i, Δ the targets' distance and d, S_a, S_b the difference and the variances of
//! what two tracks expect:
//! ```text
//! P_u(Δ) = exp(−½ Σ Δ_i²/Q_i),  Q_i = δ_i²/(2 ln 2)                       half at the distance of one cell
//! u = exp(−½ Σ d_i²/(Q_i + S_ai + S_bi))
//! ```
//! The mean of P_u has the further factor Π √(Q/(Q + S_a + S_b)) for independent errors. Those of tracks that were updated by the same plots are
//! alike, and Δ is known far better than S_a + S_b says; without the factor u is right for errors that are the same, and too large for others
//! only where no single plot can be told from one with another missed.
//!
//! So "not resolved" is a measurement of Δ = 0 with the variance Q. The plot lies between the targets, wherever their powers put it: in the middle
//! on average, with the variance of a uniform place between them added to its own, R = σ² + (d² + S_a + S_b)/12. Then
//! ```text
//! c(y) = Π N(y_i; (a + b)/2 − C d/(Q + S_a + S_b),  R + (S_a + S_b)/4 − C²/(Q + S_a + S_b)),  C = (S_a − S_b)/2      (J1)
//! ```
//! is its density, and to a alone it is a measurement, b being what it is only known to be:
//! ```text
//! ỹ = b + 2 (y − b)(2 S_b + Q)/(4R + 4 S_b + Q),   R̃ = (4 R S_b + 4 R Q + S_b Q)/(4R + 4 S_b + Q)                     (J4)
//! ```
//! For Q → ∞ that is 2y − b, the other end of a line with the plot in its middle; for Q → 0 it is b updated by y.

use std::f64::consts::LN_2;

use common::angle;
use common::geometry::Polar;

use crate::filter::{Expectation, Group};
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// Variance of a place of which only the two ends are known, of their distance squared.
const BETWEEN: f64 = 1.0 / 12.0;

/// Mean and variances of (r, β, ε, ṙ) that a track expects, all its components together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    centre: [f64; COORDINATES],
    variance: [f64; COORDINATES],
}

impl Place {
    /// Of the predicted track in `lane` of a group.
    pub fn new(prediction: &Group, expected: &[Expectation], lane: usize) -> Self {
        let average = |of: &dyn Fn(usize) -> f64| -> f64 {
            (0..expected.len()).map(|j| prediction.weight(j, lane) * of(j)).sum()
        };
        let middle = expected[prediction.layout().reference].centre.map(|row| row.0[lane]);
        let (mut centre, mut variance) = (middle, [0.0; COORDINATES]);
        for i in 0..COORDINATES {
            let from_middle = |j: usize| difference(i, expected[j].centre[i].0[lane], middle[i]);
            let mean = average(&from_middle);
            centre[i] += mean;
            variance[i] =
                average(&|j| expected[j].variance[i].0[lane] + (from_middle(j) - mean) * (from_middle(j) - mean));
        }
        Self { centre, variance }
    }

    /// u: probability that two targets are not resolved.
    pub fn unresolved(&self, other: &Self, radar: &Radar) -> f64 {
        let measured = (0..COORDINATES).filter(|&i| radar.measured[i]);
        measured.map(|i| self.pair(other, i, radar).ln_unresolved()).sum::<f64>().exp()
    }

    /// ln (u c(y)) of (J1) in the measure of y.
    pub(crate) fn ln_common_density(&self, other: &Self, plot: &Measurement, radar: &Radar) -> f64 {
        let mut ln_density = 0.0;
        for i in (0..COORDINATES).filter(|&i| radar.measured[i]) {
            let pair = self.pair(other, i, radar);
            ln_density += pair.ln_unresolved();
            if plot.measured[i] {
                let total = pair.resolution + pair.a + pair.b;
                let leaning = 0.5 * (pair.a - pair.b) / total;
                let variance =
                    plot.variance[i] + BETWEEN * pair.square() + 0.25 * (pair.a + pair.b) - leaning * leaning * total;
                let from_middle = difference(i, plot.polar[i], self.centre[i]) + (0.5 + leaning) * pair.apart;
                ln_density -= 0.5 * (from_middle * from_middle / variance + (std::f64::consts::TAU * variance).ln());
            }
        }
        ln_density - radar.volume_at(plot, |_| 1.0).ln()
    }

    /// (J4): what a plot of two targets says of this one.
    pub(crate) fn of_common(&self, other: &Self, plot: &Measurement, radar: &Radar) -> Measurement {
        let mut alone = Measurement { is_common: true, ..*plot };
        for i in (0..COORDINATES).filter(|&i| plot.measured[i] && radar.measured[i]) {
            let pair = self.pair(other, i, radar);
            let (r, q, s) = (plot.variance[i] + BETWEEN * pair.square(), pair.resolution, pair.b);
            let total = 4.0 * r + 4.0 * s + q;
            let from_other = difference(i, plot.polar[i], other.centre[i]);
            alone.polar[i] = other.centre[i] + 2.0 * from_other * (2.0 * s + q) / total;
            alone.variance[i] = (4.0 * r * s + 4.0 * r * q + s * q) / total;
        }
        alone.polar[0] = alone.polar[0].max(1.0);
        let [range_m, azimuth_rad, elevation_rad, _] = alone.polar;
        alone.cos_elevation = elevation_rad.cos();
        alone.position = Polar { range_m, azimuth_rad, elevation_rad }.to_enu().into();
        alone
    }

    fn pair(&self, other: &Self, i: usize, radar: &Radar) -> Pair {
        Pair {
            apart: difference(i, self.centre[i], other.centre[i]),
            a: self.variance[i],
            b: other.variance[i],
            resolution: radar.cell[i] * radar.cell[i] / (2.0 * LN_2),
        }
    }
}

/// Two tracks in one coordinate.
struct Pair {
    /// d.
    apart: f64,
    /// S_a, S_b.
    a: f64,
    b: f64,
    /// Q.
    resolution: f64,
}

impl Pair {
    fn ln_unresolved(&self) -> f64 {
        let total = self.resolution + self.a + self.b;
        -0.5 * self.apart * self.apart / total
    }

    /// Mean square of the distance.
    fn square(&self) -> f64 {
        self.apart * self.apart + self.a + self.b
    }
}

/// a − b in coordinate `i`.
fn difference(i: usize, a: f64, b: f64) -> f64 {
    if i == 1 { angle::difference(a, b) } else { a - b }
}
