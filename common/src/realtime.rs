//! Real-time settings of a process, `[realtime.<stage>]`, applied to the operating system.
//!
//! Nothing here is needed for correct results. What the system refuses (permissions, limits, processors that
//! are not there) is said once, shown in status and report, and the process goes on without.

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use thread_priority::unix::{
    RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
};
use thread_priority::{ThreadPriority, ThreadPriorityValue};

use crate::config::{Scheduling, StageRealtime};
use crate::health::RealtimeSetting;

/// Stack that a stage is given for good when its memory is locked, bytes.
const STACK: usize = 512 * 1024;

/// Takes what `settings` ask for and gives the bits of those that were refused ([`RealtimeSetting::bit`]).
///
/// To be called by the main thread before ports are opened: memory that is mapped later is locked, and with that touched, too.
pub fn apply(settings: &StageRealtime) -> u32 {
    let mut refused = 0;
    let mut note = |setting: RealtimeSetting, result: Result<(), String>| {
        if let Err(reason) = result {
            let name = RealtimeSetting::names(setting.bit()).concat();
            tracing::warn!("realtime.{name} refused, going on without: {reason}");
            refused |= setting.bit();
        }
    };
    if !settings.cpus.is_empty() {
        note(RealtimeSetting::Cpus, pin(&settings.cpus));
    }
    if settings.lock_memory {
        let locked = mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE);
        note(RealtimeSetting::LockMemory, locked.map_err(|error| format!("{error} (see `ulimit -l`)")));
        touch_stack();
    }
    if settings.scheduling == Scheduling::Fifo {
        note(RealtimeSetting::Scheduling, run_first(settings.priority));
    }
    refused
}

fn pin(cpus: &[usize]) -> Result<(), String> {
    let mut set = CpuSet::new();
    cpus.iter().filter(|&&cpu| cpu < CpuSet::MAX_CPU).for_each(|&cpu| set.set(cpu));
    sched_setaffinity(None, &set).map_err(|error| format!("processors {cpus:?}: {error}"))?;
    // Of several processors the system takes those that are there, and says nothing of the others.
    let taken = sched_getaffinity(None).map_err(|error| error.to_string())?;
    let missing: Vec<_> = cpus.iter().filter(|&&cpu| cpu >= CpuSet::MAX_CPU || !taken.is_set(cpu)).collect();
    if missing.is_empty() { Ok(()) } else { Err(format!("this machine has no processors {missing:?} for it")) }
}

fn run_first(priority: u8) -> Result<(), String> {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let refused = |cause: String| format!("SCHED_FIFO with priority {priority}: {cause} (see `ulimit -r`)");
    let value = ThreadPriorityValue::try_from(priority).map_err(refused)?;
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy)
        .map_err(|cause| refused(format!("{cause:?}")))
}

/// Uses the stack once, so that no later call meets a page that is not there.
#[inline(never)]
#[expect(clippy::large_stack_arrays, reason = "the stack is what it is about")]
fn touch_stack() {
    std::hint::black_box([0_u8; STACK]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_had_is_refused_and_no_more() {
        // In a thread of its own: affinity is a thread's.
        let refused = std::thread::spawn(|| {
            let on = |cpus| apply(&StageRealtime { cpus, ..StageRealtime::default() });
            [on(vec![1000]), on(vec![0, 1000]), on(vec![0])]
        });
        let cpus = RealtimeSetting::Cpus.bit();
        assert_eq!(refused.join().expect("no panic"), [cpus, cpus, 0]);
        assert_eq!(
            RealtimeSetting::names(RealtimeSetting::Cpus.bit() | RealtimeSetting::LockMemory.bit()),
            ["cpus", "lock_memory"]
        );
    }
}
