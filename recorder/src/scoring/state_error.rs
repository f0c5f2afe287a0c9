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
    /// `None` for states that are no numbers.
    pub(super) fn new(track: &Track, target: &TruthTarget) -> Option<Self> {
        let dt_s = seconds_between(target.time_ns, track.time_ns);
        let mut truth = target.state;
        for axis in POSITION {
            let [x, v, a] = [target.state[axis], target.state[axis + 1], target.state[axis + 2]];
            truth[axis] = x + v * dt_s + 0.5 * a * dt_s * dt_s;
            truth[axis + 1] = v + a * dt_s;
        }
        let error: [f64; 9] = std::array::from_fn(|index| track.state[index] - truth[index]);
        let length = |axes: [usize; 3]| axes.iter().map(|&axis| error[axis] * error[axis]).sum::<f64>().sqrt();
        let (distance_m, speed_mps) = (length(POSITION), length(POSITION.map(|axis| axis + 1)));
        let kind = match target.mode {
            HOVER => KIND_HOVER,
            CONSTANT_VELOCITY => KIND_CONSTANT_VELOCITY,
            MANOEUVRE => KIND_MANOEUVRE,
            _ => u16::MAX,
        };
        distance_m.is_finite().then(|| Self {
            distance_m,
            speed_mps,
            nees: normalised_square(&error, track, POSITION_AND_VELOCITY),
            nees_position: normalised_square(&error, track, POSITION),
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
