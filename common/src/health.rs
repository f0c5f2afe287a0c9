//! `health`: what each process says of itself, once a second and at every scan.

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::label::Label;
use crate::latency::LATENCIES;
use crate::message::{Header, Place};
use crate::recording::row::{Row, Table, Value};
use crate::topic::{TOPICS, Topic};

/// Why a piece of input was not used.
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
    /// A plot or track older than what has been processed, or far from its time.
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
    /// A record of another sensor than the site's.
    ForeignSource,
    /// A byte of a recording that could not be read.
    UnreadByte,
    /// A track whose numbers are no estimate.
    BadTrack,
    /// A track or plot that the format of an output cannot say.
    NotSayable,
    /// A dwell with hits all over its ranges, as pulses of other transmitters give them.
    Jammed,
    /// A dwell that is at the receiver's full scale in a quarter of its cells.
    Saturated,
}

impl Reject {
    /// All reasons with their names in reports.
    const NAMED: [(Self, &'static str); 20] = [
        (Self::LengthMismatch, "length_mismatch"),
        (Self::BadHeader, "bad_header"),
        (Self::BadAmplitude, "bad_amplitude"),
        (Self::BadPlot, "bad_plot"),
        (Self::Late, "late"),
        (Self::Full, "full"),
        (Self::TruncatedRecord, "truncated_record"),
        (Self::OtherCategory, "other_category"),
        (Self::UnknownItem, "unknown_item"),
        (Self::NoPosition, "no_position"),
        (Self::NoTime, "no_time"),
        (Self::FixedMonitor, "fixed_monitor"),
        (Self::NoAddress, "no_address"),
        (Self::NotATarget, "not_a_target"),
        (Self::ForeignSource, "foreign_source"),
        (Self::UnreadByte, "unread_byte"),
        (Self::BadTrack, "bad_track"),
        (Self::NotSayable, "not_sayable"),
        (Self::Jammed, "jammed"),
        (Self::Saturated, "saturated"),
    ];
}

/// Counts of rejected input by [`Reject`].
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Rejected([u64; Reject::NAMED.len()]);

impl Rejected {
    /// Counts one rejected piece of input.
    pub fn count(&mut self, reason: Reject) {
        self.count_many(reason, 1);
    }

    /// Counts several rejected pieces of input.
    pub fn count_many(&mut self, reason: Reject, count: u64) {
        self.0[reason as usize] += count;
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

    /// Reasons and counts, of those that occurred.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let all = Reject::NAMED.into_iter().map(|(reason, name)| (name, self.of(reason)));
        all.filter(|&(_, count)| count > 0)
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
    /// The process waits for another host, and those upstream wait for it.
    HeldUp,
}

impl Condition {
    /// In words, for status and logs.
    pub fn text(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::UpstreamSilent => "upstream silent",
            Self::Slow => "slow",
            Self::HeldUp => "waits for another host",
        }
    }

    /// From its number in [`Health::condition`].
    pub fn of(number: u32) -> Self {
        [Self::Fine, Self::UpstreamSilent, Self::Slow, Self::HeldUp]
            .into_iter()
            .find(|&it| it as u32 == number)
            .unwrap_or_default()
    }
}

/// Real-time settings of a stage that the operating system may refuse (`[realtime]`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum RealtimeSetting {
    /// Processors to run on.
    Cpus,
    /// Scheduling class and priority.
    Scheduling,
    /// Memory that stays resident.
    LockMemory,
}

impl RealtimeSetting {
    /// All settings with their names, as in the configuration.
    pub const NAMED: [(Self, &'static str); 3] =
        [(Self::Cpus, "cpus"), (Self::Scheduling, "scheduling"), (Self::LockMemory, "lock_memory")];

    /// Its bit in [`Health::refused`].
    pub fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Names of the settings in a set of bits.
    pub fn names(bits: u32) -> Vec<&'static str> {
        Self::NAMED.iter().filter(|(setting, _)| bits & setting.bit() != 0).map(|&(_, name)| name).collect()
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

impl Intake {
    /// What two subscribers of one topic, at two sites or one after the other, know together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            received: self.received + other.received,
            lost: self.lost + other.lost,
            restarts: self.restarts + other.restarts,
            last_seq: self.last_seq.max(other.last_seq),
        }
    }
}

/// A topic that a process reads, and what it knows of it.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Input/1")]
#[repr(C)]
pub struct Input {
    /// Name of the topic; empty where there is none.
    pub topic: Label,
    /// Messages received and missed.
    pub intake: Intake,
}

/// Input that was rejected for one reason.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/RejectedFor/1")]
#[repr(C)]
pub struct RejectedFor {
    /// The reason; empty where there is none.
    pub reason: Label,
    /// How many pieces of input.
    pub count: u64,
}

/// Messages of one topic that the full queue of one observer has discarded.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/ObserverLoss/1")]
#[repr(C)]
pub struct ObserverLoss {
    /// Name of the topic; empty where there is none.
    pub topic: Label,
    /// Name of the observer.
    pub observer: Label,
    /// Messages discarded.
    pub lost: u64,
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

/// Probability of a false alarm in a cell.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/FalseAlarms/1")]
#[repr(C)]
pub struct FalseAlarms {
    /// As set; 0 where unknown.
    pub set: f32,
    /// As measured over the last turns.
    pub measured: f32,
}

impl FalseAlarms {
    /// Measured over set above which, or under whose inverse, the noise is not what the detector is made for.
    const FAR: f32 = 3.0;

    /// Both rates, where they are known.
    pub fn known(self) -> Option<Self> {
        (self.set > 0.0).then_some(self)
    }

    /// Whether the measured rate is far from the set one.
    pub fn is_off(self) -> bool {
        self.set > 0.0 && !(self.set / Self::FAR..=self.set * Self::FAR).contains(&self.measured)
    }

    /// A warning, if there is reason for one.
    pub fn warning(self) -> Option<String> {
        let Self { set, measured } = self;
        self.is_off()
            .then(|| format!("false alarms per cell {measured:.1e}, set {set:.0e}: not the noise that CFAR expects"))
    }
}

/// State of one process.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Health/4")]
#[repr(C)]
#[repr(align(64))]
pub struct Health {
    /// Name of the process.
    pub process: Label,
    /// Site that the report is about.
    pub site: Label,
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
    /// The topics that it reads.
    pub inputs: [Input; INPUTS],
    /// By latency, in the order of [`crate::latency::Latency`]; only the recorder fills it.
    pub latency: [LatencySummary; LATENCIES],
    /// Rejected input, by reason.
    pub rejected: [RejectedFor; REASONS],
    /// What full queues of observers have discarded of the messages that it publishes.
    pub observers: [ObserverLoss; OBSERVERS],
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
    /// Real-time settings that the system has refused, one bit each by [`RealtimeSetting`].
    pub refused: u32,
    /// Resident memory that no other process shares, KiB.
    pub private_kib: u32,
    /// False alarms of the plots that come in, as far as tracks do not explain them; only the tracker fills it.
    pub false_alarms: FalseAlarms,
    /// How well the monotonic clock of another host is known, µs; only the ends of a link fill it, once they know.
    pub clock_uncertainty_us: f32,
    /// By place in `inputs`: one more than the most messages that one has found waiting before it since the last report; 0 where
    /// the process does not say.
    #[serde(default)]
    pub waiting: [u32; INPUTS],
    /// Always 0: no undefined bytes.
    pub reserved: [u32; 8],
}

const _: () = assert!(size_of::<Health>() == 2688 && align_of::<Health>() == 64);

/// Topics that a process can tell of: all that there are, and as many as may come without another layout.
pub const INPUTS: usize = 16;
const _: () = assert!(INPUTS >= TOPICS);
/// Reasons of rejection that a process can tell of; what is rejected for more counts under the last.
pub const REASONS: usize = 16;
/// Observers that a process can tell of; what more of them lose counts under the last.
pub const OBSERVERS: usize = 8;

impl Health {
    /// What the process knows of a topic that it reads.
    pub fn intake(&self, topic: Topic) -> Intake {
        self.inputs().find(|&(name, _)| name == topic.name()).map(|(_, intake)| *intake).unwrap_or_default()
    }

    /// The topics that it reads, by name.
    pub fn inputs(&self) -> impl Iterator<Item = (&str, &Intake)> {
        self.inputs.iter().filter(|input| !input.topic.is_empty()).map(|input| (input.topic.as_str(), &input.intake))
    }

    /// Notes what the process knows of a topic.
    pub fn set_intake(&mut self, topic: Topic, intake: Intake) {
        let name = Label::new(topic.name());
        let place = self.inputs.iter().position(|input| input.topic == name || input.topic.is_empty());
        let place = place.expect("room for every topic");
        self.inputs[place] = Input { topic: name, intake };
    }

    /// Notes the most messages of a topic whose intake is noted that one has found waiting before it since the last report, if they say when they were
    /// published.
    pub fn set_waiting(&mut self, topic: Topic, most: Option<u32>) {
        if let Some(place) = self.inputs.iter().position(|input| input.topic.as_str() == topic.name()) {
            self.waiting[place] = most.map_or(0, |most| most + 1);
        }
    }

    /// The most messages that one has found waiting before it since the last report, by topic, of those that the process tells of.
    pub fn waiting(&self) -> impl Iterator<Item = (&str, u32)> {
        let named = self.inputs.iter().zip(self.waiting).filter(|&(_, waiting)| waiting > 0);
        named.map(|(input, waiting)| (input.topic.as_str(), waiting - 1))
    }

    /// Rejected input, by reason.
    pub fn rejected(&self) -> impl Iterator<Item = (&str, u64)> {
        self.rejected.iter().filter(|of| of.count > 0).map(|of| (of.reason.as_str(), of.count))
    }

    /// Notes what has been rejected so far.
    pub fn set_rejected(&mut self, rejected: &Rejected) {
        self.rejected = [RejectedFor::default(); REASONS];
        for (place, (name, count)) in rejected.named().enumerate() {
            let of = &mut self.rejected[place.min(REASONS - 1)];
            *of = RejectedFor { reason: Label::new(name), count: of.count + count };
        }
    }

    /// What observers have lost of the messages that the process publishes.
    pub fn observers(&self) -> impl Iterator<Item = &ObserverLoss> {
        self.observers.iter().filter(|of| !of.topic.is_empty())
    }

    /// Notes what observers have lost so far.
    pub fn set_observers(&mut self, losses: &[ObserverLoss]) {
        self.observers = [ObserverLoss::default(); OBSERVERS];
        for (place, loss) in losses.iter().enumerate() {
            let of = &mut self.observers[place.min(OBSERVERS - 1)];
            *of = ObserverLoss { lost: of.lost + loss.lost, ..*loss };
        }
    }
}

/// Header of a health message. The payload is one [`Health`].
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/HealthHeader/1")]
#[repr(C)]
pub struct HealthHeader {
    /// Session of the process.
    pub session: u64,
    /// Counts from 0 in a session.
    pub seq: u64,
}

impl Header for HealthHeader {
    fn place(&self) -> Place {
        Place { session: self.session, seq: self.seq, ..Place::default() }
    }

    fn each_stamp(&mut self, _visit: &mut dyn FnMut(&mut u64)) {}

    fn make_comparable(&mut self) {
        self.session = 0;
    }
}

impl Row<HealthHeader> for Health {
    fn put_row(&self, _: &HealthHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("process", Value::Text(self.process.as_str()))?;
        table.put("session", Value::U64(self.session))?;
        table.put("seq", Value::U64(self.seq))?;
        table.put("heartbeat_ns", Value::U64(self.heartbeat_ns))?;
        table.put("cpu_ns", Value::U64(self.cpu_ns))?;
        table.put("rss_bytes", Value::U64(self.rss_bytes))?;
        table.put("messages_out", Value::U64(self.messages_out))?;
        table.put("scan", Value::U32(self.scan))?;
        table.put("pid", Value::U32(self.pid))?;
        for topic in Topic::ALL {
            table.put(&format!("received_{}", topic.name()), Value::U64(self.intake(topic).received))?;
        }
        for topic in Topic::ALL {
            table.put(&format!("lost_{}", topic.name()), Value::U64(self.intake(topic).lost))?;
        }
        for (_, name) in Reject::NAMED {
            let count = self.rejected().find(|&(reason, _)| reason == name).map_or(0, |(_, count)| count);
            table.put(&format!("rejected_{name}"), Value::U64(count))?;
        }
        table.put("lost_by_observers", Value::U64(self.observers().map(|of| of.lost).sum()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_more_reasons_and_observers_than_there_is_room_for_are_kept_in_sum() {
        let mut health = Health::default();
        let losses: Vec<ObserverLoss> = (0..OBSERVERS + 3)
            .map(|k| ObserverLoss { topic: "tracks".into(), observer: format!("o{k}").as_str().into(), lost: 1 })
            .collect();
        health.set_observers(&losses);
        assert_eq!(health.observers().map(|of| of.lost).sum::<u64>() as usize, losses.len());
        let mut rejected = Rejected::default();
        for (reason, _) in Reject::NAMED {
            rejected.count(reason);
        }
        health.set_rejected(&rejected);
        assert_eq!(health.rejected().map(|(_, count)| count).sum::<u64>(), rejected.total());
    }

    #[test]
    fn a_topic_keeps_its_place() {
        let mut health = Health::default();
        for received in 1..4 {
            health.set_intake(Topic::Plots, Intake { received, ..Intake::default() });
            health.set_intake(Topic::Truth, Intake { received: 7, ..Intake::default() });
        }
        assert_eq!((health.intake(Topic::Plots).received, health.inputs().count()), (3, 2));
        assert_eq!(health.intake(Topic::Dwells), Intake::default());
    }
}
