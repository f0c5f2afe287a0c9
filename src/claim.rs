//! One launcher for a domain at a time: a lock that the kernel releases when the process dies.

use std::fs::File;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::IpcConfig;
use common::ipc::{Domain, IpcError};
use common::process::BadInput;
use rustix::fs::{FlockOperation, OFlags, flock};

/// Whoever tests whether a domain is locked holds the lock for less than this time.
const TEST: Duration = Duration::from_millis(200);

/// Held as long as the launcher looks after the domain.
#[derive(Debug)]
pub(crate) struct Claim {
    path: PathBuf,
    _lock: File,
}

impl Claim {
    /// Locks the domain, or says that another launcher has it.
    pub(crate) fn lock_domain(ipc: &IpcConfig) -> anyhow::Result<Self> {
        let path = Self::path(ipc);
        std::fs::create_dir_all(&ipc.root).with_context(|| format!("creating {}", ipc.root))?;
        let began = Instant::now();
        loop {
            // No link of another user's is followed, and no pipe waited for.
            let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
            let lock = File::options().create(true).append(true).mode(0o600).custom_flags(flags).open(&path);
            if std::fs::symlink_metadata(&path).is_ok_and(|there| !there.is_file()) {
                return Err(BadInput(format!("{} is no regular file: remove it", path.display())).into());
            }
            if lock.as_ref().is_err_and(|error| error.kind() == std::io::ErrorKind::PermissionDenied) {
                return Err(BadInput(format!(
                    "{} belongs to another user: stop that chain, or use another --ipc-prefix",
                    path.display()
                ))
                .into());
            }
            let lock = lock.with_context(|| format!("opening {}", path.display()))?;
            if flock(&lock, FlockOperation::NonBlockingLockExclusive).is_err() {
                if began.elapsed() < TEST {
                    std::thread::sleep(TEST / 10); // it may only be tested
                    continue;
                }
                let prefix = &ipc.prefix;
                return Err(BadInput(format!(
                    "a chain is already running in the domain `{prefix}`: stop it, or use another --ipc-prefix"
                ))
                .into());
            }
            // One that has just ended may have removed the file between the two calls.
            let (held, named) = (lock.metadata()?, std::fs::symlink_metadata(&path));
            let owner = held.uid();
            if owner != rustix::process::geteuid().as_raw() {
                let prefix = &ipc.prefix;
                return Err(IpcError::OtherUser { prefix: prefix.clone(), owner }.into());
            }
            if named.is_ok_and(|named| named.ino() == held.ino()) {
                return Ok(Self { path, _lock: lock });
            }
        }
    }

    /// Whether a living launcher has the domain.
    pub(crate) fn is_locked(ipc: &IpcConfig) -> bool {
        File::open(Self::path(ipc)).is_ok_and(|file| flock(&file, FlockOperation::NonBlockingLockShared).is_err())
    }

    fn path(ipc: &IpcConfig) -> PathBuf {
        Domain::root(ipc).with_extension("lock")
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}
