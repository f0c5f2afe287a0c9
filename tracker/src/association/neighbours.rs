//! Tracks near a position, by a spatial index: squares over east and north, twice as wide as what counts as near.
//!
//! What is near lies in one of four squares about the nearest corner. Squares are hashed; those that share a bucket form a
//! chain. A track that moves is taken out of one chain and put into another, so no other is looked at, and a question costs four buckets
//! and what is returned. Nothing is allocated once it has grown.

/// Buckets from the start.
const FEWEST_BUCKETS: usize = 256;
/// The end of a chain.
const END: u32 = u32::MAX;

/// Places with a label each.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    reach_m: f64,
    /// First of the chain of each bucket; as many as a power of two.
    buckets: Vec<u32>,
    /// By label.
    places: Vec<Place>,
    count: usize,
}

#[derive(Debug, Clone, Copy)]
struct Place {
    /// East, north.
    square: [i64; 2],
    next: u32,
    previous: u32,
    is_taken: bool,
}

impl Place {
    const FREE: Self = Self { square: [0; 2], next: END, previous: END, is_taken: false };
}

impl Neighbours {
    /// Forgets all; from now on less than `reach_m` > 0 away is near.
    pub fn clear(&mut self, reach_m: f64) {
        self.reach_m = reach_m;
        self.buckets.fill(END);
        self.places.clear();
        self.count = 0;
    }

    /// Less than this is near, m.
    pub fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Puts `label` to a position (m, east and north first), wherever it was before.
    pub fn put(&mut self, label: u32, position: [f64; 3]) {
        let square = square(position, 2.0 * self.reach_m);
        let index = label as usize;
        if index >= self.places.len() {
            self.places.resize(index + 1, Place::FREE);
        }
        if self.places[index].is_taken {
            if self.places[index].square == square {
                return;
            }
            self.remove(label);
        }
        self.places[index] = Place { square, is_taken: true, ..Place::FREE };
        self.count += 1;
        if self.count > self.buckets.len() {
            self.spread();
        } else {
            self.link(label);
        }
    }

    /// Takes `label` away, if it is there.
    pub fn remove(&mut self, label: u32) {
        let Some(&Place { square, next, previous, is_taken: true }) = self.places.get(label as usize) else { return };
        if previous == END {
            let bucket = self.bucket(square);
            self.buckets[bucket] = next;
        } else {
            self.places[previous as usize].next = next;
        }
        if next != END {
            self.places[next as usize].previous = previous;
        }
        self.places[label as usize] = Place::FREE;
        self.count -= 1;
    }

    /// Labels of all that are near `position`, and of some that are not, in no order.
    pub fn near(&self, position: [f64; 3]) -> impl Iterator<Item = u32> {
        // The square whose corner is nearest: it and the three after it hold all that is near.
        let [east, north] = square(position.map(|along| along - self.reach_m), 2.0 * self.reach_m);
        let steps = if self.count == 0 { 0 } else { 4 };
        (0..steps).flat_map(move |step| {
            let square = [east.saturating_add(step / 2), north.saturating_add(step % 2)];
            let mut label = self.buckets[self.bucket(square)];
            std::iter::from_fn(move || {
                while label != END {
                    let (found, place) = (label, self.places[label as usize]);
                    label = place.next;
                    if place.square == square {
                        return Some(found);
                    }
                }
                None
            })
        })
    }

    fn link(&mut self, label: u32) {
        let bucket = self.bucket(self.places[label as usize].square);
        let next = std::mem::replace(&mut self.buckets[bucket], label);
        if next != END {
            self.places[next as usize].previous = label;
        }
        self.places[label as usize].next = next;
    }

    /// Doubles the buckets.
    fn spread(&mut self) {
        let buckets = (2 * self.count).next_power_of_two().max(FEWEST_BUCKETS);
        self.buckets.clear();
        self.buckets.resize(buckets, END);
        for label in 0..self.places.len() {
            if self.places[label].is_taken {
                self.places[label].previous = END;
                self.link(label as u32);
            }
        }
    }

    fn bucket(&self, square: [i64; 2]) -> usize {
        // The upper bits of a product depend on all of a factor's.
        let mixed = (square[0] as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (square[1] as u64);
        (mixed.wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 32) as usize & (self.buckets.len() - 1)
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
        /// Against looking at everybody, after some have moved and some have gone.
        #[test]
        fn all_that_are_near_are_found_and_nobody_far(
            moves in prop::collection::vec((0_u32..60, [-2e3..2e3_f64, -2e3..2e3_f64, 0.0..10.0_f64], 0..4), 0..300),
            position in [-2e3..2e3_f64, -2e3..2e3_f64, 0.0..10.0_f64],
            reach_m in 1.0..1000.0_f64,
        ) {
            let mut neighbours = Neighbours::default();
            neighbours.clear(1.0);
            neighbours.put(3, position);
            neighbours.clear(reach_m);
            let mut places = [None; 60];
            for (label, place, kind) in moves {
                if kind == 0 {
                    neighbours.remove(label);
                    places[label as usize] = None;
                } else {
                    neighbours.put(label, place);
                    places[label as usize] = Some(place);
                }
            }
            let found: Vec<u32> = neighbours.near(position).collect();
            for (place, label) in places.iter().zip(0..) {
                let times = found.iter().filter(|found| **found == label).count();
                let Some(place) = place else {
                    prop_assert!(times == 0);
                    continue;
                };
                let apart = [0, 1].map(|axis: usize| (place[axis] - position[axis]).abs());
                prop_assert!(times <= 1);
                prop_assert!(times == 1 || apart[0].hypot(apart[1]) >= reach_m);
                prop_assert!(times == 0 || apart.iter().all(|apart| *apart <= 3.0 * reach_m));
            }
        }
    }

    #[test]
    fn impossible_places_are_no_reason_to_stop() {
        let mut neighbours = Neighbours::default();
        neighbours.clear(300.0);
        for (place, label) in [[f64::NAN; 3], [f64::INFINITY; 3], [f64::MIN; 3], [0.0; 3]].into_iter().zip(0..) {
            neighbours.put(label, place);
        }
        // Saturated squares are asked for once each way.
        assert!(neighbours.near([f64::MAX; 3]).all(|label| label == 1));
        assert!(neighbours.near([10.0; 3]).any(|label| label == 3));
    }
}
