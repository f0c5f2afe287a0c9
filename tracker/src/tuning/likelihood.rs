//! How likely the plots of tracks are: each given those before it, in the directions of its line of sight.
//!
//! ```text
//! ln L = Σ ln [ (1 − ε) Σ_j W_j N(d; 0, Eᵀ P_j E + R) + ε u ]      (ML1)
//! ```
//!
//! d: from the prediction of component j to the plot along e_r, e_β, e_ε; u: the density of a plot that is no target's, which bounds what a
//! wrong plot can cost.

use common::config::TrackerConfig;
use common::units::seconds_between;
use nalgebra::{SMatrix, SVector};

use super::ERRORS;
use super::ways::{Way, Ways};
use crate::association::one_track::OneTrack;
use crate::filter::gaussian::{Gaussian, at};
use crate::filter::{TwoPlots, family};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// ε: share of plots in tracks that are not the target's.
const WRONG: f64 = 0.01;
/// Resolution cells over which those are spread.
const WRONG_CELLS: f64 = 100.0;
/// Groups of ways, of which each is left out once.
pub(super) const GROUPS: usize = 8;
/// Longest gap between two plots of a track, scans: a longer one begins it anew.
const LONGEST_GAP: f64 = 10.0;

/// The plots by which parameters are judged.
#[derive(Debug)]
pub(super) struct Likelihood {
    ways: Vec<Way>,
    period_s: f64,
    radar: Radar,
}

impl Likelihood {
    /// Of at most about `most` plots, of whole tracks from all over the recordings.
    pub(super) fn new(ways: &Ways, most: usize) -> Self {
        let gap_s = LONGEST_GAP * ways.period_s;
        let pieces =
            ways.all.iter().flat_map(|way| way.chunk_by(move |a, b| seconds_between(a.time_ns, b.time_ns) <= gap_s));
        // Long ones are cut, so that some of all tracks are taken, and enough to be left out in turn.
        let pieces = pieces.flat_map(|piece| piece.chunks(most.div_ceil(4 * GROUPS).max(3)));
        let pieces: Vec<Way> = pieces.filter(|piece| piece.len() > 2).map(<[Measurement]>::to_vec).collect();
        let all: usize = pieces.iter().map(Vec::len).sum();
        let share = (most as f64 / all.max(1) as f64).min(1.0);
        // Every piece whose number passes the next whole one, when numbers are counted in shares.
        let is_taken = |index: usize| ((index + 1) as f64 * share).floor() > (index as f64 * share).floor();
        let numbered = pieces.into_iter().enumerate();
        let taken = numbered.filter(|&(index, _)| is_taken(index)).map(|(_, piece)| piece).collect();
        Self { ways: taken, period_s: ways.period_s, radar: ways.radar }
    }

    /// Plots that are judged.
    pub(super) fn plots(&self) -> usize {
        self.ways.iter().map(|way| way.len() - 2).sum()
    }

    /// Tracks, or pieces of them, that are judged.
    pub(super) fn ways(&self) -> usize {
        self.ways.len()
    }

    /// ln L (ML1) with a configuration and factors on the errors that plots state; without one of [`GROUPS`] groups of ways if `without` says so.
    pub(super) fn of(&self, config: &TrackerConfig, scales: [f64; ERRORS], without: Option<usize>) -> f64 {
        let mut track = OneTrack::new(family(config, &self.radar, self.period_s));
        let numbered = self.ways.iter().enumerate().filter(|(index, _)| Some(index % GROUPS) != without);
        let total: f64 = numbered.map(|(_, way)| self.of_way(way, scales, &mut track)).sum();
        if total.is_finite() { total } else { f64::NEG_INFINITY }
    }

    fn of_way(&self, way: &Way, scales: [f64; ERRORS], track: &mut OneTrack) -> f64 {
        let scaled = |plot: &Measurement| {
            let mut plot = *plot;
            plot.variance.iter_mut().zip(scales).for_each(|(variance, scale)| *variance *= scale * scale);
            plot
        };
        let (first, mut last) = (scaled(&way[0]), scaled(&way[1]));
        let step_s = seconds_between(first.time_ns, last.time_ns);
        track.start(&TwoPlots { previous: &first, last: &last, step_s });
        let mut total = 0.0;
        for plot in &way[2..] {
            let plot = scaled(plot);
            // Noise is that of a scan: as the tracker does, scan by scan.
            let elapsed_s = seconds_between(last.time_ns, plot.time_ns);
            let scans = (elapsed_s / self.period_s).round().max(1.0);
            for _ in 0..scans as usize {
                track.predict(elapsed_s / scans);
            }
            total += self.of_plot(&plot, track);
            track.take(&plot);
            last = plot;
        }
        total
    }

    fn of_plot(&self, plot: &Measurement, track: &OneTrack) -> f64 {
        let state = track.state();
        let weights = state.weights().iter().enumerate();
        let density: f64 = if self.radar.measured[2] && plot.measured[2] {
            weights.map(|(j, weight)| weight * density::<3>(plot, &state.gaussian(j))).sum()
        } else {
            weights.map(|(j, weight)| weight * density::<2>(plot, &state.gaussian(j))).sum()
        };
        let across_m = plot.polar[0] * plot.cos_elevation * self.radar.cell[1];
        let height_m = if plot.measured[2] { plot.polar[0] * self.radar.cell[2] } else { 1.0 };
        let wrong = 1.0 / (WRONG_CELLS * self.radar.cell[0] * across_m * height_m.max(f64::MIN_POSITIVE));
        ((1.0 - WRONG) * density + WRONG * wrong).ln()
    }
}

/// N(d; 0, Eᵀ P E + R) in the first N directions of the plot's line of sight, m⁻ᴺ.
fn density<const N: usize>(plot: &Measurement, prediction: &Gaussian) -> f64 {
    let sight = plot.line_of_sight();
    let axes = [sight.radial, sight.along_azimuth, sight.along_elevation];
    let e = SMatrix::<f64, 3, N>::from_fn(|axis, direction| axes[direction][axis]);
    let p = SMatrix::<f64, 3, 3>::from_fn(|a, b| prediction.covariance[at(a.min(b), a.max(b))]);
    let across_m = plot.polar[0] * plot.cos_elevation;
    let length = [1.0, across_m, plot.polar[0]];
    let errors = SVector::<f64, N>::from_fn(|i, _| plot.variance[i] * length[i] * length[i]);
    let covariance = e.transpose() * p * e + SMatrix::<f64, N, N>::from_diagonal(&errors);
    let from_prediction = SVector::<f64, 3>::from_fn(|axis, _| plot.position[axis] - prediction.mean[axis]);
    let d = e.transpose() * from_prediction;
    let Some(factor) = covariance.cholesky() else { return 0.0 };
    let square = d.dot(&factor.solve(&d));
    (-0.5 * square).exp() / (std::f64::consts::TAU.powi(N as i32) * factor.determinant()).sqrt()
}

#[cfg(test)]
mod tests {
    use common::plots::Plot;

    use super::*;
    use crate::tuning::ways::Counts;

    /// A track that is longer than all that is judged is cut, and some of each part of it is taken.
    #[test]
    fn long_tracks_are_cut_and_not_left_out() {
        let plot = |second: u64| Plot {
            time_ns: second * 1_000_000_000,
            range_m: 5000.0,
            azimuth_rad: 1.0,
            sigma_range_m: 10.0,
            sigma_azimuth_rad: 1e-3,
            ..Plot::default()
        };
        let way: Way = (1..=2000).filter_map(|second| Measurement::from_plot(&plot(second))).collect();
        assert_eq!(way.len(), 2000);
        let ways = Ways { all: vec![way], counts: Counts::default(), period_s: 1.0, radar: Radar::IN_PLANE };
        let likelihood = Likelihood::new(&ways, 500);
        assert!((400..=500).contains(&likelihood.plots()), "{} plots", likelihood.plots());
        assert!(likelihood.ways() >= 2 * GROUPS, "{} pieces", likelihood.ways());
    }
}
