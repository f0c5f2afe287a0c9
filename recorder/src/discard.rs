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
            if is_of_run && is_empty(&path) {
                let _ = std::fs::remove_file(&path);
            }
        }
    }
}

/// Whether a recording can be opened and nothing is found in it, not even something that cannot be read.
fn is_empty(path: &Path) -> bool {
    recording::open(path).is_ok_and(|mut messages| messages.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::ChainConfig;
    use common::recording::Recorded;
    use common::recording::container::{Description, Writer};
    use common::tracks::TracksHeader;

    /// A recording of these messages, closed in order.
    fn recording(messages: &[Recorded]) -> Vec<u8> {
        let mut file = std::io::Cursor::new(Vec::new());
        let mut writer = Writer::new(&mut file, &Description::default(), "", 1 << 20).expect("memory");
        for message in messages {
            writer.write(message.by_ref()).expect("memory");
        }
        writer.finish().expect("memory");
        file.into_inner()
    }

    #[test]
    fn nothing_but_empty_recordings_of_the_run_and_its_draft_are_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let mut chain = ChainConfig::default();
        chain.run.id = "now".into();
        chain.recorder.directory = folder.display().to_string();
        chain.recorder.report = folder.join("report.json").display().to_string();
        let write = |name: &str, octets: &[u8]| std::fs::write(folder.join(name), octets).expect("written");
        write("site1-now.000.mcap", b"");
        write(
            "site1-now.001.mcap",
            &recording(&[Recorded::Tracks(TracksHeader { time_ns: 1, ..TracksHeader::default() }, vec![])]),
        );
        write("site1-now.002.mcap", b"{}\n");
        write("site1-now.003.mcap", b"something else");
        write("site1-now.004.mcap", &recording(&[]));
        write("site1-before.000.mcap", b"");
        let draft = draft_of(Path::new(&chain.recorder.report), &chain.ipc.prefix);
        std::fs::write(&draft, b"").expect("written");
        discard_empty(&Sites::one(chain));
        let mut left: Vec<_> =
            std::fs::read_dir(folder).expect("the folder").flatten().map(|it| it.file_name()).collect();
        left.sort();
        let expected = ["site1-before.000.mcap", "site1-now.001.mcap", "site1-now.002.mcap", "site1-now.003.mcap"];
        assert_eq!(left, expected, "what cannot be read stays");
    }
}
