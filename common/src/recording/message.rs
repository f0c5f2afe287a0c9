//! One recorded message of any topic.

use crate::dwell::DwellHeader;
use crate::health::Health;
use crate::plots::{Plot, PlotsHeader};
use crate::services::{HealthHeader, Topic};
use crate::tracks::{Track, TracksHeader};
use crate::truth::{TruthHeader, TruthTarget};

/// A message with its elements.
#[derive(Debug, Clone, PartialEq)]
pub enum Recorded {
    /// Amplitudes of cells.
    Dwells(DwellHeader, Vec<f32>),
    /// Detections of a sector.
    Plots(PlotsHeader, Vec<Plot>),
    /// Tracks of a sector.
    Tracks(TracksHeader, Vec<Track>),
    /// True targets of a scan.
    Truth(TruthHeader, Vec<TruthTarget>),
    /// State of a process.
    Health(HealthHeader, Vec<Health>),
}

/// A message whose elements lie elsewhere, in shared memory for example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RecordedRef<'a> {
    /// Amplitudes of cells.
    Dwells(&'a DwellHeader, &'a [f32]),
    /// Detections of a sector.
    Plots(&'a PlotsHeader, &'a [Plot]),
    /// Tracks of a sector.
    Tracks(&'a TracksHeader, &'a [Track]),
    /// True targets of a scan.
    Truth(&'a TruthHeader, &'a [TruthTarget]),
    /// State of a process.
    Health(&'a HealthHeader, &'a [Health]),
}

impl Recorded {
    /// The same message, borrowed.
    pub fn by_ref(&self) -> RecordedRef<'_> {
        match self {
            Self::Dwells(header, elements) => RecordedRef::Dwells(header, elements),
            Self::Plots(header, elements) => RecordedRef::Plots(header, elements),
            Self::Tracks(header, elements) => RecordedRef::Tracks(header, elements),
            Self::Truth(header, elements) => RecordedRef::Truth(header, elements),
            Self::Health(header, elements) => RecordedRef::Health(header, elements),
        }
    }
}

impl RecordedRef<'_> {
    /// The topic it travelled on.
    pub fn topic(&self) -> Topic {
        match self {
            Self::Dwells(..) => Topic::Dwells,
            Self::Plots(..) => Topic::Plots,
            Self::Tracks(..) => Topic::Tracks,
            Self::Truth(..) => Topic::Truth,
            Self::Health(..) => Topic::Health,
        }
    }

    /// Session of its publisher.
    pub fn session(&self) -> u64 {
        match self {
            Self::Dwells(header, _) => header.session,
            Self::Plots(header, _) => header.session,
            Self::Tracks(header, _) => header.session,
            Self::Truth(header, _) => header.session,
            Self::Health(header, _) => header.session,
        }
    }

    /// Position in its stream.
    pub fn seq(&self) -> u64 {
        match self {
            Self::Dwells(header, _) => header.seq,
            Self::Plots(header, _) => header.seq,
            Self::Tracks(header, _) => header.seq,
            Self::Truth(header, _) => header.seq,
            Self::Health(header, _) => header.seq,
        }
    }

    /// Measurement time, ns UTC; 0 for health, which has none.
    pub fn time_ns(&self) -> u64 {
        match self {
            Self::Dwells(header, _) => header.time_ns,
            Self::Plots(header, _) => header.time_ns,
            Self::Tracks(header, _) => header.time_ns,
            Self::Truth(header, _) => header.time_ns,
            Self::Health(..) => 0,
        }
    }

    /// Elements in the payload.
    pub fn len(&self) -> usize {
        match self {
            Self::Dwells(_, elements) => elements.len(),
            Self::Plots(_, elements) => elements.len(),
            Self::Tracks(_, elements) => elements.len(),
            Self::Truth(_, elements) => elements.len(),
            Self::Health(_, elements) => elements.len(),
        }
    }

    /// Whether the payload is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
