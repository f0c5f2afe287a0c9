//! What comes from one site: its tracks, its truth, and how far it has come.

use std::collections::BTreeMap;

use common::config::{ChainConfig, Source};
use common::geodesy::{FrameChange, Position};
use common::ipc::{IpcError, Station, Subscriber};
use common::message::END_OF_STREAM;
use common::messages::{Tracks, Truth};
use common::truth::TruthTarget;
use common::units::seconds_between;

use crate::engine::Fusion;
use crate::local::Report;

/// Truth older than this is of a target that is gone, s.
const TRUTH_AGE_S: f64 = 5.0;

/// The messages of a site.
pub(crate) struct Feed {
    tracks: Subscriber<Tracks>,
    truth: Subscriber<Truth>,
    to_centre: FrameChange,
    has_truth: bool,
    /// Measurement time up to which its tracks are there, ns UTC.
    tracks_ns: Option<u64>,
    truth_ns: u64,
    /// States of each target, oldest first, in the axes of the centre.
    targets: BTreeMap<u32, Vec<TruthTarget>>,
    ended: bool,
    /// CLOCK_MONOTONIC at which its last tracks were published, ns.
    pub(crate) tracks_out_ns: u64,
}

impl Feed {
    pub(crate) fn new(station: &Station, site: &ChainConfig, centre: &Position) -> Result<Self, IpcError> {
        let place = site.site.position.unwrap_or(*centre);
        Ok(Self {
            truth: station.subscriber()?,
            tracks: station.subscriber()?,
            to_centre: FrameChange::new(&place, centre),
            has_truth: site.run.source == Source::RadarSim,
            tracks_ns: None,
            truth_ns: 0,
            targets: BTreeMap::new(),
            ended: false,
            tracks_out_ns: 0,
        })
    }

    /// Takes what waits; gives `fusion` the reports of site number `site`.
    pub(crate) fn take_waiting(&mut self, site: usize, fusion: &mut Fusion) -> Result<(), IpcError> {
        while let Some(message) = self.truth.receive()? {
            self.truth_ns = self.truth_ns.max(message.header().time_ns);
            for target in message.elements() {
                let moved = self.in_centre(target);
                self.targets.entry(target.target_id).or_default().push(moved);
            }
        }
        while let Some(message) = self.tracks.receive()? {
            let header = message.header();
            self.tracks_ns = self.tracks_ns.max(Some(header.time_ns));
            self.tracks_out_ns = self.tracks_out_ns.max(header.stamps.tracks_out_ns);
            self.ended |= header.has(END_OF_STREAM);
            for report in message.elements().iter().filter_map(Report::from_track) {
                fusion.take(site, &report, header.time_ns);
            }
        }
        Ok(())
    }

    /// Whether nothing follows; `stopping` says whether the chain has been asked to end, so that nobody publishes any more.
    pub(crate) fn has_ended(&self, stopping: bool) -> bool {
        self.ended || stopping && self.tracks.publishers() == 0
    }

    /// Whether everything that it has to say up to `now_ns` is there.
    pub(crate) fn has_passed(&self, now_ns: u64) -> bool {
        self.tracks_ns.is_some_and(|tracks_ns| tracks_ns >= now_ns) && (!self.has_truth || self.truth_ns >= now_ns)
    }

    /// Measurement time of its last tracks, ns UTC.
    pub(crate) fn time_ns(&self) -> Option<u64> {
        self.tracks_ns
    }

    /// Messages received and missed.
    pub(crate) fn intake(&self) -> common::health::Intake {
        self.tracks.intake()
    }

    /// The targets as they are at `now_ns`; of each site the last state before.
    pub(crate) fn truth_at(&mut self, now_ns: u64, put: &mut BTreeMap<u32, TruthTarget>) {
        self.targets.retain(|_, states| {
            let known = states.partition_point(|state| state.time_ns <= now_ns);
            states.drain(..known.saturating_sub(1));
            states.first().is_some_and(|first| seconds_between(first.time_ns, now_ns) < TRUTH_AGE_S)
        });
        for (&id, states) in &self.targets {
            let Some(state) = states.first().filter(|state| state.time_ns <= now_ns) else { continue };
            let moved = at(state, now_ns);
            let entry = put.entry(id).or_insert(moved);
            // The state that is nearest in time says most; whoever sees the target says that it can be seen.
            let flags = entry.flags | moved.flags;
            *entry = TruthTarget { flags, ..*entry };
        }
    }

    fn in_centre(&self, target: &TruthTarget) -> TruthTarget {
        let of = |order: usize| std::array::from_fn(|axis| target.state[3 * axis + order]);
        let position = self.to_centre.position_m(of(0));
        let (velocity, acceleration) = (self.to_centre.vector(of(1)), self.to_centre.vector(of(2)));
        let mut moved = *target;
        for axis in 0..3 {
            moved.state[3 * axis..][..3].copy_from_slice(&[position[axis], velocity[axis], acceleration[axis]]);
        }
        moved
    }
}

/// A target some time later.
fn at(target: &TruthTarget, now_ns: u64) -> TruthTarget {
    let age_s = seconds_between(target.time_ns, now_ns);
    let mut moved = TruthTarget { time_ns: now_ns, ..*target };
    for axis in moved.state.chunks_exact_mut(3) {
        axis[0] += age_s * (axis[1] + age_s * axis[2] / 2.0);
        axis[1] += age_s * axis[2];
    }
    moved
}
