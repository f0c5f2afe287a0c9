//! One track on one target for one run: the tracker's own filter, scan by scan.
//!
//! ```text
//! the target's plots (world) ─┐
//! predict ─▶ gates ─▶ false plots in them (surround) ─▶ update ─▶ what came of it: errors, gate, loss
//! ```
//!
//! Neither the beam nor other tracks come in: the target is seen when its sights say, and the track begins with two plots of it.

mod record;

use std::time::Instant;

use common::amplitude::{Detector, FalsePower};
use common::config::{GateRule, TrackerConfig};
use common::random::{Purpose, generator};
use evaluation::track_loss::Watch;
use tracker::association::gate::Gate;
use tracker::association::hypotheses::{Hypotheses, Means, Room};
use tracker::association::one_track::OneTrack;
use tracker::association::scan::{Member, Outcome};
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::gaussian::Gaussian;
use tracker::filter::{Machine, Mixture, TwoPlots, family};
use tracker::plots::measurement::Measurement;
use tracker::plots::radar::Radar;
use tracker::tracks::amplitude::Amplitude;

use crate::surround::{Prospect, Surround};
use crate::trajectory::SCANS;
use crate::world::{Conditions, Sight, distance_m, radar};

pub use record::ScanRecord;
pub(crate) use record::errors_of;

/// Scans running outside the gate, or beyond the distance, that lose a track.
pub const LOST_SCANS: usize = 3;
/// Position error that counts as lost where it lasts, m.
pub const LOST_DISTANCE_M: f64 = 150.0;
/// False plots expected in the gate above which the source gives a track up.
pub const MOST_FALSE_PLOTS: f64 = 2000.0;
/// α of a gate that holds everything.
const WITHOUT_GATE: f64 = 100.0;
/// Probability of detection of what is always detected: "none" keeps a trace of weight.
const CERTAIN: f64 = 1.0 - 1e-12;
/// False plots per cell where there are none.
const LEAST_PFA: f64 = 1e-12;

/// Whether and how a track loses its target.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Fate {
    /// Scan k at which the target's measured place, detected or not, had been outside the gate in use for three scans, or the track was
    /// given up.
    pub lost_at: Option<u32>,
    /// Whether the estimated position was wrong by more than 150 m in three scans running.
    pub strayed: bool,
}

impl Fate {
    /// Scans for which the target was tracked.
    pub fn scans(&self) -> u32 {
        self.lost_at.unwrap_or(SCANS)
    }
}

/// Follows targets under the same conditions, one after the other.
pub struct Follower {
    config: TrackerConfig,
    conditions: Conditions,
    rules: Rules,
    radar: Radar,
    detector: Detector,
    track: OneTrack,
    room: Room,
    plots: Vec<Measurement>,
    /// Of the track, or of its hypotheses, the most probable first.
    prospects: Vec<Prospect>,
    timed_us: Option<Vec<f64>>,
    goes_on: bool,
}

/// A track in the making.
struct Pursuit {
    /// Of the last scan, s.
    time_s: f64,
    /// With (T21); else the posterior is all there is.
    hypotheses: Option<Hypotheses>,
    posterior: Vec<f64>,
    amplitude: Amplitude,
    given_up: bool,
    outside: Watch,
    beyond: Watch,
    fate: Fate,
}

impl Follower {
    /// With the settings of the tracker.
    pub fn new(config: &TrackerConfig, conditions: &Conditions) -> Self {
        let radar = radar();
        let mut rules = Rules::new(config);
        if conditions.pfa <= 0.0 {
            // The one plot is the target's: no gate, nothing else that it could be.
            rules.alpha = WITHOUT_GATE;
            rules.gate_probability = Some(1.0);
            rules.gate_probability_by_mode = false;
            rules.gate_false_plots = 0.0;
        }
        let track = OneTrack::new(family(config, &radar, 1.0));
        Self {
            rules,
            radar,
            detector: conditions.detector(),
            conditions: *conditions,
            room: Room::new(track.filter().layout()),
            track,
            plots: Vec::new(),
            prospects: Vec::new(),
            timed_us: None,
            goes_on: false,
            config: config.clone(),
        }
    }

    /// The same, but a track whose target has left the gate for three scans goes on with whatever plots it meets.
    #[must_use]
    pub fn going_on(self, goes_on: bool) -> Self {
        Self { goes_on, ..self }
    }

    /// Follows a target until it is known whether the track is lost by both criteria. `seed` and `run` choose the false plots.
    pub fn fate(&mut self, sights: &[Sight], seed: u64, run: u32) -> Fate {
        let mut pursuit = self.start(sights);
        for (k, sight) in scans(sights) {
            self.step(&mut pursuit, k, sight, seed, run);
            if pursuit.fate.strayed && pursuit.fate.lost_at.is_some() {
                break;
            }
        }
        pursuit.fate
    }

    /// Follows a target to the end; `see` gets each scan and the plots that were offered to the track.
    pub fn watch(
        &mut self,
        sights: &[Sight],
        seed: u64,
        run: u32,
        mut see: impl FnMut(ScanRecord, &[Measurement]),
    ) -> Fate {
        let mut pursuit = self.start(sights);
        for (k, sight) in scans(sights) {
            let (predicted, outcome) = self.step(&mut pursuit, k, sight, seed, run);
            let state = Mixture::new(self.track.filter().layout(), &pursuit.posterior);
            let models = self.track.filter().models(state);
            see(ScanRecord::new(k, &predicted, &state.moments(), models, &outcome, sight), &self.plots);
        }
        pursuit.fate
    }

    /// Time of prediction and update alone in each scan of one run, µs of the clock.
    pub fn time_us(&mut self, sights: &[Sight], seed: u64, run: u32) -> Vec<f64> {
        self.timed_us = Some(Vec::new());
        self.fate(sights, seed, run);
        self.timed_us.take().unwrap_or_default()
    }

    fn start(&mut self, sights: &[Sight]) -> Pursuit {
        let [first, second] = [0, 1].map(|k: usize| &sights[k].plot);
        let time_s = sights[1].time_s;
        self.track.start(&TwoPlots { previous: first, last: second, step_s: time_s - sights[0].time_s });
        let posterior = self.track.words().to_vec();
        let mut amplitude = Amplitude::prior(&self.config, &self.detector);
        for plot in [first, second] {
            amplitude.learn(plot.power, 1.0, self.detector.threshold);
        }
        let layout = self.track.filter().layout();
        let hypotheses = Hypotheses::most(&self.config).map(|most| Hypotheses::new(layout, &posterior, most));
        Pursuit {
            time_s,
            hypotheses,
            posterior,
            amplitude,
            given_up: false,
            outside: lost(),
            beyond: lost(),
            fate: Fate::default(),
        }
    }

    /// One scan: what the track expected and what became of it.
    fn step(&mut self, pursuit: &mut Pursuit, k: u32, sight: &Sight, seed: u64, run: u32) -> (Gaussian, Outcome) {
        let step_s = sight.time_s - pursuit.time_s;
        pursuit.time_s = sight.time_s;
        let layout = *self.track.filter().layout();
        let started = Instant::now();
        self.track.set(&pursuit.posterior);
        self.track.predict(step_s);
        let prediction = self.track.words().to_vec();
        if let Some(hypotheses) = &mut pursuit.hypotheses {
            let means = Means { filter: self.track.filter(), machine: Machine::default(), rules: &self.rules };
            hypotheses.predict(means, step_s, &mut self.room);
        }
        pursuit.amplitude.renew_statistics(&self.config, &self.detector);
        let predicted = started.elapsed();
        let clutter = self.conditions.pfa > 0.0;
        let statistics = *pursuit.amplitude.statistics();
        let cell: f64 = self.radar.cell.iter().product();
        let density = self.conditions.pfa.max(LEAST_PFA) / cell;
        let surroundings = Surroundings {
            radar: &self.radar,
            detection_probability: if clutter {
                statistics.detection_probability.min(self.config.detection_probability)
            } else {
                CERTAIN
            },
            target: Some(&statistics),
            shares: &[],
            clutter: |plot: &Measurement| FalsePlots {
                density: density / (plot.polar[0] * plot.polar[0] * plot.cos_elevation.max(1e-3)),
                power: FalsePower::default(),
            },
        };
        self.prospects.clear();
        match &pursuit.hypotheses {
            None => self.prospects.push(Prospect::of(&mut self.track, &prediction, &self.radar, &self.rules)),
            Some(hypotheses) => {
                let states = hypotheses.states(&layout);
                let prospect =
                    |state: Mixture<'_>| Prospect::of(&mut self.track, state.words(), &self.radar, &self.rules);
                self.prospects.extend(states.map(prospect));
            }
        }
        let own = Prospect::of(&mut self.track, &prediction, &self.radar, &self.rules);
        pursuit.given_up |= clutter && self.gives_up(&own);
        self.plots.clear();
        if !pursuit.given_up {
            self.plots.extend(sight.detected.then_some(sight.plot));
            if clutter {
                let mut rng = generator(seed, Purpose::Clutter, run, k + 1);
                let mut surround = Surround::new(&self.detector);
                surround.draw(&self.prospects, &self.rules, &surroundings, &mut rng, &mut self.plots);
            }
        }
        let started = Instant::now();
        let outcome = match &mut pursuit.hypotheses {
            None => {
                let member = Member { time_ns: 0, plots: &self.plots, surroundings };
                let outcome = self.track.update(member, &self.radar, &self.rules);
                pursuit.posterior.copy_from_slice(self.track.words());
                outcome
            }
            Some(hypotheses) => {
                let filter = family(&self.config, &self.radar, 1.0);
                let means = Means { filter: filter.as_ref(), machine: Machine::default(), rules: &self.rules };
                let choice = &mut self.track.scan.choices[0];
                let outcome = hypotheses.update(means, 0, &self.plots, &surroundings, &mut self.room, choice);
                pursuit.posterior.copy_from_slice(self.room.posterior());
                outcome
            }
        };
        if let Some(timed_us) = self.timed_us.as_mut().filter(|_| !pursuit.given_up) {
            timed_us.push((predicted + started.elapsed()).as_secs_f64() * 1e6);
        }
        let choice = &self.track.scan.choices[0];
        for (candidate, &weight) in choice.candidates.iter().zip(&choice.weights) {
            let threshold = outcome.selection.threshold.max(self.detector.threshold);
            let power = self.plots[candidate.plot].power;
            // Of several hypotheses each has its own threshold; that of the best one is taken.
            if power >= threshold {
                pursuit.amplitude.learn(power, weight, threshold);
            }
        }
        self.judge(pursuit, k, sight, &own, &outcome);
        (Mixture::new(&layout, &prediction).moments(), outcome)
    }

    /// Whether the source would give the track up: from then on it only predicts.
    fn gives_up(&self, prospect: &Prospect) -> bool {
        let component = match self.rules.gate_rule {
            GateRule::MostProbable => prospect.first,
            GateRule::Widest => prospect.widest,
            GateRule::Union => return false,
        };
        prospect.gates[component].cells(&self.radar) * self.conditions.pfa > MOST_FALSE_PLOTS
    }

    fn judge(&self, pursuit: &mut Pursuit, k: u32, sight: &Sight, prospect: &Prospect, outcome: &Outcome) {
        let holds = |gate: &Gate| gate.holds(&gate.offset(&sight.plot, 0.0), &sight.plot);
        let in_gate = match self.rules.gate_rule {
            GateRule::Union => prospect.gates.iter().any(holds),
            GateRule::MostProbable | GateRule::Widest => holds(&outcome.selection.gate),
        };
        let leaves_gate = pursuit.outside.see(in_gate).is_some();
        if pursuit.given_up || leaves_gate {
            pursuit.fate.lost_at.get_or_insert(k);
            // The source ends here; what goes on is what it would have predicted. Gates of all modes go on looking.
            pursuit.given_up |= self.rules.gate_rule != GateRule::Union && !self.goes_on;
        }
        let error_m = distance_m(
            Mixture::new(self.track.filter().layout(), &pursuit.posterior).moments().position(),
            &sight.truth,
        );
        pursuit.fate.strayed |= pursuit.beyond.see(error_m <= LOST_DISTANCE_M).is_some();
    }
}

/// Not lost yet.
fn lost() -> Watch {
    Watch::new(LOST_SCANS)
}

/// The scans after the two of the start, k = 1, 2, …
fn scans(sights: &[Sight]) -> impl Iterator<Item = (u32, &Sight)> {
    (1..).zip(sights.iter().skip(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::trajectory::Trajectory;
    use crate::world::sights;
    use common::config::Swerling;

    /// The source's filter on B without clutter errs as published (10.99 m, 15.64 m, NEES 2.80), within five standard errors of
    /// so few runs.
    #[test]
    fn the_source_is_reproduced() {
        let conditions = Conditions::WITHOUT_CLUTTER;
        let mut follower = Follower::new(&Settings::Source.config(&conditions), &conditions);
        let (mut estimated, mut predicted, mut nees, mut scans) = (0.0, 0.0, 0.0, 0.0);
        for run in 0..60 {
            let fate = follower.watch(&sights(Trajectory::B, &conditions, 2, run), 2, run, |record, plots| {
                assert_eq!(plots.len(), 1);
                estimated += record.position_error_m.norm_squared();
                predicted += record.predicted_error_m.norm_squared();
                nees += record.nees_position;
                scans += 1.0;
            });
            assert_eq!(fate, Fate::default());
        }
        let rms = |sum: f64| (sum / scans).sqrt();
        assert!((rms(estimated) - 10.99).abs() < 1.2, "{}", rms(estimated));
        assert!((rms(predicted) - 15.64).abs() < 1.5, "{}", rms(predicted));
        assert!((nees / scans - 2.80).abs() < 0.3, "{}", nees / scans);
    }

    /// The source's gate never becomes empty at F = 0.1: every track is lost at a manoeuvre, and gets no plots once it is given up.
    #[test]
    fn a_track_that_is_given_up_only_predicts() {
        let conditions = Conditions { pfa: 0.1, reference_cells: 0, snr_db: 16.0, swerling: Swerling::One };
        let mut follower = Follower::new(&Settings::Source.config(&conditions), &conditions);
        for run in 0..10 {
            let sights = sights(Trajectory::B, &conditions, 2, run);
            let mut offered = Vec::new();
            let fate = follower.watch(&sights, 2, run, |_, plots| offered.push(plots.len()));
            assert!(fate.lost_at.is_some() && fate.strayed && fate.scans() < SCANS, "{fate:?}");
            assert_eq!(fate, follower.fate(&sights, 2, run));
            let lost_at = fate.scans() as usize;
            assert!(offered[..lost_at - 3].iter().any(|&plots| plots > 0), "{offered:?}");
            assert!(offered[lost_at..].iter().all(|&plots| plots == 0), "{offered:?}");
        }
    }
}
