//! `radar-chain run`: from a clean domain, or from a chain whose launcher has died, to the report.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use common::config::{Mode, Sites};
use common::ipc::{Domain, Flow, IpcError};
use common::process::{BadInput, EXIT_BAD_USAGE, EXIT_CHECK_BROKEN, print, say, signals};
use common::report::ChainReport;
use common::topology::is_observer;

use crate::checks::machine::allow_files;
use crate::claim::Claim;
use crate::stages::orphans::{Orphans, configuration, visitors_leave};
use crate::stages::resume::run_id;
use crate::stages::supervisor::{End, Supervisor};
use crate::watch::endpoint::{Endpoint, Look};
use crate::watch::screen::Screen;
use common::status::{Board, LAUNCHER};

/// A hook that is called during a run.
pub(crate) trait Companion {
    /// Looks at the run, about ten times a second.
    fn look(&mut self, board: &Board, supervisor: &mut Supervisor, screen: &mut Screen) -> anyhow::Result<()>;
}

/// No hook.
pub(crate) struct Alone;

impl Companion for Alone {
    fn look(&mut self, _: &Board, _: &mut Supervisor, _: &mut Screen) -> anyhow::Result<()> {
        Ok(())
    }
}

/// How a run went.
pub(crate) struct Outcome {
    /// Its report.
    pub(crate) report: ChainReport,
    /// A stage found something broken or had to be restarted.
    pub(crate) disturbed: bool,
    /// Messages were lost though the mode is to lose none.
    pub(crate) lossy: bool,
    /// Observers that were to be there and have refused what is configured.
    pub(crate) absent: Vec<String>,
}

/// How the processes of a chain have ended.
struct Supervised {
    end: End,
    restarts: u32,
    absent: Vec<String>,
}

/// Launches the chain, supervises it to its end and prints its report.
pub(crate) fn run(sites: Sites) -> anyhow::Result<ExitCode> {
    let report = sites.first().recorder.report.clone();
    match launch(&Claim::lock_domain(&sites.first().ipc)?, sites, &mut Alone)? {
        Err(code) => Ok(code),
        Ok(outcome) => {
            print(&format!("{}report {report}\n", outcome.report.to_text()));
            for absent in &outcome.absent {
                say(&format!("the run was without {absent}, which refused its configuration when it was to start"));
            }
            let broken = outcome.lossy || outcome.disturbed;
            Ok(if broken { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
        }
    }
}

/// A chain from its start to its report, or the exit code of a run that failed.
pub(crate) fn launch(
    _claim: &Claim,
    mut sites: Sites,
    companion: &mut dyn Companion,
) -> anyhow::Result<Result<Outcome, ExitCode>> {
    allow_files(sites.all().len())?;
    let orphans = Orphans::find(&sites)?;
    if let Some(orphans) = &orphans {
        sites = orphans.sites.clone();
    } else {
        if sites.first().run.id.is_empty() {
            let id = run_id();
            sites.change(|site| site.run.id.clone_from(&id));
        }
        let chain = sites.first();
        check_report_place(Path::new(&chain.recorder.report))?;
        let domain = Domain::enter(&chain.ipc)?;
        if !domain.is_alive() {
            domain.remove(); // what a killed chain has left; an observer may wait for this one
        }
        for log in sites.latency_logs() {
            let _ = std::fs::remove_file(log); // of an earlier soak, to which nobody writes any more
        }
        Domain::check_shared_memory(&sites)?;
    }
    let chain = sites.first();
    let mut ended = supervise(&sites, orphans.as_ref(), companion);
    if let (Some(orphans), Err(error)) = (&orphans, &ended)
        && error.chain().any(|cause| matches!(cause.downcast_ref(), Some(IpcError::HalfMade { .. })))
    {
        // Nobody can join that chain any more: nothing of it could be started again.
        say(&format!("{error:#}: ending its stages and starting the chain again"));
        let domain = Domain::enter(&chain.ipc)?;
        orphans.kill();
        visitors_leave(&domain);
        domain.remove();
        ended = supervise(&sites, None, companion);
    }
    if Orphans::are_gone(&sites)? {
        Domain::enter(&chain.ipc)?.remove();
    }
    let Supervised { end, restarts, absent } = ended?;
    match end {
        End::Failed(code) => {
            if code == EXIT_BAD_USAGE {
                recorder::discard_empty(&sites);
            }
            Ok(Err(ExitCode::from(code)))
        }
        End::Done { broken } => {
            let report = read_report(Path::new(&chain.recorder.report), &chain.run.id)?;
            let lossy = chain.run.mode == Mode::Lossless && report.lost() > 0;
            // Restarts of an earlier launcher are in the report; those of a process that has never said a word are not.
            let counts = |name: &str| name != LAUNCHER && !is_observer(name);
            let restarted =
                restarts > 0 || report.processes().iter().any(|(name, used)| counts(name) && used.restarts > 0);
            Ok(Ok(Outcome { report, disturbed: broken || restarted, lossy, absent }))
        }
    }
}

/// Runs the processes to their end.
fn supervise(sites: &Sites, orphans: Option<&Orphans>, companion: &mut dyn Companion) -> anyhow::Result<Supervised> {
    let (mut endpoint, wakes) = Endpoint::open(LAUNCHER, sites)?;
    let file = configuration(sites);
    std::fs::write(&file, sites.to_toml()).with_context(|| format!("writing {}", file.display()))?;

    let mut screen = Screen::new();
    let mut supervisor = match orphans {
        None => Supervisor::start(sites, file)?,
        Some(orphans) => {
            screen.say("taking over a chain whose launcher has died");
            Supervisor::adopt(sites, file, orphans)
        }
    };
    let mut end = None;
    let watched = endpoint.watch(&wakes, |endpoint| {
        match signals() {
            0 => {}
            1 => supervisor.stop(),
            _ => end = Some(End::Failed(130)),
        }
        if end.is_none() {
            end = supervisor.step(&endpoint.board, &mut screen)?;
        }
        if end.is_none() {
            companion.look(&endpoint.board, &mut supervisor, &mut screen)?;
            screen.show(sites, &endpoint.board);
        }
        let flow = if end.is_some() { Flow::End } else { Flow::Wait };
        Ok(Look { flow, restarts: supervisor.restarts() })
    });
    screen.clear();
    supervisor.kill_all();
    watched?;
    Ok(Supervised {
        end: end.unwrap_or(End::Done { broken: false }),
        restarts: supervisor.restarts(),
        absent: supervisor.absent().to_vec(),
    })
}

/// Finds out before the run whether its report can be written.
fn check_report_place(path: &Path) -> anyhow::Result<()> {
    let refuse = |reason: String| Err(BadInput(format!("cannot write report {}: {reason}", path.display())).into());
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return refuse("it is a directory".into()),
        // The report is renamed into place: as root it would take the place of a device.
        Ok(there) if !there.is_file() => return refuse("it exists and is no regular file".into()),
        _ => {}
    }
    match path.parent().map(std::fs::create_dir_all) {
        Some(Err(error)) => refuse(error.to_string()),
        _ => Ok(()),
    }
}

/// The report that the recorder has left of this run.
fn read_report(path: &Path, run: &str) -> anyhow::Result<ChainReport> {
    let report = ChainReport::from_json(&std::fs::read_to_string(path).unwrap_or_default());
    report
        .filter(|report| report.run() == run)
        .with_context(|| format!("the recorder has left no report {} of this run", path.display()))
}
