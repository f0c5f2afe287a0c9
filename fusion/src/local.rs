//! Tracks as the sites report them, and their way into the axes of the centre.

use common::geodesy::{FrameChange, Position, enu_axes};
use common::tracks::{COASTING, CONFIRMED, TERMINATED, Track, pack};
use nalgebra::{Matrix3, Vector3};

use crate::gaussian::{Gaussian, Matrix, STATE, Vector};
use crate::registration::{Bias, BiasJacobian, corrected, jacobian};

/// Standard deviation of the height of a target that a radar without elevation sees, m; it is the greatest height that aircraft have,
/// as a uniform distribution has it.
const UNKNOWN_HEIGHT_M: f64 = 4000.0;
/// The same of its climb, m/s.
const UNKNOWN_CLIMB_MPS: f64 = 30.0;

/// What a site says of one of its tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// The site's number of the track.
    pub id: u64,
    /// Time of the state, ns UTC.
    pub time_ns: u64,
    /// State with the plots of the scan, in the site's ENU.
    pub posterior: Gaussian,
    /// The same without them; `None` where it is not known.
    pub prediction: Option<Gaussian>,
    /// Whether the site believes in it.
    pub confirmed: bool,
    /// Whether it is the last report of this track.
    pub ended: bool,
}

impl Report {
    /// From a track message.
    pub fn from_track(track: &Track) -> Self {
        let posterior = gaussian(&track.state, &track.covariance);
        let prediction = gaussian(&track.predicted_state, &track.predicted_covariance);
        Self {
            id: track.id,
            time_ns: track.time_ns,
            posterior,
            prediction: prediction.is_sound().then_some(prediction),
            confirmed: track.state_code == CONFIRMED || track.state_code == COASTING,
            ended: track.state_code == TERMINATED,
        }
    }
}

/// Position and velocity of a state [x ẋ ẍ y ẏ ÿ z ż z̈] with its packed covariance. A height that is not measured is unknown,
/// not 0.
fn gaussian(state: &[f64], covariance: &[f64]) -> Gaussian {
    let place = |i: usize| 3 * (i % 3) + i / 3;
    let mut of = Gaussian {
        mean: Vector::from_fn(|row, _| state[place(row)]),
        covariance: Matrix::from_fn(|row, column| covariance[pack(place(row), place(column))]),
    };
    for (axis, sigma) in [(2, UNKNOWN_HEIGHT_M), (STATE - 1, UNKNOWN_CLIMB_MPS)] {
        if of.covariance[(axis, axis)] == 0.0 {
            of.covariance[(axis, axis)] = sigma * sigma;
        }
    }
    // A filter that does not estimate velocities does not know them.
    for axis in 3..STATE - 1 {
        if of.covariance[(axis, axis)] == 0.0 {
            of.covariance[(axis, axis)] = 1e6;
        }
    }
    of
}

/// From the axes of a site to those of the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SiteFrame {
    rotation: Matrix3<f64>,
    shift_m: Vector3<f64>,
}

impl SiteFrame {
    /// Of a site, about a centre.
    pub fn new(site: &Position, centre: &Position) -> Self {
        let axes = enu_axes(centre);
        Self {
            rotation: axes * enu_axes(site).transpose(),
            shift_m: FrameChange::new(site, centre).position_m([0.0; 3]).into(),
        }
    }

    /// An estimate in the axes of the centre, without the bias of the radar.
    pub fn to_centre(&self, estimate: &Gaussian, bias: &Bias) -> Gaussian {
        let mut of = *estimate;
        let (position, velocity) = corrected(&estimate.position(), &estimate.velocity(), bias);
        of.mean.fixed_rows_mut::<3>(0).copy_from(&position);
        of.mean.fixed_rows_mut::<3>(3).copy_from(&velocity);
        of.moved(&self.rotation, &self.shift_m)
    }

    /// How a position in the axes of the centre moves with the bias of the radar.
    pub fn jacobian(&self, position_m: &Vector3<f64>, velocity_mps: &Vector3<f64>) -> BiasJacobian {
        let back = self.rotation.transpose();
        self.rotation * jacobian(&self.from_centre(position_m), &(back * velocity_mps))
    }

    /// A position in the axes of the centre, in those of the site; m.
    pub fn from_centre(&self, position_m: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transpose() * (position_m - self.shift_m)
    }
}
