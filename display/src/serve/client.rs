//! A viewer as the picture sees it: what it wants, and what waits for it.
//!
//! Nothing ever waits for a viewer. Of video it gets the latest of each sector; everything else has a queue, and who is so
//! slow that the queue is full begins anew with the picture as it then is. What it was not sent is counted, and told.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Message;
use tokio::sync::Notify;

use crate::wire::requests::{Encoding, Want};

/// Messages that wait for a viewer at most, beside the whole picture where it was given that.
const MOST_MESSAGES: usize = 1024;
/// Bytes that wait for a viewer at most, beside the same.
const MOST_BYTES: usize = 8 << 20;

/// As many times more may wait while a viewer is given what has led to a picture, which nobody but the viewer asks for: some tens of
/// scans. Whoever does not keep up with that sees the picture without what has led to it.
const LEAD: usize = 8;

/// A sector of a site.
pub(super) type SectorOf = (usize, u32);

/// One viewer.
#[derive(Debug, Default)]
pub(super) struct Client {
    state: Mutex<State>,
    news: Notify,
}

/// What it wants and what waits for it.
#[derive(Debug, Default)]
pub(super) struct State {
    pub(super) want: Want,
    pub(super) encoding: Encoding,
    /// The track that is explained, by site and number.
    pub(super) follow: Option<(usize, u64)>,
    /// The first message, which nothing that happens to the queue takes away.
    hello: Option<Message>,
    queue: VecDeque<Message>,
    bytes: usize,
    /// Messages and bytes of the whole picture that it was given last: a large one must not put it behind at once.
    picture: (usize, usize),
    video: BTreeMap<SectorOf, Message>,
    dropped: u64,
    told: u64,
    /// It has been told what there is to see; before that it gets nothing else.
    greeted: bool,
    /// It was too slow, and gets nothing before it begins anew.
    behind: bool,
    /// It is given what has led to the picture.
    led: bool,
}

/// What a viewer is to be sent next.
#[derive(Debug)]
pub(super) enum Next {
    /// This.
    Message(Message),
    /// The whole picture, because it was too slow.
    Anew,
}

impl Client {
    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes what it wants or gives it messages, and wakes it if something waits for it then.
    pub(super) fn with<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let mut state = self.state();
        let changed = change(&mut state);
        if state.has_news() {
            self.news.notify_one();
        }
        changed
    }

    /// What it is to be sent next, as soon as there is something.
    pub(super) async fn next(&self) -> Next {
        loop {
            if let Some(next) = self.state().next() {
                return next;
            }
            self.news.notified().await;
        }
    }
}

impl State {
    /// Adds a message, or counts it as dropped; how many messages were dropped by that.
    pub(super) fn push(&mut self, message: Message) -> u64 {
        let (messages, bytes) = self.picture;
        let times = if self.led { LEAD } else { 1 };
        let full = self.queue.len() >= times * MOST_MESSAGES + messages
            || self.bytes + length(&message) > times * MOST_BYTES + bytes;
        if !self.behind && !full {
            self.push_always(message);
            return 0;
        }
        self.behind = true;
        let dropped = 1 + self.queue.len() as u64 + self.video.len() as u64;
        self.queue.clear();
        self.video.clear();
        self.bytes = 0;
        self.dropped += dropped;
        dropped
    }

    /// Adds a message that the viewer has asked for, or the whole picture, which has no bound of its own here.
    pub(super) fn push_always(&mut self, message: Message) {
        self.bytes += length(&message);
        self.queue.push_back(message);
    }

    /// What waits is the whole picture.
    pub(super) fn has_picture(&mut self) {
        self.picture = (self.queue.len(), self.bytes);
    }

    /// From now on, or no longer, what comes is what has led to the picture, and then part of it.
    pub(super) fn set_led(&mut self, led: bool) {
        self.led = led;
        self.has_picture();
    }

    /// Adds the video of a sector, in the place of an earlier one that still waits; whether one was dropped.
    pub(super) fn push_video(&mut self, sector: SectorOf, message: Message) -> bool {
        if self.behind {
            return false;
        }
        let replaced = self.video.insert(sector, message).is_some();
        self.dropped += u64::from(replaced);
        replaced
    }

    /// Gives it the first message, after which it gets others.
    pub(super) fn greet(&mut self, hello: Message) {
        self.hello = Some(hello);
        self.greeted = true;
    }

    /// Forgets what waits: it is of a picture that is no more.
    pub(super) fn clear(&mut self) {
        self.queue.clear();
        self.video.clear();
        (self.bytes, self.behind) = (0, false);
    }

    /// What it has not been told yet of messages that it was not sent: how many in all.
    pub(super) fn untold(&mut self) -> Option<u64> {
        let told = std::mem::replace(&mut self.told, self.dropped);
        (told != self.dropped).then_some(self.dropped)
    }

    /// Whether it has been given its first message.
    pub(super) fn is_greeted(&self) -> bool {
        self.greeted
    }

    fn has_news(&self) -> bool {
        self.hello.is_some() || self.behind || !self.queue.is_empty() || !self.video.is_empty()
    }

    fn next(&mut self) -> Option<Next> {
        if let Some(hello) = self.hello.take() {
            return Some(Next::Message(hello));
        }
        if let Some(message) = self.queue.pop_front() {
            self.bytes -= length(&message);
            return Some(Next::Message(message));
        }
        if self.behind {
            return Some(Next::Anew);
        }
        self.video.pop_first().map(|(_, message)| Next::Message(message))
    }
}

fn length(message: &Message) -> usize {
    match message {
        Message::Text(text) => text.len(),
        Message::Binary(bytes) | Message::Ping(bytes) | Message::Pong(bytes) => bytes.len(),
        Message::Close(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(of: &str) -> Message {
        Message::Text(of.into())
    }

    fn sent(state: &mut State) -> Option<String> {
        match state.next()? {
            Next::Message(message) => Some(message.into_text().expect("text").to_string()),
            Next::Anew => Some("anew".into()),
        }
    }

    #[test]
    fn of_video_the_latest_of_each_sector_waits_behind_everything_else() {
        let mut state = State::default();
        state.greet(text("hello"));
        assert!(state.is_greeted());
        assert!(!state.push_video((0, 1), text("1 of scan 0")));
        assert!(!state.push_video((0, 0), text("0 of scan 1")));
        assert!(state.push_video((0, 1), text("1 of scan 1")));
        state.push(text("tracks"));
        let order: Vec<_> = std::iter::from_fn(|| sent(&mut state)).collect();
        assert_eq!(order, ["hello", "tracks", "0 of scan 1", "1 of scan 1"]);
        assert_eq!((state.untold(), state.untold()), (Some(1), None));
    }

    /// Whatever happens before the greeting has been sent, it is sent first.
    #[test]
    fn a_greeting_is_never_lost() {
        let mut state = State::default();
        state.greet(text("hello"));
        state.clear();
        state.push(text("tracks"));
        assert_eq!((sent(&mut state), sent(&mut state)), (Some("hello".into()), Some("tracks".into())));
        state.greet(text("hello"));
        let dropped: u64 = (0..=MOST_MESSAGES).map(|_| state.push(text("x"))).sum();
        assert!(dropped > 0);
        assert_eq!((sent(&mut state), sent(&mut state)), (Some("hello".into()), Some("anew".into())));
    }

    /// Or it would never come to what has happened since.
    #[test]
    fn a_large_picture_leaves_room_for_what_happens_while_it_is_sent() {
        let mut state = State::default();
        (0..2).for_each(|_| state.push_always(text(&"z".repeat(MOST_BYTES))));
        state.has_picture();
        assert_eq!(state.push(text("news")), 0);
        assert_eq!(std::iter::from_fn(|| sent(&mut state)).last(), Some("news".into()));
        // What it asks for itself has a bound.
        (0..4).for_each(|_| state.push_always(text(&"z".repeat(MOST_BYTES))));
        assert_eq!(state.push(text("news")), 5);
    }

    /// A jump in a recording of many tracks fills no memory.
    #[test]
    fn what_has_led_to_a_picture_has_more_room_and_a_bound() {
        let mut state = State::default();
        state.set_led(true);
        let lead = (LEAD * MOST_MESSAGES) as u64;
        assert_eq!((0..lead).map(|_| state.push(text("x"))).sum::<u64>(), 0, "all of it waits");
        assert_eq!(state.push(text("x")), lead + 1, "the bound");
        state.set_led(false);
        assert_eq!(sent(&mut state), Some("anew".into()));
        // What waits of it is part of the picture: what happens next does not put the viewer behind.
        state.clear();
        state.set_led(true);
        (0..lead).for_each(|_| assert_eq!(state.push(text("x")), 0));
        state.set_led(false);
        assert_eq!(state.push(text("news")), 0);
    }

    #[test]
    fn who_is_too_slow_begins_anew_and_knows_what_it_has_missed() {
        let mut state = State::default();
        let pushed = MOST_MESSAGES as u64 + 10;
        let dropped: u64 = (0..pushed).map(|_| state.push(text("x"))).sum();
        assert_eq!(dropped, pushed, "all of them: none was sent");
        assert_eq!(sent(&mut state), Some("anew".into()));
        state.clear();
        assert_eq!(state.push(text("y")), 0);
        assert_eq!((sent(&mut state), sent(&mut state)), (Some("y".into()), None));
        assert_eq!(state.untold(), Some(pushed));
        // A single message that is larger than the queue may be is one too many, too.
        assert_eq!(state.push(text(&"z".repeat(MOST_BYTES + 1))), 1);
    }
}
