//! Which pairs of plots of successive turns may be the start of a track (T18).
//!
//! A pair must lie within reach of a target of the greatest speed, and its change of range must
//! agree with both measured range rates:
//! ```text
//! |y_k − y_(k−1)| ≤ v_max T + 3σ
//! |(r_k − r_(k−1))/T − (ṙ_k + ṙ_(k−1))/2| ≤ 3σ,   |ṙ_k − ṙ_(k−1)| ≤ 3σ
//! ```

use crate::plots::index::Window;
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::plots::radar::Radar;

/// How far errors may reach, standard deviations.
const REACH: f64 = 3.0;

/// Limits of a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairLimits {
    /// v_max, m/s.
    pub speed_mps: f64,
    /// Change of range rate that a target may make in a second, m/s².
    pub acceleration_mps2: f64,
}

impl PairLimits {
    /// Half width in azimuth in which the earlier plot must lie, rad; at most a quarter turn.
    pub fn azimuth_rad(&self, last: &Measurement, step_s: f64) -> f64 {
        let ground = last.polar[0] * last.cos_elevation;
        let across = self.speed_mps * step_s / ground;
        let angle = if across < 1.0 { across.asin() } else { std::f64::consts::FRAC_PI_2 };
        (angle + 2.0 * REACH * last.variance[1].sqrt()).min(std::f64::consts::FRAC_PI_2)
    }

    /// Ends of the interval of range in which the earlier plot must lie if its variance of range is at most `variance`, m.
    pub fn range_m(&self, last: &Measurement, step_s: f64, variance: f64) -> [f64; 2] {
        let reach_m = self.speed_mps * step_s + REACH * (last.variance[0] + variance).sqrt();
        [last.polar[0] - reach_m, last.polar[0] + reach_m]
    }

    /// Variance of a plot's position across the line of sight, m².
    pub fn variance_across(plot: &Measurement) -> f64 {
        plot.polar[0] * plot.polar[0] * (plot.variance[1] + plot.variance[2])
    }

    /// Ends of the interval of elevation in which the earlier plot must lie if its variances along and across the line of sight are at most
    /// `variance`, rad: what lies at most a distance d away is seen within arcsin(d/r).
    pub fn elevation_rad(&self, last: &Measurement, step_s: f64, variance: [f64; 2]) -> [f64; 2] {
        let spread = last.variance[0] + variance[0] + Self::variance_across(last) + variance[1];
        let sine = (self.speed_mps * step_s + REACH * spread.sqrt()) / last.polar[0];
        if !last.measured[2] || sine >= 1.0 {
            return Window::ANY_ELEVATION;
        }
        let half = sine.asin();
        [last.polar[2] - half, last.polar[2] + half]
    }

    /// Resolution cells in which the earlier plot of a pair may lie: a box of the reach in each coordinate.
    pub fn cells(&self, last: &Measurement, step_s: f64, radar: &Radar) -> f64 {
        let travel_m = self.speed_mps * step_s;
        let reach = [travel_m, travel_m / last.polar[0], travel_m / last.polar[0], self.speed_mps];
        let most = |i: usize| {
            if i == 3 && radar.range_rate_interval_mps > 0.0 { radar.range_rate_interval_mps } else { f64::INFINITY }
        };
        let extent = |i: usize| (radar.cell[i] + 2.0 * reach[i]).min(most(i)) / radar.cell[i];
        (0..COORDINATES).filter(|&i| radar.measured[i] && last.measured[i]).map(extent).product()
    }

    /// How badly two plots `step_s` apart fit one target; `None` if they do not. Smaller is better.
    pub fn misfit(&self, previous: &Measurement, last: &Measurement, step_s: f64, radar: &Radar) -> Option<f64> {
        let travel_m = self.speed_mps * step_s;
        let range_change_m = last.polar[0] - previous.polar[0];
        let range_variance = last.variance[0] + previous.variance[0];
        // Most pairs end here, before any product.
        if range_change_m.abs() > travel_m + REACH * range_variance.sqrt() {
            return None;
        }
        let mut misfit = 0.0;
        if last.measured[3] && previous.measured[3] {
            let rate_variance = last.variance[3] + previous.variance[3];
            let [rate, rate_before] = [last, previous].map(|plot| radar.unfold(plot.polar[3], range_change_m / step_s));
            let rate_change = rate - rate_before;
            if rate_change.abs() > REACH * rate_variance.sqrt() + self.acceleration_mps2 * step_s {
                return None;
            }
            let difference = range_change_m / step_s - 0.5 * (rate + rate_before);
            let variance = range_variance / (step_s * step_s) + 0.25 * rate_variance;
            misfit += difference * difference / variance;
            if misfit > REACH * REACH {
                return None;
            }
        }
        let mut square = 0.0;
        for axis in 0..if last.measured[2] { 3 } else { 2 } {
            square += (last.position[axis] - previous.position[axis]).powi(2);
        }
        let distance = square.sqrt();
        let spread = (range_variance + Self::variance_across(last) + Self::variance_across(previous)).sqrt();
        (distance <= travel_m + REACH * spread).then(|| misfit + (distance / (travel_m + spread)).powi(2))
    }
}
