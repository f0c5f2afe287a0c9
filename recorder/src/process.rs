//! The process `recorder`: takes everything, writes it, and makes the report.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::ChainConfig;
use common::ipc::{Flow, IpcError, Received, Station, Subscriber, Turn, attend};
use common::latency_log::LatencyLog;
use common::message::END_OF_STREAM;
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, StageArgs, new_session, stop_requested};
use common::realtime;
use common::recording::container::{Entry, Reader};
use common::recording::{Gap, RecordedRef, RecordingError};
use common::services::{ALL_TOPICS, Dwells, HealthReports, Message, Plots, Topic, Tracks, Truth};
use common::time::monotonic_ns;
use tracing::{info, warn};

use crate::fold::{Files, Fold};
use crate::recording::{LISTED_GAPS, Recording};
use crate::report_place::ReportPlace;

/// Name of the process.
pub const NAME: &str = "recorder";
/// Earlier parts up to this size together are read again by a recorder that was restarted.
const READ_AGAIN_BYTES: u64 = 64 << 20;
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
    let wakes = woken_by(&chain).into_iter().map(|topic| station.wake(topic)).collect::<Result<Vec<_>, _>>()?;
    let wakes: Vec<_> = wakes.iter().collect();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;

    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let all = inputs.take_all(&mut recorder)?;
        recorder.keep_up();
        recorder.fold.close_interval_if_due();
        let flow = if all { recorder.flow(inputs.tracks.publishers()) } else { Flow::Again };
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

/// The topics whose messages wake the recorder. Tracks follow all plots, so where a tracker runs the recorder takes both
/// with them: woken by plots it would be in the tracker's way for a processor, and cost the extractor a call of the system.
fn woken_by(chain: &ChainConfig) -> Vec<Topic> {
    let mut topics = vec![Topic::Tracks];
    topics.extend((!chain.upstream_of_recorder().contains(&"tracker")).then_some(Topic::Plots));
    topics.extend(chain.recorder.dwells.then_some(Topic::Dwells));
    topics
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

    /// Takes what waits, causes before effects; whether that was all.
    fn take_all(&self, recorder: &mut Recorder) -> Result<bool, IpcError> {
        let mut all = take(&self.truth, |message| {
            recorder.take(RecordedRef::Truth(message.header(), message.elements()));
        })?;
        if let Some(dwells) = &self.dwells {
            all &= take(dwells, |message| {
                recorder.take(RecordedRef::Dwells(message.header(), message.elements()));
            })?;
        }
        all &= take(&self.plots, |message| {
            recorder.take(RecordedRef::Plots(message.header(), message.elements()));
        })?;
        all &= take(&self.tracks, |message| {
            recorder.ended |= message.header().has(END_OF_STREAM);
            recorder.take(RecordedRef::Tracks(message.header(), message.elements()));
        })?;
        all &= take(&self.health, |message| {
            recorder.take(RecordedRef::Health(message.header(), message.elements()));
        })?;
        Ok(all)
    }
}

/// Takes the messages of one topic for a turn; whether that was all.
fn take<M: Message>(topic: &Subscriber<M>, mut note: impl FnMut(&Received<M>)) -> Result<bool, IpcError> {
    let turn = Turn::begin();
    while !turn.is_over() {
        let Some(message) = topic.receive()? else { return Ok(true) };
        note(&message);
    }
    Ok(false)
}

/// The run as far as it is recorded.
struct Recorder {
    fold: Fold,
    /// None if no recording is wanted.
    recording: Option<Recording>,
    /// Gaps of a run that is not recorded.
    gaps: Vec<Gap>,
    place: ReportPlace,
    /// The tracker has published its last message.
    ended: bool,
    ended_at: Option<Instant>,
}

impl Recorder {
    /// Begins a file of the run. If the run has earlier files, its report covers them too.
    fn new(chain: &ChainConfig, session: u64) -> anyhow::Result<Self> {
        let id = if chain.run.id.is_empty() { (session / 1_000_000_000).to_string() } else { chain.run.id.clone() };
        let mut fold = Fold::new(chain);
        let mut recording = chain.recorder.record.then(|| Recording::new(chain, &id, session));
        if let Some(recording) = &mut recording {
            let earlier = recording.earlier_parts();
            read_again(&earlier, &mut fold, recording)?;
            fold.rejoin();
            match recording.begin(&fold.counts()) {
                Err(error) if earlier.is_empty() => return Err(BadInput(error.to_string()).into()),
                // In the middle of a run the chain is worth more than its recording.
                Err(error) => recording.interrupt(&error),
                Ok(()) => {}
            }
        }
        // From here on: what was read again is in the log already.
        if !chain.soak.log.is_empty() {
            let opened = File::options().create(true).append(true).open(&chain.soak.log).and_then(LatencyLog::begin);
            let refuse = |error| BadInput(format!("log of latencies {}: {error}", chain.soak.log));
            fold.log_latencies(opened.map_err(refuse)?);
        }
        let place = ReportPlace::reserve(Path::new(&chain.recorder.report), &chain.ipc.prefix)?;
        Ok(Self { fold, recording, gaps: Vec::new(), place, ended: false, ended_at: None })
    }

    fn take(&mut self, message: RecordedRef<'_>) {
        let recorded_ns = monotonic_ns();
        self.keep_up(); // before the message is counted
        let gap = self.fold.take(message, recorded_ns);
        let Some(recording) = &mut self.recording else {
            let room = LISTED_GAPS - self.gaps.len();
            self.gaps.extend(gap.into_iter().take(room));
            return;
        };
        if let Some(gap) = gap {
            recording.write_gap(gap);
        }
        recording.write(message);
        for gap in recording.take_unwritten() {
            self.fold.not_written(gap.topic, gap.count);
        }
    }

    /// Does with the files what is due.
    fn keep_up(&mut self) {
        if let Some(recording) = &mut self.recording {
            recording.keep_up(|| self.fold.counts());
            for gap in recording.take_unwritten() {
                self.fold.not_written(gap.topic, gap.count);
            }
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
        let (mut files, mut failed) = (Files { gaps: self.gaps, ..Files::default() }, false);
        if let Some(mut recording) = self.recording {
            files = recording.finish(|| self.fold.counts());
            for gap in recording.take_unwritten() {
                self.fold.not_written(gap.topic, gap.count);
            }
            failed = recording.has_failed();
        }
        self.place.write(&self.fold.finish(files))?;
        Ok(if failed { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
    }
}

/// Reads the earlier parts of a run into its report: the newest ones, so that the chain need not wait for
/// hours of recording; of older ones only what they had counted.
fn read_again(parts: &[PathBuf], fold: &mut Fold, recording: &mut Recording) -> anyhow::Result<()> {
    let size = |part: &PathBuf| std::fs::metadata(part).map_or(0, |about| about.len());
    let mut bytes = 0;
    let newest = parts.iter().rev().take_while(|part| {
        bytes += size(part);
        bytes <= READ_AGAIN_BYTES
    });
    let first = parts.len() - newest.count().max(1).min(parts.len());
    for (index, part) in parts.iter().enumerate().skip(first) {
        let open = |cause| RecordingError::Open { path: part.clone(), cause };
        let file = File::open(part).map_err(open).map_err(|error| BadInput(error.to_string()))?;
        let mut reader = Reader::ahead(BufReader::with_capacity(1 << 20, file));
        if index == first
            && let Some(counts) = reader.counts()
        {
            fold.restore(counts);
        }
        // A file that is cut or damaged ends there.
        while let Some(Ok(entry)) = reader.next_entry() {
            match entry {
                Entry::Message(message) => drop(fold.take(message.by_ref(), 0)),
                Entry::Gap(gap) => {
                    fold.take_gap(&gap);
                    recording.list(&gap);
                }
            }
        }
        info!(part = %part.display(), "earlier part read");
    }
    if first > 0 {
        warn!("latencies and scores of the report begin with {}", parts[first].display());
    }
    Ok(())
}
