//! Where the report goes: room on the disk that is taken when the recorder starts, so that a disk which fills up
//! during the run costs recordings and never the report.

use std::fs::File;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use common::config::Sites;
use common::process::BadInput;
use common::recording::run_and_part;
use common::report::{ChainReport, Report};
use rustix::fs::{FallocateFlags, fallocate};

/// Where the report of a recorded run lies beside the parts of its recording: `<site>-<run>.report.json`.
pub(crate) fn report_beside(part: &Path) -> Option<PathBuf> {
    let (run, _) = run_and_part(part)?;
    Some(part.with_file_name(format!("{run}.report.json")))
}

/// The file that becomes the report `path` of the chain with the prefix `chain`: another chain may write its report to the same place.
pub(crate) fn draft_of(path: &Path, chain: &str) -> PathBuf {
    path.with_extension(format!("json.{chain}.tmp"))
}

/// Room for a report: more than the longest lists of misses and gaps need.
const ROOM_BYTES: u64 = 1 << 20;

/// The report's file until it is whole.
#[derive(Debug)]
pub(crate) struct ReportPlace {
    path: PathBuf,
    draft: PathBuf,
    file: File,
}

impl ReportPlace {
    /// Takes room beside the report `path` of the chain with the prefix `chain`. A disk that is full already is met when
    /// the report is written.
    ///
    /// # Errors
    /// [`BadInput`] if no file can be made there.
    pub(crate) fn reserve(path: &Path, chain: &str) -> Result<Self, BadInput> {
        let refuse = |error: std::io::Error| BadInput(format!("cannot write report {}: {error}", path.display()));
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(refuse)?;
        }
        if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            return Err(refuse(std::io::Error::other("it exists and is no regular file")));
        }
        let draft = draft_of(path, chain);
        let file = File::create(&draft).map_err(refuse)?;
        if let Err(error) = fallocate(&file, FallocateFlags::empty(), 0, ROOM_BYTES) {
            tracing::warn!("no room was taken for report {}: {error}", path.display());
        }
        Ok(Self { path: path.to_path_buf(), draft, file })
    }

    /// Writes the report of all sites and renames it into place: whoever waits for it finds it complete.
    ///
    /// # Errors
    /// Writing fails.
    pub(crate) fn write(mut self, reports: Vec<Report>, sites: &Sites) -> anyhow::Result<()> {
        let text = ChainReport::new(reports, sites).to_json();
        let mut write = || {
            self.file.rewind()?;
            self.file.write_all(text.as_bytes())?;
            self.file.set_len(text.len() as u64)?;
            std::fs::rename(&self.draft, &self.path)
        };
        write().with_context(|| format!("writing {}", self.path.display()))
    }
}

impl Drop for ReportPlace {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.draft); // gone already if the report was written
    }
}
