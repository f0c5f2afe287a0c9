//! `[link]`: topics of a site to and from other hosts, over Zenoh.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require, within};
use crate::topic::Topic;

/// What leaves this host, what comes from another one, and by which way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LinkConfig {
    /// Topics of this site that other hosts get: `tracks`, `plots`, `truth`, `system-tracks`; none for no link. In lossless mode the
    /// chain waits until the other host has them; in real time it waits for nobody, and the newest are kept.
    #[schemars(with = "Vec<String>")]
    pub send: Vec<Topic>,
    /// Topics that a site with `source = "link"` gets from the host of its radar. The stages after them run here.
    #[schemars(with = "Vec<String>")]
    pub receive: Vec<Topic>,
    /// Addresses at which other hosts are let in, `tcp/ADDRESS:PORT` or `tls/ADDRESS:PORT`.
    pub listen: Vec<String>,
    /// Addresses of other hosts. Nobody is looked for beyond these.
    pub connect: Vec<String>,
    /// File of settings of Zenoh (JSON5) for all else: keys and certificates of TLS, buffers. Empty for its defaults.
    pub zenoh: String,
    /// Messages that are kept until the other host has confirmed them.
    pub window: u32,
}

impl Default for LinkConfig {
    fn default() -> Self {
        Self {
            send: Vec::new(),
            receive: vec![Topic::Truth, Topic::Tracks],
            listen: Vec::new(),
            connect: Vec::new(),
            zenoh: String::new(),
            window: 256,
        }
    }
}

impl LinkConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        for (key, topics) in [("link.send", &self.send), ("link.receive", &self.receive)] {
            let valid = topics.iter().all(|topic| topic.is_data() && !topic.is_bulk());
            let found: Vec<&str> = topics.iter().map(|topic| topic.name()).collect();
            require(key, found.join(","), valid, "plots, tracks, truth or system-tracks")?;
        }
        let drives = |topic: &Topic| matches!(topic, Topic::Plots | Topic::Tracks);
        let found: Vec<&str> = self.receive.iter().map(|topic| topic.name()).collect();
        require("link.receive", found.join(","), self.receive.iter().any(drives), "plots or tracks among them")?;
        within("link.window", self.window.into(), 1..=65_536)
    }

    /// A site that sends or receives needs somebody to talk to.
    pub(super) fn check_ways(&self) -> Result<(), ConfigError> {
        let ways = self.listen.len() + self.connect.len();
        let known = ways > 0 || !self.zenoh.is_empty();
        require("link.listen", ways, known, "an address in `link.listen`, `link.connect` or the file `link.zenoh`")
    }
}
