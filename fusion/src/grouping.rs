//! Which radars can have targets in common (F8), and which targets fly together (F9).

use nalgebra::Vector3;

/// Where a radar stands and how far it sees, in the axes of the centre; m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// East and north.
    pub place_m: [f64; 2],
    /// Greatest range D.
    pub range_m: f64,
}

/// The groups of radars, by a number for each: i and j are neighbours when √((x_i − x_j)² + (y_i − y_j)²) < D_i + D_j − R
/// (F8), and groups are the connected components. What two groups see has nothing in common, so they are worked in parallel.
pub fn groups(radars: &[Reach], margin_m: f64) -> Vec<usize> {
    let near = |a: &Reach, b: &Reach| {
        let apart = (a.place_m[0] - b.place_m[0]).hypot(a.place_m[1] - b.place_m[1]);
        apart < a.range_m + b.range_m - margin_m
    };
    components(radars.len(), |i| (0..radars.len()).filter(move |&j| j != i && near(&radars[i], &radars[j])))
}

/// The number of its connected component for each of `count` nodes.
pub(crate) fn components<I: Iterator<Item = usize>>(count: usize, neighbours: impl Fn(usize) -> I) -> Vec<usize> {
    let mut number = vec![usize::MAX; count];
    let (mut next, mut open) = (0, Vec::new());
    for start in 0..count {
        if number[start] != usize::MAX {
            continue;
        }
        number[start] = next;
        open.push(start);
        while let Some(node) = open.pop() {
            for neighbour in neighbours(node) {
                if number[neighbour] == usize::MAX {
                    number[neighbour] = next;
                    open.push(neighbour);
                }
            }
        }
        next += 1;
    }
    number
}

/// Limits within which a target flies in the formation of its leader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormationGate {
    /// East and north of the leader, m.
    pub ground_m: f64,
    /// Above and below it, m.
    pub height_m: f64,
    /// Difference of velocity east and north, m/s.
    pub velocity_mps: f64,
    /// Factor by which a member may exceed the limits before it leaves; 1 without hysteresis.
    pub hysteresis: f64,
}

impl FormationGate {
    /// Whether a target is a member; `already` says whether it has been one.
    pub fn holds(&self, from_leader_m: &Vector3<f64>, relative_mps: &Vector3<f64>, already: bool) -> bool {
        let factor = if already { self.hysteresis } else { 1.0 };
        let within = |value: f64, limit: f64| value.abs() <= factor * limit;
        within(from_leader_m.x, self.ground_m)
            && within(from_leader_m.y, self.ground_m)
            && within(from_leader_m.z, self.height_m)
            && within(relative_mps.x, self.velocity_mps)
            && within(relative_mps.y, self.velocity_mps)
    }
}
