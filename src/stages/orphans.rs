//! The stages of a chain whose launcher has died: they go on, and a new launcher finds them.

use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::Sites;
use common::ipc::{Domain, Inhabitant};
use common::process::BadInput;
use common::topology::Stage;

use super::name::{KEEPER, STATUS, StageId, label};

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
            let (inhabitants, visited) = Self::living(&domain);
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
        let file = root.join("chain.toml");
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
        Ok(Self::living(&Domain::enter(&sites.first().ipc)?).0.is_empty())
    }

    /// The stages that live in a domain, and whether somebody looks at its status.
    fn living(domain: &Domain) -> (Vec<Inhabitant>, bool) {
        let mut inhabitants = domain.inhabitants();
        let visited = inhabitants.iter().any(|of| of.process == STATUS);
        inhabitants.retain(|of| of.process == KEEPER || Stage::from_name(&of.process).is_some());
        (inhabitants, visited)
    }

    /// The process of a stage.
    pub(crate) fn process(&self, id: &StageId) -> Option<u32> {
        let is_it =
            |of: &&Inhabitant| of.process == id.process() && id.site_name.as_ref().is_none_or(|site| *site == of.site);
        self.processes.iter().find(is_it).map(|of| of.pid)
    }
}
