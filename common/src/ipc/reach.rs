//! Who could not be reached: a port whose memory this process cannot map hands over nothing, and iceoryx2 goes on without it.

use std::sync::{Arc, Mutex, PoisonError};

use iceoryx2::identifiers::UniqueNodeId;

use super::services::Ipc;

/// The last port on the other side that could not be connected, noted by the degradation handler of a port.
#[derive(Debug, Clone, Default)]
pub(super) struct Unreachable(Arc<Mutex<Option<u128>>>);

impl Unreachable {
    pub(super) fn note(&self, port: u128) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(port);
    }

    pub(super) fn take(&self) -> Option<u128> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The process of a node.
pub(super) fn process_of(node: &UniqueNodeId) -> Option<u32> {
    u32::try_from(node.pid::<Ipc>().ok()?.value()).ok()
}

/// Whether a process lives: one that has died may wait for its parent to take note.
pub(super) fn lives(pid: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    // After the name, which may hold anything: `) S …`.
    status.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with(['Z', 'X']))
}
