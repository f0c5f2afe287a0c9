//! Latencies from the stamps of messages, and their budgets.

use std::collections::BTreeMap;
use std::fs::File;
use std::time::Duration;

use common::config::{Budget, BudgetConfig, Speed};
use common::health::LatencySummary;
use common::latency::{LATENCIES, LATENCY_NAMES, Latency, LatencyHistograms};
use common::latency_log::LatencyLog;
use common::message::END_OF_SCAN;
use common::plots::PlotsHeader;
use common::report::{BudgetResult, LimitResult, MISSES_LISTED, Miss, Percentiles};
use common::tracks::TracksHeader;

/// The fold of stamps.
#[derive(Debug)]
pub(crate) struct Latencies {
    histograms: LatencyHistograms,
    budgets: BudgetConfig,
    /// As fast as it goes: queues are full by design, and only limits given for that apply.
    full_speed: bool,
    misses: [Misses; LATENCIES],
    log: Option<LatencyLog<File>>,
}

/// Scans in which one latency was above the strictest of its limits.
#[derive(Debug, Clone, Default)]
struct Misses {
    count: u64,
    /// The first of them: scan and largest value, ns.
    listed: Vec<(u32, u64)>,
    /// The last of them.
    last: Option<u32>,
}

impl Misses {
    fn note(&mut self, scan: u32, took_ns: u64) {
        if self.last != Some(scan) {
            self.last = Some(scan);
            self.count += 1;
            if self.listed.len() < MISSES_LISTED {
                self.listed.push((scan, took_ns));
            }
        } else if let Some((_, largest)) = self.listed.last_mut().filter(|(listed, _)| *listed == scan) {
            *largest = took_ns.max(*largest);
        }
    }
}

impl Latencies {
    pub(crate) fn new(budgets: &BudgetConfig, speed: Speed) -> Self {
        let misses = std::array::from_fn(|_| Misses::default());
        Self {
            histograms: LatencyHistograms::default(),
            budgets: budgets.clone(),
            full_speed: speed == Speed::Max,
            misses,
            log: None,
        }
    }

    /// Writes intervals to `log` from now on.
    pub(crate) fn log_to(&mut self, log: LatencyLog<File>) {
        self.log = Some(log);
    }

    /// Closes the interval of the log if it has lasted for `length`; a log that cannot be written ends, said once.
    pub(crate) fn close_interval(&mut self, length: Duration) {
        let Some(log) = self.log.as_mut().filter(|log| log.interval() >= length) else { return };
        if let Err(error) = log.close_interval() {
            tracing::warn!("the log of latencies ends here: {error}");
            self.log = None;
        }
    }

    /// Notes the way of a plots message so far.
    pub(crate) fn plots(&mut self, header: &PlotsHeader) {
        let (stamps, scan) = (&header.stamps, header.scan);
        self.note(Latency::HopDwells, stamps.source_out_ns, stamps.extractor_in_ns, scan);
        self.note(Latency::Extract, stamps.extractor_in_ns, stamps.plots_out_ns, scan);
    }

    /// Notes the way of a tracks message, recorded at `recorded_ns` (0 when read from a file).
    pub(crate) fn tracks(&mut self, header: &TracksHeader, recorded_ns: u64) {
        let (stamps, scan) = (&header.stamps, header.scan);
        self.note(Latency::HopPlots, stamps.plots_out_ns, stamps.tracker_in_ns, scan);
        self.note(Latency::Track, stamps.tracker_in_ns, stamps.tracks_out_ns, scan);
        self.note(Latency::EndToEnd, stamps.source_out_ns, stamps.tracks_out_ns, scan);
        if header.has(END_OF_SCAN) {
            self.note(Latency::Scan, stamps.source_out_ns, stamps.tracks_out_ns, scan);
        }
        self.note(Latency::Record, stamps.tracks_out_ns, recorded_ns, scan);
    }

    fn note(&mut self, latency: Latency, from_ns: u64, to_ns: u64, scan: u32) {
        self.histograms.record(latency, from_ns, to_ns);
        if let Some(log) = &mut self.log {
            log.record(latency, from_ns, to_ns);
        }
        let budget = self.budgets.all()[latency as usize];
        let applied = budget.limits().filter(|&(percentile, _)| self.applies(&budget, percentile));
        let limit_ns = applied.map(|(_, limit_us)| limit_us).fold(f64::INFINITY, f64::min) * 1000.0;
        let took_ns = to_ns.saturating_sub(from_ns);
        if from_ns != 0 && to_ns != 0 && took_ns as f64 > limit_ns {
            self.misses[latency as usize].note(scan, took_ns);
        }
    }

    /// Whether the limit of a percentile applies.
    fn applies(&self, budget: &Budget, percentile: f64) -> bool {
        !self.full_speed || budget.further().any(|(given, _)| (given - percentile).abs() < 1e-9)
    }

    /// Percentiles by name.
    pub(crate) fn percentiles(&self) -> BTreeMap<String, Percentiles> {
        self.histograms.named().map(|(name, histogram)| (name.to_string(), Percentiles::of(histogram))).collect()
    }

    /// Budgets by name.
    pub(crate) fn budgets(&self) -> BTreeMap<String, BudgetResult> {
        let named = LATENCY_NAMES.iter().zip(self.budgets.all()).zip(&self.misses);
        let results = named.zip(self.histograms.named()).map(|(((name, budget), misses), (_, histogram))| {
            let limit = |(percentile, limit_us): (f64, f64)| {
                let value_us = histogram.value_at_quantile(percentile / 100.0) as f64 / 1000.0;
                let ok = histogram.is_empty() || value_us <= limit_us;
                LimitResult { percentile, limit_us, value_us, ok, applied: self.applies(&budget, percentile) }
            };
            let limits: Vec<LimitResult> = budget.limits().map(limit).collect();
            let ok = limits.iter().all(|limit| limit.ok || !limit.applied);
            let LimitResult { limit_us, percentile, .. } = limits[0]; // there is always one
            ((*name).to_string(), BudgetResult { limit_us, percentile, misses: misses.count, ok, limits })
        });
        results.collect()
    }

    /// The scans above a limit that are listed, by latency and scan, each with the highest of the limits it broke.
    pub(crate) fn misses(&self) -> Vec<Miss> {
        let named = LATENCY_NAMES.iter().zip(self.budgets.all()).zip(&self.misses);
        let listed = named.flat_map(|((name, budget), misses)| {
            misses.listed.iter().map(move |&(scan, ns)| {
                let us = ns as f64 / 1000.0;
                let broken = budget.limits().map(|(_, limit_us)| limit_us).filter(|&limit_us| limit_us < us);
                Miss { scan, latency: (*name).to_string(), us, limit_us: broken.fold(0.0, f64::max) }
            })
        });
        listed.collect()
    }

    /// For the health of the recorder.
    pub(crate) fn summaries(&self) -> [LatencySummary; LATENCIES] {
        let mut summaries = [LatencySummary::default(); LATENCIES];
        for ((summary, (_, histogram)), misses) in summaries.iter_mut().zip(self.histograms.named()).zip(&self.misses) {
            let us = |quantile| histogram.value_at_quantile(quantile) as f32 / 1000.0;
            *summary = LatencySummary { n: histogram.len(), p50_us: us(0.5), p99_us: us(0.99), misses: misses.count };
        }
        summaries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::message::Stamps;

    #[test]
    fn a_miss_is_listed_with_the_limit_it_broke() {
        let mut budgets = BudgetConfig::default();
        budgets.track.p50_us = Some(5.0);
        let mut latencies = Latencies::new(&budgets, Speed::Times(1.0));
        for (scan, took_ns) in [(0, 1000), (1, 10_000), (2, 9_000_000)] {
            let stamps = Stamps { tracker_in_ns: 2000, tracks_out_ns: 2000 + took_ns, ..Stamps::default() };
            latencies.tracks(&TracksHeader { scan, stamps, ..TracksHeader::default() }, 0);
        }
        let misses: Vec<_> = latencies.misses().iter().map(|miss| (miss.scan, miss.limit_us)).collect();
        assert_eq!(misses, [(1, 5.0), (2, 2000.0)]);
    }

    #[test]
    fn at_full_speed_only_limits_given_for_it_apply() {
        for (given_us, ok) in [(None, true), (Some(5.0), false)] {
            let mut budgets = BudgetConfig::default();
            budgets.track.p50_us = given_us;
            let mut latencies = Latencies::new(&budgets, Speed::Max);
            let stamps = Stamps { tracker_in_ns: 2000, tracks_out_ns: 9_000_000, ..Stamps::default() };
            latencies.tracks(&TracksHeader { stamps, ..TracksHeader::default() }, 0);
            let budget = &latencies.budgets()["track"];
            assert_eq!(budget.ok, ok);
            assert_eq!((budget.limits[0].ok, budget.limits[0].applied), (false, false));
            assert_eq!(latencies.misses().len(), usize::from(!ok));
        }
    }

    #[test]
    fn misses_are_counted_once_a_scan_and_missing_stamps_not_at_all() {
        let mut latencies = Latencies::new(&BudgetConfig::default(), Speed::Times(1.0));
        let mut tracks = |scan, took_ns: u64| {
            let stamps =
                Stamps { source_out_ns: 1000, tracker_in_ns: 2000, tracks_out_ns: 2000 + took_ns, ..Stamps::default() };
            latencies.tracks(&TracksHeader { scan, stamps, ..TracksHeader::default() }, 0);
        };
        tracks(0, 10_000);
        tracks(1, 9_000_000);
        tracks(1, 9_000_000);
        tracks(2, 9_000_000);
        let (budgets, percentiles) = (latencies.budgets(), latencies.percentiles());
        assert_eq!((budgets["track"].misses, budgets["track"].ok), (2, false));
        let scans: Vec<_> = latencies.misses().iter().map(|miss| (miss.latency.clone(), miss.scan)).collect();
        assert!(scans.contains(&("track".into(), 1)) && scans.contains(&("end_to_end".into(), 2)), "{scans:?}");
        assert_eq!(scans.len(), 4);
        assert_eq!((percentiles["track"].n, percentiles["hop_plots"].n, percentiles["record"].n), (4, 0, 0));
        assert!((percentiles["end_to_end"].max - 9001.0).abs() < 10.0);
        assert!(budgets["hop_plots"].ok);
    }
}
