//! SAPIENT (BSI Flex 335 v2.0): an edge node that registers with a fusion node, says how it is, and reports tracks.
//!
//! ```text
//! connected ─▶ Registration ─▶ RegistrationAck ─▶ StatusReport every status_s, DetectionReport for each report of a track
//!                  Task ─▶ TaskAck                                                          closed: StatusReport goodbye
//! ```
//!
//! Messages are protobuf with their length before them, four octets, little-endian (`framing`). Nothing is reported before the other
//! side has accepted the registration; after a connection has broken, registration begins anew.

mod framing;
mod messages;
mod node;
mod registration;

pub use node::EdgeNode;
