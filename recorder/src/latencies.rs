//! Latencies from the stamps of messages, and their budgets.

use std::collections::BTreeMap;

use common::config::BudgetConfig;
use common::health::LatencySummary;
use common::latency::{LATENCIES, LATENCY_NAMES, Latency, LatencyHistograms};
use common::message::END_OF_SCAN;
use common::plots::PlotsHeader;
use common::report::{BudgetResult, Percentiles};
use common::tracks::TracksHeader;

/// The fold of stamps.
#[derive(Debug)]
pub(crate) struct Latencies {
    histograms: LatencyHistograms,
    budgets: BudgetConfig,
    /// Scans with a value above the limit, and the last of them plus one.
    misses: [(u64, u64); LATENCIES],
}

impl Latencies {
    pub(crate) fn new(budgets: &BudgetConfig) -> Self {
        Self { histograms: LatencyHistograms::default(), budgets: budgets.clone(), misses: [(0, 0); LATENCIES] }
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
        let limit_ns = self.budgets.all()[latency as usize].limit_us * 1000.0;
        let (misses, last) = &mut self.misses[latency as usize];
        let missed = from_ns != 0 && to_ns != 0 && to_ns.saturating_sub(from_ns) as f64 > limit_ns;
        if missed && *last != u64::from(scan) + 1 {
            *misses += 1;
            *last = u64::from(scan) + 1;
        }
    }

    /// Percentiles by name.
    pub(crate) fn percentiles(&self) -> BTreeMap<String, Percentiles> {
        let percentiles = self.histograms.named().map(|(name, histogram)| {
            let us = |quantile| {
                if histogram.is_empty() { 0.0 } else { histogram.value_at_quantile(quantile) as f64 / 1000.0 }
            };
            let max = if histogram.is_empty() { 0.0 } else { histogram.max() as f64 / 1000.0 };
            let n = histogram.len();
            (name.to_string(), Percentiles { n, p50: us(0.5), p90: us(0.9), p99: us(0.99), p999: us(0.999), max })
        });
        percentiles.collect()
    }

    /// Budgets by name.
    pub(crate) fn budgets(&self) -> BTreeMap<String, BudgetResult> {
        let named = LATENCY_NAMES.iter().zip(self.budgets.all()).zip(self.misses);
        let results = named.zip(self.histograms.named()).map(|(((name, budget), (misses, _)), (_, histogram))| {
            let value_us = histogram.value_at_quantile(budget.percentile / 100.0) as f64 / 1000.0;
            let ok = histogram.is_empty() || value_us <= budget.limit_us;
            let result = BudgetResult { limit_us: budget.limit_us, percentile: budget.percentile, misses, ok };
            ((*name).to_string(), result)
        });
        results.collect()
    }

    /// For the health of the recorder.
    pub(crate) fn summaries(&self) -> [LatencySummary; LATENCIES] {
        let mut summaries = [LatencySummary::default(); LATENCIES];
        for ((summary, (_, histogram)), (misses, _)) in
            summaries.iter_mut().zip(self.histograms.named()).zip(self.misses)
        {
            let us = |quantile| histogram.value_at_quantile(quantile) as f32 / 1000.0;
            *summary = LatencySummary { n: histogram.len(), p50_us: us(0.5), p99_us: us(0.99), misses };
        }
        summaries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::message::Stamps;

    #[test]
    fn misses_are_counted_once_a_scan_and_missing_stamps_not_at_all() {
        let mut latencies = Latencies::new(&BudgetConfig::default());
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
        assert_eq!((percentiles["track"].n, percentiles["hop_plots"].n, percentiles["record"].n), (4, 0, 0));
        assert!((percentiles["end_to_end"].max - 9001.0).abs() < 10.0);
        assert!(budgets["hop_plots"].ok);
    }
}
