//! Plots against the simulator's truth: detection, accuracy, false alarms.
//!
//! A plot is a target's if it lies within 6 standard errors or 1.5 cells, whichever is
//! more, on every axis, and is the nearest such plot of the moment at which the beam passed the
//! target. Errors are divided by the plot's own standard errors. Two targets whose skirts
//! touch are *unresolved*: they may give one plot between them, so neither is counted among the
//! visible ones and their plots say nothing about accuracy.
//!
//! False alarms are counted in cells: those of plots that are near no target, outside the
//! region of ground clutter, over the cells tested there. *Near a target* are ±1.5° of azimuth
//! and elevation and ±4 range cells at any range rate, where the skirts of its echo can
//! cross the threshold; *clutter* is where its echo, with the skirts of beam and filter,
//! rises to within 10 dB below noise, and as far as the CFAR window looks beyond its range.

use std::collections::{BTreeMap, VecDeque};

use common::amplitude::{Detector, NoiseEstimate};
use common::config::{ChainConfig, Swerling};
use common::plots::{Plot, PlotsHeader};
use common::report::Detection;
use common::truth::{TruthHeader, TruthTarget, VISIBLE};
use common::units::from_db;
use evaluation::poisson;

use super::clutter_region::ClutterRegion;
use super::offset::{Offset, skirt_cells, skirts_touch};
use super::path::ns;
use super::reach::beam_scans;

/// Axes of a plot, as named in the report.
const AXES: [&str; 4] = ["range", "azimuth", "elevation", "range_rate"];
/// A plot belongs to a target if it was made within this of its passage, scans.
const TIME_GATE_SCANS: f64 = 0.1;
/// Truth waits for plots no longer than this, scans.
const LONGEST_WAIT_SCANS: usize = 60;

/// The fold of truth and plots.
#[derive(Debug)]
pub struct PlotScore {
    clutter: ClutterRegion,
    swerling: Vec<Swerling>,
    rate_span_mps: f64,
    dopplers: f64,
    /// Time in which the beam passes a target wholly, as a share of a scan.
    beam_scans: f64,
    pending: VecDeque<(TruthHeader, Vec<TruthTarget>)>,
    plots: VecDeque<Candidate>,
    plots_ns: u64,
    last_header: Option<PlotsHeader>,
    cells: f64,
    counts: Counts,
    expected: f64,
    squares: [(f64, u64); 4],
}

#[derive(Debug, Default, Clone, Copy)]
struct Counts {
    plots: u64,
    left_out: u64,
    visible: u64,
    unresolved: u64,
    detected: u64,
    false_plots: u64,
    false_cells: u64,
}

/// A plot that may still turn out to be a target's.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    plot: Plot,
    of_target: bool,
    near_target: bool,
}

impl PlotScore {
    /// Nothing seen yet.
    pub fn new(config: &ChainConfig) -> Self {
        Self {
            clutter: ClutterRegion::new(config),
            swerling: config.sim.targets.iter().map(|target| target.swerling).collect(),
            rate_span_mps: config.radar.range_rate_step_mps * f64::from(config.radar.dopplers),
            dopplers: config.radar.dopplers.into(),
            beam_scans: beam_scans(&config.radar),
            pending: VecDeque::new(),
            plots: VecDeque::new(),
            plots_ns: 0,
            last_header: None,
            cells: 0.0,
            counts: Counts::default(),
            expected: 0.0,
            squares: [(0.0, 0); 4],
        }
    }

    /// Takes the plots of a sector.
    pub fn plots(&mut self, header: &PlotsHeader, plots: &[Plot]) {
        self.counts.plots += plots.len() as u64;
        self.counts.left_out += u64::from(header.left_out);
        if header.cells > 0 {
            self.cells += header.cells as f64 * (1.0 - self.clutter.share);
            let candidate = |&plot: &Plot| Candidate { plot, of_target: false, near_target: false };
            self.plots.extend(plots.iter().map(candidate));
            self.last_header = Some(*header);
        }
        self.plots_ns = self.plots_ns.max(header.time_ns);
        while let Some((truth, _)) = self.pending.front() {
            let settled_ns = truth.time_ns + ns(truth.scan_period_s * 0.5);
            if self.plots_ns < settled_ns && self.pending.len() <= LONGEST_WAIT_SCANS {
                break;
            }
            self.score_next(u64::MAX);
        }
        if self.pending.is_empty() {
            // Without truth nothing will ever claim or refuse a plot.
            let needed_ns = self.plots_ns.saturating_sub(ns(header.scan_period_s * LONGEST_WAIT_SCANS as f64));
            while self.plots.front().is_some_and(|candidate| candidate.plot.time_ns < needed_ns) {
                self.plots.pop_front();
            }
        }
    }

    /// Takes the truth of a scan.
    pub fn truth(&mut self, header: &TruthHeader, targets: &[TruthTarget]) {
        self.pending.push_back((*header, targets.to_vec()));
    }

    /// Scores what is left, and the result.
    pub fn finish(&mut self) -> Detection {
        let with_truth = self.counts.visible + self.counts.unresolved > 0 || !self.pending.is_empty();
        while !self.pending.is_empty() {
            self.score_next(self.plots_ns);
        }
        self.settle(u64::MAX);
        let counts = self.counts;
        let pfa_set = self.last_header.map(|header| header.pfa).filter(|&pfa| pfa > 0.0 && pfa < 1.0);
        let cells = self.cells.max(0.0);
        let measured = with_truth && cells > 0.0;
        let per_visible = |sum: f64| (counts.visible > 0).then(|| sum / counts.visible as f64);
        let squares = AXES.iter().zip(self.squares).filter(|(_, (_, n))| *n > 0);
        Detection {
            cells: cells as u64,
            false_alarm_cells: counts.false_cells,
            pfa_set,
            pfa_measured: measured.then(|| counts.false_cells as f64 / cells),
            pfa_interval: measured.then(|| {
                let count = poisson::count(counts.false_cells, 0.95);
                [count.lo / cells, count.hi / cells]
            }),
            pd_expected: pfa_set.and_then(|_| per_visible(self.expected)),
            pd_measured: per_visible(counts.detected as f64),
            plots: counts.plots,
            left_out: counts.left_out,
            unresolved: with_truth.then_some(counts.unresolved),
            false_plots: with_truth.then_some(counts.false_plots),
            normalised_error_squared: squares
                .map(|(name, (sum, n))| ((*name).to_string(), sum / n as f64))
                .collect::<BTreeMap<_, _>>(),
        }
    }

    /// Scores the next scan; passages of the beam that are not over at `end_ns` do not count.
    fn score_next(&mut self, end_ns: u64) {
        let Some((header, mut targets)) = self.pending.pop_front() else { return };
        let whole_ns = end_ns.saturating_sub(ns(header.scan_period_s * self.beam_scans));
        for target in targets.iter_mut().filter(|target| target.time_ns > whole_ns) {
            target.flags &= !VISIBLE;
        }
        let Some(cells) = self.last_header else { return };
        let time_gate_ns = ns(header.scan_period_s * TIME_GATE_SCANS);
        for (index, target) in targets.iter().enumerate() {
            let others = targets.iter().enumerate().filter(|&(other, _)| other != index);
            let resolved = !others.into_iter().any(|(_, other)| skirts_touch(target, other, &cells));
            self.score_target(target, resolved, &cells, time_gate_ns);
        }
        self.settle(header.time_ns.saturating_sub(time_gate_ns));
    }

    fn score_target(&mut self, target: &TruthTarget, resolved: bool, cells: &PlotsHeader, time_gate_ns: u64) {
        let mut best: Option<(f64, usize, [Option<f64>; 4])> = None;
        for (index, candidate) in self.plots.iter_mut().enumerate() {
            if candidate.plot.time_ns.abs_diff(target.time_ns) > time_gate_ns {
                continue;
            }
            let offset = Offset::new(&candidate.plot, target, self.rate_span_mps);
            candidate.near_target |= offset.within_skirts(cells);
            if let Some(normalised) = offset.normalised(&candidate.plot, cells).filter(|_| !candidate.of_target) {
                let distance = normalised.iter().flatten().map(|value| value * value).sum();
                if best.is_none_or(|(nearest, _, _)| distance < nearest) {
                    best = Some((distance, index, normalised));
                }
            }
        }
        if let Some((_, index, normalised)) = best {
            self.plots[index].of_target = true;
            for ((sum, n), error) in self.squares.iter_mut().zip(normalised) {
                if let Some(error) = error.filter(|_| resolved) {
                    *sum += error * error;
                    *n += 1;
                }
            }
        }
        if target.has(VISIBLE) {
            self.cells -= skirt_cells(target, cells, self.dopplers);
            if !resolved {
                self.counts.unresolved += 1;
                return;
            }
            self.counts.visible += 1;
            self.counts.detected += u64::from(best.is_some());
            let swerling = target.target_id.checked_sub(1).and_then(|index| self.swerling.get(index as usize));
            if let (Some(&swerling), true) = (swerling, cells.pfa > 0.0 && cells.pfa < 1.0) {
                let snr = from_db(f64::from(target.snr_db));
                let noise = NoiseEstimate::of(cells).unwrap_or(NoiseEstimate::Known);
                let detector = Detector::with(cells.pfa, noise);
                self.expected += detector.target(swerling, snr).detection_probability;
            }
        }
    }

    /// Counts the plots before `until_ns`: no target can claim them any more.
    fn settle(&mut self, until_ns: u64) {
        let Self { plots, counts, clutter, .. } = self;
        plots.retain(|candidate| {
            if candidate.plot.time_ns >= until_ns {
                return true;
            }
            if !candidate.of_target && !candidate.near_target {
                counts.false_plots += 1;
                if !clutter.holds(&candidate.plot) {
                    counts.false_cells += u64::from(candidate.plot.cell_count);
                }
            }
            false
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_probabilities_of_false_alarm_give_no_expectation() {
        for pfa in [2.0, 1.0, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut score = PlotScore::new(&ChainConfig::default());
            let header = PlotsHeader { pfa, cells: 1, scan_period_s: 1.0, time_ns: 1, ..PlotsHeader::default() };
            score.plots(&header, &[]);
            let target = TruthTarget { target_id: 1, flags: VISIBLE, state: [100.0; 9], ..TruthTarget::default() };
            score.truth(&TruthHeader { time_ns: 1, scan_period_s: 1.0, ..TruthHeader::default() }, &[target]);
            let found = score.finish();
            assert_eq!((found.pfa_set, found.pd_expected), (None, None), "{pfa}");
        }
    }
}
