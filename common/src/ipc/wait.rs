//! Sleeping until there is something to do.

use std::time::Duration;

use iceoryx2::port::listener::Listener;
use iceoryx2::prelude::*;

use super::IpcError;
use super::station::{EventService, Ipc};
use crate::services::Topic;

/// Longest sleep: the stop flag and the health report are looked after this often.
const TICK: Duration = Duration::from_millis(100);

/// Is woken by the messages of one topic.
#[derive(Debug)]
pub struct Wake {
    listener: Listener<Ipc>,
    topic: Topic,
}

impl Wake {
    pub(super) fn new(event: &EventService, topic: Topic) -> Result<Self, IpcError> {
        let listener = event.listener_builder().create().map_err(|cause| IpcError::Port {
            port: "listener",
            topic: topic.name(),
            reason: format!("{cause:?}"),
        })?;
        Ok(Self { listener, topic })
    }
}

/// What a step of a process asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Sleep until something arrives.
    Wait,
    /// The process has done its work.
    End,
}

/// Calls `step` whenever a message has arrived on one of the topics, a signal has come
/// or 100 ms have passed, until it returns [`Flow::End`]. `step` must take **all** waiting messages.
///
/// # Errors
/// [`IpcError::Port`] if waiting is impossible; the errors of `step`.
pub fn attend<E: From<IpcError>>(wakes: &[&Wake], mut step: impl FnMut() -> Result<Flow, E>) -> Result<(), E> {
    let failed = |topic: &'static str, cause: &dyn std::fmt::Debug| IpcError::Port {
        port: "wait set",
        topic,
        reason: format!("{cause:?}"),
    };
    let wait_set = WaitSetBuilder::new()
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<Ipc>()
        .map_err(|cause| failed("all", &cause))?;
    let mut guards = Vec::with_capacity(wakes.len());
    for wake in wakes {
        guards.push(wait_set.attach_notification(&wake.listener).map_err(|cause| failed(wake.topic.name(), &cause))?);
    }
    loop {
        if step()? == Flow::End {
            return Ok(());
        }
        // Its result only tells signals apart, which `step` sees by the stop flag.
        let _ = wait_set.wait_and_process_once_with_timeout(
            |_| {
                for wake in wakes {
                    let _ = wake.listener.try_wait(|_| {});
                }
                CallbackProgression::Continue
            },
            TICK,
        );
    }
}
