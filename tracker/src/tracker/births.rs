//! Plots that no confirmed track explains: clutter, or with one of the turn before the start of a track.

use std::f64::consts::TAU;
use std::ops::Range;

use common::angle;
use common::config::Association;
use common::tracks::Track;
use common::units::seconds_between;

use super::{EXPLAINED, Tracker};
use crate::environment::Site;
use crate::filter::uav::motion::MODES;
use crate::filter::uav::start::two_plots;
use crate::plots::index::{PlotIndex, Window};
use crate::plots::measurement::Measurement;
use crate::plots::store::{Entry, PlotStore};
use crate::tracks::amplitude::Amplitude;
use crate::tracks::initiation::Reach;
use crate::tracks::life::Life;
use crate::tracks::track::{LastScan, LiveTrack, Passage};

/// Mode probabilities of a new track.
const START_PROBABILITY: [f64; MODES] = [0.33, 0.34, 0.33];
/// Existence below which two plots start no track.
const LEAST_EXISTENCE: f64 = 1e-5;
/// Times between two plots of successive turns, turns.
const SHORTEST_STEP: f64 = 0.25;
const LONGEST_STEP: f64 = 1.5;

impl Tracker {
    /// Settles the plots that no confirmed track can still claim; those not explained feed the clutter map and,
    /// paired with one of the turn before, start tentative tracks.
    pub(super) fn start_tracks(&mut self, covered_rad: f64, site: &mut Site, tracks: &mut Vec<Track>) {
        let Self { agenda, tracks: roster, .. } = self;
        let begins = |track| roster.find(track).map(|place| roster[place].next.begins_rad());
        let claimed_from = agenda.claimed_from(covered_rad, begins);
        let settled = self.plots.settle(claimed_from);
        self.earlier.build(&self.plots, settled.clone(), &self.reach, self.sweep.period_s());
        for index in settled {
            let entry = *self.plots.entry(index);
            let last = self.plots.measurements(index..index + 1)[0];
            let turn = (entry.angle_rad / TAU).max(0.0) as u32;
            let mut claimed = entry.claimed;
            if entry.explained <= EXPLAINED
                && entry.owner.is_none()
                && let Some(track) = self.start(&last, &entry, turn, site)
            {
                claimed = claimed.max(track.life.existence);
                tracks.push(track.message());
                self.confirmed += u32::from(track.life.is_confirmed());
                let next = track.next;
                let handle = self.tracks.add(track);
                self.agenda.note(handle, &next);
                self.plots.entry_mut(index).owner = Some(handle);
            }
            site.clutter.observe(&last, 1.0 - claimed, turn);
        }
    }

    /// A tentative track that ends at the plot `last`, if there is a plot of the turn before to begin it.
    fn start(&mut self, last: &Measurement, entry: &Entry, turn: u32, site: &Site) -> Option<LiveTrack> {
        let (previous, step_s) = self.partner(last, entry.angle_rad)?;
        let existence = site.start_existence(&previous, last, step_s, turn, &self.reach, &self.config);
        if existence < LEAST_EXISTENCE {
            return None;
        }
        let posterior = two_plots(&previous, last, step_s, &site.kinematics.motion, START_PROBABILITY);
        if !posterior.is_sound() {
            return None;
        }
        let mut amplitude = Amplitude::prior(&self.config, &site.detector);
        for plot in [&previous, last].into_iter().filter(|plot| plot.has_power) {
            amplitude.learn(plot.power, 1.0, site.detector.threshold);
        }
        let hypotheses = (self.config.association == Association::Mht)
            .then(|| self.tracks.hypotheses(&posterior, self.config.hypotheses as usize));
        let id = self.next_id;
        self.next_id += 1;
        let (time_ns, angle_rad) = (last.time_ns, entry.angle_rad);
        let meeting = site.kinematics.meeting(&posterior, time_ns, angle_rad, 1.0, &self.sweep);
        Some(LiveTrack {
            id,
            posterior,
            hypotheses,
            time_ns,
            angle_rad,
            searched_to_rad: angle_rad,
            next: site.kinematics.passage(&posterior, &meeting, &self.sweep, &site.radar),
            last: Passage {
                prediction: posterior,
                time_ns,
                angle_rad,
                half_width_rad: 0.0,
                range_m: [last.polar[0]; 2],
            },
            life: Life::start(existence, &self.config),
            amplitude,
            last_scan: LastScan {
                weight_none: 0.0,
                weight_best: 1.0,
                plots_in_gate: 1,
                best_plot: (entry.seq, entry.index),
                ..LastScan::EMPTY
            },
            twin: None,
            scans_apart: 0,
        })
    }

    /// The best plot of the turn before for a start, and the time between the two.
    fn partner(&mut self, last: &Measurement, angle_rad: f64) -> Option<(Measurement, f64)> {
        let period_s = self.sweep.period_s();
        let half_azimuth_rad = self.reach.azimuth_rad(last, LONGEST_STEP * period_s);
        let mut best: Option<(f64, usize, f64)> = None;
        self.earlier.find(last, half_azimuth_rad, &self.reach, period_s);
        for index in self.earlier.found() {
            let (previous, entry) = (&self.plots.measurements(index..index + 1)[0], self.plots.entry(index));
            let step_s = seconds_between(previous.time_ns, last.time_ns);
            if step_s < SHORTEST_STEP * period_s
                || (entry.angle_rad - angle_rad + TAU).abs() > half_azimuth_rad
                || entry.explained > EXPLAINED
            {
                continue;
            }
            if let Some(misfit) = self.reach.misfit(previous, last, step_s)
                && best.is_none_or(|(least, other, _)| (misfit, index) < (least, other))
            {
                best = Some((misfit, index, step_s));
            }
        }
        best.map(|(_, index, step_s)| (self.plots.measurements(index..index + 1)[0], step_s))
    }
}

/// The plots of the turn before with which those that have just been settled may be paired.
#[derive(Debug, Default)]
pub(super) struct Earlier {
    first: usize,
    index: PlotIndex,
    /// Largest variance of range.
    variance: f64,
    /// What was found last, from `first` on.
    found: Vec<u32>,
}

impl Earlier {
    fn build(&mut self, plots: &PlotStore, settled: Range<usize>, reach: &Reach, period_s: f64) {
        let mut angles_rad = [f64::INFINITY, f64::NEG_INFINITY];
        for (index, last) in settled.clone().zip(plots.measurements(settled)) {
            let (angle_rad, reach_rad) =
                (plots.entry(index).angle_rad - TAU, reach.azimuth_rad(last, LONGEST_STEP * period_s));
            angles_rad = [angles_rad[0].min(angle_rad - reach_rad), angles_rad[1].max(angle_rad + reach_rad)];
        }
        let range = plots.between(angles_rad[0], angles_rad[1]);
        self.first = range.start;
        self.variance = 0.0;
        let variance = &mut self.variance;
        self.index.build(plots.measurements(range).iter().inspect(|plot| *variance = variance.max(plot.variance[0])));
    }

    /// Finds the plots in reach of `last`, and some beyond it.
    fn find(&mut self, last: &Measurement, half_azimuth_rad: f64, reach: &Reach, period_s: f64) {
        let range_m = reach.range_m(last, LONGEST_STEP * period_s, self.variance);
        let (azimuth_rad, elevation_rad) = (angle::wrap(last.polar[1]), Window::ANY_ELEVATION);
        self.index.find(&Window { azimuth_rad, half_azimuth_rad, range_m, elevation_rad }, &mut self.found);
    }

    /// The stored plots that were found.
    fn found(&self) -> impl Iterator<Item = usize> {
        self.found.iter().map(|&plot| self.first + plot as usize)
    }
}
