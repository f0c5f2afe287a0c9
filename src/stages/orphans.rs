//! The stages of a chain whose launcher has died: they go on, and a new launcher finds them.

use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::{IpcConfig, Sites};
use common::ipc::{Domain, Inhabitant};
use common::process::BadInput;
use common::topology::{Stage, label};

use super::child::Process;
use super::name::{KEEPER, STATUS, StageId};

/// Passing visitors of a domain, such as `radar-chain status`, have left after this time.
const VISIT: Duration = Duration::from_secs(3);

/// Living stages without a launcher.
#[derive(Debug)]
pub(crate) struct Orphans {
    /// The configuration they run with.
    pub(crate) sites: Sites,
    processes: Vec<Inhabitant>,
}

impl Orphans {
    /// The orphans of a chain, if there are any. The caller has the claim: no launcher lives.
    pub(crate) fn find(sites: &Sites) -> anyhow::Result<Option<Self>> {
        let chain = sites.first();
        let root = Domain::root(&chain.ipc);
        if !root.exists() {
            return Ok(None);
        }
        let domain = Domain::enter(&chain.ipc)?;
        domain.clean_dead_nodes();
        let began = Instant::now();
        let processes = loop {
            let (inhabitants, visited) = Self::living(&domain, &configuration(sites));
            if !inhabitants.is_empty() || !visited || began.elapsed() > VISIT {
                break inhabitants;
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        if processes.is_empty() {
            return Ok(None);
        }
        let refuse = |what: &str| {
            let several = sites.only().is_none();
            let name = |of: &Inhabitant| label(several.then_some(of.site.as_str()), &of.process);
            let names: Vec<String> = processes.iter().map(name).collect();
            let prefix = &chain.ipc.prefix;
            BadInput(format!(
                "{} already run in the domain `{prefix}` {what}: stop them, or use another --ipc-prefix",
                names.join(", ")
            ))
        };
        let file = configuration(sites);
        if !file.exists() {
            return Err(refuse("without a launcher").into());
        }
        let running = common::config::load_sites(Some(&file), &[])?;
        let mut wanted = sites.clone();
        wanted.change(|site| site.run.id.clone_from(&running.first().run.id));
        if wanted != running {
            return Err(refuse("with another configuration").into());
        }
        // They were started there, and their relative paths hold there.
        let folder = std::fs::read_link(format!("/proc/{}/cwd", processes[0].pid)).context("folder of the chain")?;
        std::env::set_current_dir(&folder).with_context(|| format!("folder of the chain {}", folder.display()))?;
        Ok(Some(Self { sites: running, processes }))
    }

    /// Whether no stage of any chain lives in the domain: then its files can go.
    pub(crate) fn are_gone(sites: &Sites) -> anyhow::Result<bool> {
        Ok(Self::living(&Domain::enter(&sites.first().ipc)?, &configuration(sites)).0.is_empty())
    }

    /// The stages that live in a domain or are about to enter it, and whether somebody looks at its status.
    fn living(domain: &Domain, file: &Path) -> (Vec<Inhabitant>, bool) {
        let mut inhabitants = domain.inhabitants();
        let visited = inhabitants.iter().any(|of| of.process == STATUS);
        inhabitants.retain(|of| of.process == KEEPER || Stage::from_name(&of.process).is_some());
        let known: Vec<u32> = inhabitants.iter().map(|of| of.pid).collect();
        inhabitants.extend(started(file).filter(|of| !known.contains(&of.pid)));
        (inhabitants, visited)
    }

    /// The process of a stage.
    pub(crate) fn process(&self, id: &StageId) -> Option<u32> {
        self.processes.iter().find(|of| is_stage(of, id)).map(|of| of.pid)
    }

    /// Ends all of them at once and waits until they have ended.
    pub(crate) fn kill(&self) {
        self.processes.iter().filter_map(|of| Process::adopt(of.pid)).for_each(|mut process| process.kill());
    }
}

/// Waits until those who look at a domain have left it: a visitor takes the files of its services away when it goes, by then
/// perhaps those of a chain that has just been started. Without a stage there nobody comes anew.
pub(crate) fn visitors_leave(domain: &Domain) {
    let began = Instant::now();
    while domain.is_alive() && began.elapsed() < VISIT {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A process that a launcher has started as the stage `id` with the configuration `file`, and that may not have entered the domain.
pub(crate) fn find_started(file: &Path, id: &StageId) -> Option<u32> {
    started(file).find(|of| is_stage(of, id)).map(|of| of.pid)
}

fn is_stage(of: &Inhabitant, id: &StageId) -> bool {
    of.process == id.process() && id.site_name.as_ref().is_none_or(|site| *site == of.site)
}

/// The processes that launchers have started with the configuration `file`, by their command lines ([`Process::start`]): a
/// stage that is slow to enter its domain is there all the same, and must not be started twice.
fn started(file: &Path) -> impl Iterator<Item = Inhabitant> {
    let user = rustix::process::geteuid().as_raw();
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(move |entry| {
        let pid = entry.file_name().to_str()?.parse().ok()?;
        let command = std::fs::read(entry.path().join("cmdline")).ok()?;
        let words: Vec<&str> = std::str::from_utf8(&command).ok()?.split('\0').collect();
        let [_, "stage", process, "--config", of_file, rest @ ..] = &words[..] else { return None };
        let is_ours = Path::new(of_file) == file && entry.metadata().ok()?.uid() == user;
        let site = if let ["--site", site, ..] = rest { site } else { "" };
        is_ours.then(|| Inhabitant { process: (*process).to_string(), site: site.to_string(), pid })
    })
}

/// The configuration that the launcher of a domain writes down for its stages.
pub(crate) fn configuration(sites: &Sites) -> PathBuf {
    configuration_in(&sites.first().ipc)
}

/// The same of the chain in a domain.
pub(crate) fn configuration_in(ipc: &IpcConfig) -> PathBuf {
    Domain::root(ipc).join("chain.toml")
}
