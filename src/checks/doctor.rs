//! `radar-chain doctor`: checks of this machine, with advice for each fault.

use std::path::Path;
use std::process::ExitCode;

use common::config::{ChainConfig, Scheduling, Sites};
use common::ipc::{Domain, free_bytes, shared_memory_needed};
use common::process::{EXIT_CHECK_BROKEN, print};
use rustix::process::{Resource, getrlimit};
use serde::Serialize;

use crate::claim::Claim;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Level {
    Good,
    Note,
    Bad,
}

/// One thing that was looked at.
#[derive(Debug, Serialize)]
struct Finding {
    level: Level,
    what: &'static str,
    found: String,
    /// What to do, if anything.
    #[serde(skip_serializing_if = "String::is_empty")]
    advice: String,
}

impl Finding {
    fn new(what: &'static str, found: impl Into<String>) -> Self {
        Self { level: Level::Good, what, found: found.into(), advice: String::new() }
    }

    /// The same with advice, if `fault`.
    fn unless(mut self, fault: bool, level: Level, advice: impl Into<String>) -> Self {
        if fault {
            (self.level, self.advice) = (level, advice.into());
        }
        self
    }
}

/// Looks at everything; exit code 1 if the chain cannot run.
pub(crate) fn doctor(sites: &Sites, json: bool) -> anyhow::Result<ExitCode> {
    let chain = sites.first();
    let findings = [
        shared_memory(sites),
        writable(chain),
        processors(),
        governor(),
        clock_source(),
        open_files(),
        real_time(chain),
        locked_memory(chain),
        recordings(chain),
        leftovers(chain),
        domain(chain),
    ];
    if json {
        print(&format!("{}\n", serde_json::to_string_pretty(&findings)?));
    } else {
        for Finding { level, what, found, advice } in &findings {
            let mark = match level {
                Level::Good => "ok  ",
                Level::Note => "note",
                Level::Bad => "BAD ",
            };
            print(&format!("{mark}  {what:<16}{found}\n"));
            if !advice.is_empty() {
                print(&format!("      {:<16}→ {advice}\n", ""));
            }
        }
    }
    let bad = findings.iter().any(|finding| finding.level == Level::Bad);
    Ok(if bad { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default().trim().to_string()
}

fn shared_memory(sites: &Sites) -> Finding {
    let (free, needed) = (free_bytes(), shared_memory_needed(sites) >> 20);
    let Some(free) = free.map(|free| free >> 20) else {
        return Finding::new("shared memory", "/dev/shm does not exist").unless(
            true,
            Level::Bad,
            "mount a tmpfs on /dev/shm",
        );
    };
    Finding::new("shared memory", format!("{free} MiB free in /dev/shm, this chain needs {needed} MiB")).unless(
        free < needed,
        Level::Bad,
        format!("mount -o remount,size={}M /dev/shm (containers: --shm-size)", 2 * needed + 16),
    )
}

fn writable(chain: &ChainConfig) -> Finding {
    let places = ["/dev/shm", chain.ipc.root.as_str()];
    let refused: Vec<&str> = places.into_iter().filter(|place| tempfile::tempfile_in(place).is_err()).collect();
    Finding::new("permissions", format!("files can be created in {}", places.join(" and "))).unless(
        !refused.is_empty(),
        Level::Bad,
        format!("{} cannot be written by this user", refused.join(" and ")),
    )
}

fn processors() -> Finding {
    let machine = super::machine::describe();
    Finding::new("processors", format!("{} × {}", machine.cores, machine.cpu)).unless(
        machine.cores < 2,
        Level::Note,
        "stages share one processor: latencies will be those of its time slices",
    )
}

fn governor() -> Finding {
    let governor = read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
    let text = if governor.is_empty() { "none: the frequency is not ours to set" } else { governor.as_str() };
    Finding::new("governor", text).unless(
        !governor.is_empty() && governor != "performance",
        Level::Note,
        "cpupower frequency-set -g performance",
    )
}

fn clock_source() -> Finding {
    let source = read("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    let fast = ["tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page"].contains(&source.as_str());
    let text = if source.is_empty() { "not known" } else { source.as_str() };
    Finding::new("clock", text).unless(
        !fast,
        Level::Note,
        "reading the clock may need a system call each time: latencies look longer than they are",
    )
}

fn open_files() -> Finding {
    let limit = getrlimit(Resource::Nofile).current;
    let text = limit.map_or("unlimited".into(), |limit| limit.to_string());
    Finding::new("open files", format!("limit {text}")).unless(
        limit.is_some_and(|limit| limit < 256),
        Level::Bad,
        "ulimit -n 1024",
    )
}

fn stages(chain: &ChainConfig) -> [&common::config::StageRealtime; 4] {
    let realtime = &chain.realtime;
    [&realtime.source, &realtime.plot_extractor, &realtime.tracker, &realtime.recorder]
}

fn real_time(chain: &ChainConfig) -> Finding {
    let wished =
        stages(chain).iter().filter(|stage| stage.scheduling == Scheduling::Fifo).map(|stage| stage.priority).max();
    let limit = getrlimit(Resource::Rtprio).current;
    let root = rustix::process::geteuid().is_root();
    let allowed = root || limit.is_none_or(|limit| limit >= u64::from(wished.unwrap_or(0)));
    let text = match (wished, root) {
        (None, _) => "not configured".to_string(),
        (Some(priority), true) => format!("priority {priority} configured, this user may use any"),
        (Some(priority), false) => format!("priority {priority} configured, limit {}", limit.unwrap_or(99)),
    };
    Finding::new("scheduling", text).unless(!allowed, Level::Note, "LimitRTPRIO=99 in the unit, or ulimit -r 99")
}

fn locked_memory(chain: &ChainConfig) -> Finding {
    let wished = stages(chain).iter().any(|stage| stage.lock_memory);
    let limit = getrlimit(Resource::Memlock).current;
    let text = limit.map_or("unlimited".into(), |limit| format!("limit {} MiB", limit >> 20));
    let allowed = !wished || rustix::process::geteuid().is_root() || limit.is_none_or(|limit| limit >= 256 << 20);
    let asked = if wished { "configured" } else { "not configured" };
    Finding::new("locked memory", format!("{asked}, {text}")).unless(
        !allowed,
        Level::Note,
        "LimitMEMLOCK=infinity in the unit, or ulimit -l unlimited",
    )
}

fn recordings(chain: &ChainConfig) -> Finding {
    let folder = Path::new(&chain.recorder.directory);
    let existing = folder.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    let existing = if existing.as_os_str().is_empty() { Path::new(".") } else { existing };
    let free = rustix::fs::statvfs(existing).map_or(0, |space| space.f_bavail * space.f_frsize) >> 20;
    let finding = Finding::new("recordings", format!("{free} MiB free for {}", folder.display()));
    let (wanted, written) = (chain.recorder.record, tempfile::tempfile_in(existing).is_ok());
    finding.unless(wanted && free < 1024, Level::Note, "free space, or set recorder.directory to another disk").unless(
        wanted && !written,
        Level::Bad,
        format!("{} cannot be written by this user", existing.display()),
    )
}

/// Domains of chains that are no more.
fn leftovers(chain: &ChainConfig) -> Finding {
    let prefixes = std::fs::read_dir(&chain.ipc.root)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .filter_map(|entry| entry.file_name().to_string_lossy().strip_prefix("radar-chain-").map(String::from));
    let mut dead: Vec<String> = prefixes
        .filter(|prefix| {
            let ipc = common::config::IpcConfig { prefix: prefix.clone(), ..chain.ipc.clone() };
            !Claim::is_locked(&ipc) && Domain::enter(&ipc).is_ok_and(|domain| !domain.is_alive())
        })
        .collect();
    // Files alone, without the folder that a living chain has; those of chains in another folder are not known here.
    let files = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    dead.extend(files.filter_map(|file| {
        let prefix = file.file_name().to_string_lossy().split_once(".rc_")?.0.to_string();
        let ipc = common::config::IpcConfig { prefix: prefix.clone(), ..chain.ipc.clone() };
        (!Domain::root(&ipc).exists() && !Domain::remains(&ipc).is_empty()).then_some(prefix)
    }));
    dead.sort_unstable();
    dead.dedup();
    let found = if dead.is_empty() { "none".into() } else { format!("domains of dead chains: {}", dead.join(", ")) };
    let advice = "the next `radar-chain run` with the same --ipc-prefix removes them";
    Finding::new("leftovers", found).unless(!dead.is_empty(), Level::Note, advice)
}

fn domain(chain: &ChainConfig) -> Finding {
    let prefix = &chain.ipc.prefix;
    let found = if Claim::is_locked(&chain.ipc) { "a chain runs in" } else { "no chain runs in" };
    Finding::new("domain", format!("{found} `{prefix}`"))
}
