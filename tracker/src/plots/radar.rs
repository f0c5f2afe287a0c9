//! What the radar measures, and how well in general.

use super::measurement::{COORDINATES, Measurement};

/// What the radar measures, and how well in general.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radar {
    /// σ² of (r, β, ε, ṙ).
    pub variance: [f64; COORDINATES],
    /// Sizes of a resolution cell in (r, β, ε, ṙ).
    pub cell: [f64; COORDINATES],
    /// Which of them are measured.
    pub measured: [bool; COORDINATES],
    /// Range rates are known up to multiples of this, m/s; 0 where they are known.
    pub range_rate_interval_mps: f64,
}

impl Radar {
    /// Range and azimuth, of unit errors (m, rad): for plots that bring errors of their own.
    pub const IN_PLANE: Self = Self {
        variance: [1.0; COORDINATES],
        cell: [1.0; COORDINATES],
        measured: [true, true, false, false],
        range_rate_interval_mps: 0.0,
    };

    /// Number of measured coordinates.
    pub fn dimensions(&self) -> usize {
        self.measured.iter().filter(|measured| **measured).count()
    }

    /// Of the range rates that a measured one may stand for, that nearest to `expected`, m/s.
    pub fn unfold(&self, range_rate_mps: f64, expected: f64) -> f64 {
        let interval = self.range_rate_interval_mps;
        if interval > 0.0 {
            range_rate_mps + interval * ((expected - range_rate_mps) / interval).round()
        } else {
            range_rate_mps
        }
    }

    /// The largest side of a resolution cell at a range, m.
    pub fn cell_m(&self, range_m: f64) -> f64 {
        self.cell[0].max(range_m * self.cell[1]).max(range_m * self.cell[2])
    }

    /// Product of `extent` over the measured coordinates, as a volume in the measure of y (m³·m/s) at range
    /// `r` (m) and elevation cosine `cos_e`: r² cos ε with elevation, r without.
    pub fn volume(&self, extent: impl Fn(usize) -> f64, r: f64, cos_e: f64) -> f64 {
        volume(self.measured, extent, r, cos_e)
    }

    /// The same over the coordinates that a plot holds of these, in the measure of its likelihood: a plot without elevation says nothing
    /// of one, and nor does the density of false plots to which it is compared.
    pub fn volume_at(&self, plot: &Measurement, extent: impl Fn(usize) -> f64) -> f64 {
        let held = std::array::from_fn(|i| self.measured[i] && plot.measured[i]);
        volume(held, extent, plot.polar[0].max(1.0), plot.cos_elevation.max(1e-3))
    }
}

fn volume(measured: [bool; COORDINATES], extent: impl Fn(usize) -> f64, r: f64, cos_e: f64) -> f64 {
    let product: f64 = (0..COORDINATES).filter(|&i| measured[i]).map(extent).product();
    product * if measured[2] { r * r * cos_e } else { r }
}
