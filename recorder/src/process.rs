//! The process `recorder`: takes everything of all sites, writes it, and makes the report.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Sites};
use common::health::Health;
use common::ipc::{Flow, IpcError, Station, Subscriber, Turn, attend};
use common::latency_log::LatencyLog;
use common::message::END_OF_STREAM;
use common::messages::{ForTopic, Message};
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, StageArgs, new_session, say, stop_requested};
use common::realtime;
use common::recording::container::{Entry, Reader};
use common::recording::{Gap, RecordedRef, RecordingError};
use common::report::Report;
use common::time::{monotonic_ns, utc_compact};
use common::topic::Topic;
use common::topology::{self, RECORDER, Stage};
use tracing::{info, warn};

use crate::fold::{Files, Fold};
use crate::recording::{LISTED_GAPS, Recording};
use crate::report_place::{ReportPlace, report_beside};

/// Name of the process.
pub const NAME: &str = RECORDER;
/// Earlier parts up to this size together are read again by a recorder that was restarted.
const READ_AGAIN_BYTES: u64 = 64 << 20;
/// How long the last health reports of the other processes are waited for after the end of the stream.
const LAST_HEALTH: Duration = Duration::from_millis(500);

/// Runs the process until the tracks of all sites have ended.
///
/// # Errors
/// Configuration, the recording's folder, or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let sites = args.load_sites()?;
    let chain = sites.first();
    let session = new_session();
    let refused = realtime::apply(chain.realtime.of(NAME));
    let stations = stations(&sites)?;
    // Subscribed first: what arrives while an earlier part is read waits in the queues.
    let inputs = stations.iter().zip(sites.all()).map(|(station, site)| Inputs::new(station, site));
    let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    let mut recorders = Vec::with_capacity(inputs.len());
    let mut logs = sites.latency_logs().into_iter();
    for site in sites.all() {
        recorders.push(SiteRecorder::new(site, session, logs.next())?);
    }
    let place = ReportPlace::reserve(Path::new(&chain.recorder.report), &chain.ipc.prefix)?;
    let mut wakes = Vec::new();
    for (station, site) in stations.iter().zip(sites.all()) {
        wakes.extend(woken_by(site).into_iter().map(|topic| station.wake(topic)).collect::<Result<Vec<_>, _>>()?);
    }
    let wakes: Vec<_> = wakes.iter().collect();
    let mut reporters = Vec::with_capacity(inputs.len());
    for (station, site) in stations.iter().zip(sites.all()) {
        reporters.push(HealthReporter::new(station, site, session, refused)?);
    }

    attend(&wakes, &reporters[0].watchdog(), || -> anyhow::Result<Flow> {
        let mut all = true;
        for (input, recorder) in inputs.iter().zip(&mut recorders) {
            all &= input.record_waiting(recorder)?;
            recorder.keep_up();
            recorder.fold.close_interval_if_due();
        }
        let has_ended = |(recorder, input): (&mut SiteRecorder, &Inputs)| recorder.has_ended(input);
        let ended = recorders.iter_mut().zip(&inputs).map(has_ended).filter(|&ended| ended).count();
        let flow = match all {
            true if ended == recorders.len() => Flow::End,
            true => Flow::Wait,
            false => Flow::Again,
        };
        for ((reporter, recorder), input) in reporters.iter_mut().zip(&recorders).zip(&inputs) {
            if flow == Flow::End || reporter.is_due() {
                recorder.describe(input, &mut reporter.health);
                reporter.health.ended = u32::from(flow == Flow::End);
                reporter.publish()?;
            }
        }
        Ok(flow)
    })?;
    for (input, recorder) in inputs.iter().zip(&mut recorders) {
        input.record_waiting(recorder)?; // its own last health
    }
    let mut reports = Vec::with_capacity(recorders.len());
    let mut failed = false;
    for recorder in recorders {
        let (report, has_failed) = recorder.finish();
        failed |= has_failed;
        reports.push(report);
    }
    for report in &reports {
        keep_beside_recording(report);
    }
    let recordings: Vec<String> = reports.iter().filter_map(|report| report.recording.clone()).collect();
    place.write(reports, &sites)?;
    if chain.run.id.is_empty() {
        // Nobody else tells whoever has started it by hand.
        for recording in recordings {
            say(&format!("recorded to {recording}"));
        }
        say(&format!("report {}", chain.recorder.report));
    }
    Ok(if failed { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
}

/// Writes the report of a site beside its recording: the next run writes its own to the place of this one.
fn keep_beside_recording(report: &Report) {
    let Some(place) = report.recording.as_ref().and_then(|recording| report_beside(Path::new(recording))) else {
        return;
    };
    if let Err(error) = std::fs::write(&place, report.to_json()) {
        warn!("cannot write {}: {error}", place.display());
    }
}

/// The recorder's place at each site.
fn stations(sites: &Sites) -> Result<Vec<Station>, IpcError> {
    let first = Station::enter(NAME, sites.first())?;
    let others: Vec<Station> = sites.all()[1..].iter().map(|site| first.at(site)).collect();
    Ok(std::iter::once(first).chain(others).collect())
}

/// The topics of a site whose messages wake the recorder. Tracks follow all plots, so where a tracker runs the recorder takes
/// both with them: woken by plots it would compete with the tracker for a processor, and cost the extractor a system call.
fn woken_by(site: &ChainConfig) -> Vec<Topic> {
    let mut topics = vec![Topic::Tracks];
    topics.extend((!topology::runs(site, "tracker")).then_some(Topic::Plots));
    topics.extend(site.recorder.dwells.then_some(Topic::Dwells));
    topics
}

/// What the recorder reads of a site, in the order of the table of stages: causes before effects.
struct Inputs(Vec<Box<dyn Input>>);

/// One topic of a site.
trait Input {
    /// Records messages that wait, for a turn; whether that was all.
    fn record_waiting(&self, recorder: &mut SiteRecorder) -> Result<bool, IpcError>;

    fn topic(&self) -> Topic;

    /// Publishers of its messages.
    fn publishers(&self) -> usize;

    /// The most messages that one has found waiting before it since the last call.
    fn take_most_waiting(&self) -> Option<u32>;
}

impl<M: Message> Input for Subscriber<M> {
    fn record_waiting(&self, recorder: &mut SiteRecorder) -> Result<bool, IpcError> {
        let turn = Turn::begin();
        while !turn.is_over() {
            let Some(message) = self.receive()? else { return Ok(true) };
            recorder.record(M::borrowed(message.header(), message.elements()));
        }
        Ok(false)
    }

    fn topic(&self) -> Topic {
        M::TOPIC
    }

    fn publishers(&self) -> usize {
        Subscriber::publishers(self)
    }

    fn take_most_waiting(&self) -> Option<u32> {
        Subscriber::take_most_waiting(self)
    }
}

impl Inputs {
    fn new(station: &Station, site: &ChainConfig) -> Result<Self, IpcError> {
        struct Open<'a>(&'a Station);
        impl ForTopic for Open<'_> {
            type Out = Result<Box<dyn Input>, IpcError>;

            fn call<M: Message>(self) -> Self::Out {
                Ok(Box::new(self.0.subscriber::<M>()?))
            }
        }
        let topics = Stage::from_name(NAME).into_iter().flat_map(|stage| stage.inputs.iter().map(|input| input.topic));
        let recorded = topics.filter(|topic| !topic.is_bulk() || site.recorder.dwells);
        Ok(Self(recorded.map(|topic| topic.apply(Open(station))).collect::<Result<_, _>>()?))
    }

    fn record_waiting(&self, recorder: &mut SiteRecorder) -> Result<bool, IpcError> {
        let mut all = true;
        for input in &self.0 {
            all &= input.record_waiting(recorder)?;
        }
        Ok(all)
    }

    /// Processes that publish tracks.
    fn trackers(&self) -> usize {
        self.0.iter().filter(|input| input.topic() == Topic::Tracks).map(|input| input.publishers()).sum()
    }
}

/// The run of one site as far as it is recorded.
struct SiteRecorder {
    fold: Fold,
    /// None if no recording is wanted.
    recording: Option<Recording>,
    /// Gaps of a run that is not recorded.
    gaps: Vec<Gap>,
    /// The tracker has published its last message.
    ended: bool,
    ended_at: Option<Instant>,
}

impl SiteRecorder {
    /// Begins a file of the run. If the run has earlier files, its report covers them too.
    fn new(chain: &ChainConfig, session: u64, log: Option<String>) -> anyhow::Result<Self> {
        // Of a recorder that was started by hand.
        let by_hand = || format!("{}-{:03}", utc_compact(session / 1_000_000_000), session / 1_000_000 % 1000);
        let id = if chain.run.id.is_empty() { by_hand() } else { chain.run.id.clone() };
        let mut fold = Fold::new(chain);
        let mut recording = chain.recorder.record.then(|| Recording::new(chain, &id, session));
        if let Some(recording) = &mut recording {
            let earlier = recording.earlier_parts();
            read_again(&earlier, &mut fold, recording)?;
            if !earlier.is_empty() {
                fold.rejoin();
            }
            match recording.begin(&fold.counts()) {
                Err(error) if earlier.is_empty() => return Err(BadInput(error.to_string()).into()),
                // In the middle of a run the chain is worth more than its recording.
                Err(error) => recording.interrupt(&error),
                Ok(()) => {}
            }
        }
        // From here on: what was read again is in the log already.
        if let Some(log) = log {
            let opened = File::options().create(true).append(true).open(&log).and_then(LatencyLog::begin);
            let refuse = |error| BadInput(format!("log of latencies {log}: {error}"));
            fold.log_latencies(opened.map_err(refuse)?);
        }
        Ok(Self { fold, recording, gaps: Vec::new(), ended: false, ended_at: None })
    }

    fn record(&mut self, message: RecordedRef<'_>) {
        let recorded_ns = monotonic_ns();
        self.ended |= message.topic() == Topic::Tracks && message.place().flags & END_OF_STREAM != 0;
        // One that was started again is given the last actions once more.
        if message.topic() == Topic::Actions && self.fold.has_taken(message) {
            return;
        }
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

    /// Whether the site has ended: its tracker has, and every process has had time for its last health report; when
    /// asked to stop, whether nobody publishes tracks any more.
    fn has_ended(&mut self, inputs: &Inputs) -> bool {
        if self.ended {
            let ended_at = *self.ended_at.get_or_insert_with(Instant::now);
            return self.fold.all_ended() || ended_at.elapsed() > LAST_HEALTH;
        }
        stop_requested() && inputs.trackers() == 0
    }

    fn describe(&self, inputs: &Inputs, health: &mut Health) {
        health.scan = self.fold.scans() as u32;
        for input in &inputs.0 {
            let topic = input.topic();
            health.set_intake(topic, self.fold.intake(topic));
            health.set_waiting(topic, input.take_most_waiting());
        }
        health.latency = self.fold.latency_summaries();
    }

    /// Closes the recording; the report, and whether something could not be written.
    fn finish(mut self) -> (Report, bool) {
        let (mut files, mut failed) = (Files { gaps: self.gaps, ..Files::default() }, false);
        if let Some(mut recording) = self.recording {
            files = recording.finish(|| self.fold.counts());
            for gap in recording.take_unwritten() {
                self.fold.not_written(gap.topic, gap.count);
            }
            failed = recording.has_failed();
        }
        (self.fold.finish(files), failed)
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
