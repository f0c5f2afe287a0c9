//! `radar-chain run`: from a clean domain, or from a chain whose launcher has died, to the report.

use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

use anyhow::Context;
use common::config::{ChainConfig, Mode};
use common::ipc::{Domain, Flow};
use common::process::{BadInput, EXIT_CHECK_BROKEN, signals};
use common::report::Report;

use crate::board::Board;
use crate::claim::Claim;
use crate::orphans::Orphans;
use crate::post::{Look, Post};
use crate::screen::Screen;
use crate::supervisor::{End, Supervisor};

/// Name of the launcher among the processes.
pub(crate) const NAME: &str = "radar-chain";

/// What goes along with a run and may take a hand in it.
pub(crate) trait Companion {
    /// Looks at the run, some ten times a second.
    fn look(&mut self, board: &Board, supervisor: &mut Supervisor, screen: &mut Screen) -> anyhow::Result<()>;
}

/// Nobody goes along.
pub(crate) struct Alone;

impl Companion for Alone {
    fn look(&mut self, _: &Board, _: &mut Supervisor, _: &mut Screen) -> anyhow::Result<()> {
        Ok(())
    }
}

/// How a run went.
pub(crate) struct Outcome {
    /// Its report.
    pub(crate) report: Report,
    /// A stage found something broken or had to be restarted.
    pub(crate) disturbed: bool,
    /// Messages were lost though the mode is to lose none.
    pub(crate) lossy: bool,
}

/// Launches the chain, supervises it to its end and prints its report.
pub(crate) fn run(chain: ChainConfig) -> anyhow::Result<ExitCode> {
    let report = chain.recorder.report.clone();
    match launch(&Claim::take(&chain.ipc)?, chain, &mut Alone)? {
        Err(code) => Ok(code),
        Ok(outcome) => {
            print!("{}", outcome.report.to_text());
            println!("report {report}");
            let broken = outcome.lossy || outcome.disturbed;
            Ok(if broken { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
        }
    }
}

/// A chain from its start to its report, or the exit code of a run that failed.
pub(crate) fn launch(
    _claim: &Claim,
    mut chain: ChainConfig,
    companion: &mut dyn Companion,
) -> anyhow::Result<Result<Outcome, ExitCode>> {
    let orphans = Orphans::find(&chain)?;
    if let Some(orphans) = &orphans {
        chain = orphans.chain.clone();
    } else {
        if chain.run.id.is_empty() {
            chain.run.id = run_id();
        }
        check_report_place(Path::new(&chain.recorder.report))?;
        Domain::enter(&chain.ipc)?.remove(); // what a killed chain has left
        if !chain.soak.log.is_empty() {
            let _ = std::fs::remove_file(&chain.soak.log); // of an earlier soak, to which nobody writes any more
        }
        Domain::check_shared_memory(&chain)?;
    }
    let ended = supervise(&chain, orphans.as_ref(), companion);
    if Orphans::are_gone(&chain)? {
        Domain::enter(&chain.ipc)?.remove();
    }
    let (end, restarts) = ended?;
    match end {
        End::Failed(code) => Ok(Err(ExitCode::from(code))),
        End::Done { broken } => {
            let report = read_report(Path::new(&chain.recorder.report), &chain.run.id)?;
            let lossy = chain.run.mode == Mode::Lossless && report.lost() > 0;
            // Restarts of an earlier launcher are in the report; those of a process that has never said a word are not.
            let restarted =
                restarts > 0 || report.processes.iter().any(|(name, used)| name != NAME && used.restarts > 0);
            Ok(Ok(Outcome { report, disturbed: broken || restarted, lossy }))
        }
    }
}

/// Name of a run that begins now.
pub(crate) fn run_id() -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    format!("{}-{:03}", common::time::utc_compact(now.as_secs()), now.subsec_millis())
}

/// Runs the processes to their end.
fn supervise(
    chain: &ChainConfig,
    orphans: Option<&Orphans>,
    companion: &mut dyn Companion,
) -> anyhow::Result<(End, u32)> {
    let (mut post, wake) = Post::take(NAME, chain)?;
    let file = Domain::root(&chain.ipc).join("chain.toml");
    std::fs::write(&file, chain.to_toml()).with_context(|| format!("writing {}", file.display()))?;

    let mut screen = Screen::new();
    let mut supervisor = match orphans {
        None => Supervisor::start(chain, file)?,
        Some(orphans) => {
            screen.say("taking over a chain whose launcher has died");
            Supervisor::adopt(chain, file, orphans)
        }
    };
    let mut end = None;
    let held = post.hold(&wake, |post| {
        match signals() {
            0 => {}
            1 => supervisor.stop(),
            _ => end = Some(End::Failed(130)),
        }
        if end.is_none() {
            end = supervisor.step(&post.board, &mut screen)?;
        }
        if end.is_none() {
            companion.look(&post.board, &mut supervisor, &mut screen)?;
            screen.show(chain, &post.board);
        }
        let flow = if end.is_some() { Flow::End } else { Flow::Wait };
        Ok(Look { flow, restarts: supervisor.restarts() })
    });
    screen.clear();
    supervisor.kill_all();
    held?;
    Ok((end.unwrap_or(End::Done { broken: false }), supervisor.restarts()))
}

/// Finds out before the run whether its report can be written.
fn check_report_place(path: &Path) -> anyhow::Result<()> {
    let refuse = |reason: String| Err(BadInput(format!("cannot write report {}: {reason}", path.display())).into());
    if path.is_dir() {
        return refuse("it is a directory".into());
    }
    match path.parent().map(std::fs::create_dir_all) {
        Some(Err(error)) => refuse(error.to_string()),
        _ => Ok(()),
    }
}

/// The report that the recorder has left of this run.
fn read_report(path: &Path, run: &str) -> anyhow::Result<Report> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let report: Option<Report> = serde_json::from_str(&text).ok();
    let of_run = |report: &Report| report.config.as_ref().is_some_and(|config| config.run.id == run);
    report.filter(of_run).with_context(|| format!("the recorder has left no report {} of this run", path.display()))
}
