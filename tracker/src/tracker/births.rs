//! Plots left over for track initiation: those that no confirmed track explains are clutter, or with one of the turn before the start of a
//! track.

use std::f64::consts::TAU;
use std::ops::Range;

use common::angle;
use common::tracks::Track;
use common::units::seconds_between;

use super::Tracker;
use crate::association::clutter_map::OwnPlots;
use crate::association::hypotheses::Hypotheses;
use crate::beam::opportunity::{DetectionTime, Opportunity};
use crate::constants::{ACQUISITION_CELLS, EXPLAINED, LEAST_EXISTENCE, STEP_TURNS};
use crate::environment::Environment;
use crate::filter::{Layout, Mixture, TwoPlots};
use crate::operator::Beginning;
use crate::plots::index::{PlotIndex, Window};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;
use crate::plots::store::PlotStore;
use crate::tracks::amplitude::Amplitude;
use crate::tracks::handle::Handle;
use crate::tracks::initiation::PairLimits;
use crate::tracks::life::Life;
use crate::tracks::track::{LastScan, LiveTrack};

impl Tracker {
    /// Settles the plots that no confirmed track can still claim; those not explained feed the clutter map and,
    /// paired with one of the turn before, start tentative tracks.
    pub(super) fn start_tracks(&mut self, covered_rad: f64, environment: &mut Environment, messages: &mut Vec<Track>) {
        let Self { agenda, tracks, .. } = self;
        let begins = |track| tracks.find(track).map(|place| tracks[place].next.begins_rad());
        let claimed_from = agenda.claimed_from(covered_rad, begins);
        let settled = self.plots.settle(claimed_from);
        self.births.index_earlier(&self.plots, settled.clone(), &environment.limits, self.sweep.period_s());
        for (nth, index) in settled.enumerate() {
            let entry = self.plots.entry(index);
            let turn = (entry.angle_rad / TAU).max(0.0) as u32;
            let mut claimed = entry.claimed;
            // A plot whose track has just ended begins none.
            let owner = match entry.owner {
                Some(_) => self.find(entry.owner).map_or(0.0, |place| self.tracks[place].life.existence),
                None => 0.0,
            };
            if entry.explained <= EXPLAINED
                && let Some(handle) = self.start(index, nth, turn, owner, environment)
            {
                let (place, track) = (handle.place as usize, &self.tracks[handle.place as usize]);
                claimed = claimed.max(track.life.existence);
                self.confirmed += u32::from(track.life.is_confirmed());
                self.agenda.add(handle, &track.next);
                self.forecast.tell(environment, &self.tracks, place, messages);
                self.plots.entry_mut(index).owner = Some(handle);
            }
            environment.clutter.observe(self.plots.measurement(index), 1.0 - claimed, turn);
            environment.false_alarms.observe(self.plots.measurement(index), 1.0 - claimed);
        }
    }

    /// A tentative track that ends at the stored plot `index`, the `nth` of those settled, if there is a plot of the turn before to begin it and
    /// it is more likely than the track of existence `owner` that has taken the plot.
    fn start(&mut self, index: usize, nth: usize, turn: u32, owner: f64, environment: &Environment) -> Option<Handle> {
        let beginning = match &self.operator {
            operator if operator.has_places() => {
                operator.beginning_at(self.place_m(index), self.acquisition_reach_m(index, environment))
            }
            _ => Beginning::Usual,
        };
        if beginning == Beginning::Never {
            return None;
        }
        let (previous, step_s) = self.partner(index, nth, &environment.limits, &environment.radar)?;
        let (entry, last) = (*self.plots.entry(index), self.plots.measurement(index));
        let observed = 1.0 - self.plots.entry(previous).claimed;
        let previous = self.plots.measurement(previous);
        let mut own_plots = OwnPlots::default();
        environment.clutter.add_own(&mut own_plots, previous, observed);
        let mut existence = environment.start_existence(previous, last, own_plots, step_s, turn, &self.config);
        if beginning == Beginning::AtOnce {
            existence = existence.max(self.config.confirm_existence);
        }
        if existence < LEAST_EXISTENCE || existence <= owner {
            return None;
        }
        let Self { births: Births { state, .. }, tracks, .. } = self;
        let reach_m = environment.limits.speed_mps * step_s;
        let (from, to) = (previous.with_elevation_of(last, reach_m), last.with_elevation_of(previous, reach_m));
        environment.filter.start(&TwoPlots { previous: &from, last: &to, step_s }, state);
        let mixture = Mixture::new(environment.filter.layout(), state);
        if !mixture.is_sound() {
            return None;
        }
        let mut amplitude = Amplitude::prior(&self.config, &environment.detector);
        for plot in [previous, last].into_iter().filter(|plot| plot.has_power) {
            amplitude.learn(plot.power, 1.0, environment.detector.threshold);
        }
        environment.clutter.fade(&mut own_plots, 1);
        environment.clutter.add_own(&mut own_plots, last, 1.0 - existence.max(entry.claimed));
        let hypotheses = Hypotheses::most(&self.config).map(|most| tracks.hypotheses(state, most));
        let id = self.next_id;
        self.next_id += 1;
        let (time_ns, angle_rad) = (last.time_ns, entry.angle_rad);
        let of = |i: usize| mixture.mean_of(i);
        let time = DetectionTime::predict([of(0), of(1)], [of(3), of(4)], time_ns, angle_rad, &self.sweep);
        let here = Opportunity::at(last.position, last.polar[0], time_ns, angle_rad);
        let track = LiveTrack {
            id,
            hypotheses,
            time_ns,
            angle_rad,
            searched_to_rad: angle_rad,
            next: here,
            last: here,
            life: match beginning {
                Beginning::AtOnce => Life::confirmed(existence),
                _ => Life::start(existence, &self.config),
            },
            amplitude,
            own_plots,
            last_scan: LastScan {
                weight_none: 0.0,
                weight_best: 1.0,
                plots_in_gate: 1,
                best_plot: (entry.seq, entry.index),
                ..LastScan::EMPTY
            },
            duplicate_of: None,
            scans_apart: 0,
        };
        let handle = tracks.add(track, state);
        let place = handle.place as usize;
        self.forecast.predict_one(environment, self.rules.alpha, tracks, place, time, &self.sweep);
        if beginning == Beginning::AtOnce {
            let reach_m = self.acquisition_reach_m(index, environment);
            self.operator.begun(self.place_m(index), reach_m, id);
        }
        Some(handle)
    }

    /// Where a stored plot is: east and north of the antenna, m.
    fn place_m(&self, index: usize) -> [f64; 2] {
        let [x, y, _] = self.plots.measurement(index).position;
        [x, y]
    }

    /// How far from the place that an operator has named a plot of the target may lie: what it moves in a turn, and some cells.
    fn acquisition_reach_m(&self, index: usize, environment: &Environment) -> f64 {
        let [range_m, cells] = [self.plots.measurement(index).polar[0], ACQUISITION_CELLS];
        let cell_m = environment.radar.cell[0].max(environment.radar.cell[1] * range_m);
        environment.limits.speed_mps * self.sweep.period_s() + cells * cell_m
    }

    /// The best plot of the turn before for a start, and the time between the two.
    fn partner(&mut self, index: usize, nth: usize, limits: &PairLimits, radar: &Radar) -> Option<(usize, f64)> {
        let Self { births, plots, sweep, .. } = self;
        let (last, angle_rad) = (plots.measurement(index), plots.entry(index).angle_rad);
        let period_s = sweep.period_s();
        let half_azimuth_rad = births.half_azimuths_rad[nth];
        let mut best: Option<(f64, usize, f64)> = None;
        births.find_earlier(last, half_azimuth_rad, limits, period_s);
        for index in births.found() {
            let (previous, entry) = (plots.measurement(index), plots.entry(index));
            let step_s = seconds_between(previous.time_ns, last.time_ns);
            if step_s < STEP_TURNS[0] * period_s || (entry.angle_rad - angle_rad + TAU).abs() > half_azimuth_rad {
                continue;
            }
            if let Some(misfit) = limits.misfit(previous, last, step_s, radar)
                && best.is_none_or(|(least, other, _)| (misfit, index) < (least, other))
            {
                best = Some((misfit, index, step_s));
            }
        }
        best.map(|(_, index, step_s)| (index, step_s))
    }
}

/// Room for the starts of a message: the plots of the turn before with which those that have just been settled may be paired.
#[derive(Debug)]
pub(super) struct Births {
    index: PlotIndex,
    /// Half widths in azimuth of where the partner of each settled plot may lie.
    half_azimuths_rad: Vec<f64>,
    /// Stored plots of the index: those that no confirmed track explains.
    open: Vec<u32>,
    /// Largest variances of range, and of position across the line of sight.
    variance: [f64; 2],
    /// What was found last, of the index.
    found: Vec<u32>,
    /// The state of a track that starts.
    pub(super) state: Vec<f64>,
}

impl Births {
    pub(super) fn new(layout: &Layout) -> Self {
        Self {
            index: PlotIndex::default(),
            half_azimuths_rad: Vec::new(),
            open: Vec::new(),
            variance: [0.0; 2],
            found: Vec::new(),
            state: vec![0.0; layout.words()],
        }
    }

    fn index_earlier(&mut self, plots: &PlotStore, settled: Range<usize>, limits: &PairLimits, period_s: f64) {
        let mut angles_rad = [f64::INFINITY, f64::NEG_INFINITY];
        self.half_azimuths_rad.clear();
        for (index, last) in settled.clone().zip(plots.measurements(settled)) {
            let (angle_rad, reach_rad) =
                (plots.entry(index).angle_rad - TAU, limits.azimuth_rad(last, STEP_TURNS[1] * period_s));
            self.half_azimuths_rad.push(reach_rad);
            angles_rad = [angles_rad[0].min(angle_rad - reach_rad), angles_rad[1].max(angle_rad + reach_rad)];
        }
        let range = plots.between(angles_rad[0], angles_rad[1]);
        // As if all were open: how many are varies by chance, and should not allocate for ever.
        self.open.clear();
        self.open.reserve(range.len());
        self.index.reserve(range.len(), &mut self.found);
        self.open.extend(range.filter(|&plot| plots.entry(plot).explained <= EXPLAINED).map(|plot| plot as u32));
        self.variance = [0.0; 2];
        let [along, across] = &mut self.variance;
        let open = self.open.iter().map(|&plot| plots.measurement(plot as usize));
        self.index.build(open.inspect(|plot| {
            *along = along.max(plot.variance[0]);
            *across = across.max(PairLimits::variance_across(plot));
        }));
    }

    /// Finds the plots in reach of `last`, and some beyond it.
    fn find_earlier(&mut self, last: &Measurement, half_azimuth_rad: f64, limits: &PairLimits, period_s: f64) {
        let range_m = limits.range_m(last, STEP_TURNS[1] * period_s, self.variance[0]);
        let azimuth_rad = angle::wrap(last.polar[1]);
        let elevation_rad = limits.elevation_rad(last, STEP_TURNS[1] * period_s, self.variance);
        self.index.find(&Window { azimuth_rad, half_azimuth_rad, range_m, elevation_rad }, &mut self.found);
    }

    /// The stored plots that were found.
    fn found(&self) -> impl Iterator<Item = usize> {
        self.found.iter().map(|&plot| self.open[plot as usize] as usize)
    }
}
