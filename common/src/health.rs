//! `health`: what each process says of itself, once a second and at every scan.

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::latency::LATENCIES;
use crate::services::TOPICS;

/// Why a piece of input was not used. Counted per reason in [`Health::rejected`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(usize)]
pub enum Reject {
    /// A header and its payload disagree about the number of elements.
    LengthMismatch,
    /// A header with impossible values.
    BadHeader,
    /// A NaN, infinite or negative amplitude.
    BadAmplitude,
    /// A plot with impossible values.
    BadPlot,
    /// A plot older than what has been processed.
    Late,
    /// More elements than a message holds.
    Full,
    /// A record that ends before its items do.
    TruncatedRecord,
    /// A block of a category that is not read.
    OtherCategory,
    /// An item that the edition does not define.
    UnknownItem,
    /// A target report without a position.
    NoPosition,
    /// A report without a time of day.
    NoTime,
    /// A report of a fixed monitor.
    FixedMonitor,
    /// A target report without an address, in truth.
    NoAddress,
    /// A report of a kind that is not a target (status messages).
    NotATarget,
}

/// Number of reasons in [`Reject`].
pub const REJECTS: usize = 14;

/// Names of the reasons in reports, in the order of [`Reject`].
pub const REJECT_NAMES: [&str; REJECTS] = [
    "length_mismatch",
    "bad_header",
    "bad_amplitude",
    "bad_plot",
    "late",
    "full",
    "truncated_record",
    "other_category",
    "unknown_item",
    "no_position",
    "no_time",
    "fixed_monitor",
    "no_address",
    "not_a_target",
];

/// Counts of rejected input by [`Reject`].
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Rejected(pub [u64; REJECTS]);

impl Rejected {
    /// Counts one rejected piece of input.
    pub fn count(&mut self, reason: Reject) {
        self.0[reason as usize] += 1;
    }

    /// Adds the counts of `other`.
    pub fn add(&mut self, other: &Self) {
        for (count, more) in self.0.iter_mut().zip(other.0) {
            *count += more;
        }
    }

    /// How many have been rejected for one reason.
    pub fn of(&self, reason: Reject) -> u64 {
        self.0[reason as usize]
    }

    /// How many have been rejected in all.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }
}

/// What the watchdog of a process says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum Condition {
    /// Input comes and is worked off.
    #[default]
    Fine,
    /// Nothing comes from upstream.
    UpstreamSilent,
    /// The process itself does not keep up.
    Slow,
}

impl Condition {
    /// In words, for status and logs.
    pub fn text(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::UpstreamSilent => "upstream silent",
            Self::Slow => "slow",
        }
    }

    /// From its number in [`Health::condition`].
    pub fn of(number: u32) -> Self {
        [Self::Fine, Self::UpstreamSilent, Self::Slow].into_iter().find(|&it| it as u32 == number).unwrap_or_default()
    }
}

/// What a stage may ask of the operating system (`[realtime]`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Wish {
    /// Processors to run on.
    Cpus,
    /// Scheduling class and priority.
    Scheduling,
    /// Memory that stays resident.
    LockMemory,
}

impl Wish {
    /// All wishes with their names, as in the configuration.
    pub const NAMED: [(Self, &'static str); 3] =
        [(Self::Cpus, "cpus"), (Self::Scheduling, "scheduling"), (Self::LockMemory, "lock_memory")];

    /// Its bit in [`Health::refused`].
    pub fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Names of the wishes in a set of bits.
    pub fn names(bits: u32) -> Vec<&'static str> {
        Self::NAMED.iter().filter(|(wish, _)| bits & wish.bit() != 0).map(|&(_, name)| name).collect()
    }
}

/// What a consumer knows of one topic it reads.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Intake/1")]
#[repr(C)]
pub struct Intake {
    /// Messages received.
    pub received: u64,
    /// Messages missing, from gaps of the sequence numbers.
    pub lost: u64,
    /// Times that the publisher began a new session.
    pub restarts: u64,
    /// Last sequence number received.
    pub last_seq: u64,
}

/// p50 and p99 of one latency over the run so far.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/LatencySummary/1")]
#[repr(C)]
pub struct LatencySummary {
    /// Number of values.
    pub n: u64,
    /// Median, µs.
    pub p50_us: f32,
    /// 99th percentile, µs.
    pub p99_us: f32,
    /// Values over their budget.
    pub misses: u64,
}

/// State of one process.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Health/2")]
#[repr(C)]
#[repr(align(64))]
pub struct Health {
    /// Name of the process, UTF-8, padded with zeros.
    pub name: [u8; 24],
    /// Session of the process: changes at each start.
    pub session: u64,
    /// Counts the health messages of this session from 0.
    pub seq: u64,
    /// CLOCK_MONOTONIC when this was written, ns.
    pub heartbeat_ns: u64,
    /// Processor time used, ns.
    pub cpu_ns: u64,
    /// Resident memory, bytes.
    pub rss_bytes: u64,
    /// Messages published.
    pub messages_out: u64,
    /// Elements (cells, plots, tracks) published.
    pub elements_out: u64,
    /// By topic, in the order of [`crate::services::Topic`].
    pub intake: [Intake; TOPICS],
    /// By latency, in the order of [`crate::latency::Latency`]; only the recorder fills it.
    pub latency: [LatencySummary; LATENCIES],
    /// Rejected input, in the order of [`Reject`].
    pub rejected: [u64; REJECTS],
    /// Scan being worked on.
    pub scan: u32,
    /// Process identifier.
    pub pid: u32,
    /// Tracks alive (tracker) or targets (source).
    pub tracks: u32,
    /// Tracks confirmed (tracker).
    pub confirmed: u32,
    /// Plots of the last whole scan.
    pub plots: u32,
    /// Restarts of stages so far; only the launcher fills it.
    pub restarts: u32,
    /// 1 once the process has seen the end of the stream and published all.
    pub ended: u32,
    /// Open file descriptors.
    pub files: u32,
    /// What its watchdog says, by [`Condition`].
    pub condition: u32,
    /// Times that nothing came from upstream for longer than `watchdog.silence_s`.
    pub silences: u32,
    /// Steps that took longer than `watchdog.slow_s`.
    pub slow_steps: u32,
    /// Real-time wishes that the system has refused, one bit each by [`Wish`].
    pub refused: u32,
    /// Resident memory that no other process shares, KiB.
    pub private_kib: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Health>() == 576 && align_of::<Health>() == 64);

impl Health {
    /// Name of the process.
    pub fn process(&self) -> &str {
        let end = self.name.iter().position(|&byte| byte == 0).unwrap_or(self.name.len());
        std::str::from_utf8(&self.name[..end]).unwrap_or("?")
    }

    /// Sets the name of the process; what is longer than 24 bytes is cut.
    pub fn set_process(&mut self, name: &str) {
        self.name = [0; 24];
        let length = name.len().min(self.name.len());
        self.name[..length].copy_from_slice(&name.as_bytes()[..length]);
    }
}
