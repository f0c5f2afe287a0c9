//! Two tracks of one target: which of them goes, and when.
//!
//! Who takes the same best plot as a stronger track for some scans, at the same place and velocity, is its duplicate.

use common::tracks::Track;

use super::Tracker;
use crate::tracks::track::Twin;

/// Scans in which two tracks share their best plot before one of them goes: if one is tentative, and if both are confirmed.
const SHARED_SCANS: [u32; 2] = [2, 6];
/// The same of two that have been seen apart and may have plots in common: two targets that the radar does not resolve for as long are one
/// to it. Drones that cross in one cell share their plots for some fifteen scans, and their velocities come near each other.
const SHARED_SCANS_APART: u32 = 30;
/// Squared distance of two tracks' positions and velocities below which they may be one: of χ² with 6 degrees of freedom, 0.999.
const SAME: f64 = 22.458;

impl Tracker {
    /// Gives `plot` to the track at `place`, or leaves it to a stronger one that took it before. Returns the place of the weaker of the two.
    pub(super) fn own(&mut self, plot: usize, place: usize) -> Option<usize> {
        let before = self.find(self.plots.entry(plot).owner).filter(|&other| other != place);
        let Some(other) = before else {
            self.plots.entry_mut(plot).owner = Some(self.tracks.handle(place));
            return None;
        };
        let is_weaker = self.tracks[place].rank() < self.tracks[other].rank();
        let (weaker, stronger) = if is_weaker { (place, other) } else { (other, place) };
        let stronger = self.tracks.handle(stronger);
        self.plots.entry_mut(plot).owner = Some(stronger);
        self.tracks[weaker].note_twin(stronger);
        Some(weaker)
    }

    /// Ends a track that has followed the same plots as stronger ones for some scans.
    pub(super) fn merge_duplicate(&mut self, place: usize, tracks: &mut Vec<Track>) {
        let Some(Twin { track, scans, .. }) = self.tracks[place].twin else { return };
        let Some(other) = self.find(Some(track)).filter(|_| self.tracks.is_alive(place)) else { return };
        let (a, b) = (&self.tracks[place], &self.tracks[other]);
        let may_share = self.config.joint_association && [a, b].iter().all(|track| track.is_seen_apart(&self.config));
        let needed = if may_share {
            SHARED_SCANS_APART
        } else {
            SHARED_SCANS[usize::from(a.life.is_confirmed() && b.life.is_confirmed())]
        };
        if scans < needed || a.squared_distance(b) > SAME {
            return;
        }
        self.end_and_tell(place, tracks);
    }
}
