//! `radar-chain run`: from a clean domain to the report.

use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

use anyhow::Context;
use common::config::{ChainConfig, Mode};
use common::ipc::{Domain, Flow, Station, attend};
use common::process::{BadInput, EXIT_CHECK_BROKEN, HealthReporter, new_session, signals};
use common::report::Report;
use common::services::{HealthReports, Topic};

use crate::board::Board;
use crate::screen::Screen;
use crate::supervisor::{End, Supervisor};

/// Name of the launcher among the processes.
const NAME: &str = "radar-chain";

/// Launches the chain, supervises it to its end and prints its report.
pub(crate) fn run(mut chain: ChainConfig) -> anyhow::Result<ExitCode> {
    if chain.run.id.is_empty() {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        chain.run.id = format!("{}-{:03}", common::time::utc_compact(now.as_secs()), now.subsec_millis());
    }
    let started = SystemTime::now();
    check_report_place(Path::new(&chain.recorder.report))?;
    Domain::check_shared_memory(&chain)?;
    let domain = Domain::enter(&chain.ipc)?;
    if domain.is_alive() {
        let prefix = &chain.ipc.prefix;
        return Err(BadInput(format!(
            "a chain is already running in the domain `{prefix}`: stop it, or use another --ipc-prefix"
        ))
        .into());
    }
    domain.remove(); // what a killed chain has left
    let domain = Domain::enter(&chain.ipc)?;
    let ended = supervise(&chain);
    domain.remove();
    let (end, restarts) = ended?;
    match end {
        End::Failed(code) => Ok(ExitCode::from(code)),
        End::Done { broken } => conclude(&chain, started, broken || restarts > 0),
    }
}

/// Runs the processes to their end.
fn supervise(chain: &ChainConfig) -> anyhow::Result<(End, u32)> {
    let station = Station::enter(NAME, chain)?;
    let _keeper = station.keep_services()?;
    let health = station.subscriber::<HealthReports>()?;
    let wake = station.wake(Topic::Health)?;
    let mut reporter = HealthReporter::new(&station, chain, new_session(), 0)?;
    let file = Domain::root(&chain.ipc).join("chain.toml");
    std::fs::write(&file, chain.to_toml()).with_context(|| format!("writing {}", file.display()))?;

    let mut supervisor = Supervisor::start(chain, file)?;
    let (mut board, mut screen, mut end) = (Board::default(), Screen::new(), None);
    let attended = attend(&[&wake], &reporter.watchdog(), || -> anyhow::Result<Flow> {
        while let Some(report) = health.receive()? {
            report.elements().iter().for_each(|health| board.take(health));
        }
        match signals() {
            0 => {}
            1 => supervisor.stop(),
            _ => {
                end = Some(End::Failed(130));
                return Ok(Flow::End);
            }
        }
        end = supervisor.step(&board, &mut screen)?;
        if end.is_some() {
            return Ok(Flow::End);
        }
        station.domain().clean_dead_nodes();
        reporter.health.restarts = supervisor.restarts();
        if reporter.is_due() {
            reporter.publish()?;
        }
        screen.show(chain, &board);
        Ok(Flow::Wait)
    });
    screen.clear();
    supervisor.kill_all();
    attended?;
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

/// Prints the report and judges it.
fn conclude(chain: &ChainConfig, started: SystemTime, disturbed: bool) -> anyhow::Result<ExitCode> {
    let path = Path::new(&chain.recorder.report);
    let written = std::fs::metadata(path).and_then(|file| file.modified());
    if !written.is_ok_and(|written| written >= started) {
        anyhow::bail!("the recorder has left no report {}", path.display());
    }
    let text = std::fs::read_to_string(path).with_context(|| format!("reading report {}", path.display()))?;
    let report: Report = serde_json::from_str(&text).with_context(|| format!("reading report {}", path.display()))?;
    print!("{}", report.to_text());
    println!("report {}", path.display());
    let lossy = chain.run.mode == Mode::Lossless && report.lost() > 0;
    Ok(if lossy || disturbed { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
}
