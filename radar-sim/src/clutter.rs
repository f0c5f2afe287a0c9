//! Weibull ground clutter near zero Doppler.

use common::config::{ChainConfig, ClutterConfig};
use common::random::{Purpose, generator};
use common::units::from_db;
use rand::RngExt;
use rand_distr::{Distribution, Weibull};

use crate::echo::Echoes;
use crate::response::Response;

/// Ground clutter: one complex echo per range cell and dwell, new in every scan, with
/// Weibull amplitude, mean power falling with range⁻³, spread over beams and Doppler
/// cells as an echo at elevation 0 and range rate 0 would be.
#[derive(Debug)]
pub struct Clutter {
    amplitude: Weibull<f64>,
    /// Root mean power by range cell, over the root mean noise power.
    by_range: Vec<f64>,
    /// (elevation · dopplers + doppler, amplitude gain) of the cells it spreads to.
    spread: Vec<(usize, f64)>,
    ranges: usize,
}

impl Clutter {
    /// Clutter of `config` in the cells of the radar.
    pub fn new(chain: &ChainConfig) -> Self {
        let (radar, config) = (&chain.radar, &chain.sim.clutter);
        let grid = radar.grid();
        let range_m = |cell: usize| radar.range_first_m + radar.range_step_m * cell as f64;
        let by_range: Vec<f64> = (0..grid.ranges)
            .map(range_m)
            .take_while(|&range| range < config.range_m)
            .map(|range| (from_db(config.cnr_db) * (range_m(0) / range).powi(3)).sqrt())
            .collect();
        let mut spread = Vec::new();
        if !by_range.is_empty() {
            let elevation = Response::new(radar.beamwidth_elevation_deg);
            let doppler = Response::new(radar.doppler_width_mps);
            let (elevation_reach, doppler_reach) = (elevation.reach(config.cnr_db), doppler.reach(config.cnr_db));
            for beam in 0..grid.elevations {
                let above_ground = radar.elevation_first_deg + radar.elevation_step_deg * beam as f64;
                for filter in 0..grid.dopplers {
                    let rate = radar.range_rate_first_mps() + radar.range_rate_step_mps * filter as f64;
                    if above_ground.abs() <= elevation_reach && rate.abs() <= doppler_reach {
                        let gain = elevation.amplitude(above_ground) * doppler.amplitude(rate);
                        spread.push((beam * grid.dopplers + filter, gain));
                    }
                }
            }
        }
        Self { amplitude: unit_power_weibull(config), by_range, spread, ranges: grid.ranges }
    }

    /// Adds the clutter of one dwell.
    pub fn add(&self, seed: u64, scan: u32, dwell: u32, echoes: &mut Echoes) {
        if self.spread.is_empty() {
            return;
        }
        let mut rng = generator(seed, Purpose::Clutter, scan, dwell);
        for (range, root_power) in self.by_range.iter().enumerate() {
            let amplitude = root_power * self.amplitude.sample(&mut rng);
            let (sin, cos) = (rng.random::<f64>() * std::f64::consts::TAU).sin_cos();
            for &(row, gain) in &self.spread {
                echoes.add(row * self.ranges + range, amplitude * gain * cos, amplitude * gain * sin);
            }
        }
    }
}

/// Weibull amplitude with mean square 1: E[a²] = λ² Γ(1 + 2/k).
fn unit_power_weibull(config: &ClutterConfig) -> Weibull<f64> {
    let scale = libm::tgamma(1.0 + 2.0 / config.shape).sqrt().recip();
    Weibull::new(scale, config.shape).expect("the configuration bounds the shape")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_have_unit_mean_power_for_every_shape() {
        for shape in [0.8, 1.7, 2.0, 3.0] {
            let weibull = unit_power_weibull(&ClutterConfig { shape, ..ClutterConfig::default() });
            let mut rng = generator(1, Purpose::Clutter, 0, 0);
            let n = 400_000;
            let power = (0..n).map(|_| weibull.sample(&mut rng).powi(2)).sum::<f64>() / f64::from(n);
            assert!((power - 1.0).abs() < 0.05, "{shape}: {power}");
        }
    }

    #[test]
    fn without_a_range_there_is_none() {
        let mut chain = ChainConfig::default();
        chain.sim.clutter.range_m = 0.0;
        let mut echoes = Echoes::default();
        Clutter::new(&chain).add(1, 0, 0, &mut echoes);
        echoes.apply(&mut [], || unreachable!("no echo, no phase"));
    }
}
