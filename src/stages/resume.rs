//! Where a run stands, for a process that is started again: the next scan of a source, the first number of a tracker.

use std::path::Path;
use std::time::SystemTime;

use common::config::ChainConfig;
use common::status::SiteBoard;
use common::topology::{RECORDER, is_observer};

/// Tracks of a tracker that was started again are numbered from so many further up.
pub(crate) const TRACKS_PER_START: u64 = 1_000_000;

/// Name of a run that begins now.
pub(crate) fn run_id() -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    format!("{}-{:03}", common::time::utc_compact(now.as_secs()), now.subsec_millis())
}

/// Notes in the folder of the domain that the tracker `label` is started again; how often that has been, by this launcher
/// and those before it.
pub(crate) fn note_tracker_start(folder: &Path, label: &str) -> u64 {
    let file = folder.join(format!("{}-starts", label.replace('/', "-")));
    let before: u64 = std::fs::read_to_string(&file).ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    // Where it cannot be written, this launcher's own count is still right for its own restarts.
    let _ = std::fs::write(&file, (before + 1).to_string());
    before + 1
}

/// The scan after the last one that any process of the site has reported.
pub(crate) fn next_scan(board: &SiteBoard, chain: &ChainConfig) -> u32 {
    // The recorder counts scans that are over, and what observers send is not of the chain.
    let stages = board.all().filter(|&(name, ..)| name != RECORDER && !is_observer(name));
    let at_work = stages.filter(|(_, health, _)| health.messages_out > 0 || health.scan > 0);
    let seen = at_work.map(|(_, health, _)| health.scan).max();
    seen.map_or(chain.run.first_scan, |scan| scan + 1)
}
