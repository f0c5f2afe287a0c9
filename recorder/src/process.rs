//! The process `recorder`: takes everything, writes it, and makes the report.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::ChainConfig;
use common::ipc::{Flow, IpcError, Station, Subscriber, attend};
use common::latency_log::LatencyLog;
use common::message::END_OF_STREAM;
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::services::{ALL_TOPICS, Dwells, HealthReports, Plots, Topic, Tracks, Truth};
use common::time::monotonic_ns;
use tracing::{info, warn};

use crate::Fold;
use crate::parts::{PartWriter, Run, read_whole};

/// Name of the process.
pub const NAME: &str = "recorder";
/// What has been written is on the disk after this time at the latest.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);
/// How long the last words of the other processes are waited for after the end of the stream.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// Runs the process until the stream of tracks ends.
///
/// # Errors
/// Configuration, the recording's folder, or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let session = new_session();
    let refused = realtime::take(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    // Subscribed first: what arrives while an earlier part is read waits in the queues.
    let inputs = Inputs::new(&station, &chain)?;
    let mut recorder = Recorder::new(&chain, session)?;
    let wakes = [station.wake(Topic::Tracks)?, station.wake(Topic::Plots)?, station.wake(Topic::Dwells)?];
    let wakes: Vec<_> = wakes.iter().take(if chain.recorder.dwells { 3 } else { 2 }).collect();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;

    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        inputs.take_all(&mut recorder)?;
        recorder.flush_if_due();
        recorder.fold.close_interval_if_due();
        let flow = recorder.flow(inputs.tracks.publishers());
        if flow == Flow::End || reporter.is_due() {
            recorder.describe(&mut reporter.health);
            reporter.health.ended = u32::from(flow == Flow::End);
            reporter.publish()?;
        }
        Ok(flow)
    })?;
    inputs.take_all(&mut recorder)?; // its own last health
    recorder.finish()
}

/// All topics of the site.
struct Inputs {
    dwells: Option<Subscriber<Dwells>>,
    plots: Subscriber<Plots>,
    tracks: Subscriber<Tracks>,
    truth: Subscriber<Truth>,
    health: Subscriber<HealthReports>,
}

impl Inputs {
    fn new(station: &Station, chain: &ChainConfig) -> Result<Self, IpcError> {
        Ok(Self {
            dwells: chain.recorder.dwells.then(|| station.subscriber()).transpose()?,
            plots: station.subscriber()?,
            tracks: station.subscriber()?,
            truth: station.subscriber()?,
            health: station.subscriber()?,
        })
    }

    /// Takes everything that waits, causes before effects.
    fn take_all(&self, recorder: &mut Recorder) -> Result<(), IpcError> {
        while let Some(message) = self.truth.receive()? {
            recorder.take(RecordedRef::Truth(message.header(), message.elements()));
        }
        if let Some(dwells) = &self.dwells {
            while let Some(message) = dwells.receive()? {
                recorder.take(RecordedRef::Dwells(message.header(), message.elements()));
            }
        }
        while let Some(message) = self.plots.receive()? {
            recorder.take(RecordedRef::Plots(message.header(), message.elements()));
        }
        while let Some(message) = self.tracks.receive()? {
            recorder.ended |= message.header().has(END_OF_STREAM);
            recorder.take(RecordedRef::Tracks(message.header(), message.elements()));
        }
        while let Some(message) = self.health.receive()? {
            recorder.take(RecordedRef::Health(message.header(), message.elements()));
        }
        Ok(())
    }
}

/// The run as far as it is recorded.
struct Recorder {
    fold: Fold,
    writer: Option<PartWriter>,
    path: Option<PathBuf>,
    report: PathBuf,
    flushed: Instant,
    /// The recording failed and was given up.
    failed: bool,
    /// The tracker has published its last message.
    ended: bool,
    ended_at: Option<Instant>,
}

impl Recorder {
    /// Begins a file of the run. If the run has earlier files, its report covers them too.
    fn new(chain: &ChainConfig, session: u64) -> anyhow::Result<Self> {
        let id = if chain.run.id.is_empty() { (session / 1_000_000_000).to_string() } else { chain.run.id.clone() };
        let run = Run::new(chain, &id);
        let mut fold = Fold::new(chain);
        let earlier = if chain.recorder.record { run.earlier_parts() } else { Vec::new() };
        for part in &earlier {
            read_whole(part, |message| fold.take(message, 0)).map_err(|error| BadInput(error.to_string()))?;
            info!(part = %part.display(), "earlier part read");
        }
        if !chain.soak.log.is_empty() {
            let opened = File::options().create(true).append(true).open(&chain.soak.log).and_then(LatencyLog::begin);
            fold.log_latencies(
                opened.map_err(|error| BadInput(format!("log of latencies {}: {error}", chain.soak.log)))?,
            );
        }
        let description = Description {
            config: chain.to_toml(),
            version: env!("CARGO_PKG_VERSION").to_string(),
            seed: chain.run.seed,
            session,
            run: id,
            part: earlier.len() as u32,
        };
        let mut failed = false;
        let (path, writer) = if chain.recorder.record {
            match run.create_part(chain, &description) {
                Ok((path, writer)) => (Some(path), Some(writer)),
                Err(error) if earlier.is_empty() => return Err(BadInput(error.to_string()).into()),
                Err(error) => {
                    // In the middle of a run the chain is worth more than its recording.
                    warn!("nothing more is recorded, the chain goes on: {error}");
                    failed = true;
                    (None, None)
                }
            }
        } else {
            (None, None)
        };
        let report = PathBuf::from(&chain.recorder.report);
        let flushed = Instant::now();
        Ok(Self { fold, writer, path, report, flushed, failed, ended: false, ended_at: None })
    }

    /// Writes and folds one message. A failing disk ends the recording, never the chain.
    fn take(&mut self, message: RecordedRef<'_>) {
        if self.failed {
            self.fold.not_written(message.topic(), 1);
        }
        self.keep_writing(|writer| writer.write(message));
        self.fold.take(message, monotonic_ns());
    }

    fn flush_if_due(&mut self) {
        if self.flushed.elapsed() >= FLUSH_INTERVAL {
            self.flushed = Instant::now();
            self.keep_writing(PartWriter::flush);
        }
    }

    /// Does something with the recording, if there is one; it ends when that fails, and what
    /// was not in a whole chunk of it is lost.
    fn keep_writing(&mut self, write: impl FnOnce(&mut PartWriter) -> Result<(), RecordingError>) {
        let Some(writer) = &mut self.writer else { return };
        if let Err(error) = write(writer) {
            let path = self.path.as_deref().unwrap_or(Path::new("")).display();
            warn!("recording {path} ends here, the chain goes on: {error}");
            for (topic, count) in ALL_TOPICS.into_iter().zip(writer.unsaved()) {
                self.fold.not_written(topic, count);
            }
            self.writer = None;
            self.failed = true;
        }
    }

    /// The recorder ends when the tracker has, and everybody has had time for the last words;
    /// asked to stop, it waits only as long as somebody publishes tracks.
    fn flow(&mut self, publishers: usize) -> Flow {
        if self.ended {
            let ended_at = *self.ended_at.get_or_insert_with(Instant::now);
            let all_said = self.fold.all_ended() || ended_at.elapsed() > LAST_WORDS;
            return if all_said { Flow::End } else { Flow::Wait };
        }
        if stop_requested() && publishers == 0 { Flow::End } else { Flow::Wait }
    }

    fn describe(&self, health: &mut common::health::Health) {
        health.scan = self.fold.scans() as u32;
        for topic in ALL_TOPICS {
            health.intake[topic as usize] = self.fold.intake(topic);
        }
        health.latency = self.fold.latency_summaries();
    }

    /// Closes the recording and writes the report.
    fn finish(mut self) -> anyhow::Result<ExitCode> {
        self.keep_writing(PartWriter::flush);
        if let Some(Err(error)) = self.writer.take().map(PartWriter::finish) {
            warn!("the recording has no index: {error}");
        }
        let recording = self.path.map(|path| path.display().to_string());
        let report = self.fold.finish(recording);
        if let Some(folder) = self.report.parent() {
            std::fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
        }
        // Renamed into place: whoever waits for it finds it complete.
        let unfinished = self.report.with_extension("json.tmp");
        std::fs::write(&unfinished, report.to_json())
            .and_then(|()| std::fs::rename(&unfinished, &self.report))
            .with_context(|| format!("writing {}", self.report.display()))?;
        Ok(if self.failed { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
    }
}
