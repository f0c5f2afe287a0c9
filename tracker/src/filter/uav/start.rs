//! Two plots make a track (T17).
//!
//! ```text
//! position y_k,  velocity (y_k − y_(k−1))/T,  acceleration 0
//! P_pp = R_k,  P_pv = R_k/T,  P_vv = (R_k + R_(k−1))/T² + a_j² T² I,  P_aa = a_j² I
//! ```
//!
//! Full 3×3 blocks, the actual T; the hover mode starts at rest and knows its position only. The term
//! a_j²T² is the source's, on the safe side of the mode's own noise.

use common::geometry::Polar;

use crate::filter::gaussian::{Gaussian, at};
use crate::filter::uav::imm::Imm;
use crate::filter::uav::motion::{HOVER, MODES, Motion};
use crate::plots::measurement::{LineOfSight, Measurement, position_covariance};

/// A track at the later plot's time; `step_s` is T > 0.
pub fn two_plots(
    previous: &Measurement,
    last: &Measurement,
    step_s: f64,
    motion: &Motion,
    probability: [f64; MODES],
) -> Imm {
    let errors = |plot: &Measurement| {
        position_covariance(&line_of_sight(plot), [plot.variance[0], plot.variance[1], plot.variance[2]])
    };
    let (r_last, r_previous) = (errors(last), errors(previous));
    let mut modes = [Gaussian::ZERO; MODES];
    for (mode, gaussian) in modes.iter_mut().enumerate() {
        gaussian.mean[..3].copy_from_slice(&last.position);
        gaussian.covariance[..6].copy_from_slice(&r_last);
        if mode == HOVER {
            continue;
        }
        let noise = motion.noise[mode] * motion.noise[mode];
        for b in 0..3 {
            gaussian.mean[3 + b] = (last.position[b] - previous.position[b]) / step_s;
            for a in 0..3 {
                gaussian.covariance[at(a, 3 + b)] = r_last[at(a, b)] / step_s;
            }
            for a in 0..=b {
                gaussian.covariance[at(3 + a, 3 + b)] = (r_last[at(a, b)] + r_previous[at(a, b)]) / (step_s * step_s);
            }
        }
        for axis in 0..motion.axes {
            gaussian.covariance[at(3 + axis, 3 + axis)] += noise * step_s * step_s;
            gaussian.covariance[at(6 + axis, 6 + axis)] = noise;
        }
    }
    Imm { modes, probability }
}

/// Directions at a plot; exact where the azimuth is, also above the antenna.
fn line_of_sight(plot: &Measurement) -> LineOfSight {
    let place = Polar { range_m: plot.polar[0], azimuth_rad: plot.polar[1], elevation_rad: plot.polar[2] };
    LineOfSight::at(place.to_enu().into())
}
