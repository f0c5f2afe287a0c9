//! Datagrams from the network, and to it, for the sources that listen.

mod clock;
mod ears;
mod endpoint;

pub use clock::LiveClock;
pub use ears::Ears;
pub use endpoint::{Endpoint, LARGEST_DATAGRAM, NetworkError};
