//! The topics of a site, in one table: what travels on each, in which version, and how much room it gets.
//!
//! A new topic is an entry here, a file with its header and element, and a place in the table of stages
//! ([`crate::topology`]). Services, losses, books, recordings, exports and metrics iterate over the table.

use serde::{Deserialize, Serialize};

/// Calls the macro `$then` with the table: name, version, header, elements of the longest message, [`Message`]'s
/// numbers, and the source
/// files that define header and element.
macro_rules! with_topics {
    ($then:ident) => {
        $then! {
            /// Amplitudes of every resolution cell of a dwell.
            Dwells("dwells", "dwell/1") DwellHeader, [f32; MAX_CELLS]
                { QUEUE: 32, SUBSCRIBERS: 4, PUBLISHERS: 2, HISTORY: 0 } from "dwell.rs";
            /// Detections of a sector.
            Plots("plots", "plots/2") PlotsHeader, [Plot; MAX_PLOTS]
                { QUEUE: 32, SUBSCRIBERS: 5, PUBLISHERS: 2, HISTORY: 0 } from "message.rs" "plots.rs";
            /// Tracks of a sector.
            Tracks("tracks", "tracks/3") TracksHeader, [Track; MAX_TRACKS]
                { QUEUE: 12, SUBSCRIBERS: 6, PUBLISHERS: 2, HISTORY: 0 } from "message.rs" "tracks.rs";
            /// True targets of a scan.
            Truth("truth", "truth/1") TruthHeader, [TruthTarget; MAX_TARGETS]
                { QUEUE: 8, SUBSCRIBERS: 5, PUBLISHERS: 2, HISTORY: 0 } from "truth.rs";
            /// What several sites together know of targets.
            SystemTracks("system-tracks", "system-tracks/1") SystemTracksHeader, [SystemTrack; MAX_SYSTEM_TRACKS]
                { QUEUE: 8, SUBSCRIBERS: 5, PUBLISHERS: 2, HISTORY: 0 } from "system_tracks.rs";
            /// What an operator asks of the tracker.
            Commands("commands", "commands/1") CommandsHeader, [Command; MAX_COMMANDS]
                { QUEUE: 32, SUBSCRIBERS: 3, PUBLISHERS: 4, HISTORY: 0 } from "label.rs" "commands.rs";
            /// What the tracker has made of it.
            Actions("actions", "actions/1") CommandsHeader, [Command; MAX_COMMANDS]
                { QUEUE: 128, SUBSCRIBERS: 6, PUBLISHERS: 2, HISTORY: 128 } from "label.rs" "commands.rs";
            /// Where false plots fall.
            ClutterMap("clutter-map", "clutter-map/1") ClutterMapHeader, [ClutterCell; MAX_CLUTTER_CELLS]
                { QUEUE: 2, SUBSCRIBERS: 4, PUBLISHERS: 2, HISTORY: 0 } from "clutter_map.rs";
            /// State of a process.
            HealthReports("health", "health/4") HealthHeader, [Health; 1]
                { QUEUE: 16, SUBSCRIBERS: 12, PUBLISHERS: 16, HISTORY: 1 } from "label.rs" "health.rs";
        }
    };
}
pub(crate) use with_topics;

macro_rules! declare_names {
    ($(#[$doc:meta] $name:ident($text:literal, $schema:literal) $header:path, [$element:path; $most:expr]
        { $($key:ident: $value:literal),+ } from $($source:literal)+;)+) => {
        /// The topics of a site.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[repr(usize)]
        pub enum Topic {
            $(#[$doc] #[serde(rename = $text)] $name,)+
        }

        /// Number of topics.
        pub const TOPICS: usize = [$($text),+].len();

        impl Topic {
            /// All topics.
            pub const ALL: [Self; TOPICS] = [$(Self::$name),+];

            /// Name in service names, reports and recordings.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text),+
                }
            }
        }
    };
}

with_topics!(declare_names);

impl Topic {
    /// The topic of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// All topics that tell of what the radar sees, and not of processes, operators or what was learnt of the surroundings.
    pub fn of_data() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|topic| topic.is_data())
    }

    /// Whether its messages tell of what the radar sees.
    pub fn is_data(self) -> bool {
        !matches!(self, Self::HealthReports | Self::Commands | Self::Actions | Self::ClutterMap)
    }

    /// Whether a message that is missing counts as lost. Health repeats itself, and commands come from several publishers at once,
    /// each of which counts its own.
    pub fn is_counted(self) -> bool {
        !matches!(self, Self::HealthReports | Self::Commands)
    }

    /// Whether it is too much for text, and for a recording unless it is asked for: 10⁸ bytes a second, 10⁹ as text.
    pub fn is_bulk(self) -> bool {
        self == Self::Dwells
    }
}
