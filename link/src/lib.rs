//! Topics of a site to and from other hosts.
//!
//! ```text
//! host of the radar:   tracks ──▶ link-out ─┐ messages, numbered          host of the fusion:
//!                                           ├────── Zenoh ──────▶ link-in ──▶ tracks
//!                                  window ◀─┘ which have arrived, clocks
//! ```
//!
//! Zenoh carries bytes and reconnects; that nothing is lost uncounted is the link's own: what is sent is numbered and kept in a
//! [`window::Window`] until the other side has confirmed it, what was lost on the way is sent again, and what had to give way
//! is counted. Both sides measure by how much their monotonic clocks differ ([`clock`]), so that the stamps of a message mean on
//! its new host what they meant on the old one.

pub mod arrivals;
pub mod clock;
pub mod envelope;
pub mod incoming;
mod network;
pub mod outgoing;
pub mod window;
