//! Ways to other systems. None ever waits: what a peer does not take now is kept in a bounded room or dropped, and counted.

mod datagrams;
mod listeners;
mod outbox;
mod peer;
mod retried;

use std::time::Instant;

use common::config::{Destination, OutputConfig};
use common::process::BadInput;

pub use datagrams::Datagrams;
pub use listeners::Listeners;
pub use peer::Peer;
use retried::Retried;

/// Frames by what has become of them.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Handed to the system, for each peer.
    pub sent: u64,
    /// Not taken: nobody is connected, the peer is slow, or the system refuses.
    pub dropped: u64,
}

/// What has happened on a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A peer has been connected to.
    Opened,
    /// The peer has said something.
    Heard(Vec<u8>),
}

/// A way to another system.
pub trait Line {
    /// Sends a frame, keeps it until the peer takes it, or drops it.
    fn send(&mut self, frame: &[u8]);

    /// Does what can be done now: connects, sends what waits, listens.
    fn attend(&mut self, now: Instant, events: &mut Vec<Event>);

    /// Ends a connection that is of no more use, so that a new one is made.
    fn give_up(&mut self, _why: &str, _now: Instant) {}

    /// Frames so far.
    fn counts(&self) -> Counts;

    /// Whether frames wait for a peer.
    fn is_waiting(&self) -> bool;
}

/// Opens the line of the output `name`; one that the system refuses is tried again, and said.
///
/// # Errors
/// [`BadInput`]: there is no destination.
pub fn open(name: &str, config: &OutputConfig) -> Result<Box<dyn Line>, BadInput> {
    let none = || BadInput(format!("output `{name}`: {}: it names no destination", config.to));
    let (what, name) = (format!("output `{name}`: {}", config.to), name.to_string());
    let (room, config) = (config.queue_bytes, config.clone());
    Ok(match config.destination().ok_or_else(none)? {
        Destination::Peer(to) => Box::new(Peer::new(&name, to, room)),
        Destination::Datagrams(to) => {
            Box::new(Retried::new(what, move || Ok(Box::new(Datagrams::open(&name, to, &config)?))))
        }
        Destination::Listeners(at) => {
            Box::new(Retried::new(what, move || Ok(Box::new(Listeners::open(&name, at, room)?))))
        }
    })
}
