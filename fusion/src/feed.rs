//! What comes from one site: its tracks, its truth, and how far it has come.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Source};
use common::geodesy::{FrameChange, Position};
use common::health::Intake;
use common::ipc::{IpcError, Station, Subscriber};
use common::message::END_OF_STREAM;
use common::messages::{Tracks, Truth};
use common::truth::TruthTarget;
use common::units::{NS_PER_S, seconds_between};
use tracing::warn;

use crate::engine::Fusion;
use crate::local::Report;

/// Truth older than so many scans is of a target that is gone.
const TRUTH_SCANS: f64 = 1.5;
/// A site that has never been heard by a fusion that was started again, and that nobody publishes at for so long, had ended before.
const LONG_GONE: Duration = Duration::from_secs(10);

/// Time without a message after which a site is silent.
const SILENT: Duration = Duration::from_secs(10);

/// The messages of a site.
pub(crate) struct Feed {
    /// Name of the site.
    name: String,
    tracks: Subscriber<Tracks>,
    truth: Subscriber<Truth>,
    to_centre: FrameChange,
    scan_period_s: f64,
    /// Whether its truth is that of the simulator, which numbers targets alike at all sites.
    is_simulated: bool,
    /// Measurement time up to which its tracks are there, ns UTC.
    tracks_ns: Option<u64>,
    truth_ns: u64,
    numbering: u64,
    /// Measurement time of its first tracks, ns UTC.
    first_ns: Option<u64>,
    opened: Instant,
    /// When something came last.
    heard: Instant,
    /// States of each target, oldest first, in the axes of the centre.
    targets: BTreeMap<u32, Vec<TruthTarget>>,
    ended: bool,
    /// CLOCK_MONOTONIC at which its last tracks were published, ns.
    pub(crate) tracks_out_ns: u64,
    /// How far its clock is ahead of that of the others, if that is too far, s; else 0.
    pub(crate) wrong_by_s: f64,
}

impl Feed {
    pub(crate) fn new(station: &Station, site: &ChainConfig, centre: &Position) -> Result<Self, IpcError> {
        let place = site.site.position.unwrap_or(*centre);
        Ok(Self {
            name: site.site.name.clone(),
            truth: station.subscriber()?,
            tracks: station.subscriber()?,
            to_centre: FrameChange::new(&place, centre),
            scan_period_s: site.scan_period_s(),
            is_simulated: site.run.source == Source::RadarSim,
            tracks_ns: None,
            truth_ns: 0,
            numbering: 0,
            first_ns: None,
            opened: Instant::now(),
            heard: Instant::now(),
            targets: BTreeMap::new(),
            ended: false,
            tracks_out_ns: 0,
            wrong_by_s: 0.0,
        })
    }

    /// Takes what waits, but no tracks beyond `limit_ns`: a site that is ahead of the others waits for them. Gives `fusion` the reports
    /// of site number `site`.
    pub(crate) fn take_waiting(&mut self, site: usize, limit_ns: u64, fusion: &mut Fusion) -> Result<(), IpcError> {
        while self.tracks_ns.is_none_or(|tracks_ns| tracks_ns <= limit_ns)
            && let Some(message) = self.tracks.receive()?
        {
            let header = message.header();
            if self.numbering != 0 && header.numbering() != self.numbering {
                warn!("site {}: its tracker has begun anew, its tracks have new numbers", self.name);
                fusion.forget(site);
            }
            self.numbering = header.numbering();
            self.heard = Instant::now();
            self.tracks_ns = Some(header.time_ns);
            self.first_ns.get_or_insert(header.time_ns);
            self.tracks_out_ns = self.tracks_out_ns.max(header.stamps.tracks_out_ns);
            self.ended |= header.has(END_OF_STREAM);
            if self.is_ahead() {
                fusion.refuse(site, message.elements().len());
                continue;
            }
            fusion.hear(site, header.time_ns);
            for track in message.elements() {
                fusion.take(site, &Report::from_track(track), header.time_ns);
            }
        }
        // After the tracks, so that the truth that they are scored by is there.
        while let Some(message) = self.truth.receive()? {
            self.truth_ns = self.truth_ns.max(message.header().time_ns);
            let targets = if self.is_simulated { message.elements() } else { &[] };
            for target in targets {
                let moved = self.in_centre(target);
                self.targets.entry(target.target_id).or_default().push(moved);
            }
        }
        Ok(())
    }

    /// Whether nothing follows; `stopping` says whether the chain has been asked to end, so that nobody publishes any more, and
    /// `again` whether this process has been started again, so that the end may have passed it.
    pub(crate) fn has_ended(&self, stopping: bool, again: bool) -> bool {
        let passed = again && self.tracks_ns.is_none() && self.opened.elapsed() > LONG_GONE;
        self.ended || (stopping || passed) && self.tracks.publishers() == 0
    }

    /// Whether its tracks up to `now_ns` are there.
    pub(crate) fn has_passed(&self, now_ns: u64) -> bool {
        self.tracks_ns.is_some_and(|tracks_ns| tracks_ns >= now_ns)
    }

    /// Whether its truth up to `now_ns` is there, if it has any.
    pub(crate) fn has_told_truth(&self, now_ns: u64) -> bool {
        !self.is_simulated || self.truth_ns >= now_ns
    }

    /// Measurement time of its last tracks, ns UTC.
    pub(crate) fn time_ns(&self) -> Option<u64> {
        self.tracks_ns
    }

    /// Measurement time that its clock says now, if time runs at `rate`, ns UTC.
    pub(crate) fn clock_ns(&self, rate: f64) -> Option<u64> {
        Some(self.tracks_ns? + (rate * self.heard.elapsed().as_secs_f64() * NS_PER_S) as u64)
    }

    /// Measurement time of its first tracks, ns UTC.
    pub(crate) fn first_ns(&self) -> Option<u64> {
        self.first_ns
    }

    /// Whether its clock is not that of the others.
    pub(crate) fn is_out_of_step(&self) -> bool {
        self.wrong_by_s != 0.0
    }

    /// Whether its clock is ahead of that of the others, so that its tracks are not taken.
    pub(crate) fn is_ahead(&self) -> bool {
        self.wrong_by_s > 0.0
    }

    /// Whether something has come lately.
    pub(crate) fn is_heard(&self) -> bool {
        self.heard.elapsed() < SILENT
    }

    /// Messages received and missed.
    pub(crate) fn intake(&self) -> Intake {
        self.tracks.intake()
    }

    /// The most messages that one has found waiting before it since the last call.
    pub(crate) fn take_most_waiting(&self) -> Option<u32> {
        self.tracks.take_most_waiting()
    }

    /// Puts the targets as they are at `now_ns`, with the time of what is known of each, unless something newer is known already.
    pub(crate) fn truth_at(&mut self, now_ns: u64, put: &mut BTreeMap<u32, (u64, TruthTarget)>) {
        let oldest_s = TRUTH_SCANS * self.scan_period_s;
        self.targets.retain(|_, states| {
            let known = states.partition_point(|state| state.time_ns <= now_ns);
            states.drain(..known.saturating_sub(1));
            states.last().is_some_and(|last| seconds_between(last.time_ns, now_ns) < oldest_s)
        });
        for (&id, states) in &self.targets {
            let is_known = |state: &&TruthTarget| (0.0..oldest_s).contains(&seconds_between(state.time_ns, now_ns));
            let Some(state) = states.first().filter(is_known) else { continue };
            let moved = at(state, now_ns);
            // Whoever sees the target says that it can be seen.
            let (time_ns, entry) = put.entry(id).or_insert((state.time_ns, moved));
            let flags = entry.flags | moved.flags;
            if state.time_ns > *time_ns {
                (*time_ns, *entry) = (state.time_ns, moved);
            }
            entry.flags = flags;
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
