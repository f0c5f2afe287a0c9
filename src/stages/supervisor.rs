//! Keeps the processes of a chain running and ends them in order.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Mode, Sites};
use common::health::Condition;
use common::process::{EXIT_BAD_USAGE, EXIT_FAILED};
use common::status::Board;
use common::time::monotonic_ns;
use common::topology::Role;
use rustix::process::Signal;

use super::name::StageId;
use super::orphans::{Orphans, find_started};
use super::resume::{TRACKS_PER_START, next_scan, note_tracker_start};
use super::stage::{Event, Stage};
use crate::watch::screen::Screen;

/// The processes of one chain.
pub(crate) struct Supervisor {
    sites: Sites,
    /// Effective configuration that the stages read.
    file: PathBuf,
    /// Downstream first.
    stages: Vec<Stage>,
    /// How each site ends, then the recorder, which serves all of them, and last the observers.
    endings: Vec<Ending>,
    /// Observers that have refused what is configured, by name.
    absent: Vec<String>,
}

/// How the stages of a site end.
#[derive(Debug, Default, Clone, Copy)]
struct Ending {
    /// When its source ended or was asked to.
    since: Option<Instant>,
    /// The stages have been asked to end, because the end of the stream has not reached them.
    told: bool,
    /// When those that did not end were killed, so that the recorder can still write its report.
    forced: Option<Instant>,
}

/// How long after the source the other stages end by themselves.
const LAST_MESSAGES: Duration = Duration::from_secs(3);
/// How long the recorder then has to close its file and write the report.
const LAST_REPORT: Duration = Duration::from_secs(10);
/// How long an observer has to go once everything else has ended.
const LAST_LOOK: Duration = Duration::from_secs(2);
/// A stage that has said nothing for so long may hang, or wait for one that does.
const SUSPICION: Duration = Duration::from_millis(1500);

/// How a supervised run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// All processes ended in order; whether one of them found something broken.
    Done { broken: bool },
    /// One cannot work with its input or configuration, or failed for good: this exit code.
    Failed(u8),
}

impl Supervisor {
    /// Starts all processes of a chain.
    pub(crate) fn start(sites: &Sites, file: PathBuf) -> anyhow::Result<Self> {
        let mut this = Self::new(sites, file, Vec::new());
        for id in StageId::all(sites) {
            match Stage::start(id, &this.file, &sites.first().supervision) {
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
    pub(crate) fn adopt(sites: &Sites, file: PathBuf, orphans: &Orphans) -> Self {
        let supervision = &sites.first().supervision;
        let adopted = |id: StageId| {
            let process = orphans.process(&id);
            Stage::adopt(id, process, supervision)
        };
        Self::new(sites, file, StageId::all(sites).into_iter().map(adopted).collect())
    }

    fn new(sites: &Sites, file: PathBuf, stages: Vec<Stage>) -> Self {
        let endings = vec![Ending::default(); sites.all().len() + 2];
        Self { sites: sites.clone(), file, stages, endings, absent: Vec::new() }
    }

    /// What is common to the chain.
    fn chain(&self) -> &ChainConfig {
        self.sites.first()
    }

    /// The processes that run now, upstream last: names and process identifiers.
    pub(crate) fn running(&self) -> impl Iterator<Item = (&StageId, u32)> {
        self.stages.iter().filter_map(|stage| Some((&stage.id, stage.running()?.0)))
    }

    /// How many processes the chain has.
    pub(crate) fn stages(&self) -> usize {
        self.stages.len()
    }

    /// Whether the sources of all sites have ended or been asked to.
    pub(crate) fn is_ending(&self) -> bool {
        self.of_sites().iter().all(|ending| ending.since.is_some())
    }

    /// Restarts so far of the processes that the results depend on.
    pub(crate) fn restarts(&self) -> u32 {
        self.stages.iter().filter(|stage| !stage.is_observer()).map(|stage| stage.restarts).sum()
    }

    /// Names of the observers without which the chain has gone on, because they have refused what is configured.
    pub(crate) fn absent(&self) -> &[String] {
        &self.absent
    }

    fn of_sites(&self) -> &[Ending] {
        &self.endings[..self.sites.all().len()]
    }

    /// Place of the ending of the recorder.
    fn last_report(&self) -> usize {
        self.sites.all().len()
    }

    /// Place of the ending of the observers.
    fn last_look(&self) -> usize {
        self.sites.all().len() + 1
    }

    /// Place of the ending of a stage.
    fn ending_of(&self, id: &StageId) -> usize {
        match id.stage.role {
            Role::Observer(_) => self.last_look(),
            Role::Recorder => self.last_report(),
            _ => id.site,
        }
    }

    /// Looks after the processes once; the end, if it has come.
    pub(crate) fn step(&mut self, board: &Board, screen: &mut Screen) -> anyhow::Result<Option<End>> {
        for index in 0..self.stages.len() {
            if let Some(end) = self.look_after(index, board, screen)? {
                return Ok(Some(end));
            }
        }
        let report = self.last_report();
        if self.is_ending() && self.endings[report].since.is_none() {
            self.endings[report].since = Some(Instant::now());
        }
        self.end_hung(board, screen);
        self.end_observers();
        if self.stages.iter().all(Stage::has_ended) {
            let broken = self.stages.iter().any(Stage::found_broken);
            return Ok(Some(End::Done { broken }));
        }
        for ending in 0..=report {
            self.hurry(ending, screen);
        }
        let late = |ending: &Ending| ending.forced.is_some_and(|since| since.elapsed() > LAST_REPORT);
        Ok(self.endings.iter().any(late).then_some(End::Failed(EXIT_FAILED)))
    }

    /// Looks after one process.
    fn look_after(&mut self, index: usize, board: &Board, screen: &mut Screen) -> anyhow::Result<Option<End>> {
        let id = self.stages[index].id.clone();
        let supervision = self.chain().supervision.clone();
        let (ending, is_observer) = (self.ending_of(&id), id.stage.is_observer());
        let said_end = id.health(board).is_some_and(|health| health.ended == 1);
        // A site whose plots come from a program of the user's ends with its first stage.
        let has_source = self.stages.iter().any(|stage| stage.id.site == id.site && stage.id.stage.is_source());
        let sets_pace = id.stage.is_source() || !has_source && id.stage.role == Role::Processor;
        match self.stages[index].look(&supervision, said_end)? {
            Event::Nothing => {}
            Event::Ended => {
                if sets_pace {
                    self.endings[ending].since.get_or_insert_with(Instant::now);
                }
            }
            Event::Refused if is_observer => {
                screen.say(&format!("the chain goes on without {id}"));
                self.absent.push(id.to_string());
            }
            Event::Refused => return Ok(Some(End::Failed(EXIT_BAD_USAGE))),
            Event::Died(signal) => {
                if id.stage.is_source() && said_end {
                    self.endings[ending].since.get_or_insert_with(Instant::now); // it had sent everything
                }
                let is_recorder = id.stage.role == Role::Recorder;
                if self.endings[ending].since.is_some() && !is_recorder {
                    // Nothing would tell a new one that it is the end.
                    if !id.stage.is_source() && !is_observer {
                        screen.say(&format!("{id} died while the chain was ending"));
                    }
                    self.stages[index].give_up();
                    return Ok(None);
                }
                let cause = signal.map_or("with an error".to_string(), |signal| format!("by signal {signal}"));
                let restarts = self.stages[index].restarts;
                if restarts >= supervision.max_restarts {
                    screen.say(&format!("{id} ended {cause}, after {restarts} restarts: giving up"));
                    if is_observer {
                        self.stages[index].give_up();
                        return Ok(None);
                    }
                    return Ok(Some(End::Failed(EXIT_FAILED)));
                }
                screen.say(&format!("{id} ended {cause}: starting it again"));
                // The end of the stream has passed a recorder that is started again now: it is told by a signal.
                self.endings[ending].told = false;
                self.endings[ending].since = self.endings[ending].since.map(|_| Instant::now());
            }
            Event::Due => {
                // One that a dead launcher has started and that was slow to say so: two of a stage would share its work.
                if find_started(&self.file, &id).is_some_and(|pid| self.stages[index].take_over(pid)) {
                    screen.say(&format!("{id} of the chain whose launcher has died: taken over"));
                    return Ok(None);
                }
                let overrides = self.resume_at(&self.stages[index], board);
                if let Err(error) = self.stages[index].restart(&self.file, &overrides) {
                    if self.stages[index].restarts >= supervision.max_restarts && !is_observer {
                        return Err(error);
                    }
                    screen.say(&format!("{error:#}: trying again"));
                }
            }
        }
        Ok(None)
    }

    /// Ends what does not end by itself after the end of its source.
    fn hurry(&mut self, ending: usize, screen: &mut Screen) {
        let Some(since) = self.endings[ending].since else { return };
        let of_ending: Vec<usize> =
            (0..self.stages.len()).filter(|&index| self.ending_of(&self.stages[index].id) == ending).collect();
        let source_ended = of_ending.iter().all(|&index| {
            let stage = &self.stages[index];
            !stage.id.stage.is_source() || stage.has_ended()
        });
        if source_ended && !self.endings[ending].told && since.elapsed() > LAST_MESSAGES {
            // The end of the stream has got lost on its way: they end when nobody is upstream.
            self.endings[ending].told = true;
            for &index in &of_ending {
                self.stages[index].signal(Signal::TERM);
            }
        }
        let drain_s = self.chain().supervision.drain_s;
        let drain = Duration::try_from_secs_f64(drain_s).unwrap_or(Duration::MAX);
        if self.endings[ending].forced.is_some() || since.elapsed() <= drain {
            return;
        }
        self.endings[ending].forced = Some(Instant::now());
        let told = self.endings[ending].told;
        for index in of_ending {
            let stage = &mut self.stages[index];
            if stage.has_ended() {
                continue;
            }
            screen.say(&format!("{} has not ended within {drain_s} s", stage.id));
            if !stage.id.stage.is_of_chain() {
                stage.kill();
            } else if !told {
                stage.signal(Signal::TERM); // a second one would end it at once
            }
        }
    }

    /// Ends the observers when everything else has ended. Nothing waits for them: one that does not go is killed.
    fn end_observers(&mut self) {
        if !self.stages.iter().filter(|stage| !stage.is_observer()).all(Stage::has_ended) {
            return;
        }
        let ending = self.last_look();
        let told = self.endings[ending].since.is_some();
        let since = *self.endings[ending].since.get_or_insert_with(Instant::now);
        for stage in self.stages.iter_mut().filter(|stage| stage.is_observer() && !stage.has_ended()) {
            if stage.running().is_none() {
                stage.give_up(); // it is not started again
            } else if !told {
                stage.signal(Signal::TERM);
            } else if since.elapsed() > LAST_LOOK {
                stage.kill();
            }
        }
    }

    /// Kills stages that hang, so that they are started again. In lossless mode a stage that waits for one downstream says
    /// nothing either: only one without a silent consumer can be the one that hangs, and once its consumers speak again it
    /// has as much time as they had. In real time a recorder that stands still keeps nobody waiting.
    fn end_hung(&mut self, board: &Board, screen: &mut Screen) {
        let now_ns = monotonic_ns();
        let silent = |stage: &Stage| {
            let (pid, since) = stage.running()?;
            let heard = stage.id.health(board).filter(|health| health.pid == pid);
            Some(heard.map_or(since, |health| Duration::from_nanos(now_ns.saturating_sub(health.heartbeat_ns))))
        };
        // A stage that is not running, or has not said anything yet, keeps those upstream waiting as well.
        let heard =
            |stage: &Stage| stage.id.health(board).map(|health| health.pid) == stage.running().map(|(pid, _)| pid);
        let is_held_up =
            |stage: &Stage| stage.id.health(board).is_some_and(|health| health.condition == Condition::HeldUp as u32);
        let waits = |stage: &Stage| silent(stage).is_none_or(|silent| silent > SUSPICION) || !heard(stage);
        let real_time = self.chain().run.mode == Mode::RealTime;
        let keeps_waiting = |consumer: &Stage, stage: &Stage| {
            let other = consumer.id.site != stage.id.site;
            let serves = consumer.id.stage.is_of_chain() || other == consumer.id.stage.reads_other_sites();
            let config = &self.sites.all()[stage.id.site];
            let reads = |topic| consumer.id.stage.requires(topic, config);
            serves
                && !(real_time && consumer.id.stage.role == Role::Recorder)
                && stage.id.stage.outputs.iter().any(|&topic| reads(topic))
                && !consumer.has_ended()
                && (waits(consumer) || is_held_up(consumer))
        };
        let suspects: Vec<bool> = self
            .stages
            .iter()
            .map(|stage| {
                let ends = self.endings[self.ending_of(&stage.id)].since.is_some();
                !ends && waits(stage) && !self.stages.iter().any(|consumer| keeps_waiting(consumer, stage))
            })
            .collect();
        let supervision = &self.sites.first().supervision;
        for (stage, is_suspect) in self.stages.iter_mut().zip(suspects) {
            if !is_suspect {
                stage.suspected = None;
                continue;
            }
            let since = *stage.suspected.get_or_insert_with(Instant::now);
            let is_recorder = stage.id.stage.role == Role::Recorder;
            let limit_s = if is_recorder { supervision.recorder_hang_s } else { supervision.hang_s };
            let limit = Duration::try_from_secs_f64(limit_s).unwrap_or(Duration::MAX);
            if let Some(silent) = silent(stage).filter(|&silent| limit_s > 0.0 && silent > limit)
                && since.elapsed() > limit.saturating_sub(SUSPICION).max(SUSPICION)
            {
                screen.say(&format!("{} has said nothing for {:.1} s: killing it", stage.id, silent.as_secs_f64()));
                stage.signal(Signal::KILL);
            }
        }
    }

    /// Where a restarted stage goes on: a source with the scan after the last one that
    /// any process has reported, a tracker or fusion with numbers that no track has had.
    fn resume_at(&self, stage: &Stage, board: &Board) -> Vec<String> {
        let config = &self.sites.all()[stage.id.site];
        let mut overrides = Vec::new();
        if stage.id.stage.is_source() {
            overrides.push(format!("run.first_scan={}", next_scan(board.at(stage.id.site), config)));
        }
        if [tracker::process::NAME, fusion::process::NAME].contains(&stage.id.process()) {
            let folder = self.file.parent().unwrap_or(Path::new("."));
            let starts = note_tracker_start(folder, &stage.id.label()).max(u64::from(stage.restarts) + 1);
            overrides.push(format!("run.first_track={}", config.run.first_track + TRACKS_PER_START * starts));
        }
        overrides
    }

    /// Asks the sources to end at the next sector; the others follow by themselves.
    pub(crate) fn stop(&mut self) {
        for site in 0..self.sites.all().len() {
            if self.endings[site].since.is_some() {
                continue;
            }
            self.endings[site].since = Some(Instant::now());
            for stage in self.stages.iter().filter(|stage| stage.id.site == site && stage.id.stage.is_source()) {
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
