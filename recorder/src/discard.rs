//! What is left of a run that has recorded nothing: a stage refused its configuration, and the recorder was killed with the others.

use std::path::Path;

use common::config::Sites;
use common::recording::{self, run_and_part};

use crate::report_place::draft_of;

/// Removes the draft of the report, and the recordings of the run that hold no message.
pub fn discard_empty(sites: &Sites) {
    let chain = sites.first();
    let _ = std::fs::remove_file(draft_of(Path::new(&chain.recorder.report), &chain.ipc.prefix));
    for site in sites.all().iter().filter(|_| !chain.run.id.is_empty()) {
        let entries = std::fs::read_dir(&site.recorder.directory).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            let is_of_run = run_and_part(&path).is_some_and(|(stem, _)| stem.ends_with(&format!("-{}", chain.run.id)));
            let has_messages = || recording::open(&path).is_ok_and(|mut messages| messages.any(|it| it.is_ok()));
            if is_of_run && !has_messages() {
                let _ = std::fs::remove_file(&path);
            }
        }
    }
}
