//! How long recordings are kept: the oldest of a site go when all together are too large.
//!
//! Age is what the names say, `<site>-<start in UTC>.<part>.mcap`, and not the time of the last change: a wall clock that is set
//! back would make the newest file the oldest.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use common::recording::container::Reader;
use common::recording::run_and_part;
use tracing::warn;

use crate::report_place::report_beside;

/// The limit and the files under it.
#[derive(Debug)]
pub(crate) struct Retention {
    site: String,
    /// None without a limit.
    total_bytes: Option<u64>,
    /// Recordings of the site beside the one being written, oldest first, with their sizes.
    others: Vec<(PathBuf, u64)>,
}

impl Retention {
    /// Of the recordings of `site`, together at most `total_mib` MiB; 0 for no limit.
    pub(crate) fn new(site: &str, total_mib: u32) -> Self {
        let total_bytes = (total_mib > 0).then(|| u64::from(total_mib) << 20);
        Self { site: site.to_string(), total_bytes, others: Vec::new() }
    }

    /// Looks what lies in `directory` beside `own`, which is being written.
    pub(crate) fn look(&mut self, directory: &Path, own: &Path) {
        if self.total_bytes.is_none() {
            return;
        }
        let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
        let mut found: Vec<(String, u32, PathBuf, u64)> = entries
            .filter_map(|entry| {
                let (path, about) = (entry.path(), entry.metadata().ok()?);
                let (run, part) = run_and_part(&path)?;
                let run = run.strip_prefix(self.site.as_str())?.strip_prefix('-')?.to_string();
                let others = about.is_file() && path != own && is_of_site(&path, &self.site);
                others.then_some((run, part, path, about.len()))
            })
            .collect();
        found.sort_unstable();
        self.others = found.into_iter().map(|(.., path, bytes)| (path, bytes)).collect();
    }

    /// Removes the oldest files until the others and `own` bytes are within the limit; how many were removed.
    pub(crate) fn keep(&mut self, own: u64) -> u32 {
        let Some(limit) = self.total_bytes else { return 0 };
        let mut total = own + self.others.iter().map(|(_, bytes)| bytes).sum::<u64>();
        let mut removed = 0;
        while total > limit && !self.others.is_empty() {
            let (path, bytes) = self.others.remove(0);
            total -= bytes;
            match std::fs::remove_file(&path) {
                Ok(()) => {
                    removed += 1;
                    let report = report_beside(&path).filter(|report| !self.has_part_of(report));
                    if let Some(report) = report {
                        let _ = std::fs::remove_file(report); // of a run that has left none there is nothing to remove
                    }
                    warn!("{} removed: recordings had reached recorder.total_mib", path.display());
                }
                Err(error) => warn!("{} cannot be removed: {error}", path.display()),
            }
        }
        removed
    }
}

impl Retention {
    /// Whether a part of the run with this report is left.
    fn has_part_of(&self, report: &Path) -> bool {
        self.others.iter().any(|(path, _)| report_beside(path).as_deref() == Some(report))
    }
}

/// Whether a recording says that it is of this site; one that does not say is taken by its name.
fn is_of_site(path: &Path, site: &str) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let mut reader = Reader::new(BufReader::new(file));
    reader.description().is_none_or(|description| description.site.is_empty() || description.site == site)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, SystemTime};

    use common::recording::container::{Description, Writer};

    #[test]
    fn the_oldest_by_name_go_until_all_are_within_the_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        // Recordings of 250 KiB, the older ones changed last: the clock was set back.
        let record = |name: &str, site: &str, changed_ago_s| {
            let file = File::create(path(name)).expect("a file");
            let description = Description { site: site.into(), ..Description::default() };
            Writer::new(&file, &description, "", 1 << 20).expect("a container").finish().expect("written");
            file.set_len(250 << 10).expect("a length");
            file.set_modified(SystemTime::now() - Duration::from_secs(changed_ago_s)).expect("a time");
        };
        let parts = ["north-20260101.999.mcap", "north-20260101.1000.mcap", "north-20260102.000.mcap"];
        for (name, changed_ago_s) in parts.into_iter().zip([100, 200, 300]) {
            record(name, "north", changed_ago_s);
        }
        // Not of this site: one that only begins with its name. Not a part of a run: a copy.
        record("north-east-20250101.000.mcap", "north-east", 400);
        record("north-copy.mcap", "north", 400);
        let own = path("north-20260102.001.mcap");
        record("north-20260102.001.mcap", "north", 400);

        let mut retention = Retention::new("north", 1);
        retention.look(folder.path(), &own);
        let left = || parts.map(|name| path(name).exists());
        assert_eq!((retention.keep(250 << 10), left()), (0, [true; 3]), "1000 KiB are within the limit");
        // The report of a run goes with its last part.
        let report = path("north-20260101.report.json");
        std::fs::write(&report, "{}").expect("a report");
        assert_eq!((retention.keep(500 << 10), left(), report.exists()), (1, [false, true, true], true));
        assert_eq!((retention.keep(750 << 10), left(), report.exists()), (1, [false, false, true], false));
        assert_eq!((retention.keep(5 << 20), left()), (1, [false; 3]), "the one being written stays");
        for kept in ["north-east-20250101.000.mcap", "north-copy.mcap", "north-20260102.001.mcap"] {
            assert!(path(kept).exists(), "{kept}");
        }
        let mut unlimited = Retention::new("north", 0);
        unlimited.look(folder.path(), &own);
        assert_eq!(unlimited.keep(u64::MAX), 0);
    }
}
