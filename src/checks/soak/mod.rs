//! `radar-chain soak`: a run that is measured against its limits.
//!
//! ```text
//! stages ──health──▶ launcher ──▶ resources.csv ─┐
//!    recorder ──▶ latency.hlog, report.json ─────┼─▶ verdict ─▶ report.json, report.html
//!    hop processes ──▶ hop-*.hlog ───────────────┘
//! ```
//!
//! Series go to files while the run lasts, so that a soak of days needs no more memory than one of minutes.

mod page;
mod reference;
mod resources;
mod verdict;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::{ChainConfig, Sites};
use common::latency::{LATENCY_NAMES, Latency};
use common::latency_log::{self, Interval};
use common::process::{BadInput, EXIT_CHECK_BROKEN, print, signals};
use common::report::{Blocks, ChainReport, Percentiles, Report, Soak};

use crate::claim::Claim;
use crate::run::{Companion, launch};
use crate::stages::supervisor::Supervisor;
use crate::watch::board::Board;
use crate::watch::screen::Screen;
use reference::Reference;
use resources::{Resources, Series};

pub(crate) use reference::{HopArgs, hop};

/// Blocks that the course of a latency is given in.
const BLOCKS: usize = 200;

/// What a soak is to do beside running the chain.
pub(crate) struct Plan {
    /// It ends after this time, if not by its scans.
    pub(crate) duration: Option<Duration>,
    /// Folder of its results.
    pub(crate) out: PathBuf,
    /// Whether the bare hop is measured beside it.
    pub(crate) reference: bool,
    /// Whether the picture is served meanwhile.
    pub(crate) display: bool,
}

/// Runs the chain, measures it, judges it.
pub(crate) fn soak(mut sites: Sites, plan: &Plan) -> anyhow::Result<ExitCode> {
    if plan.duration == Some(Duration::ZERO) {
        return Err(BadInput("--duration 0s: expected a time above 0".into()).into());
    }
    let claim = Claim::lock_domain(&sites.first().ipc)?; // before anything of an earlier soak, which may still run, is touched
    let refuse = |error: std::io::Error| BadInput(format!("folder of the soak {}: {error}", plan.out.display()));
    std::fs::create_dir_all(&plan.out).map_err(refuse)?;
    let out = std::path::absolute(&plan.out).map_err(refuse)?;
    let place = |name: &str| out.join(name).display().to_string();
    sites.change(|site| {
        site.recorder.report = place("report.json");
        site.soak.log = place("latency.hlog");
        site.display.enabled = plan.display;
    });
    let chain = sites.first();
    let resources = Resources::create(&out, Duration::from_secs_f64(chain.soak.interval_s))?;
    let reference = plan.reference.then(|| Reference::new(&sites, &out));
    let mut companion =
        Watcher { duration: plan.duration, begun: None, resources, reference, ended: None, unwritten: None };
    let launched = launch(&claim, sites.clone(), &mut companion)?;
    let Watcher { resources, reference, ended, unwritten, .. } = companion;
    drop(reference); // its logs are written when its processes have ended
    let series = match resources.finish() {
        Ok(series) => Series { unwritten, ..series },
        Err(error) => Series { unwritten: Some(format!("{error:#}")), ..Series::default() },
    };
    let outcome = match launched {
        Ok(outcome) => outcome,
        Err(code) => return Ok(code),
    };
    let asked = verdict::Asked { duration: plan.duration, ran: ended.unwrap_or_default(), stopped: signals() > 0 };
    let mut report = outcome.report;
    let mut ok = true;
    let names = sites.names();
    match &mut report {
        ChainReport::One(only) => {
            let logs = Logs { latencies: out.join("latency.hlog"), bare: out.clone(), results: out.clone() };
            conclude(sites.first(), only, outcome.disturbed, &series, &asked, &logs)?;
            ok &= only.soak.as_ref().is_some_and(|soak| soak.ok);
        }
        ChainReport::Several(several) => {
            for ((site, name), log) in sites.all().iter().zip(&names).zip(sites.latency_logs()) {
                let Some(of_site) = several.sites.get_mut(*name) else { continue };
                // The bare hop is measured at the first site.
                let bare = if *name == names[0] { out.clone() } else { out.join(name) };
                let logs = Logs { latencies: log.into(), bare, results: out.join(name) };
                std::fs::create_dir_all(&logs.results).map_err(refuse)?;
                conclude(site, of_site, outcome.disturbed, &series.of_site(name), &asked, &logs)?;
                ok &= of_site.soak.as_ref().is_some_and(|soak| soak.ok);
            }
            std::fs::write(out.join("report.json"), report.to_json()).context("writing report.json")?;
        }
    }
    print(&report.to_text());
    for (name, of_site) in report.sites() {
        print(&verdict::to_text(of_site, sites.only().is_none().then_some(name)));
    }
    let out = plan.out.display();
    print(&format!("\nresults in {out}: report.html, report.json, latency.hlog, resources.csv\n"));
    Ok(if ok { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) })
}

/// Where the logs of a soak are, and where its results go.
struct Logs {
    latencies: PathBuf,
    /// Folder of the logs of the bare hops.
    bare: PathBuf,
    /// Folder of the report and its page.
    results: PathBuf,
}

/// Notes resources while the chain runs, keeps the bare hop going, and ends both in time.
struct Watcher {
    duration: Option<Duration>,
    /// When the source had sent its first message.
    begun: Option<Instant>,
    resources: Resources,
    reference: Option<Reference>,
    /// How long after that the end began.
    ended: Option<Duration>,
    /// Why the series is not whole.
    unwritten: Option<String>,
}

impl Companion for Watcher {
    fn look(&mut self, board: &Board, supervisor: &mut Supervisor, screen: &mut Screen) -> anyhow::Result<()> {
        if self.begun.is_none() && board.all().any(|(_, health, _)| health.messages_out > 0) {
            self.begun = Some(Instant::now());
            if let Some(reference) = &mut self.reference {
                reference.start()?;
            }
        }
        let Some(begun) = self.begun else { return Ok(()) };
        if let Err(error) = self.resources.note(begun.elapsed(), board)
            && self.unwritten.is_none()
        {
            screen.say(&format!("{error:#}: the soak goes on"));
            self.unwritten = Some(format!("{error:#}"));
        }
        if let Some(duration) = self.duration {
            screen.left(duration.saturating_sub(begun.elapsed()));
            if begun.elapsed() >= duration {
                supervisor.stop();
            }
        }
        if supervisor.is_ending() && self.ended.is_none() {
            self.ended = Some(begun.elapsed());
            if let Some(reference) = &mut self.reference {
                reference.stop();
            }
        }
        Ok(())
    }
}

/// Adds to the report of a site what the soak has found, and writes it with its page.
fn conclude(
    chain: &ChainConfig,
    report: &mut Report,
    disturbed: bool,
    series: &Series,
    asked: &verdict::Asked,
    logs: &Logs,
) -> anyhow::Result<()> {
    let read = |path: &Path| latency_log::read(&std::fs::read_to_string(path).unwrap_or_default());
    let (intervals, mut bare) = (read(&logs.latencies), Vec::new());
    for latency in reference::LATENCIES_OF_HOPS {
        bare.extend(read(&logs.bare.join(reference::log_name(latency))));
    }
    let mut soak = Soak {
        blocks: LATENCY_NAMES
            .iter()
            .enumerate()
            .map(|(place, name)| ((*name).into(), course(&intervals, place)))
            .collect(),
        ..Soak::default()
    };
    for (process, growth) in series.growth_mib(chain.soak.warm_up) {
        match growth {
            Ok(mib) => {
                soak.growth_mib.insert(process, mib);
            }
            Err(reason) => soak.not_judged.push(format!("memory of {process}: {reason}")),
        }
    }
    if series.by_process.is_empty() {
        soak.not_judged.push("memory: the run has ended before the first reading".into());
    }
    soak.blocks.retain(|_, blocks| !blocks.t_s.is_empty());
    let bare = latency_log::merged(&bare);
    for (name, histogram) in bare.named().filter(|(_, histogram)| !histogram.is_empty()) {
        let reference = Percentiles::of(histogram);
        let hop = report.latency_us.get(name).copied().unwrap_or_default();
        soak.reference.insert(name.into(), reference);
        if hop.n > 0 {
            soak.ratio_to_reference.insert(name.into(), hop.p50 / reference.p50);
        }
    }
    soak.not_judged.extend(verdict::machine_too_slow(report, &soak));
    soak.findings = verdict::findings(chain, report, &soak, asked, disturbed);
    soak.findings.extend(series.unwritten.clone());
    soak.ok = soak.findings.is_empty();
    report.soak = Some(soak);
    let write = |name: &str, text: String| {
        let path = logs.results.join(name);
        std::fs::write(&path, text).with_context(|| format!("writing {}", path.display()))
    };
    write("report.json", report.to_json())?;
    write("report.html", page::html(chain, report, series, &latency_log::merged(&intervals), &bare))?;
    Ok(())
}

/// One latency over the run, at most [`BLOCKS`] blocks.
fn course(intervals: &[Interval], latency: usize) -> Blocks {
    debug_assert!(latency <= Latency::Record as usize);
    let mut course = Blocks::default();
    for (t_s, histogram) in latency_log::blocks(intervals, latency, BLOCKS) {
        let Percentiles { p50, p99, max, .. } = Percentiles::of(&histogram);
        course.t_s.push(t_s);
        course.p50.push(p50);
        course.p99.push(p99);
        course.max.push(max);
    }
    course
}
