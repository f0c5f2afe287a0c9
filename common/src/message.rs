//! What all message headers have in common: place in the stream and stamps.
//!
//! `seq` is the position of a message in the schedule of its stream (dwell, sector
//! or scan count since the start of the run). A restarted publisher continues the
//! count where the schedule stands and announces itself by a new `session`, so one
//! subtraction tells exactly what is missing, whoever failed to deliver it.

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The last message of a scan.
pub const END_OF_SCAN: u32 = 1;
/// The last message of a sector (dwells only).
pub const END_OF_SECTOR: u32 = 2;
/// The source has ended; nothing follows in this session.
pub const END_OF_STREAM: u32 = 4;
/// More elements were found than the message holds; the weakest were left out and counted.
pub const TRUNCATED: u32 = 8;
/// The antenna turns counter-clockwise (plots, and tracks of one radar).
pub const COUNTER_CLOCKWISE: u32 = 16;
/// The antenna stands (plots, and tracks of one radar).
pub const STANDING: u32 = 32;

/// CLOCK_MONOTONIC in ns at each hand-over on the way of the last dwell of a sector
/// through the chain; 0 where a message has not been yet. Only for latency.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Stamps/1")]
#[repr(C)]
pub struct Stamps {
    /// The source published the dwell (or, without dwells, the plots).
    pub source_out_ns: u64,
    /// The plot extractor took the dwell.
    pub extractor_in_ns: u64,
    /// The plot extractor (or plot source) published the plots.
    pub plots_out_ns: u64,
    /// The tracker took the plots.
    pub tracker_in_ns: u64,
    /// The tracker published the tracks.
    pub tracks_out_ns: u64,
}

/// Which messages of the upstream topic went into a result: the recorder can tell
/// from successive results, exactly, what a stage has missed or lost by its death.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Lineage/2")]
#[repr(C)]
pub struct Lineage {
    /// Session of the upstream publisher; 0 if there is no upstream topic.
    pub session: u64,
    /// First upstream `seq` that went into this result.
    pub first_seq: u64,
    /// Last upstream `seq` that went into this result.
    pub last_seq: u64,
    /// Upstream messages taken between the two, rejected ones included.
    pub taken: u64,
    /// Upstream messages taken in this session of the stage, these included.
    pub taken_in_session: u64,
    /// Results published in this session of the stage before this one.
    pub published_before: u64,
}

/// Where a message stands in its stream.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Session of the publisher.
    pub session: u64,
    /// Position in the stream.
    pub seq: u64,
    /// Measurement time, ns UTC; 0 where a message has none.
    pub time_ns: u64,
    /// `END_OF_…`; 0 where a message has none.
    pub flags: u32,
    /// Scan number from 0, where messages belong to one.
    pub scan: Option<u32>,
}

/// What every header says of its message.
pub trait Header {
    /// Where the message stands.
    fn place(&self) -> Place;

    /// The upstream messages that went into it, where there is an upstream.
    fn lineage(&self) -> Option<&Lineage> {
        None
    }

    /// Forgets the upstream messages that went into it, where nobody can see those; how many results there were before stays.
    fn forget_upstream(&mut self) {}

    /// Visits the times of this host's monotonic clock in it, ns; 0 where a stage has not been.
    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64));

    /// Takes away what differs between two runs of the same input: sessions and stamps.
    fn make_comparable(&mut self);
}

impl Stamps {
    /// Visits all of them.
    pub fn each(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        let Self { source_out_ns, extractor_in_ns, plots_out_ns, tracker_in_ns, tracks_out_ns } = self;
        [source_out_ns, extractor_in_ns, plots_out_ns, tracker_in_ns, tracks_out_ns].into_iter().for_each(visit);
    }
}

impl Lineage {
    /// The lineage of a result whose upstream topic is not there.
    pub(crate) fn forget_upstream(&mut self) {
        *self = Self { published_before: self.published_before, ..Self::default() };
    }

    /// The lineage without the session of the upstream publisher, which differs from run to run.
    pub(crate) fn make_comparable(&mut self) {
        self.session = 0;
    }
}
