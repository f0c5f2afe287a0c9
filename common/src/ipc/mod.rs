//! Shared memory: the only place that knows iceoryx2.
//!
//! - [`Domain`]: prefix and folder that separate one chain from another; clean-up.
//! - [`Station`]: a process in the domain; opens the ports of its site.
//! - [`Publisher`], [`Subscriber`]: one topic each, with the mode's queue policy and
//!   with losses counted from sequence numbers.
//! - [`HopSender`], [`HopReceiver`]: the bare hop that ours are compared with.
//! - [`attend`]: sleep until something arrives or 100 ms have passed.

mod backlog;
mod domain;
mod hop;
mod intake;
mod observers;
mod ports;
mod publisher;
mod reach;
mod services;
mod station;
mod subscriber;
mod wait;

pub use domain::{Domain, Inhabitant, free_bytes, shared_memory_needed};
pub use hop::{HopReceiver, HopSender};
pub use intake::count_intake;
pub use observers::ObserverLosses;
pub use ports::{Publisher, Received, Subscriber};
pub use station::{Keeper, Station};
pub use wait::{Flow, Turn, Wake, Watchdog, attend};

/// Why a port or service cannot be opened. The process cannot work without it: exit code 3.
#[derive(Debug, thiserror::Error)]
pub enum IpcError {
    /// The folder or configuration of the domain cannot be made.
    #[error("cannot prepare shared-memory domain `{prefix}` in {root}: {reason}")]
    Domain {
        /// Prefix of the domain.
        prefix: String,
        /// Its folder.
        root: String,
        /// Why.
        reason: String,
    },
    /// A service cannot be opened or created.
    #[error("cannot open service `{service}` ({schema}, {mode}): {reason}")]
    Service {
        /// Name of the service.
        service: String,
        /// Version of its messages.
        schema: &'static str,
        /// Delivery mode wanted.
        mode: &'static str,
        /// Why.
        reason: String,
    },
    /// A process was killed while it made a service, and no launcher holds the services of this domain open.
    #[error(
        "service `{service}` was left half made ({reason}): end all processes of this domain, then start the chain again"
    )]
    HalfMade {
        /// Name of the service.
        service: String,
        /// What the middleware says.
        reason: String,
    },
    /// A port cannot be created on an open service, or fails.
    #[error("{port} of `{topic}` failed: {reason}")]
    Port {
        /// Publisher, subscriber, listener, notifier.
        port: &'static str,
        /// Which topic.
        topic: &'static str,
        /// Why.
        reason: String,
    },
    /// /dev/shm is too small for the services of this configuration.
    #[error("/dev/shm has {free_mib} MiB free, this chain needs {needed_mib} MiB: enlarge it (containers: --shm-size)")]
    SharedMemoryTooSmall {
        /// Free, MiB.
        free_mib: u64,
        /// Needed at most, MiB.
        needed_mib: u64,
    },
    /// /dev/shm has been filled by others since the chain was started.
    #[error("/dev/shm has {free_mib} MiB left, a segment needs {needed_mib} MiB: another program fills it")]
    SharedMemoryFull {
        /// Free, MiB.
        free_mib: u64,
        /// Missing, MiB.
        needed_mib: u64,
    },
    /// The domain belongs to another user: what this one makes in it, the others cannot open.
    #[error("shared-memory domain `{prefix}` belongs to user {owner}: run this as that user (runuser -u … --)")]
    OtherUser {
        /// Prefix of the domain.
        prefix: String,
        /// User identifier of the owner.
        owner: u32,
    },
    /// The user asked to stop while a message waited for room.
    #[error("stopped while waiting for the consumers of `{topic}`")]
    Stopped {
        /// Which topic.
        topic: &'static str,
    },
}
