//! The confirmed tracks of a whole tracker against its targets, turn by turn.

use std::collections::BTreeMap;

use common::tracks::Track;
use evaluation::following::{Standing, pair};
use evaluation::gospa::{Gospa, gospa};
use evaluation::identity::Holder;
use evaluation::ospa::{Ospa, ospa};
use nalgebra::Vector3;
use radar_sim::motion::Segments;

use crate::turning::seconds;

/// Cut-off (m) and order of OSPA and GOSPA, those of the report of a run.
pub const CUTOFF_M: f64 = 100.0;
const ORDER: f64 = 2.0;

/// OSPA and GOSPA of targets and tracks at these distances (target, track, m).
pub fn distances_of_sets(targets: usize, tracks: usize, distances: &[(usize, usize, f64)]) -> (Ospa, Gospa) {
    let near: Vec<_> = distances.iter().copied().filter(|&(_, _, distance)| distance < CUTOFF_M).collect();
    (ospa(targets, tracks, &near, CUTOFF_M, ORDER), gospa(targets, tracks, &near, CUTOFF_M, ORDER))
}

/// Judges one run.
#[derive(Debug)]
pub struct Judge {
    gate_m: f64,
    holders: Vec<Holder<u64>>,
    standings: BTreeMap<u64, Standing>,
}

/// What there was in one turn.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The track of each target and its distance, m.
    pub tracks: Vec<Option<(u64, f64)>>,
    /// Distance of targets and tracks.
    pub ospa: Ospa,
    /// The same with missed targets and false tracks apart.
    pub gospa: Gospa,
}

impl Judge {
    /// A track follows a target within `gate_m`.
    pub fn new(gate_m: f64) -> Self {
        Self { gate_m, holders: Vec::new(), standings: BTreeMap::new() }
    }

    /// Takes the confirmed among the tracks that a turn has brought up to date. Targets are those that are there; each keeps its
    /// place in the list.
    pub fn turn(&mut self, tracks: &[Track], targets: &[Segments]) -> Verdict {
        // A track that was reported twice counts with its last report.
        let reports: BTreeMap<u64, &Track> =
            tracks.iter().filter(|track| track.is_confirmed()).map(|track| (track.id, track)).collect();
        let ids: Vec<u64> = reports.keys().copied().collect();
        let mut distances = Vec::new();
        for (row, target) in targets.iter().enumerate() {
            for (column, track) in reports.values().enumerate() {
                let truth = target.at(seconds(track.time_ns)).position_m;
                distances.push((row, column, (Vector3::from(track.position_m()) - truth).norm()));
            }
        }
        self.holders.resize(targets.len().max(self.holders.len()), Holder::default());
        let pairing =
            pair(targets.len(), ids.len(), &distances, self.gate_m, |row, column| self.holders[row].is(&ids[column]));
        for (id, role) in ids.iter().zip(pairing.roles) {
            self.standings.entry(*id).or_default().note(role);
        }
        let tracks: Vec<Option<(u64, f64)>> = pairing
            .track_of
            .iter()
            .enumerate()
            .map(|(row, column)| column.map(|column| (ids[column], distances[row * ids.len() + column].2)))
            .collect();
        for (holder, track) in self.holders.iter_mut().zip(&tracks) {
            if let Some((id, _)) = track {
                holder.follow(*id);
            }
        }
        let (ospa, gospa) = distances_of_sets(targets.len(), ids.len(), &distances);
        Verdict { tracks, ospa, gospa }
    }

    /// Tracks that were duplicates in some turn.
    pub fn redundant(&self) -> u64 {
        self.standings.values().filter(|standing| standing.is_redundant()).count() as u64
    }

    /// Tracks that were never near a target.
    pub fn spurious(&self) -> u64 {
        self.standings.values().filter(|standing| standing.is_false()).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::{CONFIRMED, TENTATIVE};

    fn track(id: u64, east_m: f64, state_code: u32) -> Track {
        let mut track = Track { id, time_ns: crate::turning::EPOCH_NS, state_code, ..Track::default() };
        track.state[0] = east_m;
        track
    }

    /// A second confirmed track of the only target is seen, by the count and by the false part of GOSPA; a tentative one is not.
    #[test]
    fn a_duplicate_is_seen() {
        let target = [Segments::straight(Vector3::zeros(), Vector3::zeros())];
        let mut judge = Judge::new(200.0);
        let alone = judge.turn(&[track(1, 3.0, CONFIRMED), track(2, 8.0, TENTATIVE)], &target);
        assert_eq!((alone.tracks[0], alone.gospa.false_tracks, judge.redundant()), (Some((1, 3.0)), 0, 0));
        let twice = judge.turn(&[track(1, 3.0, CONFIRMED), track(2, 1.0, CONFIRMED)], &target);
        assert_eq!((twice.tracks[0], twice.gospa.false_tracks), (Some((1, 3.0)), 1));
        assert!(twice.gospa.spurious > 70.0 && twice.ospa.cardinality > 70.0, "{twice:?}");
        assert_eq!((judge.redundant(), judge.spurious()), (1, 0));
        judge.turn(&[track(1, 3.0, CONFIRMED), track(3, 900.0, CONFIRMED)], &target);
        assert_eq!((judge.redundant(), judge.spurious()), (1, 1));
        assert_eq!(judge.turn(&[], &target).gospa.missed_targets, 1);
    }
}
