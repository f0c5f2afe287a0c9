//! The two published examples: ships that sail straight and turn, and what a radar measures of them.

use common::random::{Purpose, generator};
use rand_distr::{Distribution, StandardNormal};
use tracker::plots::measurement::Measurement;

/// T, s.
pub(crate) const STEP_S: f64 = 3.0;
/// σ of range, m, and of azimuth, rad.
const SIGMA: [f64; 2] = [60.0, 0.5 * std::f64::consts::PI / 180.0];
/// Errors count from here on, s.
const FIRST_S: f64 = 30.0;
/// One knot, m/s.
const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// One example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Example {
    /// As published, from 1.
    pub(crate) number: u32,
    start_m: [f64; 2],
    velocity_kn: [f64; 2],
    /// Until when (s) the ship turns at which rate (°/s, positive from x towards y).
    legs: &'static [(f64, f64)],
    /// Rates of IMM5 and of the switching grid, °/s.
    pub(super) rates: [f64; 5],
    /// t₁, t₂, t₃ and ω_max (°/s), r (°/s) of the adaptive grid.
    pub(super) adaptive: [f64; 5],
}

/// Both.
pub(crate) const EXAMPLES: [Example; 2] = [
    Example {
        number: 1,
        start_m: [1000.0, 1000.0],
        velocity_kn: [15.0, 10.0],
        legs: &[
            (90.0, 0.0),
            (180.0, -2.0),
            (240.0, 0.0),
            (330.0, 2.0),
            (360.0, 0.0),
            (540.0, -1.0),
            (600.0, 0.0),
            (750.0, 1.0),
        ],
        rates: [-2.0, -1.0, 0.0, 1.0, 2.0],
        adaptive: [0.3, 0.25, 0.75, 3.0, 2.0],
    },
    Example {
        number: 2,
        start_m: [0.0, 0.0],
        velocity_kn: [20.0, 12.0],
        legs: &[
            (45.0, 0.0),
            (120.0, 2.0),
            (135.0, 0.0),
            (180.0, -4.0),
            (210.0, 0.0),
            (255.0, 4.0),
            (360.0, -2.0),
            (390.0, 0.0),
        ],
        rates: [-4.0, -2.0, 0.0, 2.0, 4.0],
        adaptive: [0.3, 0.2, 0.8, 5.0, 4.0],
    },
];

/// The ship at one scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Truth {
    pub(crate) position_m: [f64; 2],
    pub(crate) velocity_mps: [f64; 2],
    /// At which it came here from the scan before, rad/s.
    pub(super) rate_rad_per_s: f64,
}

impl Truth {
    /// Range, m, and azimuth, rad; a millimetre away at the antenna itself, where the azimuth still matters.
    pub(super) fn polar(&self) -> [f64; 2] {
        let [x, y] = self.position_m;
        [x.hypot(y).max(1e-3), std::f64::consts::FRAC_PI_2 - y.atan2(x)]
    }
}

impl Example {
    /// The ship at every scan.
    pub(crate) fn truth(&self) -> Vec<Truth> {
        let end_s = self.legs.last().map_or(0.0, |(until_s, _)| *until_s);
        let mut ship = Truth {
            position_m: self.start_m,
            velocity_mps: self.velocity_kn.map(|knots| knots * KNOT_MPS),
            rate_rad_per_s: 0.0,
        };
        let mut all = vec![ship];
        while all.len() as f64 * STEP_S <= end_s {
            let from_s = (all.len() - 1) as f64 * STEP_S;
            let rate = self.legs.iter().find(|(until_s, _)| from_s < *until_s).map_or(0.0, |(_, rate)| *rate);
            ship = turned(&ship, rate.to_radians());
            all.push(ship);
        }
        all
    }

    /// First scan whose errors count.
    pub(super) fn first_scan() -> usize {
        (FIRST_S / STEP_S) as usize
    }

    /// What the radar measures of a ship in one run, scan by scan. Range and azimuth have errors; a range below zero is kept, on the
    /// other side of the antenna.
    pub(crate) fn plots(&self, truth: &[Truth], seed: u64, run: u32) -> Vec<Measurement> {
        let mut rng = generator(seed, Purpose::Measurement, run, self.number);
        let mut normal = |sigma: f64| sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
        let measure = |ship: &Truth| {
            let [x, y] = ship.position_m;
            let (range_m, angle) = (x.hypot(y) + normal(SIGMA[0]), y.atan2(x) + normal(SIGMA[1]));
            Measurement::in_plane([range_m * angle.cos(), range_m * angle.sin()], SIGMA)
        };
        truth.iter().map(measure).collect()
    }
}

fn turned(ship: &Truth, rate: f64) -> Truth {
    let ([x, y], [v_x, v_y]) = (ship.position_m, ship.velocity_mps);
    let (sine, cosine) = (rate * STEP_S).sin_cos();
    let (along, across) = if rate == 0.0 { (STEP_S, 0.0) } else { (sine / rate, (1.0 - cosine) / rate) };
    Truth {
        position_m: [x + along * v_x - across * v_y, y + across * v_x + along * v_y],
        velocity_mps: [cosine * v_x - sine * v_y, sine * v_x + cosine * v_y],
        rate_rad_per_s: rate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ships_keep_their_speed_and_end_on_their_courses() {
        for (example, scans, degrees) in [(EXAMPLES[0], 251, -30.0), (EXAMPLES[1], 131, -60.0)] {
            let truth = example.truth();
            assert_eq!(truth.len(), scans);
            let [first, last] = [truth[0], truth[scans - 1]].map(|ship| ship.velocity_mps);
            let speed = |v: [f64; 2]| v[0].hypot(v[1]);
            assert!((speed(last) - speed(first)).abs() < 1e-9);
            let turned = (last[1].atan2(last[0]) - first[1].atan2(first[0])).to_degrees();
            assert!(((turned - degrees + 180.0).rem_euclid(360.0) - 180.0).abs() < 1e-6, "{turned}");
        }
    }
}
