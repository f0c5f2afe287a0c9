//! Latency histograms by interval in the standard log of HdrHistogram: one line per interval and latency,
//! tagged with its name, values in ns. The usual HdrHistogram tools read, merge and draw such files.

use std::io::Write;
use std::time::{Duration, Instant, SystemTime};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hdrhistogram::Histogram;
use hdrhistogram::serialization::interval_log::{IntervalLogIterator, IntervalLogWriterBuilder, LogEntry, Tag};
use hdrhistogram::serialization::{Deserializer, V2DeflateSerializer};

use crate::latency::{LATENCIES, LATENCY_NAMES, Latency, LatencyHistograms};

/// Writes intervals.
pub struct LatencyLog<W: Write> {
    out: W,
    serializer: V2DeflateSerializer,
    begun: Instant,
    /// Since the beginning.
    interval_start: Duration,
    interval: LatencyHistograms,
}

impl<W: Write> LatencyLog<W> {
    /// Begins a log (or goes on in one: its times count from their own StartTime line).
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(mut out: W) -> std::io::Result<Self> {
        let mut serializer = V2DeflateSerializer::new();
        IntervalLogWriterBuilder::new()
            .add_comment("[Histogram log format version 1.3]")
            .add_comment("Latencies of a radar chain in ns, tagged with their names")
            .with_start_time(SystemTime::now())
            .begin_log_with(&mut out, &mut serializer)?;
        let interval = LatencyHistograms::default();
        Ok(Self { out, serializer, begun: Instant::now(), interval_start: Duration::ZERO, interval })
    }

    /// Notes a latency; stamps of 0 are left out.
    pub fn record(&mut self, latency: Latency, from_ns: u64, to_ns: u64) {
        self.interval.record(latency, from_ns, to_ns);
    }

    /// How long the present interval has lasted.
    pub fn interval(&self) -> Duration {
        self.begun.elapsed().saturating_sub(self.interval_start)
    }

    /// Writes the present interval and begins the next.
    ///
    /// # Errors
    /// Those of the output.
    pub fn close_interval(&mut self) -> std::io::Result<()> {
        let (start, length) = (self.interval_start, self.interval());
        self.interval_start += length;
        let mut log = IntervalLogWriterBuilder::new().begin_log_with(&mut self.out, &mut self.serializer)?;
        for (name, histogram) in self.interval.named().filter(|(_, histogram)| !histogram.is_empty()) {
            log.write_histogram(histogram, start, length, Tag::new(name))
                .map_err(|error| std::io::Error::other(error.to_string()))?;
        }
        self.interval.clear();
        self.out.flush()
    }
}

impl<W: Write> std::fmt::Debug for LatencyLog<W> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("LatencyLog").field("interval_start", &self.interval_start).finish_non_exhaustive()
    }
}

/// One interval as it was read.
#[derive(Debug, Clone)]
pub struct Interval {
    /// Start since the beginning of the first log in the file, s.
    pub start_s: f64,
    /// Length, s.
    pub length_s: f64,
    /// Which latency, as in [`LATENCY_NAMES`].
    pub latency: usize,
    /// Its values, ns.
    pub histogram: Histogram<u64>,
}

/// Reads a log. Lines that are cut or belong to others are passed over.
pub fn read(text: &str) -> Vec<Interval> {
    let (mut first, mut offset_s, mut intervals) = (None, 0.0, Vec::new());
    let mut deserializer = Deserializer::new();
    // Line by line, for a line cut by a crash must not hide those after it.
    for line in text.split_inclusive('\n') {
        match IntervalLogIterator::new(line.as_bytes()).next() {
            Some(Ok(LogEntry::StartTime(start))) => {
                let start_s = start.as_secs_f64();
                offset_s = start_s - *first.get_or_insert(start_s);
            }
            Some(Ok(LogEntry::Interval(entry))) => {
                let latency = entry.tag().and_then(|tag| LATENCY_NAMES.iter().position(|&name| name == tag.as_str()));
                let bytes = STANDARD.decode(entry.encoded_histogram()).unwrap_or_default();
                let decoded = deserializer.deserialize(&mut bytes.as_slice()).ok();
                if let (Some(latency), Some(histogram)) = (latency, decoded) {
                    let (start_s, length_s) = (offset_s + entry.start_timestamp().as_secs_f64(), entry.duration());
                    intervals.push(Interval { start_s, length_s: length_s.as_secs_f64(), latency, histogram });
                }
            }
            _ => {}
        }
    }
    intervals
}

/// All intervals of each latency in one histogram.
pub fn merged(intervals: &[Interval]) -> LatencyHistograms {
    let mut whole = LatencyHistograms::default();
    for interval in intervals {
        whole.add(interval.latency, &interval.histogram);
    }
    whole
}

/// Neighbouring intervals of one latency merged into at most `count` equally long blocks: time of the middle, s, and values.
pub fn blocks(intervals: &[Interval], latency: usize, count: usize) -> Vec<(f64, Histogram<u64>)> {
    debug_assert!(latency < LATENCIES && count > 0);
    let of_latency: Vec<&Interval> = intervals.iter().filter(|interval| interval.latency == latency).collect();
    let per_block = of_latency.len().div_ceil(count).max(1);
    let merge = |block: &[&Interval]| {
        let mut histogram = block[0].histogram.clone();
        block[1..].iter().for_each(|interval| {
            let _ = histogram.add(&interval.histogram); // all have the same bounds
        });
        let last = block[block.len() - 1];
        (0.5 * (block[0].start_s + last.start_s + last.length_s), histogram)
    };
    of_latency.chunks(per_block).map(merge).collect()
}

/// Name of the log `name` of one of several sites.
pub fn of_site(name: &str, site: &str) -> String {
    match name.rsplit_once('.') {
        Some((stem, extension)) => format!("{stem}-{site}.{extension}"),
        None => format!("{name}-{site}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log of two starts; in each, two intervals with one latency of `us`, `us + 1`.
    fn two_starts() -> String {
        let mut file = Vec::new();
        for us in [10, 20] {
            let mut log = LatencyLog::begin(&mut file).expect("memory");
            for more in 0..2 {
                log.record(Latency::Track, 1, 1 + (us + more) * 1000);
                log.record(Latency::Scan, 0, 5); // a stamp is missing
                log.close_interval().expect("memory");
            }
        }
        String::from_utf8(file).expect("text")
    }

    #[test]
    fn what_was_written_is_read_and_merged() {
        let text = two_starts();
        let intervals = read(&text);
        assert_eq!(intervals.len(), 4);
        assert!(intervals.windows(2).all(|pair| pair[0].start_s <= pair[1].start_s + 0.001));
        let whole = merged(&intervals);
        assert_eq!((whole.of(Latency::Track).len(), whole.of(Latency::Scan).len()), (4, 0));
        assert!(whole.of(Latency::Track).equivalent(whole.of(Latency::Track).max(), 21_000));
        let blocks = blocks(&intervals, Latency::Track as usize, 2);
        assert_eq!(blocks.iter().map(|(_, histogram)| histogram.len()).collect::<Vec<_>>(), [2, 2]);
    }

    #[test]
    fn a_line_that_was_cut_hides_no_other() {
        let text = two_starts();
        let cut = text.find("Tag=").expect("an interval") + 40;
        let rest = text[cut..].find("#[StartTime").expect("the second start") + cut;
        let spoilt = format!("{}\n{}", &text[..cut], &text[rest..]);
        assert_eq!(read(&spoilt).len(), 2);
    }
}
