//! When a process is asked to stop, and how long it has waited for its consumers.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use sd_notify::NotifyState;
use signal_hook::consts::{SIGHUP, SIGTERM};
use signal_hook::flag;
use signal_hook::iterator::Signals;

use crate::time::monotonic_ns;

static SIGNALS: AtomicU32 = AtomicU32::new(0);

/// Who is asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// A process that works alone: the second signal ends it at once. SIGHUP does not count: the system sends it to a stage
    /// that stands still when its launcher dies, and the stages of a dead launcher go on.
    Worker,
    /// A process that ends others: it lives on at the second signal, and ends them when its terminal is closed.
    Supervisor,
}

impl Asked {
    fn once_more(self) {
        if SIGNALS.fetch_add(1, Ordering::SeqCst) > 0 && self == Self::Worker {
            std::process::exit(130);
        }
    }
}

/// Counts Ctrl-C (SIGINT) and SIGTERM, for a supervisor SIGHUP too; the first asks to stop.
pub(crate) fn catch_signals(asked: Asked) {
    let install = || -> anyhow::Result<()> {
        ctrlc::set_handler(move || asked.once_more())?;
        // The crate above takes SIGHUP for Ctrl-C or leaves SIGTERM alone.
        let mut signals = Signals::new([SIGTERM])?;
        match asked {
            Asked::Worker => drop(flag::register(SIGHUP, Arc::new(AtomicBool::new(false)))?), // nobody looks at it
            Asked::Supervisor => signals.add_signal(SIGHUP)?,
        }
        let wait = move || signals.forever().for_each(|_| asked.once_more());
        std::thread::Builder::new().name("signals".into()).spawn(wait)?;
        Ok(())
    };
    if let Err(error) = install() {
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
