//! Keeps the processes of a chain running and ends them in order.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Mode};
use common::process::{EXIT_BAD_USAGE, EXIT_FAILED};
use common::time::monotonic_ns;
use rustix::process::Signal;

use crate::board::Board;
use crate::orphans::Orphans;
use crate::screen::Screen;
use crate::stage::{Event, Stage, StageName};

/// The processes of one chain.
pub(crate) struct Supervisor {
    chain: ChainConfig,
    /// Effective configuration that the stages read.
    file: PathBuf,
    stages: Vec<Stage>,
    /// When the source ended or was asked to.
    ending_since: Option<Instant>,
    /// The stages have been asked to end, because the end of the stream has not reached them.
    told: bool,
    /// When those that did not end were killed, so that the recorder can still close the books.
    forced: Option<Instant>,
    /// The stage that may hang, and since when it is the one.
    suspect: Option<(StageName, Instant)>,
}

/// How long after the source the other stages end by themselves.
const LAST_WORDS: Duration = Duration::from_secs(3);

/// How long the recorder then has to close its file and write the report.
const LAST_BOOKS: Duration = Duration::from_secs(10);

/// A stage that has said nothing for so long may hang, or wait for one that does.
const SUSPECT: Duration = Duration::from_millis(1500);

/// How a supervised run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// All processes ended in order; whether one of them found something broken.
    Done { broken: bool },
    /// One cannot work with its input or configuration, or failed for good: this exit code.
    Failed(u8),
}

impl Supervisor {
    /// Starts all processes of `chain`.
    pub(crate) fn start(chain: &ChainConfig, file: PathBuf) -> anyhow::Result<Self> {
        let mut this = Self::of(chain, file, Vec::new());
        for name in StageName::of(chain) {
            match Stage::start(name, &this.file, &chain.supervision) {
                Ok(stage) => this.stages.push(stage),
                Err(error) => {
                    this.kill_all();
                    return Err(error);
                }
            }
        }
        Ok(this)
    }

    /// Takes over the processes that a dead launcher has left, and starts those that are missing.
    pub(crate) fn adopt(chain: &ChainConfig, file: PathBuf, orphans: &Orphans) -> Self {
        let adopted = |name| Stage::adopt(name, orphans.process(name), &chain.supervision);
        Self::of(chain, file, StageName::of(chain).into_iter().map(adopted).collect())
    }

    fn of(chain: &ChainConfig, file: PathBuf, stages: Vec<Stage>) -> Self {
        Self { chain: chain.clone(), file, stages, ending_since: None, told: false, forced: None, suspect: None }
    }

    /// The processes that run now, upstream last: names and process identifiers.
    pub(crate) fn running(&self) -> impl Iterator<Item = (StageName, u32)> {
        self.stages.iter().filter_map(|stage| Some((stage.name, stage.running()?.0)))
    }

    /// How many processes the chain has.
    pub(crate) fn stages(&self) -> usize {
        self.stages.len()
    }

    /// Whether the source has ended or been asked to.
    pub(crate) fn is_ending(&self) -> bool {
        self.ending_since.is_some()
    }

    /// Restarts of a process so far.
    pub(crate) fn restarts(&self) -> u32 {
        self.stages.iter().map(|stage| stage.restarts).sum()
    }

    /// Looks after the processes once; the end, if it has come.
    pub(crate) fn step(&mut self, board: &Board, screen: &mut Screen) -> anyhow::Result<Option<End>> {
        for index in 0..self.stages.len() {
            let name = self.stages[index].name;
            let said_end = board.of(name.name()).is_some_and(|health| health.ended == 1);
            match self.stages[index].look(&self.chain.supervision, said_end)? {
                Event::Nothing => {}
                Event::Ended => {
                    if name.is_source() {
                        self.ending_since.get_or_insert_with(Instant::now);
                    }
                }
                Event::Refused => return Ok(Some(End::Failed(EXIT_BAD_USAGE))),
                Event::Died(signal) => {
                    if name.is_source() && said_end {
                        self.ending_since.get_or_insert_with(Instant::now); // it had sent everything
                    }
                    if self.ending_since.is_some() {
                        // Nothing would tell a new one that it is the end.
                        if !name.is_source() {
                            screen.say(&format!("{} died while the chain was ending", name.name()));
                        }
                        self.stages[index].give_up();
                        continue;
                    }
                    let cause = signal.map_or("with an error".to_string(), |signal| format!("by signal {signal}"));
                    if self.stages[index].restarts >= self.chain.supervision.max_restarts {
                        screen.say(&format!(
                            "{} ended {cause}, after {} restarts: giving up",
                            name.name(),
                            self.stages[index].restarts
                        ));
                        return Ok(Some(End::Failed(EXIT_FAILED)));
                    }
                    screen.say(&format!("{} ended {cause}: starting it again", name.name()));
                }
                Event::Due => {
                    let overrides = self.resume_at(&self.stages[index], board);
                    if let Err(error) = self.stages[index].restart(&self.file, &overrides) {
                        if self.stages[index].restarts >= self.chain.supervision.max_restarts {
                            return Err(error);
                        }
                        screen.say(&format!("{error:#}: trying again"));
                    }
                }
            }
        }
        self.end_hung(board, screen);
        if self.stages.iter().all(Stage::has_ended) {
            let broken = self.stages.iter().any(Stage::found_broken);
            return Ok(Some(End::Done { broken }));
        }
        let source_ended = self.stages.iter().all(|stage| !stage.name.is_source() || stage.has_ended());
        if source_ended && !self.told && self.ending_since.is_some_and(|since| since.elapsed() > LAST_WORDS) {
            // The end of the stream has got lost on its way: they end when nobody is upstream.
            self.told = true;
            for stage in &self.stages {
                stage.signal(Signal::TERM);
            }
        }
        let drain = Duration::from_secs_f64(self.chain.supervision.drain_s);
        if self.forced.is_none() && self.ending_since.is_some_and(|since| since.elapsed() > drain) {
            self.forced = Some(Instant::now());
            for stage in self.stages.iter_mut().filter(|stage| !stage.has_ended()) {
                screen.say(&format!("{} has not ended within {} s", stage.name.name(), self.chain.supervision.drain_s));
                if stage.name == StageName::Recorder {
                    if !self.told {
                        stage.signal(Signal::TERM); // a second one would end it at once
                    }
                } else {
                    stage.kill();
                }
            }
        }
        Ok(self.forced.filter(|since| since.elapsed() > LAST_BOOKS).map(|_| End::Failed(EXIT_FAILED)))
    }

    /// Kills the stage that hangs, so that it is started again. In lossless mode a stage that waits for one downstream
    /// says nothing either: only the most downstream of the silent ones can be the one that hangs, and once it speaks
    /// again the next has as much time as it had. In real time nobody waits, and a recorder that stands still hides nobody.
    fn end_hung(&mut self, board: &Board, screen: &mut Screen) {
        if self.ending_since.is_some() {
            return;
        }
        let now_ns = monotonic_ns();
        let silent = |stage: &Stage| {
            let (pid, since) = stage.running()?;
            let heard = board.of(stage.name.name()).filter(|health| health.pid == pid);
            Some(heard.map_or(since, |health| Duration::from_nanos(now_ns.saturating_sub(health.heartbeat_ns))))
        };
        // A stage that is not running, or has not said anything yet, keeps those upstream waiting as well.
        let heard =
            |stage: &Stage| board.of(stage.name.name()).map(|health| health.pid) == stage.running().map(|(pid, _)| pid);
        let waits = |stage: &&Stage| silent(stage).is_none_or(|silent| silent > SUSPECT) || !heard(stage);
        let real_time = self.chain.run.mode == Mode::RealTime;
        let suspects = |stage: &&Stage| waits(stage) && !(real_time && stage.name == StageName::Recorder);
        let upstream = self.stages.iter().find(suspects);
        let Some(suspect) = upstream.or_else(|| self.stages.iter().find(waits)) else {
            self.suspect = None;
            return;
        };
        let (name, supervision) = (suspect.name, &self.chain.supervision);
        let since = match self.suspect {
            Some((suspected, since)) if suspected == name => since,
            _ => self.suspect.insert((name, Instant::now())).1,
        };
        let limit_s = if name == StageName::Recorder { supervision.recorder_hang_s } else { supervision.hang_s };
        let limit = Duration::from_secs_f64(limit_s);
        if let Some(silent) = silent(suspect).filter(|&silent| limit_s > 0.0 && silent > limit)
            && since.elapsed() > limit.saturating_sub(SUSPECT).max(SUSPECT)
        {
            screen.say(&format!("{} has said nothing for {:.1} s: killing it", name.name(), silent.as_secs_f64()));
            suspect.signal(Signal::KILL);
        }
    }

    /// Where a restarted stage goes on: a source with the scan after the last one that
    /// anybody has seen, a tracker with numbers that no track has had.
    fn resume_at(&self, stage: &Stage, board: &Board) -> Vec<String> {
        if stage.name.is_source() {
            vec![format!("run.first_scan={}", next_scan(board, &self.chain))]
        } else if stage.name == StageName::Tracker {
            let starts =
                note_tracker_start(self.file.parent().unwrap_or(Path::new("."))).max(u64::from(stage.restarts) + 1);
            vec![format!("run.first_track={}", self.chain.run.first_track + TRACKS_PER_START * starts)]
        } else {
            Vec::new()
        }
    }

    /// Asks the source to end at the next sector; the others follow by themselves.
    pub(crate) fn stop(&mut self) {
        if self.ending_since.is_none() {
            self.ending_since = Some(Instant::now());
            for stage in self.stages.iter().filter(|stage| stage.name.is_source()) {
                stage.signal(Signal::TERM);
            }
        }
    }

    /// Ends all processes at once.
    pub(crate) fn kill_all(&mut self) {
        for stage in &mut self.stages {
            stage.kill();
        }
    }
}

/// Tracks of a tracker that was started again are numbered from so many further up.
pub(crate) const TRACKS_PER_START: u64 = 1_000_000;
/// How often trackers of the run were started again, by this launcher and those before it.
const TRACKER_STARTS: &str = "tracker-starts";

/// Notes in the folder of the domain that a tracker is started again; how often that has been.
fn note_tracker_start(folder: &Path) -> u64 {
    let file = folder.join(TRACKER_STARTS);
    let before: u64 = std::fs::read_to_string(&file).ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    // Where it cannot be written, this launcher's own count is still right for its own restarts.
    let _ = std::fs::write(&file, (before + 1).to_string());
    before + 1
}

/// The scan after the last one that anybody has seen.
pub(crate) fn next_scan(board: &Board, chain: &ChainConfig) -> u32 {
    // The recorder counts scans that are over.
    let stages = board.all().filter(|&(name, ..)| name != StageName::Recorder.name());
    let at_work = stages.filter(|(_, health, _)| health.messages_out > 0 || health.scan > 0);
    let seen = at_work.map(|(_, health, _)| health.scan).max();
    seen.map_or(chain.run.first_scan, |scan| scan + 1)
}
