//! `radar-chain chaos`: kills random stages at random times and checks that every lost message is counted.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use chacha20::ChaCha8Rng;
use common::config::{ChainConfig, Sites, Speed};
use common::ipc::Domain;
use common::process::{EXIT_CHECK_BROKEN, print};
use common::random::{Purpose, generator};
use common::report::{Book, ChainReport};
use common::topic::Topic;
use common::topology::Role;
use rand::RngExt;
use rustix::process::{Pid, Signal, kill_process};

use crate::claim::Claim;
use crate::run::{Companion, launch};
use crate::stages::name::StageId;
use crate::stages::supervisor::Supervisor;
use crate::watch::screen::Screen;
use common::status::Board;

/// Scans within which a stage has to be back.
const BACK_WITHIN: f64 = 2.0;
/// The chain is left alone for up to so many scans between a return and the next kill.
const REST_SCANS: f64 = 1.0;
/// A stage that is not back after this time never will be.
const RETURN_TIMEOUT: Duration = Duration::from_secs(60);

/// Kills, checks, and says what was found.
pub(crate) fn chaos(mut sites: Sites, kills: u32) -> anyhow::Result<ExitCode> {
    sites.change(|site| {
        site.run.scans = 0; // it ends after the last kill
        site.display.enabled = false; // nobody looks on
    });
    let chain = sites.first();
    let scan_s = sites.all().iter().map(scan_seconds).fold(0.0, f64::max);
    let mut monkey = Monkey {
        rng: generator(chain.run.seed, Purpose::Chaos, 0, 0),
        scan_s,
        left: kills,
        state: State::Resting { until: None },
        returns: Vec::new(),
    };
    let ipc = chain.ipc.clone();
    let outcome = match launch(&Claim::lock_domain(&ipc)?, sites, &mut monkey)? {
        Ok(outcome) => outcome,
        Err(code) => return Ok(code),
    };
    let mut findings = monkey.findings(kills);
    print(&monkey.table());
    print(&books_table(&outcome.report));
    let reports = outcome.report.sites();
    let books = reports.iter().flat_map(|(_, report)| &report.books);
    findings.extend(books.filter(|book| !book.balances()).map(unbalanced));
    findings.extend(reports.iter().flat_map(|(_, report)| contradictions(&report.books)));
    findings.extend(Domain::remains(&ipc).into_iter().map(|file| format!("left behind: {file}")));
    let parts = reports.iter().filter_map(|(_, report)| report.recording.as_ref());
    findings.extend(parts.flat_map(|part| recordings(Path::new(part))));
    for finding in &findings {
        print(&format!("BROKEN {finding}\n"));
    }
    if findings.is_empty() {
        print(&format!(
            "\n{kills} kills: every stage came back within {BACK_WITHIN} scans, all losses are counted, no files are left\n"
        ));
        Ok(ExitCode::SUCCESS)
    } else {
        Ok(ExitCode::from(EXIT_CHECK_BROKEN))
    }
}

/// Topics of which the books of two consumers say that different numbers were sent.
fn contradictions(books: &[Book]) -> impl Iterator<Item = String> {
    let pairs =
        books.iter().enumerate().flat_map(|(place, book)| books[..place].iter().map(move |other| (other, book)));
    pairs.filter(|(a, b)| a.topic == b.topic && a.sent != b.sent).map(|(a, b)| {
        format!("{} sent: {} as {} has it, {} as {} has it", a.topic, a.sent, a.consumer, b.sent, b.consumer)
    })
}

/// Length of a scan in processing time, s.
fn scan_seconds(chain: &ChainConfig) -> f64 {
    match chain.run.speed {
        Speed::Times(factor) => chain.scan_period_s() / factor,
        Speed::Max => chain.scan_period_s(),
    }
}

/// Kills one stage after another.
struct Monkey {
    rng: ChaCha8Rng,
    scan_s: f64,
    left: u32,
    state: State,
    returns: Vec<Return>,
}

enum State {
    /// The chain works; the next kill comes then.
    Resting { until: Option<Instant> },
    /// A stage was killed and is not back yet.
    Waiting { stage: StageId, pid: u32, killed: Instant },
    /// All has been done.
    Done,
}

/// A stage that came back.
struct Return {
    stage: StageId,
    after_s: f64,
}

impl Companion for Monkey {
    fn look(&mut self, board: &Board, supervisor: &mut Supervisor, screen: &mut Screen) -> anyhow::Result<()> {
        match &self.state {
            State::Done => {}
            State::Waiting { stage, pid, killed } => {
                let back = stage.health(board).is_some_and(|health| health.pid != *pid && works(stage, health));
                if back {
                    self.returns.push(Return { stage: stage.clone(), after_s: killed.elapsed().as_secs_f64() });
                    self.state = State::Resting { until: None };
                } else if killed.elapsed() > RETURN_TIMEOUT {
                    self.left = 0;
                    self.state = State::Done;
                    supervisor.stop();
                }
            }
            State::Resting { until: None } => {
                let running: Vec<(&StageId, u32)> = supervisor.running().collect();
                let at_work = |&(stage, pid): &(&StageId, u32)| {
                    stage.health(board).is_some_and(|health| health.pid == pid && works(stage, health))
                };
                if running.len() == supervisor.stages() && running.iter().all(at_work) {
                    // At least one scan at the end, so that all is seen to work on.
                    let scans = if self.left == 0 { REST_SCANS } else { self.rng.random_range(0.0..REST_SCANS) };
                    self.state =
                        State::Resting { until: Some(Instant::now() + Duration::from_secs_f64(scans * self.scan_s)) };
                }
            }
            State::Resting { until: Some(until) } if Instant::now() < *until => {}
            State::Resting { .. } if self.left == 0 => {
                self.state = State::Done;
                supervisor.stop();
            }
            State::Resting { .. } => {
                let running: Vec<(&StageId, u32)> = supervisor.running().collect();
                let (stage, pid) = running[self.rng.random_range(0..running.len())];
                self.left -= 1;
                screen.say(&format!("chaos: killing {stage} ({} left)", self.left));
                if let Some(process) = Pid::from_raw(pid.cast_signed()) {
                    let _ = kill_process(process, Signal::KILL);
                }
                self.state = State::Waiting { stage: stage.clone(), pid, killed: Instant::now() };
            }
        }
        Ok(())
    }
}

/// Whether a process does its work: it publishes, or receives what it is to record or to show.
fn works(stage: &StageId, health: &common::health::Health) -> bool {
    let received = health.intake(Topic::Tracks).received;
    let takes = matches!(stage.stage.role, Role::Recorder | Role::Observer(_));
    health.ended == 0 && if takes { received > 0 } else { health.messages_out > 0 }
}

impl Monkey {
    /// Returns by stage.
    fn table(&self) -> String {
        let mut text = format!("\n{:<16}{:>7}{:>14}{:>14}\n", "stage", "kills", "back, median", "slowest");
        let mut stages: Vec<String> = self.returns.iter().map(|back| back.stage.label()).collect();
        stages.sort_unstable();
        stages.dedup();
        for stage in stages {
            let mut times: Vec<f64> = self
                .returns
                .iter()
                .filter(|back| back.stage.label() == stage)
                .map(|back| back.after_s / self.scan_s)
                .collect();
            times.sort_by(f64::total_cmp);
            let (count, median, slowest) = (times.len(), times[times.len() / 2], times[times.len() - 1]);
            let _ = writeln!(text, "{stage:<16}{count:>7}{median:>8.2} scans{slowest:>8.2} scans");
        }
        text
    }

    fn findings(&self, kills: u32) -> Vec<String> {
        let mut findings = Vec::new();
        if self.returns.len() < kills as usize {
            findings.push(format!("the chain did not recover after {} of {kills} kills", self.returns.len()));
        }
        for back in self.returns.iter().filter(|back| back.after_s > BACK_WITHIN * self.scan_s) {
            let scans = back.after_s / self.scan_s;
            findings.push(format!("{} was back after {scans:.1} scans, {BACK_WITHIN} allowed", back.stage));
        }
        findings
    }
}

/// The books for a terminal.
fn books_table(report: &ChainReport) -> String {
    let mut text = String::new();
    for (site, report) in report.sites() {
        let _ =
            writeln!(text, "\n{:<10}{:<16}{:>12}{:>12}{:>10}  {site}", "topic", "consumer", "sent", "received", "lost");
        for Book { topic, consumer, sent, received, lost } in &report.books {
            let _ = writeln!(text, "{topic:<10}{consumer:<16}{sent:>12}{received:>12}{lost:>10}");
        }
    }
    text
}

fn unbalanced(book: &Book) -> String {
    let Book { topic, consumer, sent, received, lost } = book;
    format!("counts of {topic} at {consumer} do not balance: {received} received + {lost} lost, {sent} sent")
}

/// What is wrong with the parts of the run whose last one is `part`.
fn recordings(part: &Path) -> Vec<String> {
    let parts = common::recording::parts_of_run(part);
    let mut verification = recorder::verify::Verification::default();
    for path in &parts {
        let Ok(file) = std::fs::File::open(path) else { return vec![format!("{} cannot be read", path.display())] };
        let length = file.metadata().map_or(0, |about| about.len());
        verification.file(&path.display().to_string(), length, std::io::BufReader::with_capacity(1 << 20, file));
    }
    let (text, findings) = verification.finish();
    print(&format!("\n{} recordings verified, {findings} findings\n", parts.len()));
    if findings == 0 { Vec::new() } else { text.lines().map(String::from).collect() }
}
