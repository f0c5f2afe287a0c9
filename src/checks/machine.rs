//! What machine this is, as the kernel says, and what it allows.

use common::process::BadInput;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use serde::Serialize;

/// Open files that a process of a chain needs, and for each further site.
const FILES: u64 = 208;
const FILES_PER_SITE: u64 = 144;

/// Raises the limit of open files of this process, and of the stages that it starts, as far as the system allows.
///
/// # Errors
/// [`BadInput`] if that is too few for a chain of so many sites: stages would wait for each other for ever.
pub(crate) fn allow_files(sites: usize) -> Result<(), BadInput> {
    let needed = FILES + FILES_PER_SITE * (sites as u64).saturating_sub(1);
    let limit = getrlimit(Resource::Nofile);
    let _ = setrlimit(Resource::Nofile, Rlimit { current: limit.maximum, maximum: limit.maximum });
    let allowed = getrlimit(Resource::Nofile).current;
    match allowed.filter(|&allowed| allowed < needed) {
        Some(allowed) => Err(BadInput(format!(
            "{allowed} open files are allowed (ulimit -Hn), expected at least {needed} for this chain"
        ))),
        None => Ok(()),
    }
}

/// The machine of a report.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) cores: usize,
    pub(crate) kernel: String,
    pub(crate) memory_mib: u64,
}

/// This machine; what the kernel does not say is empty or 0.
pub(crate) fn describe() -> Machine {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let field = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name))?;
        Some(line.split(':').nth(1)?.trim().to_string())
    };
    let memory = field(&read("/proc/meminfo"), "MemTotal").unwrap_or_default();
    let memory_kib: u64 = memory.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or(0);
    Machine {
        cpu: field(&read("/proc/cpuinfo"), "model name").unwrap_or_default(),
        cores: std::thread::available_parallelism().map_or(0, usize::from),
        kernel: read("/proc/sys/kernel/osrelease").trim().to_string(),
        memory_mib: memory_kib / 1024,
    }
}
