//! Which tracks may want the same plots: the confirmed ones near a track, by where they are expected.

use std::f64::consts::TAU;

use crate::association::gate::Radar;
use crate::association::neighbours::Neighbours;
use crate::filter::uav::motion::CONSTANT_VELOCITY;
use crate::tracks::store::TrackStore;
use crate::tracks::track::{LiveTrack, Passage};

/// Rivals that are asked what they claim: the nearest.
pub const MOST_NEAR: usize = 6;
/// Tracks nearer than this may want the same plots, cells of range.
const RIVAL_CELLS: f64 = 5.0;
/// Passages nearer than this belong to the same turn, turns.
const RIVAL_TURNS: f64 = 0.4;

/// The confirmed tracks, by where they are and were expected.
#[derive(Debug, Default)]
pub struct Rivals(Neighbours);

impl Rivals {
    /// Makes distances those of a radar; if they were others, all tracks are looked at.
    pub fn suit(&mut self, radar: &Radar, tracks: &TrackStore) {
        let reach_m = RIVAL_CELLS * radar.cell[0];
        if self.0.reach_m().to_bits() != reach_m.to_bits() {
            self.0.clear(reach_m);
            for place in (0..tracks.places()).filter(|&place| tracks.is_alive(place)) {
                self.note(place, &tracks[place]);
            }
        }
    }

    /// Notes where the track at a place of the roster is now.
    pub fn note(&mut self, place: usize, track: &LiveTrack) {
        if track.life.is_confirmed() {
            self.0.put(2 * place as u32, position(&track.next));
            self.0.put(2 * place as u32 + 1, position(&track.last));
        }
    }

    /// Notes that a track has ended.
    pub fn forget(&mut self, place: usize) {
        self.0.remove(2 * place as u32);
        self.0.remove(2 * place as u32 + 1);
    }

    /// The nearest confirmed tracks that may want the same plots as the track at `place` in this turn, with what they expect of it.
    pub fn of<'a>(
        &self,
        place: usize,
        tracks: &'a TrackStore,
    ) -> impl Iterator<Item = (&'a LiveTrack, &'a Passage)> + Clone {
        let own = &tracks[place].next;
        let centre = position(own);
        let mut nearest = [None::<(f64, &LiveTrack, &Passage)>; MOST_NEAR];
        for label in self.0.near(centre).filter(|label| *label as usize / 2 != place) {
            let track = &tracks[label as usize / 2];
            let passages = [&track.next, &track.last];
            let of_this_turn = |passage: &&Passage| (passage.angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU;
            if passages.iter().position(of_this_turn) != Some(label as usize % 2) {
                continue;
            }
            let expects = passages[label as usize % 2];
            let there = position(expects);
            let square: f64 = (0..3).map(|axis| (there[axis] - centre[axis]).powi(2)).sum();
            if square >= self.0.reach_m() * self.0.reach_m() {
                continue;
            }
            let nearer = |other: &Option<(f64, &LiveTrack, &Passage)>| {
                other.is_some_and(|(least, other, _)| least.total_cmp(&square).then(other.id.cmp(&track.id)).is_lt())
            };
            let rank = nearest.partition_point(nearer);
            if rank < MOST_NEAR {
                nearest[rank..].rotate_right(1);
                nearest[rank] = Some((square, track, expects));
            }
        }
        nearest.into_iter().flatten().map(|(_, track, expects)| (track, expects))
    }
}

fn position(passage: &Passage) -> [f64; 3] {
    passage.prediction.modes[CONSTANT_VELOCITY].position()
}
