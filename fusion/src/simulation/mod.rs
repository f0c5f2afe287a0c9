//! Simulated radars with biases, and the local tracks that they make of targets: what tests, benchmarks and experiments run
//! the fusion on.

mod local;
mod radar;
pub mod scenarios;
mod score;
mod target;

pub use local::{Filter, Tracking};
pub use radar::Radar;
pub use score::{Errors, Outcome, Score};
pub use target::{Target, Turn};

use chacha20::ChaCha8Rng;
use common::geodesy::Position;
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

use crate::local::Report;
use crate::registration::Bias;
use crate::{Fusion, Settings, Site};

/// Begin of a run, ns UTC.
const START_NS: u64 = 1_700_000_000_000_000_000;

/// A world of targets and radars.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// Origin of the axes in which targets move and fusion works.
    pub centre: Position,
    /// The radars.
    pub radars: Vec<Radar>,
    /// The targets at the beginning.
    pub targets: Vec<Target>,
    /// Power density of the targets' random acceleration, m²/s³.
    pub noise: f64,
    /// How radars track.
    pub filter: Filter,
    /// Time of a cycle of fusion, s.
    pub cycle_s: f64,
}

/// A scenario in progress: reports cycle by cycle, and the truth.
#[derive(Debug)]
pub struct World {
    scenario: Scenario,
    rng: ChaCha8Rng,
    cycle: u32,
    /// By radar and target: time of the first look, s.
    first_look_s: Vec<Vec<f64>>,
    /// By radar and target.
    tracks: Vec<Vec<Tracking>>,
    /// What one filter makes of the measurements of all radars, by target.
    central: Vec<Tracking>,
}

impl World {
    /// Before the first cycle.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (radars, targets) = (&scenario.radars, &scenario.targets);
        let first_look_s =
            radars.iter().map(|radar| targets.iter().map(|_| radar.period_s * rng.random::<f64>()).collect()).collect();
        let of_targets = |filter: Filter| vec![Tracking::new(filter); targets.len()];
        Self {
            first_look_s,
            tracks: radars.iter().map(|_| of_targets(scenario.filter)).collect(),
            central: of_targets(Filter::Straight { noise: scenario.noise }),
            scenario,
            rng,
            cycle: 0,
        }
    }

    /// A fusion for these radars, of whose biases only the standard deviations are known.
    pub fn fusion(&self, bias: Bias, settings: Settings) -> Fusion {
        let site = |radar: &Radar| Site {
            position: radar.position,
            range_m: [0.0, radar.range_m],
            elevation_rad: Site::ALL_ELEVATIONS_RAD,
            period_s: radar.period_s,
            bias,
        };
        let sites: Vec<Site> = self.scenario.radars.iter().map(site).collect();
        Fusion::new(&self.scenario.centre, &sites, settings)
    }

    /// What radars and targets there are, targets as they are now.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// From now on a radar has other errors: what it measures too much, and what its clock is ahead, s.
    pub fn spoil(&mut self, radar: usize, bias: Bias, clock_s: f64) {
        let radar = &mut self.scenario.radars[radar];
        (radar.bias, radar.clock_s) = (bias, clock_s);
    }

    /// The tracker of a radar begins anew: it knows no track.
    pub fn begin_anew(&mut self, radar: usize) {
        let filter = self.scenario.filter;
        self.tracks[radar].fill(Tracking::new(filter));
    }

    /// Time since the beginning, s.
    pub fn time_s(&self) -> f64 {
        f64::from(self.cycle) * self.scenario.cycle_s
    }

    /// The same as time of day, ns UTC.
    pub fn time_ns(&self) -> u64 {
        nanoseconds(self.time_s())
    }

    /// Goes on for one cycle; gives `take` the radar's number and its report of every look. Targets keep their numbers as those of
    /// local tracks.
    pub fn advance(&mut self, mut take: impl FnMut(usize, Report)) {
        let (from_s, to_s) = (self.time_s(), self.time_s() + self.scenario.cycle_s);
        let Scenario { radars, targets, noise, centre, .. } = &mut self.scenario;
        let mut looks: Vec<(f64, usize)> = Vec::new();
        for (index, target) in targets.iter_mut().enumerate() {
            looks.clear();
            for (number, radar) in radars.iter().enumerate() {
                let first_s = self.first_look_s[number][index];
                let before = ((from_s - first_s) / radar.period_s).ceil().max(0.0) as u32;
                let times = (before..).map(|look| first_s + f64::from(look) * radar.period_s);
                looks.extend(times.take_while(|&time_s| time_s < to_s).map(|time_s| (time_s, number)));
            }
            looks.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut now_s = from_s;
            for &(time_s, number) in &looks {
                target.advance(now_s, time_s - now_s, *noise, &mut self.rng);
                now_s = time_s;
                let measured = radars[number].measure(target, centre, &mut self.rng);
                let track = &mut self.tracks[number][index];
                track.update(time_s, &measured);
                if let Some(report) = track.report(index as u64, nanoseconds(time_s + radars[number].clock_s)) {
                    take(number, report);
                }
                self.central[index].update(time_s, &radars[number].in_centre(&measured, centre));
            }
            target.advance(now_s, to_s - now_s, *noise, &mut self.rng);
        }
        self.cycle += 1;
    }

    /// The track that a radar has of a target.
    pub fn track(&self, radar: usize, target: usize) -> &Tracking {
        &self.tracks[radar][target]
    }

    /// The track of a target that all measurements together give.
    pub fn central(&self, target: usize) -> &Tracking {
        &self.central[target]
    }
}

fn nanoseconds(time_s: f64) -> u64 {
    START_NS + (time_s * 1e9) as u64
}

/// A number from the standard normal distribution.
pub fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}
