//! Termination of duplicate tracks of one target.
//!
//! A track that takes the same best plot as a stronger one for some scans, at the same place and velocity, is its duplicate.

use common::tracks::Track;

use super::Tracker;
use crate::constants::{MOST_PASSING, PASSING_SPEED, SAME, SHARED_SCANS};
use crate::environment::Environment;
use crate::tracks::track::DuplicateOf;

impl Tracker {
    /// Gives `plot` to the track at `place`, or leaves it to a stronger one that took it before. Returns the place of the weaker of the two.
    pub(super) fn assign_owner(&mut self, plot: usize, place: usize) -> Option<usize> {
        let before = self.find(self.plots.entry(plot).owner).filter(|&other| other != place);
        let Some(other) = before else {
            self.plots.entry_mut(plot).owner = Some(self.tracks.handle(place));
            return None;
        };
        let is_weaker = self.tracks[place].rank() < self.tracks[other].rank();
        let (weaker, stronger) = if is_weaker { (place, other) } else { (other, place) };
        let stronger = self.tracks.handle(stronger);
        self.plots.entry_mut(plot).owner = Some(stronger);
        self.tracks[weaker].note_duplicate(stronger);
        Some(weaker)
    }

    /// Ends a track that has followed the same plots as stronger ones for some scans.
    pub(super) fn merge_duplicate(&mut self, place: usize, environment: &Environment, messages: &mut Vec<Track>) {
        let Some(DuplicateOf { track, scans, .. }) = self.tracks[place].duplicate_of else { return };
        let Some(other) = self.find(Some(track)).filter(|_| self.tracks.is_alive(place)) else { return };
        let (a, b) = (&self.tracks[place], &self.tracks[other]);
        let may_share = self.config.joint_association && [a, b].iter().all(|track| track.is_seen_apart(&self.config));
        let of_one_target = SHARED_SCANS[usize::from(a.life.is_confirmed() && b.life.is_confirmed())];
        let passing = || {
            let cell_m = environment.radar.cell_m(a.last.range_m[0].midpoint(a.last.range_m[1]));
            (cell_m / (PASSING_SPEED * environment.limits.speed_mps * self.sweep.period_s())).ceil().min(MOST_PASSING)
                as u32
        };
        let needed = if may_share { of_one_target.max(passing()) } else { of_one_target };
        if scans < needed || self.tracks.squared_distance(place, other) > SAME {
            return;
        }
        self.end_and_tell(place, environment, messages);
    }
}
