//! Per-scan latencies: their names, what they are between, and their histograms.

use hdrhistogram::Histogram;

/// The latencies of `report.json`, all from monotonic stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Latency {
    /// Dwell published → extractor received it.
    HopDwells,
    /// Last dwell of a sector received → its plots published.
    Extract,
    /// Plots published → tracker received them.
    HopPlots,
    /// Plots received → tracks of that sector published.
    Track,
    /// Last dwell of a sector published by the source → tracks of that sector published.
    EndToEnd,
    /// Last dwell of a scan published → last tracks of that scan published.
    Scan,
    /// Tracks published → tracks in the recording buffer.
    Record,
}

impl Latency {
    /// All of them, in order.
    pub const ALL: [Self; LATENCIES] =
        [Self::HopDwells, Self::Extract, Self::HopPlots, Self::Track, Self::EndToEnd, Self::Scan, Self::Record];
}

/// Number of latencies.
pub const LATENCIES: usize = 7;

/// Names in configuration and reports, in the order of [`Latency`].
pub const LATENCY_NAMES: [&str; LATENCIES] =
    ["hop_dwells", "extract", "hop_plots", "track", "end_to_end", "scan", "record"];

/// Longest latency that is told apart, µs; longer ones count as this.
const LONGEST_US: u64 = 600_000_000;

/// One histogram per latency, ns resolution to three digits, mergeable.
#[derive(Debug, Clone)]
pub struct LatencyHistograms {
    histograms: Vec<Histogram<u64>>,
}

impl Default for LatencyHistograms {
    fn default() -> Self {
        let one = Histogram::new_with_bounds(1, LONGEST_US * 1000, 3).expect("constant bounds are valid");
        Self { histograms: vec![one; LATENCIES] }
    }
}

impl LatencyHistograms {
    /// Notes the time from `from_ns` to `to_ns`. Stamps of 0 mean "has not been there": nothing is noted.
    pub fn record(&mut self, latency: Latency, from_ns: u64, to_ns: u64) {
        if from_ns != 0 && to_ns != 0 {
            self.histograms[latency as usize].saturating_record(to_ns.saturating_sub(from_ns).max(1));
        }
    }

    /// Adds the values of another histogram to one latency's, by its place in [`LATENCY_NAMES`].
    pub fn add(&mut self, latency: usize, other: &Histogram<u64>) {
        let _ = self.histograms[latency].add(other); // what lies above the bounds was cut when it was recorded
    }

    /// Forgets all values.
    pub fn clear(&mut self) {
        self.histograms.iter_mut().for_each(Histogram::clear);
    }

    /// The histogram of one latency, in ns.
    pub fn of(&self, latency: Latency) -> &Histogram<u64> {
        &self.histograms[latency as usize]
    }

    /// All histograms with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &Histogram<u64>)> {
        LATENCY_NAMES.into_iter().zip(&self.histograms)
    }
}
