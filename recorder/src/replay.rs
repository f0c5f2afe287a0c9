//! Which recorded messages go out again, in which order and with what changed.
//!
//! A replay is a source: it gives its messages a session of its own, counts what it publishes, and marks the
//! last message as the end of the stream. Everything else is as recorded.

use std::collections::VecDeque;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use common::commands::Command;
use common::config::{self, ChainConfig, Mode, RecorderConfig, ReplayConfig, RunConfig, Source};
use common::message::{END_OF_STREAM, Lineage};
use common::recording::container::Reader;
use common::recording::{self, Messages, Recorded, RecordingError, parts_from};
use common::topic::Topic;
use common::topology::last_in_processing;

/// The recorded messages to publish, parts of a run after each other.
pub struct Playback {
    parts: VecDeque<PathBuf>,
    messages: Option<Messages>,
    topics: Vec<Topic>,
    /// Scans from the first to the last one, which is left out.
    scans: (u32, u32),
    sectors_per_scan: u64,
    /// The topic that drives the chain.
    driving: Topic,
    /// There were messages to drive the chain before these scans.
    passed: bool,
    ready: VecDeque<Recorded>,
}

impl Playback {
    /// The messages that `config` names, in the parts that there are now: a run that is still being recorded ends for the
    /// replay where it stands.
    ///
    /// # Errors
    /// The file cannot be opened or is not a recording.
    pub fn open(config: &ChainConfig) -> Result<Self, RecordingError> {
        let path = Path::new(&config.replay.file);
        drop(recording::open(path)?); // says what is wrong with the first one at once
        let last = if config.run.scans == 0 { u32::MAX } else { config.run.scans };
        Ok(Self {
            parts: parts_from(path).into(),
            messages: None,
            topics: config.replay.topics.clone(),
            scans: (config.run.first_scan, last),
            sectors_per_scan: config.sectors_per_scan().into(),
            driving: last_in_processing(&config.replay.topics),
            passed: false,
            ready: VecDeque::new(),
        })
    }

    /// Whether the recording has been gone through, but for nothing: a replay that is started again after its last scan.
    pub(crate) fn has_passed(&self) -> bool {
        self.passed
    }

    /// Whether a message is an action before plots of these scans.
    fn acts_within(&self, message: &Recorded) -> bool {
        let Recorded::Actions(_, actions) = message else { return false };
        let scan = |action: &Command| (action.before_seq / self.sectors_per_scan.max(1)) as u32;
        actions.first().is_some_and(|action| (self.scans.0..self.scans.1).contains(&scan(action)))
    }

    /// The next message that was asked for, in the order of the recording.
    pub(crate) fn read(&mut self) -> Result<Option<Recorded>, RecordingError> {
        loop {
            let Some(messages) = &mut self.messages else {
                let Some(part) = self.parts.pop_front() else { return Ok(None) };
                self.messages = Some(recording::open(&part)?);
                continue;
            };
            match messages.next().transpose()? {
                None => self.messages = None,
                Some(message) => {
                    let topic = message.by_ref().topic();
                    self.passed |= topic == self.driving && scan(&message).is_some_and(|scan| scan < self.scans.0);
                    let within = scan(&message).is_some_and(|scan| (self.scans.0..self.scans.1).contains(&scan));
                    // What operators did belongs to the tracks that are replayed, and to no scan.
                    let acted = self.topics.contains(&Topic::Tracks) && self.acts_within(&message);
                    if self.topics.contains(&topic) && within || acted {
                        return Ok(Some(message));
                    }
                }
            }
        }
    }
}

impl Iterator for Playback {
    type Item = Result<Recorded, RecordingError>;

    /// Reads ahead to the next message of the driving topic, to know which one is the last.
    fn next(&mut self) -> Option<Self::Item> {
        let drives = |message: &Recorded, topic| message.by_ref().topic() == topic;
        let mut waiting = self.ready.iter().filter(|message| drives(message, self.driving)).count();
        while waiting < 2 {
            match self.read() {
                Ok(Some(message)) => {
                    waiting += usize::from(drives(&message, self.driving));
                    self.ready.push_back(message);
                }
                Ok(None) => break,
                Err(error) => return Some(Err(error)),
            }
        }
        if waiting == 1 && self.ready.len() > 1 && self.ready.front().is_some_and(|first| drives(first, self.driving)) {
            self.ready.rotate_left(1); // nothing may follow the end of the stream
        }
        let mut message = self.ready.pop_front()?;
        if drives(&message, self.driving) {
            mark_end(&mut message, waiting == 1);
        }
        Some(Ok(message))
    }
}

impl std::fmt::Debug for Playback {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Playback").field("parts", &self.parts).field("scans", &self.scans).finish_non_exhaustive()
    }
}

/// Scan of a message; health has none.
fn scan(message: &Recorded) -> Option<u32> {
    message.by_ref().place().scan
}

fn mark_end(message: &mut Recorded, last: bool) {
    let flags = match message {
        Recorded::Dwells(header, _) => &mut header.flags,
        Recorded::Plots(header, _) => &mut header.flags,
        Recorded::Tracks(header, _) => &mut header.flags,
        _ => return,
    };
    *flags = *flags & !END_OF_STREAM | if last { END_OF_STREAM } else { 0 };
}

/// Lineage of a result that is published again: no process upstream, and counts of this session.
pub(crate) fn lineage_again(recorded: &Lineage, taken_in_session: &mut u64, published: u64) -> Lineage {
    *taken_in_session += recorded.taken;
    Lineage { session: 0, taken_in_session: *taken_in_session, published_before: published, ..*recorded }
}

/// The configuration of a replay of the recording `file`: that of the file `config`, or else that of the recorded run
/// (see [`recorded_config`]), with `overrides` applied.
///
/// # Errors
/// Those of [`recorded_config`] and [`config::load`].
pub fn replay_config(file: &Path, config: Option<&Path>, mut overrides: Vec<String>) -> anyhow::Result<ChainConfig> {
    let Some(config) = config else { return Ok(config::adjust(&recorded_config(file)?, &overrides)?) };
    let file = std::path::absolute(file)?;
    overrides.push("run.source=replay".to_string());
    overrides.push(format!("replay.file='''{}'''", file.display()));
    Ok(config::load(Some(config), &overrides)?)
}

/// The configuration of the recorded run, turned into one that replays it: what says what the radar sees and how it is
/// detected and tracked is from the recording `path`. Shared memory, realtime wishes, limits, metrics and logs belong to
/// the processes of that run and are as by default; recordings and report go to the folder `replay`, beside nothing of it.
///
/// # Errors
/// The file is not a recording, or holds no configuration that this version reads.
pub fn recorded_config(path: &Path) -> anyhow::Result<ChainConfig> {
    let opening = |cause| RecordingError::Open { path: path.to_path_buf(), cause };
    let bad = |error: &dyn std::fmt::Display| common::process::BadInput(error.to_string());
    drop(recording::open(path).map_err(|error| bad(&error))?);
    let file = File::open(path).map_err(opening)?;
    let text = Reader::new(BufReader::new(file)).description().map(|about| about.config.clone());
    let text = text.ok_or_else(|| bad(&format!("{} holds no configuration", path.display())))?;
    let recorded = config::parse(path, &text, &[])?;
    let file = std::path::absolute(path)?.display().to_string();
    Ok(as_replay(recorded, file))
}

/// The configuration of a run as that of a replay of its recording `file`.
fn as_replay(recorded: ChainConfig, file: String) -> ChainConfig {
    let ChainConfig { site, run, radar, sim, extractor, tracker, recorder, plot_source, replay, .. } = recorded;
    let of = if run.source == Source::Replay { replay.of } else { run.source };
    let topics = vec![if recorder.dwells { Topic::Dwells } else { Topic::Plots }, Topic::Truth];
    ChainConfig {
        run: RunConfig { source: Source::Replay, mode: Mode::Lossless, id: String::new(), ..run },
        recorder: RecorderConfig {
            directory: "replay".into(),
            report: "replay/report.json".into(),
            dwells: recorder.dwells,
            scoring: recorder.scoring,
            ..RecorderConfig::default()
        },
        replay: ReplayConfig { file, topics, of },
        site,
        radar,
        sim,
        extractor,
        tracker,
        plot_source,
        ..ChainConfig::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_replay_has_nothing_of_the_recorded_processes() {
        let settings = [
            "soak.log=/tmp/soak/latency.hlog",
            "metrics.listen=127.0.0.1:9464",
            "realtime.tracker.scheduling=fifo",
            "supervision.hang_s=77.0",
            "watchdog.slow_s=77.0",
            "budget.end_to_end.p99_us=77.0",
            "ipc.prefix=recorded",
            "run.id=recorded",
            "run.mode=real-time",
            "recorder.directory=recorded",
            "recorder.report=recorded.json",
            "recorder.record=false",
            "recorder.total_mib=77",
        ];
        let radar = ["run.seed=5", "extractor.pfa=1e-5", "radar.sectors_per_scan=8", "recorder.scoring.gate_m=50.0"];
        let config = |settings: &[&str]| {
            let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
            config::load(None, &settings).expect("valid")
        };
        let plain = as_replay(config(&radar), "a.mcap".into());
        assert_eq!((plain.run.seed, plain.radar.sectors_per_scan), (5, 8));
        assert_eq!(plain.recorder.scoring, config(&radar).recorder.scoring);
        for setting in settings {
            assert_eq!(as_replay(config(&[&radar[..], &[setting]].concat()), "a.mcap".into()), plain, "{setting}");
        }
        // A replay of a replay is one of the same source.
        assert_eq!(as_replay(plain.clone(), "a.mcap".into()), plain);
    }
}
