//! Which track follows which target in a scan, and which tracks are one too many.

use crate::assignment::cheapest;

/// A target's last track keeps it against one that is nearer by less than this share of the gate.
const FAVOUR: f64 = 0.25;

/// What a track is to the targets of one scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It follows the target of this index.
    Follows(usize),
    /// It is within the gate of a target, but every such target has another track: a duplicate.
    Redundant,
    /// No target is within the gate.
    Far,
}

/// Who follows whom in one scan.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Pairing {
    /// The track of each target.
    pub track_of: Vec<Option<usize>>,
    /// What each track is.
    pub roles: Vec<Role>,
}

/// Pairs targets and tracks one to one at the least sum of distances, as many as can be.
///
/// | argument    | shape                   | unit           |
/// |-------------|-------------------------|----------------|
/// | `distances` | (target, track, d)      | of the states  |
/// | `gate`      | no track follows a target beyond it | as d |
/// | `holds`     | (target, track): whether that track followed it last |  |
///
/// A track that is not the last one of a target counts a quarter of the gate farther away, so that tracks of two targets
/// side by side are not exchanged at every scan.
pub fn pair(
    targets: usize,
    tracks: usize,
    distances: &[(usize, usize, f64)],
    gate: f64,
    holds: impl Fn(usize, usize) -> bool,
) -> Pairing {
    let near: Vec<_> = distances.iter().copied().filter(|&(_, _, distance)| distance <= gate).collect();
    let handicap = |target, track| if holds(target, track) { 0.0 } else { FAVOUR * gate };
    let costs: Vec<_> = near.iter().map(|&(x, y, distance)| (x, y, distance + handicap(x, y))).collect();
    // No pair within the gate costs as much as a target without a track.
    let track_of = cheapest(targets, tracks, &costs, 2.0 * gate);
    let mut roles = vec![Role::Far; tracks];
    for &(_, track, _) in &near {
        roles[track] = Role::Redundant;
    }
    for (target, track) in track_of.iter().enumerate() {
        if let Some(track) = *track {
            roles[track] = Role::Follows(target);
        }
    }
    Pairing { track_of, roles }
}

/// What a track has been to the targets in all its scans.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Standing {
    near: bool,
    redundant: bool,
}

impl Standing {
    /// Takes its role in a scan.
    pub fn note(&mut self, role: Role) {
        if role != Role::Far {
            self.note_near();
        }
        self.redundant |= role == Role::Redundant;
    }

    /// It was within the gate of a target that is not looked at further.
    pub fn note_near(&mut self) {
        self.near = true;
    }

    /// Whether it was never near a target: a false track.
    pub fn is_false(&self) -> bool {
        !self.near
    }

    /// Whether it was a duplicate in some scan.
    pub fn is_redundant(&self) -> bool {
        self.redundant
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GATE: f64 = 100.0;

    #[test]
    fn a_second_track_of_a_target_is_redundant() {
        let pairing = pair(1, 3, &[(0, 0, 30.0), (0, 1, 10.0), (0, 2, 500.0)], GATE, |_, _| false);
        assert_eq!(pairing.track_of, [Some(1)]);
        assert_eq!(pairing.roles, [Role::Redundant, Role::Follows(0), Role::Far]);
        let mut standing = Standing::default();
        assert!(standing.is_false());
        standing.note(Role::Far);
        assert!(standing.is_false() && !standing.is_redundant());
        standing.note(Role::Redundant);
        standing.note(Role::Follows(0));
        assert!(!standing.is_false() && standing.is_redundant());
    }

    #[test]
    fn a_target_keeps_its_track_unless_another_is_much_nearer() {
        let distances = |second| [(0, 0, 40.0), (0, 1, second)];
        let held = |_, track| track == 0;
        assert_eq!(pair(1, 2, &distances(20.0), GATE, held).track_of, [Some(0)]);
        assert_eq!(pair(1, 2, &distances(10.0), GATE, held).track_of, [Some(1)]);
        assert_eq!(pair(1, 2, &distances(20.0), GATE, |_, _| false).track_of, [Some(1)]);
    }

    proptest! {
        /// No track is given twice or from beyond the gate; a redundant one has only targets near it that have others; and none is
        /// redundant while a target near it has no track.
        #[test]
        fn roles_and_pairs_agree(places in prop::collection::vec(0.0..400.0_f64, 0..5), tracks in prop::collection::vec(0.0..400.0_f64, 0..5)) {
            let distance = |x: usize, y: usize| (places[x] - tracks[y]).abs();
            let all: Vec<_> =
                (0..places.len()).flat_map(|x| (0..tracks.len()).map(move |y| (x, y))).map(|(x, y)| (x, y, distance(x, y))).collect();
            let pairing = pair(places.len(), tracks.len(), &all, GATE, |x, y| x == y);
            for (y, role) in pairing.roles.iter().enumerate() {
                let near: Vec<usize> = (0..places.len()).filter(|&x| distance(x, y) <= GATE).collect();
                match *role {
                    Role::Follows(x) => prop_assert!(near.contains(&x) && pairing.track_of[x] == Some(y)),
                    Role::Redundant => prop_assert!(!near.is_empty() && near.iter().all(|&x| pairing.track_of[x].is_some_and(|other| other != y))),
                    Role::Far => prop_assert!(near.is_empty()),
                }
            }
            let follow = pairing.roles.iter().filter(|role| matches!(role, Role::Follows(_))).count();
            prop_assert_eq!(follow, pairing.track_of.iter().flatten().count());
        }
    }
}
