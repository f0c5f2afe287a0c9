//! How long it takes until a new target is followed.

/// Scans from the first in which the target can be seen to the first in which a confirmed track follows it, both
/// included; `None` if that never happens.
///
/// `seen_and_followed` has one pair a scan: the target is inside the coverage; a confirmed track follows it. Scans before the
/// target is first seen do not count. The least possible value is the number of plots that the logic asks for.
pub fn delay_scans(seen_and_followed: impl IntoIterator<Item = (bool, bool)>) -> Option<u64> {
    let since_seen = seen_and_followed.into_iter().skip_while(|&(seen, _)| !seen);
    since_seen.zip(1..).find_map(|((_, followed), scans)| followed.then_some(scans))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_count() {
        let scans = |seen: &str, followed: &str| {
            let is = |c: char| c == '1';
            delay_scans(seen.chars().zip(followed.chars()).map(|(seen, followed)| (is(seen), is(followed))))
        };
        assert_eq!(scans("0011111", "0000011"), Some(4));
        assert_eq!(scans("1", "1"), Some(1));
        // A track that was there before does not count before the target can be seen.
        assert_eq!(scans("0011", "1100"), None);
        assert_eq!(scans("0011", "1101"), Some(2));
        assert_eq!(scans("", ""), None);
        // Out of sight in between, time goes on.
        assert_eq!(scans("1001", "0001"), Some(4));
    }
}
