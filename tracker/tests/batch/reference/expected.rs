//! What a mode expects and how likely a plot is, one at a time: (T5)-(T8) as they are written.

use common::tracks::STATE;
use tracker::filter::gaussian::{Gaussian, at};
use tracker::plots::measurement::{COORDINATES, LineOfSight, Measurement, NEAREST_M, position_covariance};

use super::motion::DIMENSIONS;

/// Elements of the packed triangle of a 4×4 matrix.
pub(crate) const PACKED_4: usize = 10;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// What one mode expects: h(u*), H, H P* Hᵀ, P* Hᵀ, and the variances in polar coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expected {
    /// Directions at the predicted position.
    pub(crate) frame: LineOfSight,
    /// Predicted position, m.
    pub(crate) position: [f64; 3],
    /// Predicted velocity, m/s.
    pub(crate) velocity: [f64; 3],
    /// Predicted acceleration, m/s².
    pub(crate) acceleration: [f64; 3],
    /// ṙ, m/s.
    pub(crate) range_rate: f64,
    /// g_p: ∂ṙ/∂position, 1/s.
    pub(crate) range_rate_gradient: [f64; 3],
    /// H P* Hᵀ, packed.
    pub(crate) covariance: [f64; PACKED_4],
    /// P* Hᵀ: a row of four per state.
    pub(crate) cross: [[f64; COORDINATES]; STATE],
    /// p*: predicted variances of r, β, ε, ṙ: gᵀ P* g with g their gradients (T9).
    pub(crate) polar_variance: [f64; COORDINATES],
}

impl Expected {
    /// For the prediction of `mode`.
    pub(crate) fn new(mode: usize, predicted: &Gaussian) -> Self {
        let position = predicted.position();
        let velocity = predicted.velocity();
        let frame = LineOfSight::at(position);
        let e_r = frame.radial;
        let range_rate = dot(velocity, e_r);
        let g_p: [f64; 3] = std::array::from_fn(|i| (velocity[i] - range_rate * e_r[i]) / frame.range_m);
        let p = &predicted.covariance;
        let mut cross = [[0.0; COORDINATES]; STATE];
        for (i, row) in cross.iter_mut().enumerate().take(DIMENSIONS[mode]) {
            let to_position: [f64; 3] = std::array::from_fn(|k| p[at(i, k)]);
            let to_velocity: [f64; 3] = std::array::from_fn(|k| p[at(i, 3 + k)]);
            row[..3].copy_from_slice(&to_position);
            row[3] = dot(to_position, g_p) + dot(to_velocity, e_r);
        }
        let mut covariance = [0.0; PACKED_4];
        covariance[..6].copy_from_slice(&p[..6]);
        for i in 0..3 {
            covariance[at(i, 3)] = cross[i][3];
        }
        // Rounding can take a variance below zero, here and of the other coordinates.
        let rate_variance: f64 = (0..3).map(|i| g_p[i] * cross[i][3] + e_r[i] * cross[3 + i][3]).sum();
        covariance[9] = rate_variance.max(0.0);
        let along = |e: [f64; 3]| {
            let mut sum = 0.0_f64;
            for b in 0..3 {
                sum += e[b] * (p[at(0, b)] * e[0] + p[at(1, b)] * e[1] + p[at(2, b)] * e[2]);
            }
            sum.max(0.0)
        };
        let across = (frame.range_m * frame.cos_elevation).max(NEAREST_M);
        let polar_variance = [
            along(e_r),
            along(frame.along_azimuth) / (across * across),
            along(frame.along_elevation) / (frame.range_m * frame.range_m),
            covariance[9],
        ];
        Self {
            frame,
            position,
            velocity,
            acceleration: [predicted.mean[6], predicted.mean[7], predicted.mean[8]],
            range_rate,
            range_rate_gradient: g_p,
            covariance,
            cross,
            polar_variance,
        }
    }

    /// h(u*) in gate coordinates: (r, β, ε, ṙ).
    pub(crate) fn polar(&self) -> [f64; COORDINATES] {
        [self.frame.range_m, self.frame.azimuth_rad, self.frame.elevation_rad, self.range_rate]
    }

    /// d = y − h(u*), 0 where not measured. `offset_s` is the plot's time minus the prediction's:
    /// the expectation is moved there along the mean motion,
    /// ```text
    /// p + v τ + a τ²/2,   ṙ + τ (a·e_r + (|v|² − ṙ²)/ρ)
    /// ```
    pub(crate) fn innovation(&self, measurement: &Measurement, offset_s: f64) -> [f64; COORDINATES] {
        let half_square = 0.5 * offset_s * offset_s;
        let mut d = [0.0; COORDINATES];
        for i in 0..3 {
            if i < 2 || measured_height(measurement) {
                d[i] = measurement.position[i]
                    - (self.position[i] + self.velocity[i] * offset_s + self.acceleration[i] * half_square);
            }
        }
        if measurement.measured[3] {
            d[3] = measurement.polar[3] - self.range_rate - self.range_rate_drift() * offset_s;
        }
        d
    }

    /// How fast h(u*) moves in (r, β, ε, ṙ) along the mean motion, per s.
    pub(crate) fn drift(&self) -> [f64; COORDINATES] {
        let across = (self.frame.range_m * self.frame.cos_elevation).max(1.0);
        [
            self.range_rate,
            dot(self.velocity, self.frame.along_azimuth) / across,
            dot(self.velocity, self.frame.along_elevation) / self.frame.range_m.max(1.0),
            self.range_rate_drift(),
        ]
    }

    /// dṙ/dt along the mean motion, m/s².
    fn range_rate_drift(&self) -> f64 {
        let turning = dot(self.velocity, self.velocity) - self.range_rate * self.range_rate;
        dot(self.acceleration, self.frame.radial) + turning / self.frame.range_m.max(1.0)
    }

    /// D⁻¹ and |D| of (T8) for plots with the variances and coordinates of `measurement`; `None` if D is not
    /// positive definite. `inflation` is γ of (T7).
    pub(crate) fn likelihood(&self, measurement: &Measurement, inflation: f64) -> Option<Likelihood> {
        let mut d = self.covariance;
        let [r, beta, epsilon, range_rate] = measurement.variance;
        for (d, r) in d.iter_mut().zip(position_covariance(&self.frame, [r, beta, epsilon])) {
            *d += r;
        }
        d[9] = (1.0 + inflation) * d[9] + range_rate;
        for (index, present) in [(2, measured_height(measurement)), (3, measurement.measured[3])] {
            if !present {
                for other in 0..COORDINATES {
                    d[at(index, other)] = 0.0;
                }
                d[at(index, index)] = 1.0;
            }
        }
        let mut likelihood = Likelihood::new(&d, measurement.dimensions())?;
        for (index, present) in [(2, measured_height(measurement)), (3, measurement.measured[3])] {
            if !present {
                likelihood.inverse[at(index, index)] = 0.0;
            }
        }
        Some(likelihood)
    }
}

/// A plot without elevation says nothing of z.
fn measured_height(measurement: &Measurement) -> bool {
    measurement.measured[2]
}

/// N(d; 0, D) ready for use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Likelihood {
    /// D⁻¹, packed; 0 in coordinates not measured.
    pub(crate) inverse: [f64; PACKED_4],
    /// ln of the density at d = 0.
    pub(crate) ln_peak: f64,
}

impl Likelihood {
    /// Of D (packed) in which `dimensions` coordinates were measured, by Cholesky's D = L Lᵀ.
    fn new(d: &[f64; PACKED_4], dimensions: usize) -> Option<Self> {
        // M = L⁻¹ row by row, then D⁻¹ = Mᵀ M.
        let mut l = [[0.0; COORDINATES]; COORDINATES];
        let mut m = [[0.0; COORDINATES]; COORDINATES];
        let mut determinant_root = 1.0;
        for j in 0..COORDINATES {
            for i in 0..j {
                let mut sum = d[at(i, j)];
                for k in 0..i {
                    sum -= l[j][k] * l[i][k];
                }
                l[j][i] = sum * m[i][i];
            }
            let mut pivot = d[at(j, j)];
            for k in 0..j {
                pivot -= l[j][k] * l[j][k];
            }
            if !(pivot > 0.0 && pivot < f64::MAX) {
                return None;
            }
            let root = pivot.sqrt();
            determinant_root *= root;
            m[j][j] = 1.0 / root;
            for i in 0..j {
                let mut sum = 0.0;
                for k in i..j {
                    sum += l[j][k] * m[k][i];
                }
                m[j][i] = -sum * m[j][j];
            }
        }
        let mut inverse = [0.0; PACKED_4];
        for j in 0..COORDINATES {
            for i in 0..=j {
                for row in &m[j..] {
                    inverse[at(i, j)] += row[i] * row[j];
                }
            }
        }
        let ln_peak = -determinant_root.ln() - 0.5 * dimensions as f64 * std::f64::consts::TAU.ln();
        ln_peak.is_finite().then_some(Self { inverse, ln_peak })
    }

    /// D⁻¹ d.
    pub(crate) fn solve(&self, d: [f64; COORDINATES]) -> [f64; COORDINATES] {
        let s = &self.inverse;
        [
            s[0] * d[0] + s[1] * d[1] + s[3] * d[2] + s[6] * d[3],
            s[1] * d[0] + s[2] * d[1] + s[4] * d[2] + s[7] * d[3],
            s[3] * d[0] + s[4] * d[1] + s[5] * d[2] + s[8] * d[3],
            s[6] * d[0] + s[7] * d[1] + s[8] * d[2] + s[9] * d[3],
        ]
    }
}
