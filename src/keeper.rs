//! The stage `keeper`: what the launcher does for a chain whose stages a service manager starts and restarts.
//!
//! It holds the services open, cleans up after dead processes, serves metrics, and writes down where the run
//! stands, so that a stage started again with `--resume` goes on there.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::{ChainConfig, Sites};
use common::ipc::{Domain, Flow};
use common::process::{Resume, StageArgs, resume_file, stop_requested};

use crate::claim::Claim;
use crate::stages::name::KEEPER;
use crate::stages::resume::{TRACKS_PER_START, next_scan, run_id};
use crate::watch::endpoint::{Endpoint, Look};
use common::status::SiteBoard;

/// Asked to stop, it waits so long for the stages to go first.
const LAST: Duration = Duration::from_secs(20);
/// The place of the run is written this often.
const WRITE: Duration = Duration::from_millis(200);

/// Runs the process until it is asked to stop.
pub(crate) fn keep(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let sites = args.load_sites()?;
    let ipc = &sites.first().ipc;
    let _claim = Claim::lock_domain(ipc)?;
    let domain = Domain::enter(ipc)?;
    if !domain.is_alive() {
        domain.remove(); // what a killed chain has left
    }
    let ended = hold(&sites);
    let domain = Domain::enter(ipc)?;
    if !domain.is_alive() {
        domain.remove();
    }
    ended.map(|()| ExitCode::SUCCESS)
}

fn hold(sites: &Sites) -> anyhow::Result<()> {
    let (mut endpoint, wakes) = Endpoint::open(KEEPER, sites)?;
    let root = Domain::root(&sites.first().ipc);
    write(&root, "chain.toml", &sites.to_toml())?;
    let several = sites.only().is_none();
    let mut places: Vec<Place> = sites.all().iter().map(|site| Place::find(&root, site, several)).collect();
    let run = places.iter().find_map(|place| place.run.clone());
    let given = Some(sites.first().run.id.clone()).filter(|id| !id.is_empty());
    let run = run.or(given).unwrap_or_else(run_id);
    for (place, (_, board)) in places.iter().zip(endpoint.board.sites()) {
        place.write(&root, &run, board)?;
    }
    let (mut written, mut unwritten, mut asked) = (Instant::now(), false, None);
    endpoint.watch(&wakes, |endpoint| {
        for (place, (_, board)) in places.iter_mut().zip(endpoint.board.sites()) {
            place.note_tracker(board);
        }
        if written.elapsed() > WRITE && !endpoint.board.is_empty() {
            written = Instant::now();
            let boards = endpoint.board.sites().map(|(_, board)| board);
            // A full disk is no reason to leave the stages alone.
            let noted = places.iter().zip(boards).try_for_each(|(place, board)| place.write(&root, &run, board));
            if let Some(error) = noted.as_ref().err().filter(|_| !unwritten) {
                tracing::warn!("{error:#}: a stage that is started again goes on at an earlier place");
            }
            unwritten = noted.is_err();
        }
        let mut flow = Flow::Wait;
        if stop_requested() {
            let since = *asked.get_or_insert_with(Instant::now);
            let alone = endpoint.domain().inhabitants().iter().all(|of| of.process == KEEPER);
            flow = if alone || since.elapsed() > LAST { Flow::End } else { Flow::Wait };
        }
        Ok(Look { flow, restarts: 0 })
    })
}

/// Where the run of one site stands.
#[derive(Debug)]
struct Place {
    chain: ChainConfig,
    file: String,
    /// Identity of the run that a keeper which has died had written down.
    run: Option<String>,
    /// The present tracker, and how many there have been: each numbers its new tracks from further up.
    tracker_session: u64,
    tracker_starts: u64,
}

impl Place {
    /// The place that an earlier keeper of this run has written down, or the beginning.
    fn find(root: &Path, chain: &ChainConfig, several: bool) -> Self {
        let file = resume_file(several.then_some(&chain.site.name));
        let text = std::fs::read_to_string(root.join(&file)).unwrap_or_default();
        let value = |of: Resume| text.lines().find_map(|line| line.strip_prefix(of.key())?.strip_prefix('='));
        let first_track = value(Resume::Tracks).and_then(|number| number.parse::<u64>().ok());
        let starts = first_track.map_or(0, |first| first.saturating_sub(chain.run.first_track) / TRACKS_PER_START);
        let run = value(Resume::Run).map(|run| run.trim_matches('"').to_string());
        Self { chain: chain.clone(), file, run, tracker_session: 0, tracker_starts: starts }
    }

    fn note_tracker(&mut self, board: &SiteBoard) {
        let tracker = board.of(tracker::process::NAME).filter(|tracker| tracker.session != self.tracker_session);
        if let Some(tracker) = tracker {
            self.tracker_session = tracker.session;
            self.tracker_starts += 1;
        }
    }

    /// Writes down where the run stands, as overrides of the configuration.
    fn write(&self, root: &Path, run: &str, board: &SiteBoard) -> anyhow::Result<()> {
        let first_track = self.chain.run.first_track + TRACKS_PER_START * self.tracker_starts;
        let [scan, tracks, id] = [Resume::Scan, Resume::Tracks, Resume::Run].map(Resume::key);
        let next = next_scan(board, &self.chain);
        write(root, &self.file, &format!("{scan}={next}\n{tracks}={first_track}\n{id}=\"{run}\"\n"))
    }
}

/// Writes a file of the domain whole or not at all.
fn write(root: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let (file, draft) = (root.join(name), root.join(format!("{name}.tmp")));
    std::fs::write(&draft, text)
        .and_then(|()| std::fs::rename(&draft, &file))
        .with_context(|| format!("writing {}", file.display()))
}
