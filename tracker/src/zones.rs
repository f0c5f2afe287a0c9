//! The zones of a site in a file of its domain: a tracker that is started again has them before its first plots.

use std::io;
use std::path::{Path, PathBuf};

use common::commands::{ASKED, Command};

/// The file.
pub(crate) struct ZonesFile(PathBuf);

impl ZonesFile {
    /// That of a site, in the folder of the domain.
    pub(crate) fn of(folder: &Path, site: &str) -> Self {
        Self(folder.join(format!("{site}-zones.json")))
    }

    /// The commands that set the zones of the tracker before; none where there was none.
    pub(crate) fn read(&self) -> Vec<Command> {
        let Ok(text) = std::fs::read(&self.0) else { return Vec::new() };
        let zones: Vec<Command> = serde_json::from_slice(&text).unwrap_or_else(|error| {
            tracing::warn!("{}: {error}: the zones of the tracker before are lost", self.0.display());
            Vec::new()
        });
        zones.into_iter().map(|zone| Command { before_seq: 0, outcome: ASKED, ..zone }).collect()
    }

    /// Writes them whole or not at all. A full disk is no reason to track no more.
    pub(crate) fn write(&self, zones: &[Command]) {
        let draft = self.0.with_extension("tmp");
        let text = serde_json::to_vec(zones).map_err(io::Error::from);
        let written =
            text.and_then(|text| std::fs::write(&draft, text)).and_then(|()| std::fs::rename(&draft, &self.0));
        if let Err(error) = written {
            tracing::warn!("{}: {error}: a tracker that is started again will not have the zones", self.0.display());
        }
    }
}
