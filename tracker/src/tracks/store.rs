//! All tracks, each in a place of its own for as long as it lives.
//!
//! Tracks are kilobytes: none is moved when another ends. A [`Handle`] finds its track without a search, and finds out that it has
//! ended.

use common::tracks::TERMINATED;

use crate::association::hypotheses::Hypotheses;
use crate::filter::uav::imm::Imm;
use crate::tracks::handle::Handle;
use crate::tracks::track::LiveTrack;

/// Hypotheses that are made at once at most, of some 22 kB each.
const MADE_IN_ADVANCE: usize = 64;

/// The tracks.
#[derive(Debug, Default)]
pub struct TrackStore {
    /// Those that have ended are `TERMINATED`.
    places: Vec<LiveTrack>,
    free: Vec<u32>,
    /// Hypotheses of tracks that have ended, to be used again.
    left: Vec<Hypotheses>,
}

impl TrackStore {
    /// Number of tracks.
    pub fn len(&self) -> usize {
        self.places.len() - self.free.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The tracks, in no order.
    pub fn iter(&self) -> impl Iterator<Item = &LiveTrack> {
        self.places.iter().filter(|track| track.life.state != TERMINATED)
    }

    /// Number of places, those of tracks that have ended included.
    pub fn places(&self) -> usize {
        self.places.len()
    }

    /// Whether the track at a place lives.
    pub fn is_alive(&self, place: usize) -> bool {
        self.places[place].life.state != TERMINATED
    }

    /// Where a track is, if it lives.
    pub fn find(&self, handle: Handle) -> Option<usize> {
        let place = handle.place as usize;
        (place < self.places.len() && self.places[place].id == handle.id && self.is_alive(place)).then_some(place)
    }

    /// The handle of the track at a place.
    pub fn handle(&self, place: usize) -> Handle {
        Handle { id: self.places[place].id, place: place as u32 }
    }

    /// Adds a track.
    pub fn add(&mut self, track: LiveTrack) -> Handle {
        let id = track.id;
        if let Some(place) = self.free.pop() {
            self.places[place as usize] = track;
            return Handle { id, place };
        }
        self.places.push(track);
        // All may end at once.
        self.free.reserve(self.places.len());
        let place = (self.places.len() - 1) as u32;
        Handle { id, place }
    }

    /// Frees the place of a track that has ended.
    pub fn free(&mut self, place: usize) {
        let track = &mut self.places[place];
        track.life.state = TERMINATED;
        self.left.extend(track.hypotheses.take());
        self.free.push(place as u32);
    }

    /// Hypotheses for a track that begins with `posterior`, at most so many. Where none are left over, some are made in advance:
    /// the number of tracks varies by chance, and should not allocate for ever.
    pub fn hypotheses(&mut self, posterior: &Imm, most: usize) -> Hypotheses {
        if self.left.is_empty() {
            self.left.extend((0..self.places.len().min(MADE_IN_ADVANCE)).map(|_| Hypotheses::new(posterior, most)));
        }
        let mut hypotheses = self.left.pop().unwrap_or_else(|| Hypotheses::new(posterior, most));
        hypotheses.restart(posterior);
        hypotheses
    }
}

impl std::ops::Index<usize> for TrackStore {
    type Output = LiveTrack;

    fn index(&self, place: usize) -> &LiveTrack {
        &self.places[place]
    }
}

impl std::ops::IndexMut<usize> for TrackStore {
    fn index_mut(&mut self, place: usize) -> &mut LiveTrack {
        &mut self.places[place]
    }
}
