//! Eight tracks in structure-of-arrays form.
//!
//! ```text
//! mode            mean   covariance (packed triangle, see `crate::filter::gaussian`)
//! hover            3      6     position
//! near-constant    6     21     position, velocity
//! manoeuvre        9     45     position, velocity, acceleration
//! ```
//!
//! 18 + 72 + 3 numbers of a track; element k of all eight is one [`Row`]. What a mode does not know is not stored: it is
//! zero in [`Imm`].

use crate::filter::gaussian::{Gaussian, packed};
use crate::filter::uav::imm::Imm;
use crate::filter::uav::motion::{CONSTANT_VELOCITY, HOVER, MANOEUVRE, MODES};

use super::lanes::{LANES, Row};

/// Mean and covariance of a mode of N states, P = N (N + 1)/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode<const N: usize, const P: usize> {
    /// u; m, m/s, m/s².
    pub mean: [Row; N],
    /// Packed triangle of P.
    pub covariance: [Row; P],
}

/// û, P̂, W of eight tracks; or u*, P*, W*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Hover.
    pub hover: Mode<3, { packed(3) }>,
    /// Near-constant velocity.
    pub constant_velocity: Mode<6, { packed(6) }>,
    /// Manoeuvre.
    pub manoeuvre: Mode<9, { packed(9) }>,
    /// W by mode; they sum to 1.
    pub probability: [Row; MODES],
}

impl<const N: usize, const P: usize> Mode<N, P> {
    /// Tracks at the antenna with unit covariance: what an empty lane computes with.
    fn idle() -> Self {
        let mut mode = Self { mean: [Row::ZERO; N], covariance: [Row::ZERO; P] };
        for i in 0..N {
            mode.covariance[packed(i + 1) - 1] = Row::splat(1.0);
        }
        mode
    }

    fn load(&mut self, lane: usize, gaussian: &Gaussian) {
        for (row, value) in self.mean.iter_mut().zip(gaussian.mean) {
            row.0[lane] = value;
        }
        for (row, value) in self.covariance.iter_mut().zip(gaussian.covariance) {
            row.0[lane] = value;
        }
    }

    fn store(&self, lane: usize) -> Gaussian {
        let mut gaussian = Gaussian::ZERO;
        for (row, value) in self.mean.iter().zip(&mut gaussian.mean) {
            *value = row.0[lane];
        }
        for (row, value) in self.covariance.iter().zip(&mut gaussian.covariance) {
            *value = row.0[lane];
        }
        gaussian
    }

    fn copy_lane(&mut self, lane: usize, other: &Self) {
        for (row, from) in self.mean.iter_mut().zip(&other.mean) {
            row.0[lane] = from.0[lane];
        }
        for (row, from) in self.covariance.iter_mut().zip(&other.covariance) {
            row.0[lane] = from.0[lane];
        }
    }
}

impl Default for Block {
    fn default() -> Self {
        Self {
            hover: Mode::idle(),
            constant_velocity: Mode::idle(),
            manoeuvre: Mode::idle(),
            probability: [Row::splat(1.0 / MODES as f64); MODES],
        }
    }
}

impl Block {
    /// Puts a track into `lane`; what a mode does not know is dropped.
    pub fn load(&mut self, lane: usize, track: &Imm) {
        assert!(lane < LANES, "lane {lane} of {LANES}");
        self.hover.load(lane, &track.modes[HOVER]);
        self.constant_velocity.load(lane, &track.modes[CONSTANT_VELOCITY]);
        self.manoeuvre.load(lane, &track.modes[MANOEUVRE]);
        for (row, value) in self.probability.iter_mut().zip(track.probability) {
            row.0[lane] = value;
        }
    }

    /// The track in `lane`.
    pub fn store(&self, lane: usize) -> Imm {
        Imm {
            modes: [self.hover.store(lane), self.constant_velocity.store(lane), self.manoeuvre.store(lane)],
            probability: std::array::from_fn(|j| self.probability[j].0[lane]),
        }
    }

    /// Makes `lane` that of `other`.
    pub fn copy_lane(&mut self, lane: usize, other: &Self) {
        self.hover.copy_lane(lane, &other.hover);
        self.constant_velocity.copy_lane(lane, &other.constant_velocity);
        self.manoeuvre.copy_lane(lane, &other.manoeuvre);
        for (row, from) in self.probability.iter_mut().zip(&other.probability) {
            row.0[lane] = from.0[lane];
        }
    }
}
