//! Targets that are larger than a cell: which clusters are none of a point, and where their middle lies (C7).
//!
//! The response of a point is known, so its cluster is foretold by its peak: a point δ cells from the peak cell has in the cell
//! k the amplitude a h_k (C6). A cluster is of an *extended* target if along any axis
//!
//! - the amplitude of its last cell is far above a point's there, and its power no less than a hundredth of the peak's, or
//! - the three cells x_k about the peak do not fit a point. With a = Σ x_k h_k / Σ h_k², the expectation
//!   m_k = √(a² h_k² + ½) and the variance ½ of an amplitude in noise of power 1, Σ (x_k − m_k)²/(½ + ρ² m_k²) is at most χ² of one degree of
//!   freedom for a point; ρ is how well the response is known.
//!
//! What such a target is seen by wanders over it, so its place is the middle of what is seen, (k₁ + k₂)/2, known to a cell
//! (C1). Where only a part p of the cells is over the threshold, an end row of m cells is missed with the
//! probability (1 − p)^m, and so are the rows after it; with s = 1 − (1 − p)^m
//!
//! ```text
//! σ² = 1/12 + ½ (1 − s)/s²   cells²
//! ```

use crate::centroid::Offset;
use crate::clustering::{Cluster, Cut, Reach};

/// The amplitude of a point's last cell is at most so many standard errors above what is foretold.
const FAR: f64 = 4.5;
/// Cells of one hull have powers within this of each other; clutter that a strong target's skirts touch has less.
const LIKE: f64 = 0.01;
/// χ² of one degree of freedom that one point in 2000 exceeds.
const MISFIT: f64 = 12.0;
/// ρ: the response of a real radar is Gaussian to about this part.
const RESPONSE_ERROR: f64 = 0.1;
/// Variance of a place within a cell, cells².
const CELL_VARIANCE: f64 = 1.0 / 12.0;

/// What is known of a cluster along an axis.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// How far it reaches, with powers over the noise of the peak.
    pub reach: Reach,
    /// Cell, or dwell, of the peak.
    pub peak: u64,
    /// Powers through the peak.
    pub cut: Cut,
    /// Place of the peak as that of a point.
    pub point: Offset,
    /// κ of the axis.
    pub curvature: f64,
}

impl Axis {
    /// Whether a point cannot look so.
    fn is_extended(&self) -> bool {
        let peak = (self.cut[1] - 1.0).max(0.0);
        let foretold = |place: f64| {
            let k = place - self.peak as f64;
            let (delta, kappa) = (self.point.cells, self.curvature);
            1.0 + peak * (-kappa * ((k - delta).powi(2) - delta * delta)).exp()
        };
        let ends = [self.reach.first, self.reach.last].into_iter().zip(self.reach.powers);
        let is_stronger = |(place, power): (u64, f64)| {
            let expected = foretold(place as f64).sqrt();
            power > LIKE * self.cut[1] && power.sqrt() - expected > FAR * (0.5_f64.sqrt() + RESPONSE_ERROR * expected)
        };
        ends.into_iter().any(is_stronger) || self.misfit() > MISFIT
    }

    /// χ² of the cells about the peak as those of a point.
    fn misfit(&self) -> f64 {
        let cells = (-1_i32..).zip(self.cut).filter(|(_, power)| !power.is_nan()).map(|(k, power)| {
            let distance = f64::from(k) - self.point.cells;
            (power.max(0.0).sqrt(), (-0.5 * self.curvature * distance * distance).exp())
        });
        let (seen, energy) = cells.clone().fold((0.0, 0.0), |(seen, energy), (x, h)| (seen + x * h, energy + h * h));
        let amplitude = seen / energy;
        let deviation = |(x, h): (f64, f64)| {
            let expected = ((amplitude * h).powi(2) + 0.5).sqrt();
            (x - expected).powi(2) / (0.5 + (RESPONSE_ERROR * expected).powi(2))
        };
        cells.map(deviation).sum()
    }
}

/// Places relative to the peak along range, azimuth and elevation, if the cluster is of an extended target.
pub fn middle(cluster: &Cluster, axes: &[Axis; 3]) -> Option<[Offset; 3]> {
    if !axes.iter().any(Axis::is_extended) {
        return None;
    }
    let lengths = axes.map(|axis| axis.reach.length() as f64);
    let cells: f64 = lengths.iter().product();
    let filled = (f64::from(cluster.hits) / cells).min(1.0);
    Some(std::array::from_fn(|index| {
        let Axis { reach, peak, .. } = axes[index];
        let seen = 1.0 - (1.0 - filled).powf(cells / lengths[index]);
        let variance = CELL_VARIANCE + 0.5 * (1.0 - seen) / (seen * seen);
        Offset { cells: 0.5 * (reach.first + reach.last) as f64 - peak as f64, sigma: variance.sqrt() }
    }))
}
