//! Records that were received before: a second line carries the same data, and networks repeat datagrams.

use std::collections::HashSet;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// A record is known for this long at least, and for twice as long at most, ns.
const KNOWN_NS: u64 = 10_000_000_000;
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
    /// Whether a record of a category was received before.
    pub fn is_repeated(&mut self, category: u8, octets: &[u8], now_ns: u64) -> bool {
        if now_ns.saturating_sub(self.since_ns) >= KNOWN_NS || self.young.len() >= MOST {
            self.old = std::mem::take(&mut self.young);
            if now_ns.saturating_sub(self.since_ns) >= 2 * KNOWN_NS {
                self.old.clear();
            }
            self.since_ns = now_ns;
        }
        let hash = self.hasher.hash_one((category, octets));
        !self.young.insert(hash) || self.old.contains(&hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_known_for_seconds_and_not_for_ever() {
        let mut repeats = Repeats::default();
        let mut is_repeated = |octets: &[u8], now_s: u64| repeats.is_repeated(48, octets, now_s * 1_000_000_000);
        assert!(!is_repeated(b"north", 1) && !is_repeated(b"sector", 2));
        assert!(is_repeated(b"north", 3) && is_repeated(b"sector", 9));
        assert!(is_repeated(b"north", 12));
        assert!(!is_repeated(b"north", 60));
    }
}
