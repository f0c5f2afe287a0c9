//! What M-of-N logic would bring without false plots and without errors of association.

use super::target::WINDOW;

/// Probability that a target detected with `pd` in every scan, independently, is confirmed within [`WINDOW`] scans by hits alone.
///
/// Two hits in a row start a track; it is confirmed by `hits` hits in `scans` scans, the two included, and ends when
/// these are over or after `misses` scans in a row without one.
pub(super) fn perfect_m_of_n(pd: f64, [hits, scans]: [u32; 2], misses: u32) -> f64 {
    let confirms = |sequence: u32| {
        let mut track: Option<[u32; 3]> = None; // age, hits, misses in a row
        for scan in 0..WINDOW {
            let hit = |scan: u32| sequence >> scan & 1 == 1;
            track = match track {
                None if scan > 0 && hit(scan) && hit(scan - 1) => Some([2, 2, 0]),
                None => None,
                Some([age, seen, _]) if hit(scan) => Some([age + 1, seen + 1, 0]),
                Some([age, seen, missed]) => Some([age + 1, seen, missed + 1]),
            };
            if let Some([age, seen, missed]) = track {
                if seen >= hits && age <= scans && hit(scan) {
                    return true;
                }
                if age > scans || missed >= misses {
                    track = None;
                }
            }
        }
        false
    };
    let probability = |sequence: u32| {
        let detected = sequence.count_ones() as i32;
        pd.powi(detected) * (1.0 - pd).powi(WINDOW as i32 - detected)
    };
    (0..1 << WINDOW).filter(|&sequence| confirms(sequence)).map(probability).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perfect_logic_by_hand() {
        // Two of two: at least one pair of neighbours in ten. The complement is counted by Fibonacci-like recursion.
        let pd: f64 = 0.7;
        let (mut last_missed, mut last_hit) = (1.0 - pd, pd);
        for _ in 1..WINDOW {
            (last_missed, last_hit) = ((last_missed + last_hit) * (1.0 - pd), last_missed * pd);
        }
        assert!((perfect_m_of_n(pd, [2, 2], 3) - (1.0 - last_missed - last_hit)).abs() < 1e-12);
        assert!((perfect_m_of_n(1.0, [4, 6], 3) - 1.0).abs() < 1e-12);
        assert!(perfect_m_of_n(0.0, [2, 2], 3).abs() < 1e-12);
        assert!(perfect_m_of_n(0.5, [4, 6], 3) < perfect_m_of_n(0.5, [3, 5], 3));
    }
}
