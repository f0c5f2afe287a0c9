//! Flights and their plots, drawn.

use std::f64::consts::TAU;

use common::geometry::{Polar, range_rate_mps};
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use tracker::filter::uav::Uav;
use tracker::filter::{Filter, Mixture, TwoPlots};
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

use crate::reference::imm::Imm;
use crate::reference::motion::Motion;

/// Errors of (r, β, ε, ṙ); m, rad, rad, m/s.
pub(crate) const SIGMA: [f64; COORDINATES] = [20.0, 0.0017, 0.0017, 10.0];
/// A resolution cell, likewise.
const CELL: [f64; COORDINATES] = [69.3, 0.006, 0.006, 34.6];
/// α of the gates.
pub(crate) const ALPHA: f64 = 3.0;

/// With elevation and range rate, or without.
pub(crate) fn radar(full: bool) -> Radar {
    Radar {
        variance: SIGMA.map(|sigma| sigma * sigma),
        cell: CELL,
        measured: [true, true, full, full],
        range_rate_interval_mps: 0.0,
    }
}

/// The filter under test.
pub(crate) fn filter(full: bool, stay: f64) -> Uav {
    let axes = if full { 3 } else { 2 };
    Uav { noise: [1.0, 1.0, 7.0], jerk_share: 1.0, axes, stay, start_probability: [0.33, 0.34, 0.33] }
}

/// Its modes.
pub(crate) fn motion(filter: &Uav) -> Motion {
    Motion { noise: filter.noise, axes: filter.axes }
}

/// Two plots as a state of the filter under test.
pub(crate) fn two_plots(filter: &Uav, previous: &Measurement, last: &Measurement, step_s: f64) -> Imm {
    let mut state = vec![0.0; filter.layout().words()];
    filter.start(&TwoPlots { previous, last, step_s }, &mut state);
    Imm::of(Mixture::new(filter.layout(), &state))
}

/// A plot at (r, β, ε, ṙ) with `scale` times the errors.
pub(crate) fn measurement(polar: [f64; COORDINATES], scale: f64, measured: [bool; COORDINATES]) -> Measurement {
    let polar: [f64; COORDINATES] = std::array::from_fn(|i| if measured[i] { polar[i] } else { 0.0 });
    let place = Polar { range_m: polar[0], azimuth_rad: polar[1], elevation_rad: polar[2] };
    Measurement {
        time_ns: 0,
        position: place.to_enu().into(),
        polar,
        cos_elevation: polar[2].cos(),
        variance: std::array::from_fn(|i| if measured[i] { (SIGMA[i] * scale).powi(2) } else { 0.0 }),
        power: 20.0,
        measured,
        has_power: true,
        is_common: false,
        crowd: 0.0,
    }
}

/// A target that turns now and then.
pub(crate) struct Flight {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    full: bool,
}

impl Flight {
    pub(crate) fn new(rng: &mut impl Rng, full: bool) -> Self {
        let place = Polar {
            range_m: rng.random_range(300.0..20_000.0),
            azimuth_rad: rng.random_range(0.0..TAU),
            elevation_rad: if full { rng.random_range(0.0..1.2) } else { 0.0 },
        };
        let speed = rng.random_range(0.0..40.0);
        let velocity = Vector3::new(speed, rng.random_range(-20.0..20.0), if full { 1.0 } else { 0.0 });
        Self { position: place.to_enu(), velocity, full }
    }

    pub(crate) fn fly(&mut self, rng: &mut impl Rng, dt_s: f64) {
        if rng.random_range(0.0..1.0) < 0.1 {
            self.velocity = Vector3::new(self.velocity.y, -self.velocity.x, self.velocity.z);
        }
        if self.position.norm() < 200.0 || self.position.norm() > 30_000.0 {
            self.velocity = self.position.normalize() * if self.position.norm() < 200.0 { 30.0 } else { -30.0 };
        }
        self.position += self.velocity * dt_s;
    }

    /// A plot `spread` standard deviations of size `scale` from the target.
    pub(crate) fn plot(
        &self,
        rng: &mut impl Rng,
        spread: f64,
        scale: f64,
        measured: [bool; COORDINATES],
    ) -> Measurement {
        let mut normal = |i: usize| spread * scale * SIGMA[i] * sample(rng);
        let place = Polar::from_enu(&self.position);
        let rate = range_rate_mps(&self.position, &self.velocity);
        let elevation_rad = if self.full { place.elevation_rad + normal(2) } else { 0.0 };
        let polar =
            [(place.range_m + normal(0)).abs() + 1.0, place.azimuth_rad + normal(1), elevation_rad, rate + normal(3)];
        measurement(polar, scale, measured)
    }

    pub(crate) fn start(&self, rng: &mut impl Rng) -> Imm {
        let measured = [true, true, self.full, self.full];
        let (first, second) = (self.plot(rng, 1.0, 1.0, measured), self.plot(rng, 1.0, 1.0, measured));
        two_plots(&filter(self.full, 0.9), &first, &second, 1.0)
    }
}

fn sample(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}
