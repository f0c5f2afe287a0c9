//! A system track: what all sites together know of a target.

use crate::engine::Decision;
use crate::gaussian::Gaussian;
use crate::motion::Moving;

/// Most sites that a system track can tell of at once.
pub const CONTRIBUTORS: usize = 64;

/// A local track that a system track is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contributor {
    /// Number of the site.
    pub site: u16,
    /// Place of the local track.
    pub(crate) local: u32,
    /// The site's number of the track.
    pub id: u64,
}

/// A system track as it goes out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SystemTrack<'a> {
    /// Its number, never used again.
    pub id: u64,
    /// Time of the state, ns UTC.
    pub time_ns: u64,
    /// State in the axes of the centre; what is not known of the radars' biases is part of the covariance.
    pub estimate: Gaussian,
    /// Probability that the target manoeuvres.
    pub manoeuvre: f64,
    /// The local tracks that it is made of.
    pub contributors: &'a [Contributor],
    /// Cycles without any contributor.
    pub coasting: u32,
    /// Whether it has ended; this is its last message.
    pub ended: bool,
}

/// A system track as it is kept.
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub(crate) id: u64,
    pub(crate) time_ns: u64,
    pub(crate) state: Moving,
    pub(crate) contributors: Vec<Contributor>,
    /// Time since which nobody contributes.
    pub(crate) alone_since_ns: Option<u64>,
    pub(crate) coasting: u32,
    /// For another system track that may be the same target.
    pub(crate) twin: Option<Decision>,
    /// Whether it has become part of another.
    pub(crate) merged: bool,
    /// Whether the last cycle has ended it.
    pub(crate) ended: bool,
    /// Whether the place holds a track at all.
    pub(crate) alive: bool,
}

impl System {
    /// Whether local tracks may become part of it.
    pub(crate) fn is_open(&self) -> bool {
        self.alive && !self.merged
    }

    pub(crate) fn contributes(&self, site: u16) -> bool {
        self.contributors.iter().any(|of| of.site == site)
    }
}
