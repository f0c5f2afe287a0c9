//! Track store: all tracks and their states, each in a place of its own for as long as it lives.
//!
//! Tracks are kilobytes: none is moved when another ends. A [`Handle`] finds its track without a search, and finds out that it has
//! ended.

use common::tracks::TERMINATED;
use common::units::seconds_between;
use nalgebra::{SMatrix, SVector};

use super::handle::Handle;
use super::states::States;
use super::track::LiveTrack;
use crate::association::hypotheses::Hypotheses;
use crate::filter::Layout;
use crate::filter::gaussian::at;

/// Hypotheses that are made at once at most, of some 12 kB each.
const MADE_IN_ADVANCE: usize = 64;
/// Components in which tracks are compared: position and velocity.
const COMPARED: usize = 6;

/// The tracks.
#[derive(Debug)]
pub struct TrackStore {
    /// Those that have ended are `TERMINATED`.
    places: Vec<LiveTrack>,
    /// Of the tracks at the same places.
    pub states: States,
    free: Vec<u32>,
    /// Hypotheses of tracks that have ended, to be used again.
    left: Vec<Hypotheses>,
}

impl TrackStore {
    /// No tracks; their states will be of the form `layout`.
    pub fn new(layout: &Layout) -> Self {
        Self { places: Vec::new(), states: States::new(layout), free: Vec::new(), left: Vec::new() }
    }

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

    /// Whether the track at a place lives.
    pub fn is_alive(&self, place: usize) -> bool {
        self.places[place].life.state != TERMINATED
    }

    /// Where a track is, if it lives.
    pub fn find(&self, handle: Handle) -> Option<usize> {
        let place = handle.place as usize;
        (place < self.places.len() && self.places[place].id == handle.id && self.is_alive(place)).then_some(place)
    }

    /// The places of the tracks, in their order.
    pub fn alive(&self) -> impl Iterator<Item = usize> {
        (0..self.places.len()).filter(|&place| self.is_alive(place))
    }

    /// The handle of the track at a place.
    pub fn handle(&self, place: usize) -> Handle {
        Handle { id: self.places[place].id, place: place as u32 }
    }

    /// Adds a track with a posterior, that is also its last prediction.
    pub fn add(&mut self, track: LiveTrack, posterior: &[f64]) -> Handle {
        let id = track.id;
        let place = if let Some(place) = self.free.pop() {
            self.places[place as usize] = track;
            place
        } else {
            self.places.push(track);
            self.states.add_place();
            // All may end at once.
            self.free.reserve(self.places.len());
            (self.places.len() - 1) as u32
        };
        self.states.posterior_mut(place as usize).copy_from_slice(posterior);
        self.states.begin(place as usize);
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
    pub fn hypotheses(&mut self, posterior: &[f64], most: usize) -> Hypotheses {
        let layout = self.states.layout();
        if self.left.is_empty() {
            let made = 0..self.places.len().min(MADE_IN_ADVANCE);
            self.left.extend(made.map(|_| Hypotheses::new(layout, posterior, most)));
        }
        let mut hypotheses = self.left.pop().unwrap_or_else(|| Hypotheses::new(layout, posterior, most));
        hypotheses.restart(layout, posterior);
        hypotheses
    }

    /// Squared distance of two tracks' positions and velocities, in standard deviations of both:
    /// ```text
    /// d² = Δᵀ (P_a + P_b)⁻¹ Δ
    /// ```
    /// Errors of tracks that share plots are alike, so that of one target is smaller than χ² of 6 (or 4) degrees of freedom. The second track
    /// is moved to the time of the first along its mean.
    pub fn squared_distance(&self, first: usize, second: usize) -> f64 {
        let [a, b] = [first, second].map(|place| self.states.posterior(place).moments());
        let later_s = seconds_between(self.places[second].time_ns, self.places[first].time_ns);
        let difference = SVector::<f64, COMPARED>::from_fn(|i, _| {
            a.mean[i] - b.mean[i] - if i < 3 { b.mean[3 + i] * later_s } else { 0.0 }
        });
        let both = SMatrix::<f64, COMPARED, COMPARED>::from_fn(|i, j| {
            let sum = a.covariance[at(i, j)] + b.covariance[at(i, j)];
            if i == j { sum * (1.0 + 1e-9) + f64::MIN_POSITIVE } else { sum }
        });
        both.cholesky().map_or(f64::INFINITY, |factor| difference.dot(&factor.solve(&difference)))
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
