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
//! Far away the uncertainty of a plot is a bent arc: on average it lies nearer than its range by b = r (cos²ε σ_β² + σ_ε²)/2. Where b is more
//! than a tenth of σ_r the position is moved out by b, and σ_r² grows by 4b²: 2b² for the bend of the plot, and as much again for a prediction of half
//! its variance.
//!
//! R is evaluated at the mode's predicted position, so the order of plots cannot matter. A
//! coordinate that was not measured (elevation, range rate) gets unit variance, no coupling and
//! no innovation: every formula then holds as it stands, and it adds nothing.

use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot};
use nalgebra::Vector3;

use crate::filter::gaussian::at;

/// Coordinates of a measurement: x, y, z, ṙ; or r, β, ε, ṙ in gates.
pub const COORDINATES: usize = 4;

/// Ranges below this are taken for it where a formula divides by the range, m.
pub const NEAREST_M: f64 = 1e-3;

/// Square of the bend of a plot's uncertainty, over its variance of range, that is left out of account.
const SLIGHT_BEND: f64 = 0.01;

/// Largest standard error of an angle, rad: a wider one is no direction.
const WIDEST_RAD: f32 = 1.0;

/// A plot, converted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// When the beam passed, ns UTC.
    pub time_ns: u64,
    /// (x, y, z) of (T5), m.
    pub position: [f64; 3],
    /// (r, β, ε, ṙ); m, rad, m/s.
    pub polar: [f64; COORDINATES],
    /// cos ε.
    pub cos_elevation: f64,
    /// σ² of (r, β, ε, ṙ).
    pub variance: [f64; COORDINATES],
    /// q = z², the power statistic; 0 if not measured.
    pub power: f64,
    /// Which of `polar` were measured.
    pub measured: [bool; COORDINATES],
    /// Whether `power` was measured.
    pub has_power: bool,
    /// Whether it is what a plot of two targets says of one of them: no plot of its own.
    pub is_common: bool,
    /// Plots per resolution cell in a crowd of its turn, 0 outside one.
    pub crowd: f32,
}

#[cfg(test)]
impl Measurement {
    /// A plot for tests: at a range and an azimuth, all coordinates measured with unit errors, no power.
    pub(crate) fn at(range_m: f64, azimuth_rad: f64) -> Self {
        Self {
            time_ns: 0,
            position: [0.0; 3],
            polar: [range_m, azimuth_rad, 0.0, 0.0],
            cos_elevation: 1.0,
            variance: [1.0; COORDINATES],
            power: 0.0,
            measured: [true; COORDINATES],
            has_power: false,
            is_common: false,
            crowd: 0.0,
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
            && sigma[1] <= WIDEST_RAD
            && (!measured[2] || sigma[2] <= WIDEST_RAD)
            && (!has_power || (plot.statistic >= 0.0 && plot.statistic < 1e9));
        if !possible {
            return None;
        }
        let place = Polar { range_m: plot.range_m, azimuth_rad: plot.azimuth_rad, elevation_rad };
        let mut variance: [f64; COORDINATES] =
            std::array::from_fn(|i| if measured[i] { f64::from(sigma[i]) * f64::from(sigma[i]) } else { 0.0 });
        let cos_elevation = elevation_rad.cos();
        let bend_m = 0.5 * plot.range_m * (variance[1] * cos_elevation * cos_elevation + variance[2]);
        let mut position: [f64; 3] = place.to_enu().into();
        if bend_m * bend_m > SLIGHT_BEND * variance[0] {
            variance[0] += 4.0 * bend_m * bend_m;
            position = position.map(|axis| axis * (1.0 + bend_m / plot.range_m));
        }
        Some(Self {
            time_ns: plot.time_ns,
            position,
            polar,
            cos_elevation,
            variance,
            power: if has_power { f64::from(plot.statistic) * f64::from(plot.statistic) } else { 0.0 },
            measured,
            has_power,
            is_common: false,
            crowd: 0.0,
        })
    }

    /// A position in the plane, m, known with standard errors of range (m) and azimuth (rad), and nothing else: for studies of a filter.
    pub fn in_plane([east, north]: [f64; 2], sigma: [f64; 2]) -> Self {
        let position = [east, north, 0.0];
        let at = LineOfSight::at(position);
        Self {
            time_ns: 0,
            position,
            polar: [at.range_m, at.azimuth_rad, 0.0, 0.0],
            cos_elevation: 1.0,
            variance: [sigma[0] * sigma[0], sigma[1] * sigma[1], 0.0, 0.0],
            power: 0.0,
            measured: [true, true, false, false],
            has_power: false,
            is_common: false,
            crowd: 0.0,
        }
    }

    /// Directions at its polar place; exact where the azimuth is, also above the antenna.
    pub fn line_of_sight(&self) -> LineOfSight {
        let place = Polar { range_m: self.polar[0], azimuth_rad: self.polar[1], elevation_rad: self.polar[2] };
        LineOfSight::at(place.to_enu().into())
    }

    /// The same, where it has no elevation and `other` has one, with that, from which the target has gone at most `reach_m`.
    #[must_use]
    pub fn with_elevation_of(&self, other: &Self, reach_m: f64) -> Self {
        if self.measured[2] || !other.measured[2] {
            return *self;
        }
        let mut this = *self;
        let [range_m, azimuth_rad, ..] = self.polar;
        let elevation_rad = other.polar[2];
        this.polar[2] = elevation_rad;
        this.variance[2] = other.variance[2] + (reach_m / range_m).powi(2);
        this.cos_elevation = elevation_rad.cos();
        this.position = Polar { range_m, azimuth_rad, elevation_rad }.to_enu().into();
        this
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
