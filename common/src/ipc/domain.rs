//! A shared-memory domain: chains with different prefixes do not see each other.

use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::time::Duration;

use iceoryx2::node::NodeView;
use iceoryx2::prelude::*;
use rustix::fs::{AtFlags, CWD, Timespec, Timestamps, UTIME_NOW, utimensat};

use super::IpcError;
use crate::config::{ChainConfig, IpcConfig, Sites};
use crate::fnv::fnv1a;
use crate::messages::{ForTopic, Message};
use crate::topic::Topic;
use crate::topology;

/// Where shared-memory segments live on Linux.
const SHARED_MEMORY: &str = "/dev/shm";

/// Between the name of a process and that of its site.
const AT: char = '@';

/// A living process that uses a domain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Inhabitant {
    /// Name of the process.
    pub process: String,
    /// The site that it works for, the first one if it serves several.
    pub site: String,
    /// Process identifier.
    pub pid: u32,
}

impl Inhabitant {
    /// Name of its node.
    pub(super) fn node_name(process: &str, site: &str) -> String {
        format!("{process}{AT}{site}")
    }
}

/// Prefix and folder of one chain's files.
#[derive(Debug, Clone)]
pub struct Domain {
    /// Of the files in shared memory.
    file_prefix: String,
    root: PathBuf,
    config: Config,
}

impl Domain {
    /// Prepares the domain and makes it this process's global one: a node that died
    /// before it wrote its details is only found, and cleaned up, through the global
    /// configuration, which iceoryx2 takes from a file.
    ///
    /// # Errors
    /// [`IpcError::Domain`] if the folder or the file in it cannot be written, [`IpcError::OtherUser`].
    pub fn enter(ipc: &IpcConfig) -> Result<Self, IpcError> {
        let (root, file_prefix) = (Self::root(ipc), Self::file_prefix(ipc));
        let error =
            |reason: String| IpcError::Domain { prefix: ipc.prefix.clone(), root: root.display().to_string(), reason };
        set_log_level(LogLevel::Fatal);
        let mut config = Config::default();
        config.global.prefix =
            FileName::new(file_prefix.as_bytes()).map_err(|cause| error(format!("prefix refused: {cause:?}")))?;
        let root_path = iceoryx2::prelude::Path::new(root.display().to_string().as_bytes())
            .map_err(|cause| error(format!("path refused: {cause:?}")))?;
        config.global.set_root_path(&root_path);

        if let Some(parent) = root.parent() {
            std::fs::create_dir_all(parent).map_err(|cause| error(cause.to_string()))?;
        }
        match std::fs::DirBuilder::new().mode(0o700).create(&root) {
            Err(cause) if cause.kind() != std::io::ErrorKind::AlreadyExists => return Err(error(cause.to_string())),
            _ => {}
        }
        // Of the folder itself: a link would lead to what its maker chose.
        let there = std::fs::symlink_metadata(&root).map_err(|cause| error(cause.to_string()))?;
        if !there.is_dir() {
            return Err(error("it is no folder: remove it".into()));
        }
        let owner = there.uid();
        if owner != rustix::process::geteuid().as_raw() {
            return Err(IpcError::OtherUser { prefix: ipc.prefix.clone(), owner });
        }
        let file = root.join("iceoryx2.toml");
        let text = toml::to_string(&config).map_err(|cause| error(cause.to_string()))?;
        if std::fs::read_to_string(&file).is_ok_and(|present| present == text) {
            // Another process of the chain has written it.
        } else {
            let draft = root.join(format!("iceoryx2.toml.{}", std::process::id()));
            std::fs::write(&draft, text)
                .and_then(|()| std::fs::rename(&draft, &file))
                .map_err(|cause| error(cause.to_string()))?;
        }
        let path = FilePath::new(file.display().to_string().as_bytes())
            .map_err(|cause| error(format!("path refused: {cause:?}")))?;
        Config::setup_global_config_from_file(&path).map_err(|cause| error(format!("{cause:?}")))?;
        Ok(Self { file_prefix, root, config })
    }

    /// Folder of the domain's management files.
    pub fn root(ipc: &IpcConfig) -> PathBuf {
        let given = PathBuf::from(&ipc.root);
        let root = given.canonicalize().or_else(|_| std::path::absolute(&given)).unwrap_or(given);
        root.join(format!("radar-chain-{}", ipc.prefix))
    }

    /// How the names of the domain's files in shared memory begin: the prefix, and the folder as a number, so that one
    /// prefix in two folders is two domains.
    fn file_prefix(ipc: &IpcConfig) -> String {
        let folder = Self::root(ipc);
        let number = fnv1a(0, folder.as_os_str().as_encoded_bytes());
        format!("{}.rc_{:08x}_", ipc.prefix, number >> 32)
    }

    /// A file of the domain in shared memory: written without a disk, and gone with the domain.
    pub fn memory_file(ipc: &IpcConfig, name: &str) -> PathBuf {
        Path::new(SHARED_MEMORY).join(Self::file_prefix(ipc) + name)
    }

    /// The iceoryx2 configuration of the domain.
    pub(super) fn config(&self) -> &Config {
        &self.config
    }

    /// Releases what dead processes have left. Cheap when there is none.
    pub fn clean_dead_nodes(&self) {
        clean_dead_nodes(&self.config);
    }

    /// Living processes that use the domain.
    pub fn inhabitants(&self) -> Vec<Inhabitant> {
        let mut alive = Vec::new();
        // The list breaks off when a dead process is cleaned up under it; nobody may be overlooked for that.
        for _ in 0..LISTINGS {
            alive.clear();
            let listed = Node::<ipc::Service>::list(&self.config, |state| {
                if let NodeState::Alive(node) = state
                    && let Some(details) = node.details()
                {
                    let name = details.name().to_string();
                    let (process, site) = name.split_once(AT).unwrap_or((&name, ""));
                    let pid = details.process_id().value().cast_unsigned();
                    alive.push(Inhabitant { process: process.to_string(), site: site.to_string(), pid });
                }
                CallbackProgression::Continue
            });
            if listed.is_ok() {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        alive
    }

    /// Marks every file of the domain as used now: cleaners of temporary folders remove what has not been used for days.
    pub fn keep_fresh(&self) {
        let now = Timespec { tv_sec: 0, tv_nsec: UTIME_NOW };
        let times = Timestamps { last_access: now, last_modification: now };
        let mut paths = vec![self.root.clone(), self.root.with_extension("lock")];
        while let Some(path) = paths.pop() {
            // One that has just gone needs no mark.
            let _ = utimensat(CWD, &path, &times, AtFlags::SYMLINK_NOFOLLOW);
            let entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
            paths.extend(entries.map(|entry| entry.path()));
        }
    }

    /// Whether any living process uses the domain.
    pub fn is_alive(&self) -> bool {
        !self.inhabitants().is_empty()
    }

    /// Removes every file of the domain. Only when no process uses it.
    pub fn remove(&self) {
        clean_dead_nodes(&self.config);
        let _ = std::fs::remove_dir_all(&self.root);
        let Ok(entries) = std::fs::read_dir(SHARED_MEMORY) else { return };
        for entry in entries.flatten() {
            if entry.file_name().to_string_lossy().starts_with(&self.file_prefix) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }

    /// Files of the domain that are there.
    pub fn remains(ipc: &IpcConfig) -> Vec<String> {
        let root = Self::root(ipc);
        let mut files: Vec<String> = root.exists().then(|| root.display().to_string()).into_iter().collect();
        let prefix = Self::file_prefix(ipc);
        let names = std::fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        files.extend(names.filter(|name| name.starts_with(&prefix)));
        files
    }

    /// Makes sure of every page of the domain's segments, this process's among them. Segments are sparse: a page that
    /// cannot be had when it is first written ends a process by SIGBUS; here it is an error that can be told.
    ///
    /// # Errors
    /// [`IpcError::SharedMemoryFull`].
    pub(super) fn reserve(&self) -> Result<(), IpcError> {
        let Ok(entries) = std::fs::read_dir(SHARED_MEMORY) else { return Ok(()) };
        let ours = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with(&self.file_prefix);
        for entry in entries.flatten().filter(|entry| ours(&entry.file_name())) {
            // A segment may go while it is looked at.
            let Ok(file) = std::fs::File::options().write(true).open(entry.path()) else { continue };
            let Ok(metadata) = file.metadata() else { continue };
            let held = metadata.blocks() * 512;
            if held >= metadata.len() {
                continue;
            }
            let reserved = rustix::fs::fallocate(&file, rustix::fs::FallocateFlags::KEEP_SIZE, 0, metadata.len());
            if reserved == Err(rustix::io::Errno::NOSPC) {
                let free_mib = free_bytes().unwrap_or(0) >> 20;
                return Err(IpcError::SharedMemoryFull { free_mib, needed_mib: ((metadata.len() - held) >> 20) + 1 });
            }
        }
        Ok(())
    }

    /// Compares free shared memory with what all sites need at most. To be asked before
    /// anything is created: writing to a page that is not there ends a process by SIGBUS.
    ///
    /// # Errors
    /// [`IpcError::SharedMemoryTooSmall`].
    pub fn check_shared_memory(sites: &Sites) -> Result<(), IpcError> {
        let Some(free) = free_bytes() else { return Ok(()) };
        let needed = shared_memory_needed(sites);
        if free >= needed {
            return Ok(());
        }
        Err(IpcError::SharedMemoryTooSmall { free_mib: free >> 20, needed_mib: (needed >> 20) + 1 })
    }
}

/// Free shared memory, bytes, where the system says.
pub fn free_bytes() -> Option<u64> {
    rustix::fs::statvfs(SHARED_MEMORY).ok().map(|space| space.f_bavail * space.f_frsize)
}

/// Shared memory that the publishers of all sites can fill at most, bytes.
pub fn shared_memory_needed(sites: &Sites) -> u64 {
    sites.all().iter().map(needed_by).sum::<u64>() + MANAGEMENT
}

fn needed_by(site: &ChainConfig) -> u64 {
    struct Segment(Option<usize>);
    impl ForTopic for Segment {
        type Out = u64;

        fn call<M: Message>(self) -> u64 {
            let elements = self.0.unwrap_or(M::MOST);
            let sample = size_of::<M::Header>() + size_of::<M::Element>() * elements + 64;
            let samples = M::SUBSCRIBERS * (M::QUEUE + BORROWED) + M::HISTORY + LOANED;
            (sample * samples) as u64
        }
    }
    let cells = if topology::runs(site, "plot-extractor") { site.radar.grid().cells() } else { 0 };
    let of_topic = |topic: Topic| match topic {
        Topic::Dwells => topic.apply(Segment(Some(cells))),
        Topic::SystemTracks if !topology::runs(site, topology::FUSION) => 0,
        Topic::HealthReports => PROCESSES * topic.apply(Segment(None)),
        _ => topic.apply(Segment(None)),
    };
    Topic::ALL.into_iter().map(of_topic).sum()
}

/// How often the processes of a domain are listed until that succeeds.
const LISTINGS: u32 = 100;
/// Room for the ports' own queues and lists, bytes.
const MANAGEMENT: u64 = 4 << 20;
/// Processes that publish their health.
const PROCESSES: u64 = 8;
/// Samples that a subscriber may hold at once.
pub(super) const BORROWED: usize = 2;
/// Samples that a publisher may hold at once.
pub(super) const LOANED: usize = 1;

/// Releases what dead processes have left in the domain of `config`.
pub(super) fn clean_dead_nodes(config: &Config) {
    let _ = Node::<ipc::Service>::list(config, |state| {
        if let NodeState::Dead(dead) = state {
            let _ = dead.try_remove_stale_resources();
        }
        CallbackProgression::Continue
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, SystemTime};

    #[test]
    fn files_of_a_domain_that_is_kept_fresh_are_young() {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path().join("radar-chain-x");
        std::fs::create_dir_all(root.join("services")).expect("folders");
        let files = [root.join("chain.toml"), root.join("services/one"), root.with_extension("lock")];
        let old = SystemTime::now() - Duration::from_secs(20 * 86_400);
        for file in &files {
            std::fs::File::create(file).and_then(|file| file.set_modified(old)).expect("an old file");
        }
        Domain { file_prefix: String::new(), root, config: Config::default() }.keep_fresh();
        for file in &files {
            let modified = std::fs::metadata(file).and_then(|about| about.modified()).expect("a time");
            assert!(modified > old + Duration::from_secs(86_400), "{}", file.display());
        }
    }
}
