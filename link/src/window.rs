//! The messages that the other side has not yet confirmed, in order.

use std::collections::VecDeque;

/// Messages on the way at most: what Zenoh and the network hold is bounded by it.
const MOST_ON_THE_WAY: u64 = 64;
/// Bytes that are kept at most; one message is always kept.
const MOST_BYTES: usize = 64 << 20;
/// Nothing has been confirmed for so long: what is on the way is sent again, ns.
const PATIENCE_NS: u64 = 250_000_000;

/// What is kept until it is confirmed. `P` is a message in a form that is cheap to clone.
#[derive(Debug)]
pub struct Window<P> {
    kept: VecDeque<(P, usize)>,
    bytes: usize,
    most: usize,
    /// Number of the oldest one kept.
    oldest: u64,
    /// Number of the one to be sent next.
    next: u64,
    given_up: u64,
    sent_again: u64,
    /// When something was confirmed, or sent first after that.
    progress_ns: u64,
}

impl<P: Clone> Window<P> {
    /// Room for `most` messages.
    pub fn new(most: usize) -> Self {
        Self {
            kept: VecDeque::with_capacity(most),
            bytes: 0,
            most,
            oldest: 0,
            next: 0,
            given_up: 0,
            sent_again: 0,
            progress_ns: 0,
        }
    }

    /// Whether another message can be kept without giving one up.
    pub fn has_room(&self) -> bool {
        self.kept.len() < self.most && self.bytes < MOST_BYTES
    }

    /// Keeps a message of `bytes`; without room, the oldest ones give way, counted.
    pub fn push(&mut self, message: P, bytes: usize) {
        while !self.kept.is_empty() && (self.kept.len() >= self.most || self.bytes + bytes > MOST_BYTES) {
            self.drop_oldest();
            self.given_up += 1;
        }
        self.next = self.next.max(self.oldest);
        self.bytes += bytes;
        self.kept.push_back((message, bytes));
    }

    fn drop_oldest(&mut self) {
        if let Some((_, bytes)) = self.kept.pop_front() {
            self.bytes -= bytes;
            self.oldest += 1;
        }
    }

    /// Notes that the other side expects `next` and has, if there is a `gap`, received later ones already.
    pub fn confirm(&mut self, next: u64, gap: bool, now_ns: u64) {
        if next > self.end() {
            return; // of no message that was ever sent
        }
        if next > self.oldest {
            self.progress_ns = now_ns;
        }
        while self.oldest < next {
            self.drop_oldest();
        }
        self.next = self.next.max(self.oldest);
        // Once for each gap: what is on the way again has had no time to arrive yet.
        if gap && now_ns.saturating_sub(self.progress_ns) > PATIENCE_NS / 10 {
            self.go_back(now_ns);
        }
    }

    /// The next message that goes on the way, with its number.
    pub fn next_to_send(&mut self, now_ns: u64) -> Option<(u64, P)> {
        if self.next > self.oldest && now_ns.saturating_sub(self.progress_ns) > PATIENCE_NS {
            self.go_back(now_ns);
        }
        if self.next - self.oldest >= MOST_ON_THE_WAY {
            return None;
        }
        let message = self.kept.get((self.next - self.oldest) as usize)?.0.clone();
        if self.next == self.oldest {
            self.progress_ns = now_ns;
        }
        self.next += 1;
        Some((self.next - 1, message))
    }

    fn go_back(&mut self, now_ns: u64) {
        self.sent_again += self.next - self.oldest;
        self.next = self.oldest;
        self.progress_ns = now_ns;
    }

    /// Number of the oldest message kept.
    pub fn oldest(&self) -> u64 {
        self.oldest
    }

    /// Number of the next message that will be kept.
    pub fn end(&self) -> u64 {
        self.oldest + self.kept.len() as u64
    }

    /// Whether everything has been confirmed.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Messages that gave way before they were confirmed.
    pub fn given_up(&self) -> u64 {
        self.given_up
    }

    /// Messages sent more than once.
    pub fn sent_again(&self) -> u64 {
        self.sent_again
    }
}
