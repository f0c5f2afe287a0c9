//! The association alone: two filters that have begun on their drones, with and without joint events, on the same plots.

use common::amplitude::FalsePower;
use common::config::TrackerConfig;
use common::random::{Purpose, generator};
use evaluation::following::pair;
use nalgebra::Vector3;
use radar_sim::motion::Segments;
use tracker::association::joint::{Claimant, Sharing};
use tracker::association::one_track::OneTrack;
use tracker::association::scan::Member;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::filter::{Machine, Mixture, TwoPlots, family};
use tracker::plots::measurement::Measurement;
use tracker::plots::radar::Radar;
use tracker::tracks::amplitude::Amplitude;

use super::course::{CONDITIONS, Course, FOLLOWS_M, SCANS, paths, plots};
use super::outcome::Outcome;
use crate::judge::distances_of_sets;
use crate::surround::{Prospect, Surround};
use crate::world::{distance_m, plot, radar};

/// Scans at the end in which tracks in one place count as coalesced.
const LAST: u32 = 5;

/// Two tracks and what they need.
pub(super) struct Filters {
    config: TrackerConfig,
    rules: Rules,
    radar: Radar,
    track: OneTrack,
    sharing: Sharing,
    shares: Vec<f64>,
    plots: Vec<Measurement>,
}

impl Filters {
    pub(super) fn new() -> Self {
        let (config, radar) = (TrackerConfig::default(), radar());
        let (rules, track) = (Rules::new(&config), OneTrack::new(family(&config, &radar, 1.0)));
        Self {
            sharing: Sharing::new(track.filter().layout(), Machine::default(), rules.inflation),
            rules,
            radar,
            track,
            shares: Vec::new(),
            plots: Vec::new(),
            config,
        }
    }

    /// One run: first with independent tracks, then with joint events.
    pub(super) fn fly(&mut self, course: Course, separation: f64, merged: bool, seed: u64, run: u32) -> [Outcome; 2] {
        let drones = paths(course, separation);
        let scans: Vec<Vec<Measurement>> = (0..SCANS)
            .map(|scan| {
                let mut rng = generator(seed, Purpose::Measurement, run, scan);
                // The tracks begin on two plots of their own.
                let begun = scan > 1;
                let seen = plots(&drones, [f64::from(scan); 2], merged && begun, &mut rng);
                let mut seen: Vec<Measurement> = seen.iter().map(|seen| plot(seen.polar, seen.power)).collect();
                seen.retain(|plot| !begun || plot.power > CONDITIONS.detector().threshold);
                seen
            })
            .collect();
        [false, true].map(|joint| self.follow(&drones, &scans, joint, seed, run))
    }

    fn follow(
        &mut self,
        drones: &[Segments; 2],
        scans: &[Vec<Measurement>],
        joint: bool,
        seed: u64,
        run: u32,
    ) -> Outcome {
        let detector = CONDITIONS.detector();
        let mut tracks: [Vec<f64>; 2] = std::array::from_fn(|i| {
            self.track.start(&TwoPlots { previous: &scans[0][i], last: &scans[1][i], step_s: 1.0 });
            self.track.words().to_vec()
        });
        let mut amplitudes = [Amplitude::prior(&self.config, &detector); 2];
        let mut outcome = Outcome::default();
        for (scan, seen) in (0..).zip(scans).skip(2) {
            let predictions = tracks.each_ref().map(|track| {
                self.track.set(track);
                self.track.predict(1.0);
                self.track.words().to_vec()
            });
            let prospects =
                predictions.each_ref().map(|words| Prospect::of(&mut self.track, words, &self.radar, &self.rules));
            for amplitude in &mut amplitudes {
                amplitude.renew_statistics(&self.config, &detector);
            }
            self.plots.clear();
            self.plots.extend(seen);
            let cells: f64 = self.radar.cell.iter().product();
            let clutter = |plot: &Measurement| FalsePlots {
                density: CONDITIONS.pfa / cells / (plot.polar[0] * plot.polar[0] * plot.cos_elevation.max(1e-3)),
                power: FalsePower::default(),
            };
            let around = Surroundings {
                radar: &self.radar,
                detection_probability: 1.0,
                target: Some(amplitudes[0].statistics()),
                shares: &[],
                clutter,
            };
            let mut rng = generator(seed, Purpose::Clutter, run, scan);
            Surround::new(&detector).draw(&prospects, &self.rules, &around, &mut rng, &mut self.plots);
            for own in 0..2 {
                tracks[own] = self.updated(own, joint, &predictions, &amplitudes, clutter);
            }
            let truth = [0, 1].map(|i: usize| drones[i].at(f64::from(scan)));
            let mut distances = Vec::with_capacity(4);
            for (target, truth) in truth.iter().enumerate() {
                for (track, words) in tracks.iter().enumerate() {
                    distances.push((target, track, distance_m(self.position(words), truth)));
                }
            }
            let (ospa, gospa) = distances_of_sets(2, 2, &distances);
            outcome.add(&ospa, &gospa);
            if scan + LAST >= SCANS {
                let places = tracks.each_ref().map(|words| Vector3::from(self.position(words)));
                let together = (places[0] - places[1]).norm() < FOLLOWS_M;
                outcome.coalesced += f64::from(u8::from(together)) / f64::from(LAST);
            }
            if scan + 1 == SCANS {
                let end = pair(2, 2, &distances, FOLLOWS_M, |_, _| false).track_of;
                outcome.changed = end == [Some(1), Some(0)];
                outcome.lost = end.contains(&None);
            }
        }
        outcome
    }

    fn position(&self, words: &[f64]) -> [f64; 3] {
        Mixture::new(self.track.filter().layout(), words).moments().position()
    }

    fn updated<F: Fn(&Measurement) -> FalsePlots + Copy>(
        &mut self,
        own: usize,
        joint: bool,
        predictions: &[Vec<f64>; 2],
        amplitudes: &[Amplitude; 2],
        clutter: F,
    ) -> Vec<f64> {
        let most = self.config.detection_probability;
        let detection_probability = |of: usize| amplitudes[of].statistics().detection_probability.min(most);
        let claimant = |of: usize| Claimant {
            prediction: &predictions[of],
            time_ns: 0,
            existence: 1.0 - 1e-6,
            detection_probability: detection_probability(of),
            target: Some(amplitudes[of].statistics()),
            seen_apart: true,
        };
        self.shares.clear();
        let plots = self.plots.len();
        if joint {
            let rivals = std::iter::once(claimant(1 - own));
            let shared = self.sharing.share(&claimant(own), rivals, &self.plots, clutter, &self.radar);
            self.shares.extend(shared.shares);
            self.shares.extend(shared.common.iter().map(|common| common.share));
            self.plots.extend(shared.common.iter().map(|common| common.measurement));
        }
        let surroundings = Surroundings {
            radar: &self.radar,
            detection_probability: detection_probability(own),
            target: Some(amplitudes[own].statistics()),
            shares: &self.shares,
            clutter,
        };
        self.track.set(&predictions[own]);
        let member = Member { time_ns: 0, plots: &self.plots, surroundings };
        self.track.update(member, &self.radar, &self.rules);
        self.plots.truncate(plots);
        self.track.words().to_vec()
    }
}
