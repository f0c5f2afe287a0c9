//! Tracks of one radar: one Kalman filter, or two that are mixed.

use super::radar::Measured;
use crate::gaussian::{Gaussian, Matrix, STATE, Vector};
use crate::local::Report;
use crate::measurement::Measurement;
use crate::motion::{Motion, Moving};

/// Standard deviation of a velocity of which nothing is known, m/s.
const ANY_MPS: f64 = 300.0;
/// Variance of what is known nothing of at all.
const NOTHING: f64 = 1e12;

/// How a radar tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filter {
    /// One Kalman filter of near-constant velocity.
    Straight {
        /// Power density of its acceleration, m²/s³.
        noise: f64,
    },
    /// Two of them, mixed.
    Manoeuvring(Motion),
}

/// A track in progress.
#[derive(Debug, Clone, Copy)]
pub struct Tracking {
    motion: Motion,
    /// Time, s; the filters.
    now: Option<(f64, Moving)>,
    /// Before the last measurement.
    prediction: Option<Gaussian>,
}

impl Tracking {
    pub(super) fn new(filter: Filter) -> Self {
        let motion = match filter {
            // One that nobody leaves, and one that nobody enters.
            Filter::Straight { noise } => Motion { noise: [noise; 2], stay_s: [1e12, 1.0] },
            Filter::Manoeuvring(motion) => motion,
        };
        Self { motion, now: None, prediction: None }
    }

    pub(super) fn update(&mut self, time_s: f64, measured: &Measured) {
        let mut alone = Gaussian { mean: Vector::zeros(), covariance: Matrix::identity() * NOTHING };
        let nothing = alone;
        alone.mean.fixed_rows_mut::<3>(0).copy_from(&measured.position_m);
        alone.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&measured.covariance);
        if let Some((before_s, moving)) = &mut self.now {
            moving.predict(time_s - *before_s, &self.motion);
            self.prediction = Some(moving.moments());
            if let Some(measurement) = Measurement::of_position(&alone, &nothing) {
                moving.absorb(&measurement);
            }
            *before_s = time_s;
        } else {
            (3..STATE).for_each(|axis| alone.covariance[(axis, axis)] = ANY_MPS * ANY_MPS);
            self.now = Some((time_s, Moving::new(alone, &self.motion)));
        }
    }

    /// The track at a time.
    pub fn at(&self, time_s: f64) -> Option<Gaussian> {
        let (then_s, mut moving) = self.now?;
        moving.predict(time_s - then_s, &self.motion);
        Some(moving.moments())
    }

    pub(super) fn report(&self, id: u64, time_ns: u64) -> Option<Report> {
        let posterior = self.now?.1.moments();
        let prediction = Some(self.prediction.unwrap_or(posterior));
        Some(Report { id, time_ns, posterior, prediction, confirmed: true, ended: false })
    }
}
