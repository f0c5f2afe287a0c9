//! A process of the operating system: started by this launcher, or taken over from one that died.

use std::os::fd::OwnedFd;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use anyhow::Context;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, kill_process, pidfd_open, pidfd_send_signal};

use super::name::StageId;

/// One process.
#[derive(Debug)]
pub(crate) enum Process {
    /// Started by this launcher, which learns how it ends.
    Own(Child),
    /// Started by another: only that it ends can be seen.
    Adopted {
        /// Its process identifier.
        pid: u32,
        /// Stands for this process even if the number is given to another.
        handle: OwnedFd,
    },
}

/// This program, even if its file has been replaced meanwhile: all processes of a chain are of one version.
const OWN_PROGRAM: &str = "/proc/self/exe";

/// Exit code, or the signal that ended the process.
type Exit = (Option<i32>, Option<i32>);

impl Process {
    /// Starts this program as the stage `id`. It gets a process group of its own: Ctrl-C in the
    /// terminal must reach the launcher alone, which then ends the source first.
    pub(crate) fn start(id: &StageId, file: &Path, overrides: &[String]) -> anyhow::Result<Self> {
        let mut command = Command::new(OWN_PROGRAM);
        command.arg0(id.label()).arg("stage").arg(id.process()).arg("--config").arg(file);
        if let Some(site) = &id.site_name {
            command.arg("--site").arg(site);
        }
        for argument in overrides {
            command.arg("--set").arg(argument);
        }
        command.stdin(Stdio::null()).process_group(0);
        Ok(Self::Own(command.spawn().with_context(|| format!("starting {id}"))?))
    }

    /// Takes over a living process.
    pub(crate) fn adopt(pid: u32) -> Option<Self> {
        let handle = pidfd_open(Pid::from_raw(pid.cast_signed())?, PidfdFlags::empty()).ok()?;
        Some(Self::Adopted { pid, handle })
    }

    /// Its identifier.
    pub(crate) fn id(&self) -> u32 {
        match self {
            Self::Own(child) => child.id(),
            Self::Adopted { pid, .. } => *pid,
        }
    }

    /// How it ended, if it has. Of an adopted process that `said_end` the end is a good one.
    pub(crate) fn exit(&mut self, said_end: bool) -> anyhow::Result<Option<Exit>> {
        match self {
            Self::Own(child) => {
                let status = child.try_wait().context("waiting for a process")?;
                Ok(status.map(|status| (status.code(), status.signal())))
            }
            Self::Adopted { handle, .. } => {
                let ended = poll(&mut [PollFd::new(handle, PollFlags::IN)], Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))
                    .context("looking after an adopted process")?;
                Ok((ended > 0).then_some((said_end.then_some(0), None)))
            }
        }
    }

    /// Sends a signal.
    pub(crate) fn signal(&self, signal: Signal) {
        let _ = match self {
            Self::Own(child) => match Pid::from_raw(child.id().cast_signed()) {
                Some(pid) => kill_process(pid, signal),
                None => Ok(()),
            },
            Self::Adopted { handle, .. } => pidfd_send_signal(handle, signal),
        };
    }

    /// Ends it at once and waits until it has.
    pub(crate) fn kill(&mut self) {
        match self {
            Self::Own(child) => {
                let _ = child.kill();
                let _ = child.wait();
            }
            Self::Adopted { handle, .. } => {
                let _ = pidfd_send_signal(&*handle, Signal::KILL);
                let _ = poll(&mut [PollFd::new(handle, PollFlags::IN)], None);
            }
        }
    }
}
