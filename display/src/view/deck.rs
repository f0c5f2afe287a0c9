//! The recordings of all sites of a run, as one stream in the order of time.

use std::iter::Peekable;

use common::recording::Recorded;

use super::tape::{Messages, Tape};

/// Recordings being read.
pub(crate) struct Deck {
    messages: Vec<Peekable<Messages>>,
}

impl Deck {
    /// All recordings from the chunks on that hold `time_ns`.
    pub(crate) fn from(tapes: &[Tape], time_ns: u64) -> Self {
        Self { messages: tapes.iter().map(|tape| tape.from(time_ns).peekable()).collect() }
    }

    /// Time of the next message, ns UTC; `None` at the end.
    pub(crate) fn next_ns(&mut self) -> Option<u64> {
        self.messages.iter_mut().filter_map(|messages| messages.peek().map(|&(time_ns, _)| time_ns)).min()
    }

    /// The next message until `time_ns`, with the number of its site.
    pub(crate) fn next_until(&mut self, time_ns: u64) -> Option<(usize, Recorded)> {
        let waiting = self.messages.iter_mut().enumerate();
        let times = waiting.filter_map(|(site, messages)| messages.peek().map(|&(time_ns, _)| (time_ns, site)));
        let (next_ns, site) = times.min()?;
        if next_ns > time_ns {
            return None;
        }
        self.messages[site].next().map(|(_, message)| (site, message))
    }
}
