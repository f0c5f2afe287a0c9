//! What a plot says and what a mode expects it to say (T5)-(T8).
//!
//! ```text
//! y = [x y z ṙ],  x = r cos ε sin β,  y = r cos ε cos β,  z = r sin ε              (T5)
//! h(u) = [x, y, z, (xẋ + yẏ + zż)/ρ],  ρ = |position|
//! H: rows 1-3 select the position; row 4 = [g_p  e_r  0], g_p = (v − ṙ e_r)/ρ
//! R = σ_r² e_r e_rᵀ + (ρ cos ε σ_β)² e_β e_βᵀ + (ρ σ_ε)² e_ε e_εᵀ,  R₄₄ = σ_ṙ²    (T6)
//! D = H P* Hᵀ + R,  D₄₄ inflated by γ H₄ P* H₄ᵀ                                    (T7), (T8)
//! ```
//!
//! R is evaluated at the mode's predicted position, so the order of plots cannot matter. A
//! coordinate that was not measured (elevation, range rate) gets unit variance, no coupling and
//! no innovation: every formula then holds as it stands, and it adds nothing.

use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use common::tracks::STATE;
use nalgebra::Vector3;

use crate::filter::gaussian::{Gaussian, at, dot};
use crate::filter::uav::motion::DIMENSIONS;

/// Coordinates of a measurement: x, y, z, ṙ; or r, β, ε, ṙ in gates.
pub const COORDINATES: usize = 4;
/// Elements of the packed triangle of a 4×4 matrix.
pub const PACKED_4: usize = 10;

/// Ranges below this are taken for it where a formula divides by the range, m.
const NEAREST_M: f64 = 1e-3;

/// A plot, converted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// When the beam passed, ns UTC.
    pub time_ns: u64,
    /// (x, y, z) of (T5), m.
    pub position: [f64; 3],
    /// (r, β, ε, ṙ); m, rad, m/s.
    pub polar: [f64; COORDINATES],
    /// σ² of (r, β, ε, ṙ).
    pub variance: [f64; COORDINATES],
    /// q = z², the power statistic; 0 if not measured.
    pub power: f64,
    /// Which of `polar` were measured.
    pub measured: [bool; COORDINATES],
    /// Whether `power` was measured.
    pub has_power: bool,
}

#[cfg(test)]
impl Measurement {
    /// A plot for tests: at a range and an azimuth, all coordinates measured with unit errors, no power.
    pub(crate) fn at(range_m: f64, azimuth_rad: f64) -> Self {
        Self {
            time_ns: 0,
            position: [0.0; 3],
            polar: [range_m, azimuth_rad, 0.0, 0.0],
            variance: [1.0; COORDINATES],
            power: 0.0,
            measured: [true; COORDINATES],
            has_power: false,
        }
    }
}

impl Measurement {
    /// Converts a plot (T5); `None` if a value is impossible: not finite, no range, an elevation beyond
    /// the zenith, an error that is not positive, a negative statistic.
    pub fn from_plot(plot: &Plot) -> Option<Self> {
        let measured = [true, true, plot.has(HAS_ELEVATION), plot.has(HAS_RANGE_RATE)];
        let has_power = plot.has(HAS_STATISTIC);
        let elevation_rad = if measured[2] { plot.elevation_rad } else { 0.0 };
        let polar =
            [plot.range_m, plot.azimuth_rad, elevation_rad, if measured[3] { plot.range_rate_mps } else { 0.0 }];
        let sigma = [plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps];
        let within = |value: f64, limit: f64| value.is_finite() && value.abs() <= limit;
        let possible = plot.range_m > 0.0
            && within(plot.range_m, 1e7)
            && within(plot.azimuth_rad, 2.0 * std::f64::consts::TAU)
            && within(elevation_rad, std::f64::consts::FRAC_PI_2)
            && within(polar[3], 1e6)
            && (0..COORDINATES).all(|i| !measured[i] || (sigma[i] > 1e-9 && sigma[i] < 1e6))
            && (!has_power || (plot.statistic >= 0.0 && plot.statistic < 1e9));
        if !possible {
            return None;
        }
        let place = Polar { range_m: plot.range_m, azimuth_rad: plot.azimuth_rad, elevation_rad };
        let variance =
            std::array::from_fn(|i| if measured[i] { f64::from(sigma[i]) * f64::from(sigma[i]) } else { 0.0 });
        Some(Self {
            time_ns: plot.time_ns,
            position: place.to_enu().into(),
            polar,
            variance,
            power: if has_power { f64::from(plot.statistic) * f64::from(plot.statistic) } else { 0.0 },
            measured,
            has_power,
        })
    }

    /// Number of measured coordinates.
    pub fn dimensions(&self) -> usize {
        self.measured.iter().filter(|measured| **measured).count()
    }
}

/// R of (T6) at `position` (m), for σ² of (r, β, ε); packed 3×3, m².
pub fn position_covariance(frame: &LineOfSight, variance: [f64; 3]) -> [f64; 6] {
    let across = frame.range_m * frame.cos_elevation;
    let scale = [variance[0], variance[1] * across * across, variance[2] * frame.range_m * frame.range_m];
    let axes = [frame.radial, frame.along_azimuth, frame.along_elevation];
    let mut r = [0.0; 6];
    for (axis, scale) in axes.iter().zip(scale) {
        for b in 0..3 {
            let scaled = scale * axis[b];
            for a in 0..=b {
                r[at(a, b)] += scaled * axis[a];
            }
        }
    }
    r
}

/// Directions at a position, as seen from the antenna.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfSight {
    /// ρ, m; at least a millimetre.
    pub range_m: f64,
    /// β, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// ε, rad.
    pub elevation_rad: f64,
    /// cos ε.
    pub cos_elevation: f64,
    /// e_r.
    pub radial: [f64; 3],
    /// e_β.
    pub along_azimuth: [f64; 3],
    /// e_ε.
    pub along_elevation: [f64; 3],
}

impl LineOfSight {
    /// At `position`, m.
    pub fn at(position: [f64; 3]) -> Self {
        let place = Polar::from_enu(&Vector3::from(position));
        let ground = position[0].hypot(position[1]);
        let range_m = place.range_m.max(NEAREST_M);
        let (sin_b, cos_b) = if ground > 0.0 { (position[0] / ground, position[1] / ground) } else { (0.0, 1.0) };
        let (sin_e, cos_e) =
            if place.range_m > 0.0 { (position[2] / place.range_m, ground / place.range_m) } else { (0.0, 1.0) };
        Self {
            range_m,
            azimuth_rad: place.azimuth_rad,
            elevation_rad: place.elevation_rad,
            cos_elevation: cos_e,
            radial: [cos_e * sin_b, cos_e * cos_b, sin_e],
            along_azimuth: [cos_b, -sin_b, 0.0],
            along_elevation: [-sin_e * sin_b, -sin_e * cos_b, cos_e],
        }
    }
}

/// What one mode expects: h(u*), H, H P* Hᵀ, P* Hᵀ, and the variances in polar coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Directions at the predicted position.
    pub frame: LineOfSight,
    /// Predicted position, m.
    pub position: [f64; 3],
    /// Predicted velocity, m/s.
    pub velocity: [f64; 3],
    /// Predicted acceleration, m/s².
    pub acceleration: [f64; 3],
    /// ṙ, m/s.
    pub range_rate: f64,
    /// g_p: ∂ṙ/∂position, 1/s.
    pub range_rate_gradient: [f64; 3],
    /// H P* Hᵀ, packed.
    pub covariance: [f64; PACKED_4],
    /// P* Hᵀ: a row of four per state.
    pub cross: [[f64; COORDINATES]; STATE],
    /// p*: predicted variances of r, β, ε, ṙ: gᵀ P* g with g their gradients (T9).
    pub polar_variance: [f64; COORDINATES],
}

impl Expected {
    /// For the prediction of `mode`.
    pub fn new(mode: usize, predicted: &Gaussian) -> Self {
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
            acceleration: predicted.acceleration(),
            range_rate,
            range_rate_gradient: g_p,
            covariance,
            cross,
            polar_variance,
        }
    }

    /// h(u*) in gate coordinates: (r, β, ε, ṙ).
    pub fn polar(&self) -> [f64; COORDINATES] {
        [self.frame.range_m, self.frame.azimuth_rad, self.frame.elevation_rad, self.range_rate]
    }

    /// d = y − h(u*), 0 where not measured. `offset_s` is the plot's time minus the prediction's:
    /// the expectation is moved there along the mean motion,
    /// ```text
    /// p + v τ + a τ²/2,   ṙ + τ (a·e_r + (|v|² − ṙ²)/ρ)
    /// ```
    pub fn innovation(&self, measurement: &Measurement, offset_s: f64) -> [f64; COORDINATES] {
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
    pub fn drift(&self) -> [f64; COORDINATES] {
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
    pub fn likelihood(&self, measurement: &Measurement, inflation: f64) -> Option<Likelihood> {
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
pub struct Likelihood {
    /// D⁻¹, packed; 0 in coordinates not measured.
    pub inverse: [f64; PACKED_4],
    /// ln of the density at d = 0.
    pub ln_peak: f64,
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

    /// ln N(d; 0, D) for y = D⁻¹ d.
    pub fn ln_density(&self, d: [f64; COORDINATES], y: [f64; COORDINATES]) -> f64 {
        self.ln_peak - 0.5 * (d[0] * y[0] + d[1] * y[1] + d[2] * y[2] + d[3] * y[3])
    }

    /// D⁻¹ d.
    pub fn solve(&self, d: [f64; COORDINATES]) -> [f64; COORDINATES] {
        let s = &self.inverse;
        [
            s[0] * d[0] + s[1] * d[1] + s[3] * d[2] + s[6] * d[3],
            s[1] * d[0] + s[2] * d[1] + s[4] * d[2] + s[7] * d[3],
            s[3] * d[0] + s[4] * d[1] + s[5] * d[2] + s[8] * d[3],
            s[6] * d[0] + s[7] * d[1] + s[8] * d[2] + s[9] * d[3],
        ]
    }
}
