//! A track report against truth at its time.

use common::tracks::{KIND_CONSTANT_VELOCITY, KIND_HOVER, KIND_MANOEUVRE, Track, pack};
use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, TruthTarget};
use common::units::seconds_between;
use evaluation::consistency;
use nalgebra::{SMatrix, SVector};

/// Indices of position in the state.
const POSITION: [usize; 3] = [0, 3, 6];
/// Indices of position and velocity in the state.
const POSITION_AND_VELOCITY: [usize; 6] = [0, 1, 3, 4, 6, 7];

/// A track report minus truth, moved to the time of the report by its velocity and acceleration.
#[derive(Debug, Clone)]
pub(super) struct StateError {
    /// Length of the error of position, m.
    pub(super) distance_m: f64,
    /// Length of the error of velocity, m/s.
    pub(super) speed_mps: f64,
    /// NEES of position and velocity over its dimension.
    pub(super) nees: Option<f64>,
    /// NEES of position over its dimension.
    pub(super) nees_position: Option<f64>,
    /// What the track gives to the models of the true kind, if its filter has one and the truth is known.
    pub(super) true_kind: Option<f64>,
}

impl StateError {
    /// Of a radar that measures elevation (`is_elevated`) in three dimensions, of another one in its slant plane. `None` for
    /// states that are no numbers.
    pub(super) fn new(track: &Track, target: &TruthTarget, is_elevated: bool) -> Option<Self> {
        let dt_s = seconds_between(target.time_ns, track.time_ns);
        let mut truth = target.state;
        for axis in POSITION {
            let [x, v, a] = [target.state[axis], target.state[axis + 1], target.state[axis + 2]];
            truth[axis] = x + v * dt_s + 0.5 * a * dt_s * dt_s;
            truth[axis + 1] = v + a * dt_s;
        }
        if !is_elevated {
            truth = in_slant_plane(&truth);
        }
        let error: [f64; 9] = std::array::from_fn(|index| track.state[index] - truth[index]);
        let axes = if is_elevated { &POSITION[..] } else { &POSITION[..2] };
        let length = |of: usize| axes.iter().map(|&axis| error[axis + of].powi(2)).sum::<f64>().sqrt();
        let (distance_m, speed_mps) = (length(0), length(1));
        let kind = match target.mode {
            HOVER => KIND_HOVER,
            CONSTANT_VELOCITY => KIND_CONSTANT_VELOCITY,
            MANOEUVRE => KIND_MANOEUVRE,
            _ => u16::MAX,
        };
        distance_m.is_finite().then(|| Self {
            distance_m,
            speed_mps,
            nees: if is_elevated {
                normalised_square(&error, track, POSITION_AND_VELOCITY)
            } else {
                normalised_square(&error, track, [0, 1, 3, 4])
            },
            nees_position: if is_elevated {
                normalised_square(&error, track, POSITION)
            } else {
                normalised_square(&error, track, [0, 3])
            },
            true_kind: track.model_kind.contains(&kind).then(|| track.probability_of(kind)),
        })
    }
}

/// NEES of some components over their number; `None` if P has no Cholesky factor.
fn normalised_square<const N: usize>(error: &[f64; 9], track: &Track, components: [usize; N]) -> Option<f64> {
    let covariance =
        SMatrix::<f64, N, N>::from_fn(|row, column| track.covariance[pack(components[row], components[column])]);
    let error = SVector::from(components.map(|component| error[component]));
    Some(consistency::normalised_square(&error, &covariance)? / N as f64)
}

/// Position and velocity of a target as a radar without elevation sees them: at slant range r in the direction of its azimuth β.
///
/// ```text
/// p = r u, ṗ = ṙ u + r β̇ w        u = (x, y)/ρ, w = (y, −x)/ρ, ρ² = x² + y², β̇ = (ẋ y − ẏ x)/ρ²
/// ```
fn in_slant_plane(state: &[f64; 9]) -> [f64; 9] {
    let ([x, y, z], [vx, vy, vz]) = ([state[0], state[3], state[6]], [state[1], state[4], state[7]]);
    let (ground_m, range_m) = (x.hypot(y), x.hypot(y).hypot(z));
    if ground_m == 0.0 {
        return *state;
    }
    let (rate_mps, across_mps) = ((x * vx + y * vy + z * vz) / range_m, (vx * y - vy * x) / ground_m);
    let (east, north) = (x / ground_m, y / ground_m);
    let across_mps = across_mps * range_m / ground_m;
    let mut plane = [0.0; 9];
    (plane[0], plane[3]) = (range_m * east, range_m * north);
    (plane[1], plane[4]) = (rate_mps * east + across_mps * north, rate_mps * north - across_mps * east);
    plane
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The velocity in the slant plane is the change of the position in it.
    #[test]
    fn velocity_in_the_slant_plane_is_the_change_of_position() {
        let at = |time_s: f64| {
            let [vx, vy, vz] = [-30.0, 55.0, 8.0];
            let mut state = [0.0; 9];
            (state[0], state[3], state[6]) = (3000.0 + vx * time_s, 1000.0 + vy * time_s, 4000.0 + vz * time_s);
            (state[1], state[4], state[7]) = (vx, vy, vz);
            in_slant_plane(&state)
        };
        let (before, now, after) = (at(-1e-3), at(0.0), at(1e-3));
        for axis in [0, 3] {
            let change = (after[axis] - before[axis]) / 2e-3;
            assert!((now[axis + 1] - change).abs() < 1e-6, "{} {change}", now[axis + 1]);
        }
        assert!(
            (now[0].hypot(now[3]) - (3000.0_f64.powi(2) + 1000.0_f64.powi(2) + 4000.0_f64.powi(2)).sqrt()).abs() < 1e-9
        );
    }
}
