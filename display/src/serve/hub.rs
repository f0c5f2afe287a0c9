//! All viewers: each gets what it wants of a message, which is written once for all that want it alike.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use axum::extract::ws::Message;

use super::client::{Client, State};
use crate::picture::video::SectorVideo;
use crate::wire::requests::{Encoding, Want};
use crate::wire::video::frame;

/// Kinds of messages that are sent to whoever wants them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Beam,
    Plots,
    Tracks,
    Truth,
    SystemTracks,
    Maps,
    Health,
    Events,
    /// What everybody has to know.
    All,
}

impl Kind {
    fn is_wanted(self, want: &Want) -> bool {
        match self {
            Self::Beam | Self::All => true,
            Self::Plots => want.plots,
            Self::Tracks => want.tracks,
            Self::Truth => want.truth,
            Self::SystemTracks => want.system_tracks,
            Self::Maps => want.maps,
            Self::Health => want.health,
            Self::Events => want.events,
        }
    }
}

/// The viewers there are.
#[derive(Debug)]
pub(super) struct Hub {
    clients: Mutex<Vec<Arc<Client>>>,
    most: usize,
    sent: AtomicU64,
    dropped: AtomicU64,
    refused: AtomicU64,
}

/// What has become of messages and viewers so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages given to viewers.
    pub sent: u64,
    /// Messages that slow viewers were not sent.
    pub dropped: u64,
    /// Connections and viewers beyond the limit.
    pub refused: u64,
}

impl Hub {
    /// Room for so many viewers.
    pub(super) fn new(most: usize) -> Self {
        let (sent, dropped, refused) = Default::default();
        Self { clients: Mutex::default(), most, sent, dropped, refused }
    }

    /// A new viewer, if there is room.
    pub(super) fn join(&self) -> Option<Arc<Client>> {
        let mut clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        if clients.len() >= self.most {
            self.refuse();
            return None;
        }
        let client = Arc::new(Client::default());
        clients.push(Arc::clone(&client));
        Some(client)
    }

    /// A viewer has gone.
    pub(super) fn leave(&self, client: &Arc<Client>) {
        let mut clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        clients.retain(|of| !Arc::ptr_eq(of, client));
    }

    /// Counts a connection that was not let in.
    pub(super) fn refuse(&self) {
        self.refused.fetch_add(1, Ordering::Relaxed);
    }

    /// The counts so far.
    pub(super) fn counts(&self) -> Counts {
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        Counts { sent: read(&self.sent), dropped: read(&self.dropped), refused: read(&self.refused) }
    }

    /// Whether anybody wants something of this kind.
    pub(super) fn wants(&self, kind: Kind) -> bool {
        self.any(|state| kind.is_wanted(&state.want))
    }

    /// Whether anybody wants video.
    pub(super) fn wants_video(&self) -> bool {
        self.any(|state| state.want.video.is_some())
    }

    /// Whether anybody follows a track of this site.
    pub(super) fn follows(&self, site: usize) -> bool {
        self.any(|state| state.follow.is_some_and(|(of, _)| of == site))
    }

    fn any(&self, is: impl Fn(&State) -> bool) -> bool {
        let clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        clients.iter().any(|client| is(&client.state()))
    }

    fn each(&self, mut give: impl FnMut(&mut State) -> bool) {
        let clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        for client in clients.iter() {
            let given = client.with(|state| state.is_greeted() && give(state));
            self.sent.fetch_add(given.into(), Ordering::Relaxed);
        }
    }

    fn give(&self, state: &mut State, message: Message) -> bool {
        let dropped = state.push(message);
        self.dropped.fetch_add(dropped, Ordering::Relaxed);
        dropped == 0
    }

    /// Sends a message to whoever wants its kind; `write` makes it once for each encoding that is asked for.
    pub(super) fn publish(&self, kind: Kind, write: impl Fn(Encoding) -> Message) {
        let (mut binary, mut json) = (None, None);
        self.each(|state| {
            if !kind.is_wanted(&state.want) {
                return false;
            }
            let place = if state.encoding == Encoding::Json { &mut json } else { &mut binary };
            let message = place.get_or_insert_with(|| write(state.encoding)).clone();
            self.give(state, message)
        });
    }

    /// Sends a message of text to whoever wants its kind.
    pub(super) fn publish_text(&self, kind: Kind, write: impl Fn() -> String) {
        self.publish(kind, |_| Message::Text(write().into()));
    }

    /// Sends the video of a sector, as fine as each viewer wants it.
    pub(super) fn publish_video(&self, site: usize, name: &str, video: &SectorVideo) {
        let mut written = BTreeMap::new();
        self.each(|state| {
            let Some(fineness) = state.want.video else { return false };
            let message =
                written.entry(fineness).or_insert_with(|| Message::Binary(frame(name, video, fineness).into()));
            let replaced = state.push_video((site, video.sector), message.clone());
            self.dropped.fetch_add(replaced.into(), Ordering::Relaxed);
            true
        });
    }

    /// Explains tracks to those who follow them; `explain` has the message of a track of the site that was updated.
    pub(super) fn publish_followed(&self, site: usize, explain: impl Fn(u64) -> Option<String>) {
        self.each(|state| {
            let followed = state.follow.filter(|&(of, _)| of == site);
            let Some(text) = followed.and_then(|(_, track)| explain(track)) else { return false };
            self.give(state, Message::Text(text.into()))
        });
    }

    /// From now on, or no longer, viewers are given what has led to a picture.
    pub(super) fn set_each_led(&self, led: bool) {
        self.each(|state| {
            state.set_led(led);
            false
        });
    }

    /// Gives every viewer the picture anew, which `write` puts into its queue.
    pub(super) fn begin_anew(&self, write: impl Fn(&mut State)) {
        self.each(|state| {
            state.clear();
            write(state);
            true
        });
    }
}
