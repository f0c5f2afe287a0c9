//! False plots about one track: drawn only where the track will look for them.
//!
//! ```text
//! number     Poisson, mean U P_N(q > t)           U cells of a box, t the power from which plots are looked at
//! place      uniform over the box
//! power      as noise above t                     (C4)
//! ```
//!
//! A box that is searched later brings only plots that no box before could have held, so that no volume counts twice.

use common::amplitude::{Detector, NoiseEstimate};
use common::angle;
use common::config::GateRule;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, Poisson};
use tracker::association::gate::Gate;
use tracker::association::one_track::OneTrack;
use tracker::association::{Rules, Surroundings};
use tracker::filter::Mixture;
use tracker::plots::measurement::{COORDINATES, Measurement};
use tracker::plots::radar::Radar;

use crate::world::{offset, plot, radar};

/// A box in (r, β, ε, ṙ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Centre; m, rad, rad, m/s.
    pub centre: [f64; COORDINATES],
    /// Half widths in the same units.
    pub half: [f64; COORDINATES],
}

impl From<&Gate> for Region {
    fn from(gate: &Gate) -> Self {
        Self { centre: gate.centre, half: gate.half }
    }
}

impl Region {
    /// The smallest box that holds both.
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        let mut joined = *self;
        for i in 0..COORDINATES {
            let shift = offset(other.centre[i], self.centre[i], i);
            let low = (-self.half[i]).min(shift - other.half[i]);
            let high = self.half[i].max(shift + other.half[i]);
            joined.half[i] = 0.5 * (high - low);
            joined.centre[i] = self.centre[i] + 0.5 * (high + low);
        }
        joined
    }

    /// Whether a place lies inside.
    pub fn holds(&self, polar: &[f64; COORDINATES]) -> bool {
        (0..COORDINATES).all(|i| offset(polar[i], self.centre[i], i).abs() <= self.half[i])
    }

    /// Resolution cells inside.
    pub fn cells(&self, radar: &Radar) -> f64 {
        (0..COORDINATES).map(|i| 2.0 * self.half[i] / radar.cell[i]).product()
    }
}

/// The gates of a predicted track or hypothesis, by component of its filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Prospect {
    /// The gates.
    pub gates: Vec<Gate>,
    /// The most probable component.
    pub first: usize,
    /// The component that is searched if the first gate is empty.
    pub widest: usize,
}

impl Prospect {
    /// Of a predicted state of the filter of `track`.
    pub fn of(track: &mut OneTrack, words: &[f64], radar: &Radar, rules: &Rules) -> Self {
        let layout = *track.filter().layout();
        let (first, widest) = (Mixture::new(&layout, words).most_probable(), layout.widest);
        Self { gates: track.gates(words, radar, rules.alpha), first, widest }
    }
}

/// The boxes of one scan, each with the power from which plots in it count.
#[derive(Debug)]
pub struct Surround<'a> {
    detector: &'a Detector,
    searched: Vec<(Region, f64)>,
}

impl<'a> Surround<'a> {
    /// Nothing searched yet.
    pub fn new(detector: &'a Detector) -> Self {
        Self { detector, searched: Vec::new() }
    }

    /// Appends the false plots among which `rules` will choose for a track with these `prospects`, the most
    /// probable first (one, or those of the hypotheses of a track). `plots` may hold the target's plot: where a rule looks
    /// elsewhere if its gate is empty, that counts.
    pub fn draw<F>(
        &mut self,
        prospects: &[Prospect],
        rules: &Rules,
        surroundings: &Surroundings<'_, F>,
        rng: &mut impl Rng,
        plots: &mut Vec<Measurement>,
    ) {
        let radar = surroundings.radar;
        let Prospect { gates, first, widest } = &prospects[0];
        match rules.gate_rule {
            GateRule::MostProbable => {
                let first = Region::from(&gates[*first]);
                self.search(first, 0.0, rng, plots);
                if !plots.iter().any(|plot| first.holds(&plot.polar)) {
                    self.search(Region::from(&gates[*widest]), 0.0, rng, plots);
                }
            }
            GateRule::Widest => self.search(Region::from(&gates[*widest]), 0.0, rng, plots),
            GateRule::Union => {
                let joined = |prospect: &Prospect| {
                    let cells = prospect.gates.iter().map(|gate| gate.cells(radar)).fold(0.0, f64::max);
                    let regions = prospect.gates.iter().map(Region::from);
                    let threshold = surroundings.scan_threshold(cells, rules.gate_false_plots);
                    let region = regions.reduce(|joined, region| joined.join(&region));
                    (region.unwrap_or(Region { centre: [0.0; COORDINATES], half: [0.0; COORDINATES] }), threshold)
                };
                let mut regions: Vec<(Region, f64)> = prospects.iter().map(joined).collect();
                // A box with a lower threshold has all plots of those after it.
                regions.sort_by(|a, b| a.1.total_cmp(&b.1));
                for (region, threshold) in regions {
                    self.search(region, threshold, rng, plots);
                }
            }
        }
    }

    /// Appends the false plots of a box that lie in none before.
    fn search(&mut self, region: Region, threshold: f64, rng: &mut impl Rng, plots: &mut Vec<Measurement>) {
        let threshold = threshold.max(self.detector.threshold);
        let expected = region.cells(&radar()) * self.detector.noise_survival(threshold);
        if let Ok(number) = Poisson::new(expected) {
            for _ in 0..number.sample(rng) as u64 {
                let mut polar: [f64; COORDINATES] =
                    std::array::from_fn(|i| region.centre[i] + region.half[i] * rng.random_range(-1.0..1.0));
                polar[1] = angle::wrap(polar[1]);
                let power = noise_power_above(self.detector, threshold, rng);
                if polar[0] > 0.0 && !self.searched.iter().any(|(before, _)| before.holds(&polar)) {
                    plots.push(plot(polar, power));
                }
            }
        }
        self.searched.push((region, threshold));
    }
}

/// q/q̄ of a noise cell over `threshold`: 1 + q/N falls as a power, or q exponentially with known noise (C4).
fn noise_power_above(detector: &Detector, threshold: f64, rng: &mut impl Rng) -> f64 {
    let excess: f64 = Exp1.sample(rng);
    match detector.noise {
        NoiseEstimate::Known => threshold + excess,
        NoiseEstimate::Mean(cells) => {
            let n = f64::from(cells);
            n * ((1.0 + threshold / n) * (excess / n).exp() - 1.0)
        }
        _ => detector.power_exceeded_by(detector.noise_survival(threshold) * (-excess).exp()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};

    const REGION: Region = Region { centre: [1000.0, 0.02, 0.1, 0.0], half: [200.0, 0.05, 0.02, 60.0] };

    /// Numbers and powers of false plots are those of F and (C4), with known noise and with reference cells.
    #[test]
    fn false_plots_are_as_many_and_as_strong_as_they_should_be() {
        for reference_cells in [0, 32] {
            let detector = Detector::new(0.01, reference_cells);
            let mut rng = generator(3, Purpose::Test, reference_cells, 0);
            let high = detector.threshold + 2.0;
            let (mut count, mut above) = (0.0, 0.0);
            let scans = 400;
            for _ in 0..scans {
                let mut plots = Vec::new();
                Surround::new(&detector).search(REGION, 0.0, &mut rng, &mut plots);
                assert!(plots.iter().all(|plot| REGION.holds(&plot.polar)));
                count += plots.len() as f64;
                above += plots.iter().filter(|plot| plot.power > high).count() as f64;
            }
            let near =
                |got: f64, expected: f64| assert!((got - expected).abs() < 5.0 * expected.sqrt(), "{got} {expected}");
            let cells = REGION.cells(&radar()) * f64::from(scans);
            near(count, 0.01 * cells);
            near(above, detector.noise_survival(high) * cells);
        }
    }

    #[test]
    fn a_joined_box_holds_both_across_north() {
        let other = Region { centre: [1100.0, 6.2, 0.1, 10.0], half: [50.0, 0.1, 0.01, 20.0] };
        let joined = REGION.join(&other);
        for region in [&REGION, &other] {
            for sign in [-0.999, 0.999] {
                assert!(joined.holds(&std::array::from_fn(|i| region.centre[i] + sign * region.half[i])));
            }
        }
        assert!((joined.half[1] - 0.5 * (0.07 + 0.183_185_3)).abs() < 1e-6, "{joined:?}");
    }
}
