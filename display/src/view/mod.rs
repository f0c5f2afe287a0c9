//! `radar-chain view`: the picture of recordings, with a time line.
//!
//! ```text
//! tape (a site's files) ─▶ deck (all sites by time) ─▶ player ─▶ picture
//! ```

mod deck;
mod player;
mod tape;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::Duration;

use anyhow::Context;
use common::config::Sites;
use common::process::{BadInput, stop_requested, tell};
use common::recording::Recorded;
use common::units::NS_PER_S;

use crate::picture::Picture;
use crate::picture::events::EventLog;
use crate::serve::{Access, Served, bind, serve};
use crate::wire::hello::Extent;
pub(crate) use deck::Deck;
use player::{Order, Player};
pub(crate) use tape::Tape;

/// What viewers want of the player waits up to this number of orders; more is refused.
const MOST_ORDERS: usize = 256;
/// How long the process sleeps between two looks for a signal.
const SLEEP: Duration = Duration::from_millis(50);

/// Serves the picture of the recordings of one run, one for each site, with their later parts, until it is asked to stop.
/// `listen` is where and to whom, an address and a file with a token, in the place of what the recorded configuration says.
///
/// # Errors
/// A file cannot be read, is not a recording, or is of another run; the address cannot be used, or anybody could look without a
/// token.
pub fn run(files: &[PathBuf], listen: Option<(&str, &str)>) -> anyhow::Result<ExitCode> {
    let tapes = files.iter().map(|file| Tape::open(file)).collect::<anyhow::Result<Vec<_>>>()?;
    let (mut sites, (from_ns, to_ns)) = sites_and_extent(&tapes)?;
    if let Some((address, token_file)) = listen {
        sites.change(|site| (site.display.listen, site.display.token_file) = (address.into(), token_file.into()));
    }
    let chain = sites.first();
    // The command line has names of its own for these keys.
    let by_option =
        |text: String| text.replace("key `display.listen`", "--listen").replace("display.token_file", "--token-file");
    let refused = |text: String| BadInput(if listen.is_some() { by_option(text) } else { text });
    chain.display.check().map_err(|error| refused(error.to_string()))?;
    let listener = bind(chain.display.address())?;
    let address = listener.local_addr()?;
    let (from_s, to_s) = (from_ns as f64 / NS_PER_S, to_ns as f64 / NS_PER_S);
    let extent = Extent { from_s, to_s, files: tapes.iter().map(Tape::files).sum() };
    let (orders, ordered) = sync_channel(MOST_ORDERS);
    let of_viewers = orders.clone();
    let tell_player = move |wanted| of_viewers.try_send(Order::Viewer(wanted)).is_ok();
    let access = Access::new(&chain.display.token_file)?;
    let served = Arc::new(Served::recording(&sites, access, extent, Box::new(tell_player)));
    let (player_sites, player_tapes, player_served) = (sites.clone(), tapes.clone(), Arc::clone(&served));
    let player = thread::Builder::new().name("player".into());
    player
        .spawn(move || Player::new(player_served, &player_sites, player_tapes, (from_ns, to_ns)).run(&ordered))
        .context("starting the player")?;
    serve(listener, served)?;
    tell(&format!("picture: http://{address}, {:.0} s of {}", to_s - from_s, sites.names().join(", ")));
    let finder = thread::Builder::new().name("events".into());
    finder
        .spawn(move || {
            let (events, actions) = events(&sites, &tapes);
            orders.send(Order::Events(events, actions))
        })
        .context("looking for events")?;
    while !stop_requested() {
        thread::sleep(SLEEP);
    }
    Ok(ExitCode::SUCCESS)
}

/// The configuration of the sites whose recordings these are, and the times of the first and the last message, ns UTC.
pub(crate) fn sites_and_extent(tapes: &[Tape]) -> anyhow::Result<(Sites, (u64, u64))> {
    let sites = Sites::several(tapes.iter().map(|tape| tape.site.clone()).collect())?;
    let extents = || tapes.iter().filter_map(Tape::extent_ns);
    let extent = extents().map(|of| of.0).min().zip(extents().map(|of| of.1).max());
    Ok((sites, extent.ok_or_else(|| BadInput("the recording holds no messages".into()))?))
}

/// All that has happened in the recordings, and what operators have done, site by site.
fn events(sites: &Sites, tapes: &[Tape]) -> (EventLog, Vec<(usize, Recorded)>) {
    let (mut picture, mut actions) = (Picture::new(sites), Vec::new());
    picture.events = EventLog::of_recording();
    let mut deck = Deck::from(tapes, 0);
    while let Some((site, message)) = deck.next_until(u64::MAX) {
        if !matches!(message, Recorded::Dwells(..)) {
            picture.take(site, message.by_ref(), 0);
        }
        if let Recorded::Actions(..) = message {
            actions.push((site, message));
        }
    }
    (picture.events.whole(), actions)
}
