//! The tracker: one call per `plots` message, the tracks brought up to date by it.
//!
//! ```text
//!  plots of a sector ─▶ store, ordered by beam angle
//!  every track whose gates the beam has passed: gate ─▶ associate ─▶ update ─▶ existence ─▶ predict its next passage
//!                                               └─ up to eight at once ─┘
//!  every plot that no confirmed track can still claim: clutter map, pair with last turn ─▶ tentative track
//! ```
//!
//! A track is processed once per passage of the beam, as soon as the upper azimuth edge of its gates is
//! covered. All angles are unwrapped ([`crate::beam::sweep`]), so north is no special place. Nothing here
//! depends on the time of day, on threads or on the order of plots in a message.

mod births;
mod duplicates;
mod updates;

use common::config::{ConfigError, TrackerConfig};
use common::health::{Reject, Rejected};
use common::message::END_OF_STREAM;
use common::plots::{Plot, PlotsHeader};
use common::tracks::{TERMINATED, Track};

use crate::association::Rules;
use crate::beam::agenda::Agenda;
use crate::beam::sweep::{Continuation, Sweep};
use crate::environment::{self, Site};
use crate::plots::measurement::Measurement;
use crate::plots::store::{Entry, PlotStore};
use crate::tracks::handle::Handle;
use crate::tracks::initiation::Reach;
use crate::tracks::store::TrackStore;
use births::Earlier;
use updates::Passages;

/// Association weight with a confirmed track from which a plot starts no new one and is no evidence for a tentative one.
const EXPLAINED: f64 = 0.2;
/// A plot this far behind what has been processed may still be used, cells of azimuth: interpolation moves plots a little.
const LATE_CELLS: f64 = 2.0;

/// What became of one message.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Processed {
    /// Input that was not used, by reason.
    pub rejected: Rejected,
    /// Tracks alive, of any state.
    pub alive: u32,
    /// Of these confirmed or coasting.
    pub confirmed: u32,
}

/// The tracker of one radar.
#[derive(Debug)]
pub struct Tracker {
    config: TrackerConfig,
    rules: Rules,
    reach: Reach,
    sweep: Sweep,
    plots: PlotStore,
    site: Option<Site>,
    tracks: TrackStore,
    agenda: Agenda,
    next_id: u64,
    /// Of the tracks, those that are confirmed or coasting.
    confirmed: u32,
    /// Places of the tracks that this message has ended, reused.
    ended: Vec<usize>,
    passages: Passages,
    earlier: Earlier,
}

impl Tracker {
    /// An empty tracker; track numbers count from `first_id`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn new(config: &TrackerConfig, first_id: u64) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            config: config.clone(),
            rules: Rules::new(config),
            reach: Reach { speed_mps: config.start_speed_mps, acceleration_mps2: config.manoeuvre_noise_mps3 },
            sweep: Sweep::default(),
            plots: PlotStore::default(),
            site: None,
            tracks: TrackStore::default(),
            agenda: Agenda::default(),
            next_id: first_id,
            confirmed: 0,
            ended: Vec::with_capacity(256),
            passages: Passages::default(),
            earlier: Earlier::default(),
        })
    }

    /// Updates tracks one by one, never in groups, to compare.
    #[must_use]
    pub fn one_by_one(mut self) -> Self {
        self.passages.in_groups = false;
        self
    }

    /// Takes the plots of one sector and replaces `tracks` by the tracks that it brought up to date:
    /// processed, started, or ended (once, as `TERMINATED`).
    pub fn process_plots(&mut self, header: &PlotsHeader, plots: &[Plot], tracks: &mut Vec<Track>) -> Processed {
        let mut taken = Processed::default();
        tracks.clear();
        if !environment::is_possible(header) {
            taken.rejected.count(Reject::BadHeader);
            return self.counted(taken);
        }
        match self.sweep.advance(header) {
            Continuation::Onwards => {}
            Continuation::Late => {
                for _ in plots {
                    taken.rejected.count(Reject::Late);
                }
                return self.counted(taken);
            }
            Continuation::Anew => {
                self.plots.clear();
                self.end_all(tracks);
            }
        }
        // Processed out, so that tracks and site can be borrowed side by side.
        let mut site = match self.site.take() {
            Some(site) if site.is_described_by(header) => site,
            _ => Site::new(header, &self.config),
        };
        for (index, plot) in plots.iter().enumerate() {
            if let Err(reason) = self.store(header, index, plot) {
                taken.rejected.count(reason);
            }
        }
        self.plots.sort();
        let covered_rad = self.sweep.covered_to_rad();
        self.process_due(covered_rad, header.has(END_OF_STREAM), &site, tracks);
        self.start_tracks(covered_rad, &mut site, tracks);
        self.plots.drop_before(covered_rad);
        for place in self.ended.drain(..) {
            self.tracks.free(place);
        }
        self.site = Some(site);
        self.counted(taken)
    }

    /// Keeps a plot at the angle of the beam, or says why not.
    fn store(&mut self, header: &PlotsHeader, index: usize, plot: &Plot) -> Result<(), Reject> {
        let measurement = Measurement::from_plot(plot).ok_or(Reject::BadPlot)?;
        let angle_rad = self.sweep.unwrap(header, plot.azimuth_rad);
        let tolerance_rad = LATE_CELLS * header.cell_azimuth_rad;
        let angle_rad = self.plots.admit(angle_rad, tolerance_rad).ok_or(Reject::Late)?;
        let (seq, index) = (header.seq, index as u32);
        self.plots.push(Entry { angle_rad, seq, index, explained: 0.0, claimed: 0.0, owner: None }, measurement);
        Ok(())
    }

    /// Tracks alive.
    pub fn alive(&self) -> &TrackStore {
        &self.tracks
    }

    fn counted(&self, mut taken: Processed) -> Processed {
        taken.alive = self.tracks.len() as u32;
        taken.confirmed = self.confirmed;
        taken
    }

    /// Ends every track: measurement time went back.
    fn end_all(&mut self, tracks: &mut Vec<Track>) {
        let places: Vec<usize> = (0..self.tracks.places()).filter(|&place| self.tracks.is_alive(place)).collect();
        for place in places {
            self.end(place);
            tracks.push(self.tracks[place].message());
        }
        for place in self.ended.drain(..) {
            self.tracks.free(place);
        }
        self.agenda.clear();
    }

    /// Ends a track; its place is free after the message.
    fn end(&mut self, place: usize) {
        let track = &mut self.tracks[place];
        self.confirmed -= u32::from(track.life.is_confirmed());
        track.life.state = TERMINATED;
        self.passages.rivals.forget(place);
        self.ended.push(place);
    }

    /// Ends a track and says so in `tracks`, which may hold a message of it.
    fn end_and_tell(&mut self, place: usize, tracks: &mut Vec<Track>) {
        self.end(place);
        let message = self.tracks[place].message();
        match tracks.iter_mut().find(|track| track.id == message.id) {
            Some(track) => *track = message,
            None => tracks.push(message),
        }
    }

    /// A track that is alive.
    fn find(&self, handle: Option<Handle>) -> Option<usize> {
        handle.and_then(|handle| self.tracks.find(handle))
    }
}
