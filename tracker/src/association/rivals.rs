//! Which tracks may want the same plots: the confirmed ones near a track, by where they are expected.

use std::f64::consts::TAU;

use crate::association::neighbours::Neighbours;
use crate::plots::radar::Radar;
use crate::tracks::states::Of;
use crate::tracks::store::TrackStore;
use crate::tracks::track::LiveTrack;

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
            for place in tracks.alive() {
                self.record(place, &tracks[place]);
            }
        }
    }

    /// Records where the track at a place of the store is expected and was.
    pub fn record(&mut self, place: usize, track: &LiveTrack) {
        if track.life.is_confirmed() {
            self.0.put(2 * place as u32, track.next.position_m);
            self.0.put(2 * place as u32 + 1, track.last.position_m);
        }
    }

    /// Removes a track that has ended.
    pub fn forget(&mut self, place: usize) {
        self.0.remove(2 * place as u32);
        self.0.remove(2 * place as u32 + 1);
    }

    /// The nearest confirmed tracks that may want the same plots as the track at `place` in this scan, with which of their predictions are of
    /// it.
    pub fn of<'a>(
        &self,
        place: usize,
        tracks: &'a TrackStore,
    ) -> impl Iterator<Item = (usize, &'a LiveTrack, Of)> + Clone {
        let own = &tracks[place].next;
        let mut nearest = [None::<(f64, usize, &LiveTrack, Of)>; MOST_NEAR];
        for label in self.0.near(own.position_m).filter(|label| *label as usize / 2 != place) {
            let other = label as usize / 2;
            let track = &tracks[other];
            let of_this_scan = |angle_rad: f64| (angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU;
            let (of, expects) = if of_this_scan(track.next.angle_rad) {
                (Of::NextScan, &track.next)
            } else if of_this_scan(track.last.angle_rad) {
                (Of::LastScan, &track.last)
            } else {
                continue;
            };
            if (of == Of::LastScan) != (label % 2 == 1) {
                continue;
            }
            let square: f64 = (0..3).map(|axis| (expects.position_m[axis] - own.position_m[axis]).powi(2)).sum();
            if square >= self.0.reach_m() * self.0.reach_m() {
                continue;
            }
            let nearer = |other: &Option<(f64, usize, &LiveTrack, Of)>| {
                other.is_some_and(|(least, _, other, _)| least.total_cmp(&square).then(other.id.cmp(&track.id)).is_lt())
            };
            let rank = nearest.partition_point(nearer);
            if rank < MOST_NEAR {
                nearest[rank..].rotate_right(1);
                nearest[rank] = Some((square, other, track, of));
            }
        }
        nearest.into_iter().flatten().map(|(_, place, track, of)| (place, track, of))
    }
}
