//! Every service of a site: name, message types, limits. One table, used by the
//! launcher, which creates the services, and by the stages, which open them.

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::dwell::DwellHeader;
use crate::health::Health;
use crate::plots::{Plot, PlotsHeader};
use crate::tracks::{Track, TracksHeader};
use crate::truth::{TruthHeader, TruthTarget};

/// The topics of a site.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[repr(usize)]
pub enum Topic {
    /// Amplitudes of cells.
    Dwells,
    /// Detections.
    Plots,
    /// Tracks.
    Tracks,
    /// True targets.
    Truth,
    /// State of the processes.
    Health,
}

/// Number of topics.
pub const TOPICS: usize = 5;

/// Names of the topics in service names, reports and recordings, in the order of [`Topic`].
pub const TOPIC_NAMES: [&str; TOPICS] = ["dwells", "plots", "tracks", "truth", "health"];

/// All topics.
pub const ALL_TOPICS: [Topic; TOPICS] = [Topic::Dwells, Topic::Plots, Topic::Tracks, Topic::Truth, Topic::Health];

impl Topic {
    /// Name in service names, reports and recordings.
    pub fn name(self) -> &'static str {
        TOPIC_NAMES[self as usize]
    }
}

/// Processes that a publisher may have to wait for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Consumer {
    /// Any process that nobody waits for.
    Observer,
    /// `plot-extractor`.
    PlotExtractor,
    /// `tracker`.
    Tracker,
    /// `recorder`.
    Recorder,
}

impl Consumer {
    /// Number of kinds.
    pub const KINDS: usize = 4;

    /// The kind of the process with this name.
    pub fn of(process: &str) -> Self {
        match process {
            "plot-extractor" => Self::PlotExtractor,
            "tracker" => Self::Tracker,
            "recorder" => Self::Recorder,
            _ => Self::Observer,
        }
    }
}

/// What travels on a topic, and how much room it gets.
pub trait Message: 'static {
    /// Which topic.
    const TOPIC: Topic;
    /// Version of the message pair, stored as an attribute of the service.
    const SCHEMA: &'static str;
    /// Unread messages that a subscriber may have waiting.
    const BUFFER: usize;
    /// Subscribers at most.
    const SUBSCRIBERS: usize;
    /// Publishers at most (one more than live ones, so that a restart never waits for a clean-up).
    const PUBLISHERS: usize;
    /// Messages kept for a late joiner.
    const HISTORY: usize;
    /// Header of the message.
    type Header: ZeroCopySend + Default + Clone + Copy + std::fmt::Debug;
    /// Element of the payload slice.
    type Element: ZeroCopySend + Default + Clone + Copy + std::fmt::Debug;
    /// Session and sequence number of a header.
    fn place(header: &Self::Header) -> (u64, u64);
}

/// [`Topic::Dwells`].
#[derive(Debug)]
pub struct Dwells;
/// [`Topic::Plots`].
#[derive(Debug)]
pub struct Plots;
/// [`Topic::Tracks`].
#[derive(Debug)]
pub struct Tracks;
/// [`Topic::Truth`].
#[derive(Debug)]
pub struct Truth;
/// [`Topic::Health`].
#[derive(Debug)]
pub struct HealthReports;

/// Most plots in one message; the weakest of more are left out and counted.
pub const MAX_PLOTS: usize = 1024;
/// Most tracks in one message; tentative ones are left out first, and counted.
pub const MAX_TRACKS: usize = 256;
/// Most targets in the truth of one scan.
pub const MAX_TARGETS: usize = 1024;

impl Message for Dwells {
    const TOPIC: Topic = Topic::Dwells;
    const SCHEMA: &'static str = "dwell/1";
    const BUFFER: usize = 32;
    const SUBSCRIBERS: usize = 4;
    const PUBLISHERS: usize = 2;
    const HISTORY: usize = 0;
    type Header = DwellHeader;
    type Element = f32;
    fn place(header: &DwellHeader) -> (u64, u64) {
        (header.session, header.seq)
    }
}

impl Message for Plots {
    const TOPIC: Topic = Topic::Plots;
    const SCHEMA: &'static str = "plots/2";
    const BUFFER: usize = 32;
    const SUBSCRIBERS: usize = 4;
    const PUBLISHERS: usize = 2;
    const HISTORY: usize = 0;
    type Header = PlotsHeader;
    type Element = Plot;
    fn place(header: &PlotsHeader) -> (u64, u64) {
        (header.session, header.seq)
    }
}

impl Message for Tracks {
    const TOPIC: Topic = Topic::Tracks;
    const SCHEMA: &'static str = "tracks/3";
    const BUFFER: usize = 16;
    const SUBSCRIBERS: usize = 4;
    const PUBLISHERS: usize = 2;
    const HISTORY: usize = 0;
    type Header = TracksHeader;
    type Element = Track;
    fn place(header: &TracksHeader) -> (u64, u64) {
        (header.session, header.seq)
    }
}

impl Message for Truth {
    const TOPIC: Topic = Topic::Truth;
    const SCHEMA: &'static str = "truth/1";
    const BUFFER: usize = 16;
    const SUBSCRIBERS: usize = 4;
    const PUBLISHERS: usize = 2;
    const HISTORY: usize = 0;
    type Header = TruthHeader;
    type Element = TruthTarget;
    fn place(header: &TruthHeader) -> (u64, u64) {
        (header.session, header.seq)
    }
}

/// Most cells in a dwell: 16 MiB of amplitudes.
pub const MAX_CELLS: usize = 4 * 1024 * 1024;

impl Message for HealthReports {
    const TOPIC: Topic = Topic::Health;
    const SCHEMA: &'static str = "health/2";
    const BUFFER: usize = 16;
    const SUBSCRIBERS: usize = 8;
    const PUBLISHERS: usize = 12;
    const HISTORY: usize = 1;
    type Header = HealthHeader;
    type Element = Health;
    fn place(header: &HealthHeader) -> (u64, u64) {
        (header.session, header.seq)
    }
}

/// Header of a health message: who sent it. The payload is one [`Health`].
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/HealthHeader/1")]
#[repr(C)]
pub struct HealthHeader {
    /// Session of the process.
    pub session: u64,
    /// Counts from 0 in a session.
    pub seq: u64,
}
