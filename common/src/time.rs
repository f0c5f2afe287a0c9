//! Processing time and resource use of this process, from the kernel.

use rustix::time::{ClockId, clock_gettime};

/// CLOCK_MONOTONIC, ns: the same for all processes of a machine. Only for latency.
pub fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Processor time this process has used, ns.
pub fn process_cpu_ns() -> u64 {
    let used = clock_gettime(ClockId::ProcessCPUTime);
    used.tv_sec as u64 * 1_000_000_000 + used.tv_nsec as u64
}

/// Resident memory of this process, bytes: all of it, and what no other process shares; 0 where the kernel does not say.
pub fn resident_bytes() -> (u64, u64) {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: Vec<u64> = statm.split(' ').skip(1).take(2).filter_map(|field| field.parse().ok()).collect();
    let page = rustix::param::page_size() as u64;
    match pages[..] {
        [resident, shared] => (resident * page, resident.saturating_sub(shared) * page),
        _ => (0, 0),
    }
}

/// Open file descriptors of this process; 0 where the kernel does not say.
pub fn open_files() -> u32 {
    // The folder that is being read is one of them.
    std::fs::read_dir("/proc/self/fd").map_or(0, |files| files.count().saturating_sub(1) as u32)
}

/// ns since 1970 as RFC 3339 with milliseconds, UTC.
pub fn rfc3339(time_ns: u64) -> String {
    let time = jiff::Timestamp::from_nanosecond(time_ns.into()).unwrap_or(jiff::Timestamp::MAX);
    format!("{time:.3}")
}

/// `seconds` since 1970 as UTC in the form 20261122-231500, for names of files.
pub fn utc_compact(seconds: u64) -> String {
    let time = jiff::Timestamp::from_second(seconds.cast_signed()).unwrap_or(jiff::Timestamp::MAX);
    time.strftime("%Y%m%d-%H%M%S").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_milliseconds() {
        assert_eq!(rfc3339(1_767_225_600_000_000_000 + 45_296_789_999_999), "2026-01-01T12:34:56.789Z");
    }
}
