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
const SLACK: f64 = 1.25;
/// The index is reviewed when every track has been recorded so many times.
const REVIEW: usize = 8;
/// Least and largest reach of the index, m.
const REACH_M: [f64; 2] = [1.0, 1e6];

/// What is known of the plots of a message beside where they are.
#[derive(Debug, Clone, Copy, Default)]
pub struct Plots {
    /// How much farther a gate reaches in range than for plots of nominal errors, m.
    pub margin_m: f64,
    /// Some have no elevation: they lie in gates of any.
    pub some_are_flat: bool,
}

/// The confirmed tracks, by where they are expected.
#[derive(Debug, Default)]
pub struct Rivals {
    index: Neighbours,
    /// By place of the track: a circle about its windows, east and north of the middle and the radius, m. A glance at it tells most tracks apart.
    circles: Vec<[f32; 3]>,
    /// By place: the windows of the scan to come, and of the last one.
    windows: Vec<[Opportunity; 2]>,
    /// A circle reaches farther than the index.
    outgrown: bool,
    /// Tracks recorded since the last review.
    recorded: usize,
}

impl Rivals {
    /// Reviews how far the index reaches: as far as the widest circles of a track that is looked for and of one that looks.
    pub fn review(&mut self, tracks: &TrackStore) {
        if !self.outgrown && self.recorded < REVIEW * tracks.len() {
            return;
        }
        (self.outgrown, self.recorded) = (false, 0);
        let confirmed = || tracks.alive().filter(|&place| tracks[place].life.is_confirmed());
        let widest = |radii: &mut dyn Iterator<Item = f64>| radii.fold(0.0, f64::max);
        let circle = widest(&mut confirmed().map(|place| radius_m(&[tracks[place].next, tracks[place].last])));
        let window = widest(&mut tracks.alive().map(|place| radius_m(&[tracks[place].next; 2])));
        let needed_m = (circle + window.max(circle)).clamp(REACH_M[0], REACH_M[1]);
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
        if !track.life.is_confirmed() {
            return;
        }
        let windows = [track.next, track.last];
        if place >= self.windows.len() {
            self.windows.resize(place + 1, windows);
            self.circles.resize(place + 1, [0.0; 3]);
        }
        let ([east_m, north_m, _], radius_m) = (track.next.position_m, radius_m(&windows));
        self.windows[place] = windows;
        self.circles[place] = [east_m as f32, north_m as f32, rounded_up(radius_m)];
        self.outgrown |= 2.0 * radius_m > self.index.reach_m();
        self.recorded += 1;
        if self.index.reach_m() > 0.0 {
            self.index.put(place as u32, track.next.position_m);
        }
    }

    /// Removes a track that has ended.
    pub fn forget(&mut self, place: usize) {
        self.index.remove(place as u32);
    }

    /// Replaces `found` by the places of the nearest confirmed tracks that may want the same plots as the track at `place` in this scan, with
    /// which of their predictions are of it.
    pub fn find(&self, place: usize, tracks: &TrackStore, plots: Plots, found: &mut Vec<(usize, Of)>) {
        found.clear();
        let own = &tracks[place].next;
        let mut nearest = [None::<(f64, usize)>; MOST_NEAR];
        let [east_m, north_m] = [own.position_m[0] as f32, own.position_m[1] as f32];
        let own_radius_m = rounded_up(radius_m(&[*own; 2]) + 2.0 * plots.margin_m);
        for other in self.index.near(own.position_m).map(|place| place as usize) {
            let [other_east_m, other_north_m, radius_m] = self.circles[other];
            let reach_m = own_radius_m + radius_m;
            if (other_east_m - east_m).abs() > reach_m || (other_north_m - north_m).abs() > reach_m || other == place {
                continue;
            }
            let of_this_scan = |window: &Opportunity| (window.angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU;
            let [next, last] = &self.windows[other];
            let (of, window) = match [next, last].map(of_this_scan) {
                [true, _] => (Of::NextScan, next),
                [false, true] => (Of::LastScan, last),
                [false, false] => continue,
            };
            if !overlap(own, window, plots) {
                continue;
            }
            let square: f64 = (0..3).map(|axis| (window.position_m[axis] - own.position_m[axis]).powi(2)).sum();
            let nearer = |than: &Option<(f64, usize)>| {
                than.is_some_and(|(least, place)| least.total_cmp(&square).then(place.cmp(&other)).is_lt())
            };
            let rank = nearest.partition_point(nearer);
            if rank < MOST_NEAR {
                nearest[rank..].rotate_right(1);
                nearest[rank] = Some((square, other));
                found.truncate(MOST_NEAR - 1);
                found.insert(rank, (other, of));
            }
        }
    }
}

/// How far plots in two windows of a track may lie from the place of the first, m.
fn radius_m([next, last]: &[Opportunity; 2]) -> f64 {
    let moved_m = length(std::array::from_fn(|axis| last.position_m[axis] - next.position_m[axis]));
    let about_m = |window: &Opportunity| {
        let range_m = length(window.position_m);
        let along_m = (range_m - window.range_m[0]).max(window.range_m[1] - range_m);
        let across_m = (range_m * range_m.max(window.range_m[1])).sqrt() * window.half_width_rad;
        along_m.hypot(across_m)
    };
    let radius_m = about_m(next).max(moved_m + about_m(last));
    // Nobody is near a track of which nothing is known any more.
    if radius_m.is_finite() { radius_m.min(0.5 * REACH_M[1]) } else { 0.0 }
}

/// A radius, m, in single precision, so much larger that nobody is missed for rounding of places up to 1000 km away.
fn rounded_up(radius_m: f64) -> f32 {
    (1.001 * radius_m) as f32 + 0.1
}

/// Whether one plot can lie in both windows.
fn overlap(a: &Opportunity, b: &Opportunity, plots: Plots) -> bool {
    let apart = |a: [f64; 2], b: [f64; 2], by: f64| a[0] > b[1] + by || b[0] > a[1] + by;
    if apart(a.range_m, b.range_m, 2.0 * plots.margin_m)
        || (!plots.some_are_flat && apart(a.elevation_rad, b.elevation_rad, 0.0))
    {
        return false;
    }
    let ([east, north, _], [other_east, other_north, _]) = (a.position_m, b.position_m);
    let [across, along] = [east * other_north - north * other_east, east * other_east + north * other_north];
    across.abs().atan2(along) <= a.half_width_rad + b.half_width_rad
}

fn length([east, north, up]: [f64; 3]) -> f64 {
    (east * east + north * north + up * up).sqrt()
}
