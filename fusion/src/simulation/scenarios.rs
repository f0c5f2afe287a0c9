//! Scenarios that tests and experiments share: radars on a circle, aircraft all over it, and what makes it harder.

use std::f64::consts::TAU;

use common::geodesy::Position;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};

use super::{Filter, Radar, Scenario, Target, Turn, normal};
use crate::motion::Motion;
use crate::registration::Bias;

type Draws = chacha20::ChaCha8Rng;

/// One degree, rad.
pub const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Origin of the axes.
const CENTRE: Position = Position { latitude_deg: 50.0, longitude_deg: 30.0, height_m: 150.0 };
/// Radars stand so far from it, m.
const CIRCLE_M: f64 = 60_000.0;
/// Half side of the square in which targets begin, m.
const EXTENT_M: f64 = 120_000.0;
/// Members of a formation.
const MEMBERS: usize = 4;

/// Standard deviations of range, azimuth, elevation of radars that are alike; m, rad, rad.
pub const EQUAL: [[f64; 3]; 8] = [[50.0, 0.1 * DEGREE, 0.1 * DEGREE]; 8];
/// The same of radars that are not.
pub const MIXED: [[f64; 3]; 8] = [
    [30.0, 0.05 * DEGREE, 0.08 * DEGREE],
    [80.0, 0.2 * DEGREE, 0.2 * DEGREE],
    [150.0, 0.15 * DEGREE, 0.3 * DEGREE],
    [50.0, 0.1 * DEGREE, 0.1 * DEGREE],
    [100.0, 0.2 * DEGREE, 0.2 * DEGREE],
    [50.0, 0.15 * DEGREE, 0.15 * DEGREE],
    [150.0, 0.1 * DEGREE, 0.2 * DEGREE],
    [60.0, 0.12 * DEGREE, 0.12 * DEGREE],
];

/// Standard deviations of biases that a network is to cope with: 60 m, 0.1°, 0.1°.
pub fn usual_bias() -> Bias {
    Bias::new(60.0, 0.1 * DEGREE, 0.1 * DEGREE, 0.0)
}

impl Scenario {
    /// Radars of these errors on a circle, with turns of 4 to 10 s, and so many aircraft in straight flight.
    pub fn circle(radars: &[[f64; 3]], targets: usize, seed: u64) -> Self {
        let mut rng = Draws::seed_from_u64(seed);
        let radar = |(i, &sigma): (usize, &[f64; 3])| {
            let angle = TAU * i as f64 / radars.len() as f64;
            Radar::near(&CENTRE, [CIRCLE_M * angle.sin(), CIRCLE_M * angle.cos()], sigma, [5.0, 6.0, 4.0, 10.0][i % 4])
        };
        Self {
            centre: CENTRE,
            radars: radars.iter().enumerate().map(radar).collect(),
            targets: (0..targets).map(|_| Target::any(&mut rng, EXTENT_M)).collect(),
            noise: 0.5,
            filter: Filter::Straight { noise: 0.5 },
            cycle_s: 5.0,
        }
    }

    /// This share of the targets turn once, for 20 s at 1 g; radars track with two motions.
    #[must_use]
    pub fn with_turns(mut self, share: f64, seed: u64) -> Self {
        let mut rng = Draws::seed_from_u64(seed);
        for target in &mut self.targets {
            if rng.random::<f64>() < share {
                let from_s = rng.random_range(60.0..120.0);
                let right_mps2 = if rng.random::<bool>() { 10.0 } else { -10.0 };
                target.turn = Some(Turn { right_mps2, from_s, to_s: from_s + 20.0 });
            }
        }
        self.filter = Filter::Manoeuvring(Motion { noise: [0.5, 500.0], stay_s: [120.0, 15.0] });
        self
    }

    /// Every radar has a bias of its own.
    #[must_use]
    pub fn with_biases(mut self, sigma: &Bias, seed: u64) -> Self {
        let mut rng = Draws::seed_from_u64(seed);
        for radar in &mut self.radars {
            radar.bias = sigma.map(|sigma| sigma * normal(&mut rng));
        }
        self
    }

    /// The second half of the targets fly in formations of four, 100 to 250 m from one to the next.
    #[must_use]
    pub fn with_formations(mut self, seed: u64) -> Self {
        let mut rng = Draws::seed_from_u64(seed);
        let half = self.targets.len() / 2;
        for formation in self.targets[half..].chunks_mut(MEMBERS) {
            for member in 1..formation.len() {
                let (angle, apart_m) = (rng.random_range(0.0..TAU), rng.random_range(100.0..250.0));
                let offset = apart_m * Vector3::new(angle.sin(), angle.cos(), 0.0);
                formation[member] = formation[member - 1];
                formation[member].position_m += offset;
            }
        }
        (self.noise, self.filter) = (0.01, Filter::Straight { noise: 0.01 });
        self
    }
}
