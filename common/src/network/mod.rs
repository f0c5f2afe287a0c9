//! Datagrams from the network, and to it, for the sources that listen.

mod clock;
mod ears;
mod endpoint;

pub use clock::LiveClock;
pub use ears::Ears;
pub use endpoint::{Endpoint, LARGEST_DATAGRAM, NetworkError};

/// What the user should know of a chain that waits for its consumers, and of a radar that waits for nobody.
pub const NO_WAITING: &str = "a radar is listened to with `run.mode` = \"lossless\": it does not wait, and what it sends while the \
                              chain is held up may be lost on the network (--set run.mode=real-time)";
