//! The stages of a chain whose launcher has died: they go on, and a new launcher finds them.

use std::time::{Duration, Instant};

use anyhow::Context;
use clap::ValueEnum;
use common::config::ChainConfig;
use common::ipc::Domain;
use common::process::BadInput;

use crate::stage::StageName;

/// Passing visitors of a domain, such as `radar-chain status`, have left after this time.
const VISIT: Duration = Duration::from_secs(3);

/// Living stages without a launcher.
#[derive(Debug)]
pub(crate) struct Orphans {
    /// The configuration they run with.
    pub(crate) chain: ChainConfig,
    /// Names and process identifiers.
    processes: Vec<(String, u32)>,
}

impl Orphans {
    /// The orphans of the domain of `chain`, if there are any. The caller has the claim: no launcher lives.
    pub(crate) fn find(chain: &ChainConfig) -> anyhow::Result<Option<Self>> {
        let root = Domain::root(&chain.ipc);
        if !root.exists() {
            return Ok(None);
        }
        let domain = Domain::enter(&chain.ipc)?;
        domain.clean_dead_nodes();
        let began = Instant::now();
        let processes = loop {
            let (inhabitants, all) = Self::living(&domain);
            if !inhabitants.is_empty() || all == 0 || began.elapsed() > VISIT {
                break inhabitants;
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        if processes.is_empty() {
            return Ok(None);
        }
        let refuse = |what: &str| {
            let names: Vec<&str> = processes.iter().map(|(name, _)| name.as_str()).collect();
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
        let running = common::config::load(Some(&file), &[])?;
        let mut wanted = chain.clone();
        wanted.run.id.clone_from(&running.run.id);
        if wanted != running {
            return Err(refuse("with another configuration").into());
        }
        // They were started there, and their relative paths hold there.
        let folder = std::fs::read_link(format!("/proc/{}/cwd", processes[0].1)).context("folder of the chain")?;
        std::env::set_current_dir(&folder).with_context(|| format!("folder of the chain {}", folder.display()))?;
        Ok(Some(Self { chain: running, processes }))
    }

    /// Whether no stage of any chain lives in the domain: then its files can go.
    pub(crate) fn are_gone(chain: &ChainConfig) -> anyhow::Result<bool> {
        Ok(Self::living(&Domain::enter(&chain.ipc)?).0.is_empty())
    }

    /// The stages that live in a domain, and how many processes do in all.
    fn living(domain: &Domain) -> (Vec<(String, u32)>, usize) {
        let mut inhabitants = domain.inhabitants();
        let all = inhabitants.len();
        inhabitants.retain(|(name, _)| StageName::value_variants().iter().any(|stage| stage.name() == name));
        (inhabitants, all)
    }

    /// The process of a stage.
    pub(crate) fn process(&self, stage: StageName) -> Option<u32> {
        self.processes.iter().find(|(name, _)| name == stage.name()).map(|&(_, pid)| pid)
    }
}
