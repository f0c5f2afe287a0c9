//! How many messages waited in the queue of a consumer, from the times at which they were published and taken: a message has
//! found as many before it as were taken after it had been published.

use std::collections::VecDeque;

/// The queue of one consumer.
#[derive(Debug)]
pub(super) struct Backlog {
    /// When messages were taken that later ones may have found waiting, ns of CLOCK_MONOTONIC.
    taken_ns: VecDeque<u64>,
    room: usize,
    most: Option<u32>,
}

impl Backlog {
    /// A queue with room for so many messages.
    pub(super) fn new(room: usize) -> Self {
        Self { taken_ns: VecDeque::with_capacity(room), room, most: None }
    }

    /// Notes a message that was published at one time and taken at another, ns of CLOCK_MONOTONIC; 0 for a message that does not say when.
    pub(super) fn take(&mut self, published_ns: u64, taken_ns: u64) {
        if published_ns == 0 {
            return;
        }
        while self.taken_ns.front().is_some_and(|&before_ns| before_ns < published_ns) {
            self.taken_ns.pop_front();
        }
        self.most = self.most.max(Some(self.taken_ns.len() as u32));
        if self.taken_ns.len() == self.room {
            self.taken_ns.pop_front();
        }
        self.taken_ns.push_back(taken_ns);
    }

    /// The most that a message has found waiting since the last call; `None` where none has said when it was published.
    pub(super) fn take_most(&mut self) -> Option<u32> {
        self.most.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_finds_those_that_are_taken_after_it_was_published() {
        let mut backlog = Backlog::new(4);
        for published_ns in [10, 20, 30] {
            backlog.take(published_ns, published_ns + 1);
        }
        assert_eq!(backlog.take_most(), Some(0), "each was taken before the next one came");
        // Three come while nobody takes any; a fourth when one of them has been taken.
        for (published_ns, taken_ns) in [(40, 50), (41, 60), (42, 70), (55, 80)] {
            backlog.take(published_ns, taken_ns);
        }
        assert_eq!((backlog.take_most(), backlog.take_most()), (Some(2), None));
        for k in 0..100 {
            backlog.take(100, 101 + k);
        }
        assert_eq!(backlog.take_most(), Some(4), "no more than there is room for");
    }
}
