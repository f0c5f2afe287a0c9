//! When a process is asked to stop, and how long it has waited for its consumers.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use sd_notify::NotifyState;

use crate::time::monotonic_ns;

static SIGNALS: AtomicU32 = AtomicU32::new(0);

/// Counts SIGINT and SIGTERM; the first asks to stop.
pub(crate) fn catch_signals(second_ends: bool) {
    let installed = ctrlc::set_handler(move || {
        if SIGNALS.fetch_add(1, Ordering::SeqCst) > 0 && second_ends {
            std::process::exit(130);
        }
    });
    if let Err(error) = installed {
        tracing::warn!(%error, "signals are not handled");
    }
}

/// Whether the user has asked to stop.
pub fn stop_requested() -> bool {
    SIGNALS.load(Ordering::Relaxed) > 0
}

/// How often the user has asked to stop.
pub fn signals() -> u32 {
    SIGNALS.load(Ordering::Relaxed)
}

static WAITED_NS: AtomicU64 = AtomicU64::new(0);

/// Notes that this process has stood still for so long because a consumer did not take what it sends.
pub(crate) fn note_waiting(time: Duration) {
    WAITED_NS.fetch_add(time.as_nanos() as u64, Ordering::Relaxed);
}

/// How long this process has stood still for its consumers in all.
pub(crate) fn waited() -> Duration {
    Duration::from_nanos(WAITED_NS.load(Ordering::Relaxed))
}

/// Tells a service manager that watches over this process, at most once a second, that it lives but has to wait
/// for another: not this one is the one that hangs.
pub(crate) fn say_waiting() {
    static SAID_MS: AtomicU64 = AtomicU64::new(0);
    let now_ms = monotonic_ns() / 1_000_000;
    if now_ms.saturating_sub(SAID_MS.load(Ordering::Relaxed)) >= 1000 {
        SAID_MS.store(now_ms, Ordering::Relaxed);
        let _ = sd_notify::notify(&[NotifyState::Watchdog, NotifyState::Status("waiting for a consumer")]);
    }
}
