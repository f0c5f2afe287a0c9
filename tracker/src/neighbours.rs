//! Who is near a place: squares over east and north, as wide as what counts as near.
//!
//! Whoever is near lies in the square of the place or in one of the eight around it. The squares in use are a sorted list:
//! n log n to build, log n and what is returned to ask. Nothing is allocated once it has grown.

/// Places with a label each.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    reach_m: f64,
    /// By square.
    places: Vec<Place>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    /// East, north.
    square: [i64; 2],
    label: u32,
}

impl Neighbours {
    /// Takes positions (m, east and north first) in place of those before; less than `reach_m` > 0 away is near.
    pub fn build(&mut self, reach_m: f64, places: impl Iterator<Item = ([f64; 3], u32)>) {
        self.reach_m = reach_m;
        self.places.clear();
        self.places.extend(places.map(|(position, label)| Place { square: square(position, reach_m), label }));
        self.places.sort_unstable();
    }

    /// Labels of all that are near `position`, once for each place of theirs, and of some that are not.
    pub fn near(&self, position: [f64; 3]) -> impl Iterator<Item = u32> {
        let [east, north] = square(position, self.reach_m);
        [-1, 0, 1].into_iter().flat_map(move |step| {
            let column = east.saturating_add(step);
            let first = [column, north.saturating_sub(1)];
            let last = [column, north.saturating_add(1)];
            let from = self.places.partition_point(|place| place.square < first);
            self.places[from..].iter().take_while(move |place| place.square <= last).map(|place| place.label)
        })
    }
}

fn square(position: [f64; 3], side_m: f64) -> [i64; 2] {
    [0, 1].map(|axis| (position[axis] / side_m).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against looking at everybody.
        #[test]
        fn all_that_are_near_are_found_and_nobody_far(
            places in prop::collection::vec([-2e3..2e3_f64, -2e3..2e3_f64, 0.0..10.0_f64], 0..200),
            position in [-2e3..2e3_f64, -2e3..2e3_f64, 0.0..10.0_f64],
            reach_m in 1.0..1000.0_f64,
        ) {
            let mut neighbours = Neighbours::default();
            neighbours.build(1.0, places.iter().copied().zip(0..).take(3)); // the list is reused
            neighbours.build(reach_m, places.iter().copied().zip(0..));
            let found: Vec<u32> = neighbours.near(position).collect();
            for (place, label) in places.iter().zip(0..) {
                let apart = [0, 1].map(|axis: usize| (place[axis] - position[axis]).abs());
                let times = found.iter().filter(|found| **found == label).count();
                prop_assert!(times <= 1);
                prop_assert!(times == 1 || apart[0].hypot(apart[1]) >= reach_m);
                prop_assert!(times == 0 || apart.iter().all(|apart| *apart <= 2.0 * reach_m));
            }
        }
    }

    #[test]
    fn impossible_places_are_no_reason_to_stop() {
        let mut neighbours = Neighbours::default();
        neighbours.build(300.0, [[f64::NAN; 3], [f64::INFINITY; 3], [f64::MIN; 3], [0.0; 3]].into_iter().zip(0..));
        assert!(neighbours.near([f64::MAX; 3]).count() < 4);
        assert!(neighbours.near([10.0; 3]).any(|label| label == 3));
    }
}
