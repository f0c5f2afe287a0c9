//! What is known of the radar and its surroundings, from the headers of its plots.

use std::f64::consts::TAU;

use common::amplitude::{Detector, FalsePower, NoiseEstimate, TargetStatistics};
use common::config::TrackerConfig;
use common::plots::PlotsHeader;

use crate::association::clutter_map::{ClutterMap, OwnPlots};
use crate::association::joint::Claimant;
use crate::association::{FalsePlots, Surroundings};
use crate::constants::LEAST_EXISTENCE;
use crate::filter::{Filter, Machine, family};
use crate::plots::false_alarms::FalseAlarmCount;
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;
use crate::tracks::amplitude::Amplitude;
use crate::tracks::initiation::PairLimits;
use crate::tracks::track::LiveTrack;

/// Cells tested per false plot where the radar does not say: its plots are not the result of a known threshold.
const UNKNOWN_PFA: f64 = 1e-6;

/// Relative change of the turn time that changes nothing else.
const SAME_TURN: f64 = 0.1;

/// The radar as its headers describe it.
#[derive(Debug)]
pub(crate) struct Environment {
    pub(crate) radar: Radar,
    pub(crate) detector: Detector,
    /// Whether the header says how plots were detected; else decision statistics have no scale.
    pub(crate) threshold_is_known: bool,
    /// Statistics of the power of a target of which nothing is known yet.
    start_target: TargetStatistics,
    pub(crate) filter: Box<dyn Filter>,
    /// Turn time that the filter is for, s.
    period_s: f64,
    /// Of the pairs of plots that may start a track.
    pub(crate) limits: PairLimits,
    pub(crate) machine: Machine,
    pub(crate) clutter: ClutterMap,
    pub(crate) false_alarms: FalseAlarmCount,
}

impl Environment {
    /// From the header of a message, with nothing learnt of the clutter.
    pub(crate) fn new(header: &PlotsHeader, config: &TrackerConfig, machine: Machine) -> Self {
        let (cell, pfa) = (cells(header), pfa(header));
        // Errors are uniform within a cell (C1); plots carry their own.
        let variance = cell.map(|cell| cell * cell / 12.0);
        let radar = Radar {
            variance,
            cell,
            measured: [true, true, cell[2] > 0.0, cell[3] > 0.0],
            range_rate_interval_mps: header.range_rate_interval_mps,
        };
        let detector = Detector::with(pfa, noise(header));
        let filter = family(config, &radar, header.scan_period_s);
        let base = config.clutter_floor.max(header.pfa);
        Self {
            radar,
            detector,
            threshold_is_known: header.pfa > 0.0,
            start_target: detector.target_of_unknown_power(config.swerling, config.snr_db),
            limits: PairLimits {
                speed_mps: config.start_speed_mps,
                acceleration_mps2: filter.greatest_acceleration_mps2(),
            },
            filter,
            period_s: header.scan_period_s,
            machine,
            clutter: ClutterMap::new(radar, detector, base, config.clutter_map_scans),
            false_alarms: FalseAlarmCount::default(),
        }
    }

    /// Follows a turn time that has changed: what the filter's noise depends on.
    pub(crate) fn turn_in(&mut self, period_s: f64, config: &TrackerConfig) {
        if (period_s / self.period_s - 1.0).abs() > SAME_TURN {
            self.period_s = period_s;
            self.filter = family(config, &self.radar, period_s);
        }
    }

    /// Whether a header still says the same of the radar.
    #[expect(clippy::float_cmp, reason = "a header says the same or it does not")]
    pub(crate) fn is_described_by(&self, header: &PlotsHeader) -> bool {
        self.radar.cell == cells(header)
            && self.radar.range_rate_interval_mps == header.range_rate_interval_mps
            && self.detector.pfa == pfa(header)
            && self.detector.noise == noise(header)
    }

    /// Probability that a pair of plots is a new target rather than two false plots:
    /// ```text
    /// odds = (b/F₂) λ₂ · λ₁/(F₁ U)
    /// ```
    /// with b new targets and F false plots per cell, U the cells that the first plot could have been in.
    pub(crate) fn start_existence(
        &self,
        previous: &Measurement,
        last: &Measurement,
        own: OwnPlots,
        step_s: f64,
        turn: u32,
        config: &TrackerConfig,
    ) -> f64 {
        let clutter = self.clutter.in_scan(turn, own);
        let [last_among, previous_among] = [last, previous].map(clutter);
        let cells = self.limits.cells(last, step_s, &self.radar);
        let odds = |ratio: &dyn Fn(&Measurement, FalsePower) -> f64| {
            let evidence = |plot: &Measurement, among: FalsePlots| {
                let ratio = if plot.has_power && self.threshold_is_known { ratio(plot, among.power) } else { 1.0 };
                ratio / (among.density * self.radar.volume_at(plot, |i| self.radar.cell[i]))
            };
            config.start_density * evidence(last, last_among) * evidence(previous, previous_among) / cells
        };
        // Nearly all pairs are of false plots, and a glance tells.
        if odds(&|plot, _| self.start_target.greatest_likelihood_ratio(plot.power)) < LEAST_EXISTENCE {
            return 0.0;
        }
        let odds = odds(&|plot, among| self.start_target.likelihood_ratio_among(plot.power, among)).min(1e12);
        (odds / (1.0 + odds)).min(config.start_existence)
    }

    /// D of a track.
    pub(crate) fn detection_probability(&self, config: &TrackerConfig, amplitude: &Amplitude) -> f64 {
        match self.statistics(amplitude) {
            Some(statistics) => statistics.detection_probability.min(config.detection_probability),
            None => config.detection_probability,
        }
    }

    /// Statistics of a track's power, where the radar's threshold is known.
    pub(crate) fn statistics<'a>(&self, amplitude: &'a Amplitude) -> Option<&'a TargetStatistics> {
        self.threshold_is_known.then(|| amplitude.statistics())
    }

    /// What a track knows of its surroundings in turn `turn`; `shares` are those of the plots offered to it.
    pub(crate) fn surroundings<'a>(
        &'a self,
        config: &TrackerConfig,
        amplitude: &'a Amplitude,
        own: OwnPlots,
        shares: &'a [f64],
        turn: u32,
    ) -> Surroundings<'a, impl Fn(&Measurement) -> FalsePlots> {
        Surroundings {
            radar: &self.radar,
            detection_probability: self.detection_probability(config, amplitude),
            target: self.statistics(amplitude),
            shares,
            clutter: self.clutter.in_scan(turn, own),
        }
    }

    /// A track as one that wants plots in the scan of `time_ns`.
    pub(crate) fn claimant<'a>(
        &self,
        config: &TrackerConfig,
        track: &'a LiveTrack,
        prediction: &'a [f64],
        time_ns: u64,
    ) -> Claimant<'a> {
        Claimant {
            prediction,
            time_ns,
            existence: track.life.existence,
            detection_probability: self.detection_probability(config, &track.amplitude),
            target: self.statistics(&track.amplitude).filter(|_| config.association.uses_power()),
            seen_apart: track.is_seen_apart(config),
        }
    }
}

/// Sizes of a resolution cell: r, β, ε, ṙ.
fn cells(header: &PlotsHeader) -> [f64; 4] {
    [header.cell_range_m, header.cell_azimuth_rad, header.cell_elevation_rad, header.cell_range_rate_mps]
}

/// F, or what stands for it.
fn pfa(header: &PlotsHeader) -> f64 {
    if header.pfa > 0.0 { header.pfa } else { UNKNOWN_PFA }
}

/// How the detector estimates the noise; messages of an unknown kind are refused ([`is_possible`]).
fn noise(header: &PlotsHeader) -> NoiseEstimate {
    NoiseEstimate::of(header).unwrap_or(NoiseEstimate::Known)
}

/// Whether a header can be worked with.
pub(crate) fn is_possible(header: &PlotsHeader) -> bool {
    let within = |value: f64, low: f64, high: f64| value >= low && value <= high;
    within(header.scan_period_s, 1e-3, 1e4)
        && within(header.covered_from_rad, -TAU, 2.0 * TAU)
        && within(header.covered_to_rad, header.covered_from_rad, 2.0 * TAU)
        && within(header.cell_range_m, 1e-3, 1e6)
        && within(header.cell_azimuth_rad, 1e-6, TAU)
        && within(header.cell_elevation_rad, 0.0, TAU)
        && within(header.cell_range_rate_mps, 0.0, 1e6)
        && within(header.range_rate_interval_mps, 0.0, 1e7)
        && (header.pfa == 0.0 || within(header.pfa, 1e-100, 0.5))
        && NoiseEstimate::of(header).is_some()
        && header.sectors_per_scan > 0
        && header.sector < header.sectors_per_scan
        && header.seq == u64::from(header.scan) * u64::from(header.sectors_per_scan) + u64::from(header.sector)
}
