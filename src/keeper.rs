//! The stage `keeper`: what the launcher does for a chain whose stages a service manager starts and restarts.
//!
//! It holds the services open, cleans up after dead processes, serves metrics, and writes down where the run
//! stands, so that a stage started again with `--resume` goes on there.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::ChainConfig;
use common::ipc::{Domain, Flow};
use common::process::{RESUME_FILE, Resume, StageArgs, stop_requested};

use crate::board::Board;
use crate::claim::Claim;
use crate::post::{Look, Post};
use crate::run::run_id;
use crate::supervisor::{TRACKS_PER_START, next_scan};

/// Name of the process.
pub(crate) const NAME: &str = "keeper";
/// Asked to stop, it waits so long for the stages to go first.
const LAST: Duration = Duration::from_secs(20);
/// The place of the run is written this often.
const WRITE: Duration = Duration::from_millis(200);

/// Runs the process until it is asked to stop.
pub(crate) fn keep(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let _claim = Claim::take(&chain.ipc)?;
    let domain = Domain::enter(&chain.ipc)?;
    if !domain.is_alive() {
        domain.remove(); // what a killed chain has left
    }
    let ended = hold(&chain);
    let domain = Domain::enter(&chain.ipc)?;
    if !domain.is_alive() {
        domain.remove();
    }
    ended.map(|()| ExitCode::SUCCESS)
}

fn hold(chain: &ChainConfig) -> anyhow::Result<()> {
    let (mut post, wake) = Post::take(NAME, chain)?;
    let root = Domain::root(&chain.ipc);
    write(&root, "chain.toml", &chain.to_toml())?;
    let (run, mut trackers) = earlier(&root, chain).unwrap_or_else(|| {
        let given = Some(chain.run.id.clone()).filter(|id| !id.is_empty());
        (given.unwrap_or_else(run_id), Trackers::default())
    });
    write_place(&root, chain, &run, &post.board, &trackers)?;
    let (mut written, mut unwritten, mut asked) = (Instant::now(), false, None);
    post.hold(&wake, |post| {
        trackers.note(&post.board);
        if written.elapsed() > WRITE && !post.board.is_empty() {
            written = Instant::now();
            // A full disk is no reason to leave the stages alone.
            let noted = write_place(&root, chain, &run, &post.board, &trackers);
            if let Some(error) = noted.as_ref().err().filter(|_| !unwritten) {
                tracing::warn!("{error:#}: a stage that is started again goes on at an earlier place");
            }
            unwritten = noted.is_err();
        }
        let mut flow = Flow::Wait;
        if stop_requested() {
            let since = *asked.get_or_insert_with(Instant::now);
            let alone = post.domain().inhabitants().iter().all(|(name, _)| name == NAME);
            flow = if alone || since.elapsed() > LAST { Flow::End } else { Flow::Wait };
        }
        Ok(Look { flow, restarts: 0 })
    })
}

/// What a keeper of this run that has died had written down.
fn earlier(root: &Path, chain: &ChainConfig) -> Option<(String, Trackers)> {
    let place = std::fs::read_to_string(root.join(RESUME_FILE)).ok()?;
    let value = |of: Resume| place.lines().find_map(|line| line.strip_prefix(of.key())?.strip_prefix('='));
    let first_track: u64 = value(Resume::Tracks)?.parse().ok()?;
    let starts = first_track.saturating_sub(chain.run.first_track) / TRACKS_PER_START;
    Some((value(Resume::Run)?.trim_matches('"').to_string(), Trackers { session: 0, starts }))
}

/// Sessions of trackers seen: each numbers its tracks anew.
#[derive(Debug, Default)]
struct Trackers {
    session: u64,
    starts: u64,
}

impl Trackers {
    fn note(&mut self, board: &Board) {
        let Some(tracker) = board.of("tracker").filter(|tracker| tracker.session != self.session) else { return };
        self.session = tracker.session;
        self.starts += 1;
    }
}

/// Writes down where the run stands, as overrides of the configuration.
fn write_place(root: &Path, chain: &ChainConfig, run: &str, board: &Board, trackers: &Trackers) -> anyhow::Result<()> {
    let first_track = chain.run.first_track + TRACKS_PER_START * trackers.starts;
    let [scan, tracks, id] = [Resume::Scan, Resume::Tracks, Resume::Run].map(Resume::key);
    let place = format!("{scan}={}\n{tracks}={first_track}\n{id}=\"{run}\"\n", next_scan(board, chain));
    write(root, RESUME_FILE, &place)
}

/// Writes a file of the domain whole or not at all.
fn write(root: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let (file, draft) = (root.join(name), root.join(format!("{name}.tmp")));
    std::fs::write(&draft, text)
        .and_then(|()| std::fs::rename(&draft, &file))
        .with_context(|| format!("writing {}", file.display()))
}
