//! How a system track moves: straight on, or manoeuvring.
//!
//! One Kalman filter of near-constant velocity for each of two powers of acceleration, mixed as in the IMM, the
//! time between reports being anything: P(change in T) = 1 − exp(−T/τ).

use crate::gaussian::{Gaussian, Vector};
use crate::measurement::Measurement;
use crate::rules;

/// Kinds of motion.
pub const MODELS: usize = 2;
/// Least probability of a model: one that is ruled out for good could not come back.
const LEAST: f64 = 1e-6;

/// What targets do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Power density of the acceleration, straight on and manoeuvring; m²/s³.
    pub noise: [f64; MODELS],
    /// Mean time that a target goes on so, s.
    pub stay_s: [f64; MODELS],
}

/// A state of which two filters know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving {
    parts: [Gaussian; MODELS],
    probability: [f64; MODELS],
}

impl Moving {
    /// A target of which one estimate is known.
    pub fn new(estimate: Gaussian, motion: &Motion) -> Self {
        let [straight, manoeuvre] = motion.stay_s;
        let probability = straight / (straight + manoeuvre);
        Self { parts: [estimate; MODELS], probability: [probability, 1.0 - probability] }
    }

    /// Probability of each kind of motion.
    pub fn probability(&self) -> [f64; MODELS] {
        self.probability
    }

    /// Predicts by `step_s` s.
    pub fn predict(&mut self, step_s: f64, motion: &Motion) {
        if step_s <= 0.0 {
            return;
        }
        let leave = motion.stay_s.map(|stay_s| 1.0 - (-step_s / stay_s).exp());
        let [p0, p1] = self.probability;
        let joint = [[p0 * (1.0 - leave[0]), p1 * leave[1]], [p0 * leave[0], p1 * (1.0 - leave[1])]];
        let parts = joint.map(|from| mixed(&self.parts, from));
        self.probability = joint.map(|from| from[0] + from[1]);
        for (part, (from, noise)) in self.parts.iter_mut().zip(parts.iter().zip(motion.noise)) {
            *part = from.predicted(step_s, noise);
        }
    }

    /// Takes a measurement of now.
    pub fn absorb(&mut self, measurement: &Measurement) {
        let fits = self.parts.each_mut().map(|part| measurement.absorb(part));
        let most = fits.iter().map(|fit| fit.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        let mut sum = 0.0;
        for (probability, fit) in self.probability.iter_mut().zip(&fits) {
            *probability = (*probability * (fit.log_likelihood - most).exp()).max(LEAST);
            sum += *probability;
        }
        self.probability = self.probability.map(|probability| probability / sum);
    }

    /// Takes an estimate of now whose errors may have anything in common with this one's.
    pub fn intersect(&mut self, estimate: &Gaussian) {
        for part in &mut self.parts {
            *part = rules::intersection(&[*part, *estimate]).unwrap_or(*part);
        }
    }

    /// Moves it to another place: what was taken for its position was another radar's bias.
    pub fn shift(&mut self, by: &Vector) {
        for part in &mut self.parts {
            part.mean += by;
        }
    }

    /// Mean and covariance of both together.
    pub fn moments(&self) -> Gaussian {
        mixed(&self.parts, self.probability)
    }
}

/// Moments of a mixture with weights that need not add up to 1.
fn mixed(parts: &[Gaussian; MODELS], weights: [f64; MODELS]) -> Gaussian {
    let share = weights[0] / (weights[0] + weights[1]);
    let apart = parts[0].mean - parts[1].mean;
    let mean = parts[1].mean + share * apart;
    let spread = apart * apart.transpose() * (share * (1.0 - share));
    Gaussian { mean, covariance: share * parts[0].covariance + (1.0 - share) * parts[1].covariance + spread }
}
