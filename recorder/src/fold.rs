//! Everything that a run's report says, folded from its messages.

use std::fs::File;
use std::time::Duration;

use common::config::{ChainConfig, Mode};
use common::health::{Intake, LatencySummary};
use common::latency::LATENCIES;
use common::latency_log::LatencyLog;
use common::message::END_OF_SCAN;
use common::recording::{Gap, RecordedRef};
use common::report::{Report, SCHEMA};
use common::topic::Topic;
use common::topology;
use common::tracks::TracksHeader;
use common::units::seconds_between;
use serde::{Deserialize, Serialize};

use crate::books::Books;
use crate::latencies::Latencies;
use crate::losses::{Losses, Missing};
use crate::processes::Processes;
use crate::schedule::Schedule;
use crate::scoring::Scoring;

/// What became of a run in files.
#[derive(Debug, Default)]
pub struct Files {
    /// The last part.
    pub last: Option<String>,
    /// Parts of the run.
    pub parts: u32,
    /// Files removed to keep the total size within its limit.
    pub removed: u32,
    /// What is missing from them.
    pub gaps: Vec<Gap>,
}

/// The fold of a run.
#[derive(Debug)]
pub struct Fold {
    config: ChainConfig,
    losses: Losses,
    books: Books,
    latencies: Latencies,
    processes: Processes,
    scoring: Scoring,
    progress: Progress,
}

/// How far a run has come.
#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Progress {
    scans: u64,
    /// Processing time of the first source stamp and the last tracks, ns.
    wall_ns: Option<(u64, u64)>,
    /// Measurement time of the first and the last tracks, ns UTC.
    measured_ns: Option<(u64, u64)>,
}

impl Progress {
    fn note(&mut self, header: &TracksHeader) {
        self.scans += u64::from(header.has(END_OF_SCAN));
        let extend = |span: Option<(u64, u64)>, from: u64, to: u64| {
            let (first, last) = span.unwrap_or((from, to));
            Some((first.min(from), last.max(to)))
        };
        let stamps = &header.stamps;
        if stamps.tracks_out_ns != 0 {
            let from_ns = if stamps.source_out_ns == 0 { stamps.tracks_out_ns } else { stamps.source_out_ns };
            self.wall_ns = extend(self.wall_ns, from_ns, stamps.tracks_out_ns);
        }
        self.measured_ns = extend(self.measured_ns, header.time_ns, header.time_ns);
    }

    /// Length in processing time and in measurement time, s.
    fn lengths_s(&self) -> [f64; 2] {
        [self.wall_ns, self.measured_ns].map(|span| span.map_or(0.0, |(first, last)| seconds_between(first, last)))
    }
}

impl Fold {
    /// Nothing seen yet of a run with `config`.
    pub fn new(config: &ChainConfig) -> Self {
        Self {
            config: config.clone(),
            losses: Losses::new(Schedule::new(config)),
            books: Books::default(),
            latencies: Latencies::new(&config.budget, config.run.speed),
            processes: Processes::default(),
            scoring: Scoring::new(config),
            progress: Progress::default(),
        }
    }

    /// Takes the next message; `recorded_ns` is the processing time at which it was recorded, 0 for one from a file.
    /// Gives the messages that are missing before it and of which no recorded gap tells.
    pub fn take(&mut self, message: RecordedRef<'_>, recorded_ns: u64) -> Option<Gap> {
        self.books.take(message);
        let Missing { gap, .. } = self.losses.take(message);
        match message {
            RecordedRef::Plots(header, plots) => {
                self.latencies.plots(header);
                self.scoring.plots(header, plots);
            }
            RecordedRef::Tracks(header, tracks) => {
                self.latencies.tracks(header, recorded_ns);
                self.scoring.tracks(header, tracks);
                self.progress.note(header);
            }
            RecordedRef::Truth(header, targets) => self.scoring.truth(header, targets),
            RecordedRef::HealthReports(_, reports) => reports.iter().for_each(|health| self.processes.take(health)),
            _ => {}
        }
        gap
    }

    /// Takes a gap from a file.
    pub fn take_gap(&mut self, gap: &Gap) {
        self.losses.announce(gap);
    }

    /// Notes that a new recorder takes over.
    pub fn rejoin(&mut self) {
        self.losses.rejoin();
    }

    /// What has been counted so far, for whoever goes on from here without the messages.
    pub fn counts(&self) -> String {
        let Self { losses, books, processes, progress, .. } = self;
        serde_json::to_string(&(losses, books, processes, progress)).unwrap_or_default()
    }

    /// Goes on from [`Fold::counts`]; what is not such a text changes nothing.
    pub fn restore(&mut self, counts: &str) {
        if let Some(counts) = read_counts(counts) {
            (self.losses, self.books, self.processes, self.progress) = counts;
        }
    }

    /// Writes latencies by interval to `log` from now on.
    pub fn log_latencies(&mut self, log: LatencyLog<File>) {
        self.latencies.log_to(log);
    }

    /// Closes the interval of the latencies' log if it is due.
    pub fn close_interval_if_due(&mut self) {
        self.latencies.close_interval(Duration::from_secs_f64(self.config.soak.interval_s));
    }

    /// Notes messages that were received but could not be written to the recording.
    pub fn not_written(&mut self, topic: Topic, count: u64) {
        self.losses.not_written(topic, count);
    }

    /// Scans that went through the whole chain.
    pub fn scans(&self) -> u64 {
        self.progress.scans
    }

    /// Messages received on a topic.
    pub fn received(&self, topic: Topic) -> u64 {
        self.losses.received(topic)
    }

    /// What has been received and missed on a topic.
    pub fn intake(&self, topic: Topic) -> Intake {
        self.losses.intake(topic)
    }

    /// Whether a message comes a second time.
    pub(crate) fn has_taken(&self, message: RecordedRef<'_>) -> bool {
        self.losses.has_taken(message)
    }

    /// p50, p99 and misses so far.
    pub fn latency_summaries(&self) -> [LatencySummary; LATENCIES] {
        self.latencies.summaries()
    }

    /// Whether every process upstream has said that it ended in order.
    pub fn all_ended(&self) -> bool {
        {
            let upstream = topology::stages(&self.config).into_iter().filter(|stage| !stage.is_of_chain());
            self.processes.have_ended(upstream.map(|stage| stage.name))
        }
    }

    /// The report of everything taken, and of what became of it in files.
    pub fn finish(mut self, files: Files) -> Report {
        self.latencies.close_interval(Duration::ZERO);
        let (detection, tracking) = self.scoring.finish();
        let [wall_s, measured_s] = self.progress.lengths_s();
        let loss = self.losses.lost(&self.books);
        let lossless = self.config.run.mode == Mode::Lossless;
        let whole = loss.values().flat_map(|consumers| consumers.values()).all(|&lost| lost == 0);
        Report {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION").to_string(),
            git: option_env!("RADAR_CHAIN_GIT").unwrap_or("unknown").to_string(),
            seed: self.config.run.seed,
            scans: self.progress.scans,
            wall_s,
            realtime_factor: if wall_s > 0.0 { measured_s / wall_s } else { 0.0 },
            comparable: lossless && whole && !self.losses.restarted() && !self.processes.restarted(),
            loss,
            messages: self.losses.messages(),
            latency_us: self.latencies.percentiles(),
            budget: self.latencies.budgets(),
            detection,
            tracking,
            books: self.books.balance(&self.losses),
            observers: self.processes.observers(),
            misses: self.latencies.misses(),
            soak: None,
            processes: self.processes.report(),
            recording: files.last,
            parts: files.parts,
            removed_recordings: files.removed,
            gaps: files.gaps,
            config: Some(self.config),
        }
    }
}

/// Counts that a recording holds; `None` if they are not of this version.
pub(crate) fn read_counts(text: &str) -> Option<(Losses, Books, Processes, Progress)> {
    serde_json::from_str(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::health::{Health, HealthHeader};
    use common::message::Stamps;

    /// A scan a second; the tracker is started again in the middle.
    fn take(fold: &mut Fold, seconds: std::ops::Range<u64>) {
        for second in seconds {
            let (flags, now_ns, session) = (END_OF_SCAN, second * 1_000_000_000, 1 + second / 5);
            let stamps = Stamps { source_out_ns: now_ns + 1, tracks_out_ns: now_ns + 2, ..Stamps::default() };
            let header =
                TracksHeader { seq: second, session, time_ns: now_ns, flags, stamps, ..TracksHeader::default() };
            fold.take(RecordedRef::Tracks(&header, &[]), 0);
            let mut health = Health { session, heartbeat_ns: now_ns, cpu_ns: 1_000_000_000, ..Health::default() };
            health.process = "tracker".into();
            fold.take(RecordedRef::HealthReports(&HealthHeader { session, seq: second }, &[health]), 0);
        }
    }

    #[test]
    fn who_goes_on_from_counts_reports_the_whole_run() {
        let chain = ChainConfig::default();
        let (mut alone, mut first, mut second) = (Fold::new(&chain), Fold::new(&chain), Fold::new(&chain));
        take(&mut alone, 0..10);
        take(&mut first, 0..7);
        second.restore(&first.counts());
        take(&mut second, 7..10);
        let [alone, second] = [alone, second].map(|fold| fold.finish(Files::default()));
        assert_eq!((alone.scans, alone.processes["tracker"].restarts, alone.comparable), (10, 1, false));
        assert!((alone.wall_s - 9.0).abs() < 1e-6 && (alone.processes["tracker"].cpu_s - 2.0).abs() < 1e-9);
        let counted = |report: &Report| {
            let books = serde_json::to_value((&report.processes, &report.books, &report.loss, &report.messages));
            (report.scans, report.wall_s, report.realtime_factor, report.comparable, books.expect("JSON"))
        };
        assert_eq!(counted(&alone), counted(&second));
    }
}
