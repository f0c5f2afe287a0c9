//! Records that were received before: a second line carries the same data, and networks repeat datagrams.

use std::collections::HashSet;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// A record is known for this long at least, and for twice as long at most, ns.
const KNOWN_NS: u64 = 10_000_000_000;
/// A record without a time of day may be the same in the next scan: it is known for this long, and for twice as long at most.
const KNOWN_TIMELESS_NS: u64 = 100_000_000;
/// Records that are known, at most, in each half.
const MOST: usize = 1 << 18;

/// Records of the last seconds.
#[derive(Debug, Default)]
pub struct Repeats {
    hasher: RandomState,
    young: HashSet<u64>,
    old: HashSet<u64>,
    since_ns: u64,
}

impl Repeats {
    /// Whether a record of a category, which may hold a time of day, was received before.
    pub fn is_repeated(&mut self, category: u8, octets: &[u8], has_time: bool, now_ns: u64) -> bool {
        if now_ns.saturating_sub(self.since_ns) >= KNOWN_NS || self.young.len() >= MOST {
            self.old = std::mem::take(&mut self.young);
            if now_ns.saturating_sub(self.since_ns) >= 2 * KNOWN_NS {
                self.old.clear();
            }
            self.since_ns = now_ns;
        }
        let hash = |period: u64| self.hasher.hash_one((category, octets, period));
        if has_time {
            let hash = hash(0);
            return !self.young.insert(hash) || self.old.contains(&hash);
        }
        let period = now_ns / KNOWN_TIMELESS_NS;
        let (hash, before) = (hash(period), hash(period.saturating_sub(1)));
        !self.young.insert(hash)
            || [hash, before].iter().any(|it| self.old.contains(it))
            || self.young.contains(&before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_known_for_seconds_and_not_for_ever() {
        let mut repeats = Repeats::default();
        let mut is_repeated = |octets: &[u8], now_s: u64| repeats.is_repeated(48, octets, true, now_s * 1_000_000_000);
        assert!(!is_repeated(b"north", 1) && !is_repeated(b"sector", 2));
        assert!(is_repeated(b"north", 3) && is_repeated(b"sector", 9));
        assert!(is_repeated(b"north", 12));
        assert!(!is_repeated(b"north", 60));
    }

    /// A target that stands still is reported alike in every scan by radars that send no time.
    #[test]
    fn a_record_without_time_is_another_one_in_the_next_scan() {
        let mut repeats = Repeats::default();
        for scan in 0..30_u64 {
            for (later_ns, is_repeated) in [(0, false), (4_000_000, true), (99_000_000, true)] {
                let now_ns = 1_714_867_200_000_000_000 + scan * 1_030_000_000 + later_ns;
                assert_eq!(
                    repeats.is_repeated(1, b"clutter", false, now_ns),
                    is_repeated,
                    "scan {scan}, {later_ns} ns"
                );
            }
        }
    }
}
