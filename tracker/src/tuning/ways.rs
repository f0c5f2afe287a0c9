//! The plots of each confirmed track, those of none, and how often there was one.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::TAU;

use common::config::{ConfigError, TrackerConfig};
use common::message::END_OF_SCAN;
use common::plots::Plot;
use common::tracks::{TERMINATED, Track};

use super::{ERRORS, Learnt, Messages};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;
use crate::tracker::Tracker;

/// A plot is the track's from this weight on.
const OWN_WEIGHT: f32 = 0.5;
/// Parts of the range and of the azimuth by which false plots are counted.
const PARTS: usize = 8;

/// The plots of one track, by time.
pub(super) type Way = Vec<Measurement>;

/// What the tracker made of recordings.
#[derive(Debug)]
pub(super) struct Ways {
    pub(super) all: Vec<Way>,
    pub(super) counts: Counts,
    pub(super) period_s: f64,
    pub(super) radar: Radar,
}

/// What was counted.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Counts {
    /// Scans of all recordings.
    pub scans: u64,
    /// Detection opportunities of confirmed tracks before their last plot.
    pub opportunities: u64,
    /// Of these, those with a plot.
    pub detections: u64,
    /// Plots of no confirmed track, by part of range and azimuth.
    pub false_plots: Vec<u64>,
    /// Resolution cells in a scan, out to the farthest plot.
    pub cells: f64,
}

impl Counts {
    /// The share of opportunities with a plot, and its binomial error.
    pub(super) fn detection_probability(&self) -> Option<Learnt> {
        let (all, hits) = (self.opportunities as f64, self.detections as f64);
        let value = hits / all;
        (all > 0.0).then(|| Learnt { value, error: (value * (1.0 - value) / all).sqrt().max(1.0 / all) })
    }

    fn total(&self) -> f64 {
        self.false_plots.iter().sum::<u64>() as f64
    }

    /// False plots per cell and scan, and the error of a Poisson count.
    pub(super) fn clutter(&self) -> Option<Learnt> {
        let looks = self.cells * self.scans as f64;
        let uneven = self.clutter_dispersion().unwrap_or(1.0).max(1.0);
        let error = (uneven * self.total().max(1.0)).sqrt() / looks;
        (looks > 0.0).then(|| Learnt { value: self.total() / looks, error })
    }

    /// Variance over mean of the counts by part, all of which have as many cells.
    pub(super) fn clutter_dispersion(&self) -> Option<f64> {
        let parts = self.false_plots.len() as f64;
        let mean = self.total() / parts;
        let squares: f64 = self.false_plots.iter().map(|&count| (count as f64 - mean).powi(2)).sum();
        (mean > 0.0).then(|| squares / (parts - 1.0) / mean)
    }
}

/// The looks at one track.
#[derive(Debug, Default)]
struct Looks {
    way: Way,
    keys: Vec<(u64, u32)>,
    is_confirmed: bool,
    /// After its confirmation: opportunities and detections up to the last detection, and opportunities since.
    counted: [u64; 2],
    since: u64,
}

impl Ways {
    /// Follows recordings; errors of plots are `scales` times those stated.
    pub(super) fn of(
        recordings: &[&Messages],
        config: &TrackerConfig,
        scales: [f64; ERRORS],
    ) -> Result<Self, ConfigError> {
        let mut ways = Self { all: Vec::new(), counts: Counts::default(), period_s: 1.0, radar: Radar::IN_PLANE };
        let plots = || recordings.iter().flat_map(|messages| messages.iter()).flat_map(|(_, plots)| plots);
        let farthest_m = plots().map(|plot| plot.range_m).fold(0.0, f64::max);
        let elevation_rad = plots().map(|plot| plot.elevation_rad).fold(0.0, f64::max);
        ways.counts.false_plots = vec![0; PARTS * PARTS];
        let mut periods_s = Vec::new();
        for messages in recordings {
            ways.follow(messages, config, scales, farthest_m)?;
            periods_s.extend(messages.iter().map(|(header, _)| header.scan_period_s));
        }
        periods_s.sort_by(f64::total_cmp);
        ways.period_s = periods_s.get(periods_s.len() / 2).copied().unwrap_or(1.0);
        if let Some((header, _)) = recordings.iter().flat_map(|messages| messages.iter()).next() {
            let cell = [header.cell_range_m, header.cell_azimuth_rad, header.cell_elevation_rad, 0.0];
            ways.radar = Radar { measured: [true, true, cell[2] > 0.0, false], cell, ..Radar::IN_PLANE };
            let layers = if cell[2] > 0.0 { (elevation_rad / cell[2]).max(1.0) } else { 1.0 };
            ways.counts.cells = farthest_m / cell[0] * TAU / cell[1] * layers;
        }
        Ok(ways)
    }

    fn follow(
        &mut self,
        messages: &Messages,
        config: &TrackerConfig,
        scales: [f64; ERRORS],
        farthest_m: f64,
    ) -> Result<(), ConfigError> {
        let mut tracker = Tracker::new(config, 1)?;
        let mut looks: BTreeMap<u64, Looks> = BTreeMap::new();
        let mut plots: HashMap<(u64, u32), Measurement> = HashMap::new();
        let (mut tracks, mut scaled) = (Vec::new(), Vec::new());
        for (header, stated) in messages {
            scaled.clear();
            scaled.extend(stated.iter().map(|plot| with_errors(plot, scales)));
            let measured = stated.iter().map(Measurement::from_plot);
            plots.extend((0..).zip(measured).filter_map(|(index, plot)| Some(((header.seq, index), plot?))));
            tracker.process_plots(header, &scaled, &mut tracks);
            self.counts.scans += u64::from(header.has(END_OF_SCAN));
            for track in tracks.iter().filter(|track| track.state_code != TERMINATED) {
                looks.entry(track.id).or_default().take(track, &plots);
            }
        }
        let mut own: HashSet<(u64, u32)> = HashSet::new();
        for looks in looks.into_values().filter(|looks| looks.is_confirmed) {
            own.extend(&looks.keys);
            self.counts.opportunities += looks.counted[0];
            self.counts.detections += looks.counted[1];
            self.all.push(looks.way);
        }
        for (key, plot) in &plots {
            if !own.contains(key) {
                // Parts of a disc of equal numbers of cells: cells are as deep everywhere, and as wide in azimuth.
                let part = |share: f64| ((share * PARTS as f64) as usize).min(PARTS - 1);
                let place = part(plot.polar[0] / farthest_m) * PARTS + part(plot.polar[1].rem_euclid(TAU) / TAU);
                self.counts.false_plots[place] += 1;
            }
        }
        Ok(())
    }
}

impl Looks {
    fn take(&mut self, track: &Track, plots: &HashMap<(u64, u32), Measurement>) {
        let key = (track.best_plot_seq, track.best_plot_index);
        let is_new = track.weight_best as f32 >= OWN_WEIGHT && self.keys.last() != Some(&key);
        let plot = plots.get(&key).filter(|_| is_new);
        let plot = plot.filter(|plot| self.way.last().is_none_or(|last| last.time_ns < plot.time_ns));
        if self.is_confirmed {
            self.since += 1;
            if plot.is_some() {
                self.counted[0] += self.since;
                self.counted[1] += 1;
                self.since = 0;
            }
        }
        self.is_confirmed |= track.is_confirmed();
        if let Some(plot) = plot {
            self.way.push(*plot);
            self.keys.push(key);
        }
    }
}

/// A plot with other errors than it states.
fn with_errors(plot: &Plot, scales: [f64; ERRORS]) -> Plot {
    Plot {
        sigma_range_m: plot.sigma_range_m * scales[0] as f32,
        sigma_azimuth_rad: plot.sigma_azimuth_rad * scales[1] as f32,
        sigma_elevation_rad: plot.sigma_elevation_rad * scales[2] as f32,
        ..*plot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_become_shares_and_densities() {
        let counts = Counts { scans: 10, opportunities: 400, detections: 300, false_plots: vec![8, 12], cells: 100.0 };
        let share = counts.detection_probability().expect("counted");
        assert!((share.value - 0.75).abs() < 1e-12 && (share.error - (0.75_f64 * 0.25 / 400.0).sqrt()).abs() < 1e-12);
        let density = counts.clutter().expect("counted");
        assert!((density.value - 0.02).abs() < 1e-12 && (density.error - 20.0_f64.sqrt() / 1000.0).abs() < 1e-12);
        assert!((counts.clutter_dispersion().expect("counted") - 0.8).abs() < 1e-12);
        assert_eq!(Counts::default().detection_probability(), None);
    }
}
