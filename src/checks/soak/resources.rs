//! Memory, files, processor time, plots and tracks over the run: a table that is written as it comes.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context;
use common::status::Board;
use common::units::MIB;
use serde::{Deserialize, Serialize};

/// Rows that memory growth can be told from: at least one in each tenth of the run.
const ROWS: usize = 10;
/// Rows are thinned to at most so many of each process when they are read back.
const POINTS: usize = 400;

/// One process at one time: a line of `resources.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) t_s: f64,
    pub(super) process: String,
    pub(super) pid: u32,
    pub(super) scan: u32,
    pub(super) rss_bytes: u64,
    /// What no other process shares.
    pub(super) private_bytes: u64,
    pub(super) files: u32,
    pub(super) cpu_share: f64,
    pub(super) plots: u32,
    pub(super) tracks: u32,
    pub(super) confirmed: u32,
}

/// The table being written.
pub(super) struct Resources {
    path: PathBuf,
    writer: csv::Writer<File>,
    interval: Duration,
    next: Duration,
}

impl Resources {
    /// Begins `resources.csv` in a folder.
    pub(super) fn create(out: &Path, interval: Duration) -> anyhow::Result<Self> {
        let path = out.join("resources.csv");
        let file = File::create(&path).with_context(|| format!("creating {}", path.display()))?;
        Ok(Self { path, writer: csv::Writer::from_writer(file), interval, next: Duration::ZERO })
    }

    /// Writes a line per process if an interval has passed.
    pub(super) fn note(&mut self, elapsed: Duration, board: &Board) -> anyhow::Result<()> {
        if elapsed < self.next {
            return Ok(());
        }
        self.next = elapsed + self.interval;
        for (process, health, cpu_share) in board.all() {
            let row = Row {
                t_s: elapsed.as_secs_f64(),
                process,
                pid: health.pid,
                scan: health.scan,
                rss_bytes: health.rss_bytes,
                private_bytes: u64::from(health.private_kib) << 10,
                files: health.files,
                cpu_share,
                plots: health.plots,
                tracks: health.tracks,
                confirmed: health.confirmed,
            };
            self.writer.serialize(row).with_context(|| format!("writing {}", self.path.display()))?;
        }
        self.writer.flush().with_context(|| format!("writing {}", self.path.display()))
    }

    /// Reads the whole table back.
    pub(super) fn finish(mut self) -> anyhow::Result<Series> {
        self.writer.flush()?;
        let reading = || format!("reading {}", self.path.display());
        let mut by_process: BTreeMap<String, Vec<Row>> = BTreeMap::new();
        for row in csv::Reader::from_path(&self.path).with_context(reading)?.deserialize() {
            let row: Row = row.with_context(reading)?;
            by_process.entry(row.process.clone()).or_default().push(row);
        }
        Ok(Series { by_process, unwritten: None })
    }
}

/// The table by process.
#[derive(Debug, Default)]
pub(super) struct Series {
    pub(super) by_process: BTreeMap<String, Vec<Row>>,
    /// Why it is not whole.
    pub(super) unwritten: Option<String>,
}

impl Series {
    /// The processes of one of several sites, and those that serve all.
    pub(super) fn of_site(&self, site: &str) -> Self {
        let of_site = |(name, rows): (&String, &Vec<Row>)| match name.split_once('/') {
            Some((of, process)) => (of == site).then(|| (process.to_string(), rows.clone())),
            None => Some((name.clone(), rows.clone())),
        };
        Self { by_process: self.by_process.iter().filter_map(of_site).collect(), unwritten: self.unwritten.clone() }
    }

    /// Private memory gained after the first share `warm_up` of the run, MiB: median of the last tenth less median
    /// of the tenth after warm-up. Shared memory is reserved at the start and cannot grow; what a process has touched of it can.
    /// Of a process that was restarted, or measured for too short a time, it says why it has none.
    pub(super) fn growth_mib(&self, warm_up: f64) -> BTreeMap<String, Result<f64, String>> {
        let growth = |rows: &[Row]| {
            let (count, end) = (rows.len(), rows.last().map_or(0.0, |row| row.t_s));
            let too_short = || format!("{end:.0} s with {count} readings are too short, {ROWS} readings needed");
            if rows.iter().any(|row| row.pid != rows[count - 1].pid) {
                return Err("it was restarted".to_string());
            }
            if count < ROWS {
                return Err(too_short());
            }
            let within = |from: f64, to: f64| {
                let chosen = rows.iter().filter(|row| (from * end..=to * end).contains(&row.t_s));
                let mut values: Vec<u64> = chosen.map(|row| row.private_bytes).collect();
                values.sort_unstable();
                values.get(values.len() / 2).map(|&bytes| bytes as f64 / MIB)
            };
            let gained = |before: f64| Some(within(0.9, 1.0)? - before);
            within(warm_up, warm_up + 0.1).and_then(gained).ok_or_else(too_short)
        };
        self.by_process.iter().map(|(name, rows)| (name.clone(), growth(rows))).collect()
    }
}

/// A value of one process over the run, thinned: the largest of each block of neighbours, so that no spike is lost.
pub(super) fn points(rows: &[Row], value: fn(&Row) -> f64) -> Vec<f64> {
    let largest = |block: &[Row]| block.iter().map(value).fold(f64::MIN, f64::max);
    rows.chunks(rows.len().div_ceil(POINTS).max(1)).map(largest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rss_mib: impl Fn(u32) -> f64, pid: impl Fn(u32) -> u32) -> Vec<Row> {
        let row = |k| Row {
            t_s: f64::from(k),
            process: "tracker".into(),
            pid: pid(k),
            scan: k,
            rss_bytes: 0,
            private_bytes: (rss_mib(k) * MIB) as u64,
            files: 3,
            cpu_share: 0.1,
            plots: 0,
            tracks: 0,
            confirmed: 0,
        };
        (0..1000).map(row).collect()
    }

    fn growth(rows: Vec<Row>) -> Result<f64, String> {
        let series = Series { by_process: [("tracker".to_string(), rows)].into(), unwritten: None };
        series.growth_mib(0.1)["tracker"].clone()
    }

    #[test]
    fn warm_up_is_no_growth_and_a_leak_is() {
        let warm = growth(rows(|k| if k < 50 { 5.0 } else { 9.0 }, |_| 1)).expect("known");
        assert!(warm.abs() < 1e-6, "{warm}");
        let leak = growth(rows(|k| 9.0 + 0.01 * f64::from(k), |_| 1)).expect("known");
        assert!((leak - 8.0).abs() < 0.02, "{leak}");
    }

    #[test]
    fn thinning_keeps_a_spike() {
        let spiky = rows(|k| if k == 501 { 99.0 } else { 1.0 }, |_| 1);
        let thinned = points(&spiky, |row| row.private_bytes as f64 / MIB);
        assert!(thinned.len() <= POINTS && thinned.contains(&99.0), "{} points", thinned.len());
    }

    #[test]
    fn a_process_that_was_restarted_or_lived_shortly_says_so() {
        assert_eq!(growth(rows(|_| 9.0, |k| k / 500)), Err("it was restarted".to_string()));
        let short = rows(|_| 9.0, |_| 1).into_iter().take(5).collect();
        assert_eq!(growth(short), Err("4 s with 5 readings are too short, 10 readings needed".to_string()));
    }
}
