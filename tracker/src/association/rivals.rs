//! Which tracks may want the same plots: the confirmed ones whose windows for plots overlap that of a track, whatever the radar and however far
//! apart its cells, its errors and the targets' manoeuvres make that.

use std::f64::consts::TAU;

use crate::association::neighbours::Neighbours;
use crate::beam::opportunity::Opportunity;
use crate::tracks::states::Of;
use crate::tracks::store::TrackStore;
use crate::tracks::track::LiveTrack;

/// Rivals that are asked what they claim: the nearest.
pub const MOST_NEAR: usize = 6;
/// Passages nearer than this belong to the same turn, turns.
const RIVAL_TURNS: f64 = 0.4;
/// Room that the index leaves for windows to grow.
const SLACK: f64 = 1.5;
/// The index is reviewed when every track has been recorded so many times.
const REVIEW: usize = 8;
/// Least and largest reach of the index, m.
const REACH_M: [f64; 2] = [1.0, 1e6];

/// The confirmed tracks, by where they are and were expected.
#[derive(Debug, Default)]
pub struct Rivals {
    index: Neighbours,
    /// By label: the windows of the scan to come, and of the last one.
    windows: Vec<Opportunity>,
    /// A window reaches farther than the index.
    outgrown: bool,
    /// Windows since the last review.
    recorded: usize,
}

impl Rivals {
    /// Reviews how far the index reaches: twice as far as the widest window.
    pub fn review(&mut self, tracks: &TrackStore) {
        if !self.outgrown && self.recorded < REVIEW * tracks.len() {
            return;
        }
        (self.outgrown, self.recorded) = (false, 0);
        let confirmed = || tracks.alive().filter(|&place| tracks[place].life.is_confirmed());
        let radii = confirmed().flat_map(|place| [&tracks[place].next, &tracks[place].last].map(radius_m));
        let needed_m = (2.0 * radii.fold(0.0, f64::max)).clamp(REACH_M[0], REACH_M[1]);
        if (needed_m..=SLACK * SLACK * needed_m).contains(&self.index.reach_m()) {
            return;
        }
        self.index.clear(SLACK * needed_m);
        for place in confirmed() {
            self.record(place, &tracks[place]);
        }
    }

    /// Records where the track at a place of the store is expected and was.
    pub fn record(&mut self, place: usize, track: &LiveTrack) {
        if track.life.is_confirmed() {
            for (label, window) in (2 * place..).zip([track.next, track.last]) {
                if label >= self.windows.len() {
                    self.windows.resize(label + 1, window);
                }
                self.windows[label] = window;
                self.outgrown |= 2.0 * radius_m(&window) > self.index.reach_m();
                if self.index.reach_m() > 0.0 {
                    self.index.put(label as u32, window.position_m);
                }
            }
            self.recorded += 1;
        }
    }

    /// Removes a track that has ended.
    pub fn forget(&mut self, place: usize) {
        self.index.remove(2 * place as u32);
        self.index.remove(2 * place as u32 + 1);
    }

    /// Replaces `found` by the places of the nearest confirmed tracks that may want the same plots as the track at `place` in this scan, with
    /// which of their predictions are of it.
    pub fn find(&self, place: usize, tracks: &TrackStore, found: &mut Vec<(usize, Of)>) {
        found.clear();
        let own = &tracks[place].next;
        let mut nearest = [None::<(f64, u32)>; MOST_NEAR];
        for label in self.index.near(own.position_m).filter(|label| *label as usize / 2 != place) {
            let of_this_scan =
                |label: u32| (self.windows[label as usize].angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU;
            // Of a track that both passages of are near, the one to come counts.
            let is_of_last_scan = label % 2 == 1;
            let window = &self.windows[label as usize];
            if !of_this_scan(label) || (is_of_last_scan && of_this_scan(label - 1)) || !overlap(own, window) {
                continue;
            }
            let square: f64 = (0..3).map(|axis| (window.position_m[axis] - own.position_m[axis]).powi(2)).sum();
            let nearer = |other: &Option<(f64, u32)>| {
                other.is_some_and(|(least, other)| least.total_cmp(&square).then(other.cmp(&label)).is_lt())
            };
            let rank = nearest.partition_point(nearer);
            if rank < MOST_NEAR {
                nearest[rank..].rotate_right(1);
                nearest[rank] = Some((square, label));
                found.truncate(MOST_NEAR - 1);
                found.insert(rank, (label as usize / 2, if is_of_last_scan { Of::LastScan } else { Of::NextScan }));
            }
        }
    }
}

/// How far plots in a window may lie from the target's place, m.
fn radius_m(window: &Opportunity) -> f64 {
    let range_m = length(window.position_m);
    let along_m = (range_m - window.range_m[0]).max(window.range_m[1] - range_m);
    along_m.hypot(range_m * window.half_width_rad).min(0.5 * REACH_M[1])
}

/// Whether one plot can lie in both windows.
fn overlap(a: &Opportunity, b: &Opportunity) -> bool {
    let apart = |a: [f64; 2], b: [f64; 2]| a[0] > b[1] || b[0] > a[1];
    if apart(a.range_m, b.range_m) || apart(a.elevation_rad, b.elevation_rad) {
        return false;
    }
    let ([east, north, _], [other_east, other_north, _]) = (a.position_m, b.position_m);
    let [across, along] = [east * other_north - north * other_east, east * other_east + north * other_north];
    across.abs().atan2(along) <= a.half_width_rad + b.half_width_rad
}

fn length([east, north, up]: [f64; 3]) -> f64 {
    (east * east + north * north + up * up).sqrt()
}
