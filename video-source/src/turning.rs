//! The position of each spoke in the scan: the dwell that it fills, counted on from turn to turn.
//!
//! Spokes come at even steps, but say their azimuth in steps of their own, and that of a ship's radar trembles with the compass. A
//! spoke that is no more than three quarters of a dwell from where the next one is expected is the next one. One that is farther ahead comes after
//! lost ones; one that is behind is a second one of a dwell, or of another radar, and is left out.

use std::f64::consts::TAU;

/// Distance from the expected azimuth, dwells, up to which a spoke is the expected one.
const TREMBLING: f64 = 0.75;

/// Counts dwells.
#[derive(Debug, Clone)]
pub struct Turning {
    dwells_per_scan: u32,
    last: Option<u64>,
}

impl Turning {
    /// Turns of so many dwells, the first one beginning at north.
    pub fn new(dwells_per_scan: u32) -> Self {
        Self { dwells_per_scan, last: None }
    }

    /// Position of the spoke at `azimuth_rad`: scan · dwells per scan + dwell; none if its dwell is taken or behind the beam.
    pub fn place(&mut self, azimuth_rad: f64) -> Option<u64> {
        let dwells = f64::from(self.dwells_per_scan);
        // Centres of dwells lie half a dwell after their beginnings.
        let measured = azimuth_rad / TAU * dwells - 0.5;
        let place = match self.last {
            None => measured.round().rem_euclid(dwells) as u64,
            Some(last) => {
                let expected = last + 1;
                let ahead = measured - (expected % u64::from(self.dwells_per_scan)) as f64;
                let ahead = (ahead + dwells / 2.0).rem_euclid(dwells) - dwells / 2.0;
                if ahead.abs() <= TREMBLING {
                    expected
                } else if ahead > 0.0 {
                    expected + ahead.round() as u64
                } else {
                    return None;
                }
            }
        };
        self.last = Some(place);
        Some(place)
    }

    /// Position of the spoke at `azimuth_rad` after a pause in which the antenna has gone on by about `passed` dwells.
    pub fn resume(&mut self, azimuth_rad: f64, passed: f64) -> Option<u64> {
        let Some(last) = self.last else { return self.place(azimuth_rad) };
        let dwells = f64::from(self.dwells_per_scan);
        let about = last as f64 + passed;
        let ahead = (azimuth_rad / TAU * dwells - 0.5 - about).rem_euclid(dwells);
        let nearest = about + if ahead > dwells / 2.0 { ahead - dwells } else { ahead };
        let place = (nearest.round() as u64).max(last + 1);
        self.last = Some(place);
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_trembling_compass_loses_no_dwell() {
        // Angles of 2048 spokes in 4096 steps, and a heading that goes up and down by one.
        let mut turning = Turning::new(2048);
        for spoke in 0..5000_u64 {
            let steps = 2 * spoke + 605 + (spoke / 7) % 2;
            let azimuth_rad = (steps % 4096) as f64 / 4096.0 * TAU;
            let place = turning.place(azimuth_rad).expect("each spoke has its dwell");
            assert_eq!(place, spoke + 302, "spoke {spoke}");
        }
    }

    #[test]
    fn a_pause_is_as_many_turns_as_its_time_says() {
        for (passed, expected) in [(64.0 * 3.0 + 5.0, 3 * 64 + 15), (64.0 * 2.6, 2 * 64 + 15 + 64), (40.0, 15 + 64)] {
            let mut turning = Turning::new(64);
            assert_eq!(turning.place(10.5 / 64.0 * TAU), Some(10));
            let place = turning.resume(15.5 / 64.0 * TAU, passed);
            assert_eq!(place, Some(expected), "{passed}");
            assert_eq!(turning.place(16.5 / 64.0 * TAU), Some(expected + 1));
        }
    }

    proptest! {
        /// Whatever is lost, every spoke that is left has the dwell of its azimuth, and its turn.
        #[test]
        fn lost_spokes_leave_their_dwells_empty(dwells in 64_u32..5000, lost in prop::collection::vec(0_u64..20, 1..200)) {
            let mut turning = Turning::new(dwells);
            let mut place = 3;
            for lost in lost {
                let azimuth_rad = ((place % u64::from(dwells)) as f64 + 0.5) / f64::from(dwells) * TAU;
                prop_assert_eq!(turning.place(azimuth_rad), Some(place));
                prop_assert_eq!(turning.place(azimuth_rad), None, "a second time");
                place += 1 + lost;
            }
        }
    }
}
