//! What one scan did to a track.

use common::tracks::Models;
use evaluation::consistency::normalised_square;
use nalgebra::{Matrix3, Vector3};
use radar_sim::motion::Kinematics;
use tracker::association::gate::Gate;
use tracker::association::scan::Outcome;
use tracker::filter::gaussian::Gaussian;

use crate::world::Sight;

/// What one scan did.
#[derive(Debug, Clone, Copy)]
pub struct ScanRecord {
    /// k.
    pub k: u32,
    /// Predicted position minus truth, ENU, m.
    pub predicted_error_m: Vector3<f64>,
    /// Estimated position minus truth, ENU, m.
    pub position_error_m: Vector3<f64>,
    /// Estimated velocity minus truth, ENU, m/s.
    pub velocity_error_mps: Vector3<f64>,
    /// Standard deviations that the filter states for the estimated position, ENU, m.
    pub position_sd_m: Vector3<f64>,
    /// νᵀ P⁻¹ ν of the position; 3 on average if the filter is right.
    pub nees_position: f64,
    /// What the filter says of the way to move.
    pub models: Models,
    /// Whether the most probable model is that of the truth.
    pub correct: bool,
    /// The gate in use; the largest of a union.
    pub gate: Gate,
}

/// Errors of a track in one scan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Errors {
    /// Of the predicted position, ENU, m.
    pub(crate) predicted_m: Vector3<f64>,
    /// Of the estimated position, ENU, m.
    pub(crate) position_m: Vector3<f64>,
    /// Of the estimated velocity, ENU, m/s.
    pub(crate) velocity_mps: Vector3<f64>,
    /// Standard deviations that the filter states for the estimated position, ENU, m.
    position_sd_m: Vector3<f64>,
    /// Of the estimated position.
    pub(crate) nees_position: f64,
}

/// Prediction and estimate minus truth.
pub(crate) fn errors_of(predicted: &Gaussian, estimate: &Gaussian, truth: &Kinematics) -> Errors {
    let p = &estimate.covariance;
    let covariance = Matrix3::new(p[0], p[1], p[3], p[1], p[2], p[4], p[3], p[4], p[5]);
    let position_m = Vector3::from(estimate.position()) - truth.position_m;
    Errors {
        predicted_m: Vector3::from(predicted.position()) - truth.position_m,
        position_m,
        velocity_mps: Vector3::from(estimate.velocity()) - truth.velocity_mps,
        position_sd_m: covariance.diagonal().map(f64::sqrt),
        nees_position: normalised_square(&position_m, &covariance).unwrap_or(f64::NAN),
    }
}

impl ScanRecord {
    /// Probability of the models of a kind together.
    pub fn probability_of(&self, kind: u16) -> f64 {
        let models = self.models.kind.iter().zip(&self.models.probability);
        models.filter(|(own, _)| **own == kind).map(|(_, probability)| probability).sum()
    }

    pub(super) fn new(
        k: u32,
        predicted: &Gaussian,
        estimate: &Gaussian,
        models: Models,
        outcome: &Outcome,
        sight: &Sight,
    ) -> Self {
        let errors = errors_of(predicted, estimate, &sight.truth);
        Self {
            k,
            predicted_error_m: errors.predicted_m,
            position_error_m: errors.position_m,
            velocity_error_mps: errors.velocity_mps,
            position_sd_m: errors.position_sd_m,
            nees_position: errors.nees_position,
            models,
            correct: models.most_probable() == sight.kind,
            gate: outcome.selection.gate,
        }
    }
}
