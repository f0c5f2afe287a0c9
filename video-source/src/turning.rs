//! The position of each spoke in the scan: the dwell that it fills, counted on from turn to turn.
//!
//! Spokes come at even steps, but say their azimuth in steps of their own, and that of a ship's radar trembles with the compass. A
//! spoke that is no more than three quarters of a dwell from where the next one is expected is the next one. One that is farther ahead comes after
//! lost ones, if the antenna may have turned so far since the last one; else it is left out, unless the next one follows it. One that
//! is behind is a second one of a dwell, or of another radar, and is left out.

use std::f64::consts::TAU;

/// Distance from the expected azimuth, dwells, up to which a spoke is the expected one.
const TREMBLING: f64 = 0.75;
/// An antenna may have turned by twice the dwells that time says and this share of a turn: packets wait on their way, and clocks are coarse.
const SLACK: f64 = 1.0 / 64.0;

/// Counts dwells.
#[derive(Debug, Clone)]
pub struct Turning {
    dwells_per_scan: u32,
    last: Option<u64>,
    /// Place of the spoke before, if it was left out as too far ahead.
    doubted: Option<u64>,
}

impl Turning {
    /// Turns of so many dwells, the first one beginning at north.
    pub fn new(dwells_per_scan: u32) -> Self {
        Self { dwells_per_scan, last: None, doubted: None }
    }

    /// Position of the spoke at `azimuth_rad`: scan · dwells per scan + dwell; none if its dwell is taken, behind the beam or too far ahead
    /// of it. Since the last one about `passed` dwells have gone by; none where times are not known, and every spoke ahead is believed.
    pub fn place(&mut self, azimuth_rad: f64, passed: Option<f64>) -> Option<u64> {
        let dwells = f64::from(self.dwells_per_scan);
        // Centres of dwells lie half a dwell after their beginnings.
        let measured = azimuth_rad / TAU * dwells - 0.5;
        let place = match self.last {
            None => measured.round().rem_euclid(dwells) as u64,
            Some(last) => {
                let expected = last + 1;
                let ahead = measured - (expected % u64::from(self.dwells_per_scan)) as f64;
                let ahead = (ahead + dwells / 2.0).rem_euclid(dwells) - dwells / 2.0;
                let place = if ahead.abs() <= TREMBLING {
                    expected
                } else {
                    expected.checked_add_signed(ahead.round() as i64)?
                };
                if place < expected {
                    return None;
                }
                let follows_doubted = self.doubted.is_some_and(|doubted| (doubted + 1..=doubted + 2).contains(&place));
                let may_be = passed.is_none_or(|passed| ahead <= 2.0 * passed.max(0.0) + (SLACK * dwells).max(2.0));
                if !may_be && !follows_doubted {
                    self.doubted = Some(place);
                    return None;
                }
                place
            }
        };
        (self.last, self.doubted) = (Some(place), None);
        Some(place)
    }

    /// Position of the spoke at `azimuth_rad` after a pause in which the antenna has gone on by about `passed` dwells.
    pub fn resume(&mut self, azimuth_rad: f64, passed: f64) -> Option<u64> {
        let Some(last) = self.last else { return self.place(azimuth_rad, None) };
        let dwells = f64::from(self.dwells_per_scan);
        let about = last as f64 + passed;
        let ahead = (azimuth_rad / TAU * dwells - 0.5 - about).rem_euclid(dwells);
        let nearest = about + if ahead > dwells / 2.0 { ahead - dwells } else { ahead };
        let place = (nearest.round() as u64).max(last + 1);
        (self.last, self.doubted) = (Some(place), None);
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
            let place = turning.place(azimuth_rad, Some(1.0)).expect("each spoke has its dwell");
            assert_eq!(place, spoke + 302, "spoke {spoke}");
        }
    }

    #[test]
    fn a_pause_is_as_many_turns_as_its_time_says() {
        for (passed, expected) in [(64.0 * 3.0 + 5.0, 3 * 64 + 15), (64.0 * 2.6, 2 * 64 + 15 + 64), (40.0, 15 + 64)] {
            let mut turning = Turning::new(64);
            assert_eq!(turning.place(10.5 / 64.0 * TAU, None), Some(10));
            let place = turning.resume(15.5 / 64.0 * TAU, passed);
            assert_eq!(place, Some(expected), "{passed}");
            assert_eq!(turning.place(16.5 / 64.0 * TAU, Some(1.0)), Some(expected + 1));
        }
    }

    #[test]
    fn a_spoke_that_is_too_far_ahead_is_one_if_the_next_follows_it() {
        let azimuth_rad = |dwell: f64| (dwell + 0.5) / 256.0 * TAU;
        let mut turning = Turning::new(256);
        let mut place = |dwell: f64| turning.place(azimuth_rad(dwell), Some(1.0));
        assert_eq!((place(10.0), place(100.0), place(11.0)), (Some(10), None, Some(11)), "one stray");
        assert_eq!((place(60.0), place(61.2), place(62.0)), (None, Some(61), Some(62)), "many have come at once");
        assert_eq!(
            (place(140.0), place(30.0), place(141.0)),
            (None, None, Some(141)),
            "behind is no witness against it"
        );
    }

    proptest! {
        /// Whatever is lost, every spoke that is left has the dwell of its azimuth, and its turn.
        #[test]
        fn lost_spokes_leave_their_dwells_empty(dwells in 64_u32..5000, lost in prop::collection::vec(0_u64..20, 1..200)) {
            let mut turning = Turning::new(dwells);
            let (mut place, mut passed) = (3, 1.0);
            for lost in lost {
                let azimuth_rad = ((place % u64::from(dwells)) as f64 + 0.5) / f64::from(dwells) * TAU;
                prop_assert_eq!(turning.place(azimuth_rad, Some(passed)), Some(place));
                prop_assert_eq!(turning.place(azimuth_rad, Some(0.0)), None, "a second time");
                place += 1 + lost;
                passed = 1.0 + lost as f64;
            }
        }
    }
}
