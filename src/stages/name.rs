//! Names of the processes of a chain.

use common::config::Sites;
use common::topology::{self, Stage};

/// Name of the launcher among the processes.
pub(crate) const LAUNCHER: &str = "radar-chain";
/// Name of the process that keeps a chain for systemd.
pub(crate) const KEEPER: &str = "keeper";
/// Name of a process that looks at the status of a chain.
pub(crate) const STATUS: &str = "status";

/// A stage at its site.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StageId {
    /// Its entry in the table of stages.
    pub(crate) stage: &'static Stage,
    /// Index of its site; that of the first site where it serves all of them.
    pub(crate) site: usize,
    /// Name of its site, where the chain has several and it serves one of them.
    pub(crate) site_name: Option<String>,
}

impl StageId {
    /// The processes of a chain, downstream first, so that consumers are there early.
    pub(crate) fn all(sites: &Sites) -> Vec<Self> {
        let several = sites.only().is_none();
        let mut ids: Vec<Self> = Vec::new();
        for (index, site) in sites.all().iter().enumerate() {
            for stage in topology::stages(site).into_iter().rev() {
                let site_name = (several && !stage.is_of_chain()).then(|| site.site.name.clone());
                let id = Self { stage, site: if stage.is_of_chain() { 0 } else { index }, site_name };
                if !ids.contains(&id) {
                    ids.push(id);
                }
            }
        }
        ids
    }

    /// Name of the process.
    pub(crate) fn process(&self) -> &'static str {
        self.stage.name
    }

    /// Name for people and in reports: `SITE/PROCESS` where there are several sites.
    pub(crate) fn label(&self) -> String {
        label(self.site_name.as_deref(), self.process())
    }
}

/// `SITE/PROCESS`, or the process alone.
pub(crate) fn label(site: Option<&str>, process: &str) -> String {
    site.map_or_else(|| process.to_string(), |site| format!("{site}/{process}"))
}

impl std::fmt::Display for StageId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.label())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_site_has_its_stages_and_all_share_the_others() {
        let place = "position = { latitude_deg = 50.0, longitude_deg = 30.0 }";
        let text = format!("[[site]]\nname = \"a\"\n{place}\n[[site]]\nname = \"b\"\nsource = \"plot-source\"");
        let sites = common::config::parse_sites(std::path::Path::new("x.toml"), &text, &[]).expect("valid");
        let labels: Vec<String> = StageId::all(&sites).iter().map(StageId::label).collect();
        assert_eq!(labels[..2], ["display", "recorder"]);
        assert_eq!(labels[2..], ["a/tracker", "a/plot-extractor", "a/radar-sim", "b/tracker", "b/plot-source"]);
        let one = Sites::one(sites.first().clone());
        let labels: Vec<String> = StageId::all(&one).iter().map(StageId::label).collect();
        assert_eq!(labels, ["display", "recorder", "tracker", "plot-extractor", "radar-sim"]);
    }
}
