//! The page in headless Chromium, used as a reader would. It needs `python3` with the packages that the judge names, and Chromium;
//! without them the test says that it is left out, except where `CI` is set.

#[path = "../display/tests/support/mod.rs"]
mod viewer;

mod support;

use std::path::Path;
use std::process::Command;

use support::{Bench, python_lacks, text_of};
use viewer::address_in;

/// The default scenario: seven drones are in the radar's range from the beginning. How fast the page is, is measured elsewhere.
#[test]
fn a_reader_finds_the_tracks_and_what_the_chain_does_and_reaches_everything_by_keyboard() {
    if python_lacks("playwright.sync_api, axe_playwright_python.sync_playwright", "see tests/judges/display_page.py") {
        return;
    }
    let Some(browser) = support::browser() else { return };
    let bench = Bench::new();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/uav.toml");
    let keys = ["display.enabled=true", "display.listen='127.0.0.1:0'", "display.control=true"];
    let keys = keys.iter().flat_map(|key| ["--set", key]);
    let running = bench.start_config(&config, &["--scans", "0"].into_iter().chain(keys).collect::<Vec<_>>());
    let judge = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/judges/display_page.py"))
        .arg(format!("http://{}", address_in(&bench.root())))
        .args(["--tracks", "5", "--within", "120", "--measure", "3", "--chromium", browser])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("python3");
    assert!(judge.status.success(), "{}", text_of(&judge));
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
}
